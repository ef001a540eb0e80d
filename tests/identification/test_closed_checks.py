"""Checks without a model: sound campaigns pass with every tolerance in them, and a mistake is called by its name."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS, MOTIONS, DynamicMass
from geometry.errors import BadInput
from geometry.inertia import Inertia
from geometry.sensors import ChannelTable, Tolerances
from identification import consistency
from identification.base_motion import base_motion, resultants
from identification.campaign import Campaign
from identification.chain import chain
from identification.consistency import Mistake
from identification.dynamic_mass import from_runs
from identification.elastic import model
from identification.elastic.model import ElasticTerms, dynamic_mass
from identification.identify import BENT, BROKEN, MISFIT, contradictions, failures, first_resonance, judged
from identification.request import Identified
from identification.spectra.line_spectra import Spectra
from identification.spectra.of_campaign import spectra

LINES = np.linspace(4.0, 32.0, 29)
LEVEL = np.array(list(LEVELS.values()))
BODY = Inertia.from_cog(mass=41.0, cog=[0.012, -0.008, 0.1], tensor=np.diag([0.9, 0.95, 0.75]))
ORDINARY = Tolerances()


def _sway(frequency: float) -> ElasticTerms:
    """A mast that bends along x and y at nearly the same frequency, with half of the mass 0.5 m above."""
    omega = 2 * np.pi * frequency
    L = np.array([[4.5, 0, 0, 0, 2.2, 0], [0, 4.5, 0, -2.2, 0, 0]])
    return ElasticTerms(frequency=np.array([1.0, 1.02]) * frequency, damping=0.007 * omega * np.eye(2), participation=L)


def made(
    table: ChannelTable,
    *,
    offset: float = 1.0,
    signs: bool = False,
    seed: int = 0,
    terms: ElasticTerms | None = None,
    lines: np.ndarray = LINES,
) -> Spectra:
    """Spectra of six runs of a body on a stiff FMD; channels are off by `offset` tolerances, normal ones or random signs only."""
    rng = np.random.default_rng(seed)
    of = chain(table, ORDINARY, stiffness=np.inf)
    draw = rng.standard_normal(len(of.parameters))
    A0, A1 = of.rows(offset * of.tolerances * (np.sign(draw) if signs else draw), lines)
    cross = rng.standard_normal((2, 6, len(lines), 6)) * 0.03
    U = (np.eye(6)[:, None, :] + cross[0] + 1j * cross[1]) * LEVEL
    H = model.dynamic_mass(BODY.mass_matrix, terms or ElasticTerms(), lines)
    values = np.zeros((6, len(lines), len(table)), dtype=complex)
    values[:, :, of.columns] = np.einsum("nck,rnk->rnc", A0 + A1 @ H, U)
    return Spectra(
        table=table,
        frequency=lines,
        values=values,
        noise=np.full(values.shape, 1e-4),
        quality=np.ones(values.shape[:2]),
        runs=MOTIONS,
        axes=MOTIONS,
    )


def found(spectra: Spectra) -> dict[str, consistency.Finding]:
    estimate = from_runs(resultants(spectra).values, base_motion(spectra).values, spectra.frequency)
    return {one.name: one for one in consistency.checks(estimate.dynamic_mass, spectra)}


def suspected(spectra: Spectra) -> tuple[consistency.Suspect, ...]:
    return consistency.suspects(consistency.readings(spectra, ORDINARY))


def with_mistake(spectra: Spectra, mistake: Mistake) -> Spectra:
    inverse = replace(mistake, factor=1 / mistake.factor)
    return replace(spectra, values=consistency.undone(spectra.table, spectra.values, inverse))


@pytest.mark.parametrize("seed", range(5))
def test_sound_campaigns_pass_every_check_with_ordinary_tolerances(campaign: Campaign, seed: int) -> None:
    failed = [one.text for one in found(made(campaign.table, seed=seed)).values() if not one.holds]
    assert failed == []


@pytest.mark.parametrize("seed", range(8))
def test_nobody_is_suspected_when_every_tolerance_is_three_sigma_off(campaign: Campaign, seed: int) -> None:
    assert suspected(made(campaign.table, offset=3.0, signs=True, seed=seed)) == ()


@pytest.mark.parametrize("frequency", [5.7, 8.0, 11.6])
def test_an_elastic_structure_is_no_mistake(campaign: Campaign, frequency: float) -> None:
    assert suspected(made(campaign.table, terms=_sway(frequency))) == ()


@pytest.mark.parametrize("frequency", [3.9, 4.3, 5.1, 5.9])
def test_a_structure_whose_modes_lie_among_the_lowest_lines_is_no_mistake(campaign: Campaign, frequency: float) -> None:
    """Above its own mode half of the mass pulls the other way. Two pick-ups and two load cells had been "exchanged"."""
    lines = np.linspace(4.0, 32.0, 281)
    sound = made(campaign.table, terms=_sway(frequency), lines=lines)
    assert [one.text for one in found(sound).values() if not one.holds] == []
    wrong = with_mistake(sound, next(one for one in _signs(campaign.table) if one.channels == ("fmd-z2",)))
    assert [one.channels for one in suspected(wrong)[0].mistakes] == [("fmd-z2",)]


def test_mean_squares_are_about_one_at_the_tolerances(campaign: Campaign) -> None:
    """The laws of misfit rest on it: 40 laboratories, each with its own offsets."""
    squares = []
    for seed in range(40):
        of = consistency.readings(made(campaign.table, seed=seed), ORDINARY)
        one = consistency.misfit(of, of.values[None], of.noise[None])
        squares.append([one.redundancy[0], one.parity[0], one.structure[0]])
    assert np.all((np.mean(squares, axis=0) > 0.3) & (np.mean(squares, axis=0) < 1.3))
    assert np.max(squares) < consistency.LIMIT / 3


SLIPS = {"acceleration": (1 / 9.80665, 9.80665, 1e3, 1e-3), "force": (1e3, 1e-3, 4.4482216152605, 1 / 4.4482216152605)}
"""Units taken for another: g, mm, kN, lbf, and the other way round."""


def _signs(table: ChannelTable) -> list[Mistake]:
    return [one for one in consistency.candidates(table) if one.kind == "polarity" and len(one.channels) == 1]


def _swaps(table: ChannelTable) -> list[Mistake]:
    return [one for one in consistency.candidates(table) if one.kind == "channel-swap"]


def _slips(table: ChannelTable, which: int) -> list[Mistake]:
    return [
        Mistake(kind="unit", channels=(channel.name,), factor=SLIPS[channel.quantity][(k + which) % 4])
        for k, channel in enumerate(table.channels)
    ]


def _names(spectra: Spectra, mistake: Mistake) -> bool:
    """Whether `mistake` alone is suspected, and nothing else."""
    accused = suspected(with_mistake(spectra, mistake))
    if len(accused) != 1 or len(accused[0].mistakes) != 1:
        return False
    (one,) = accused[0].mistakes
    return (one.kind, one.channels) == (mistake.kind, mistake.channels) and bool(np.isclose(one.factor, mistake.factor))


@pytest.mark.parametrize("step", [3, pytest.param(1, marks=pytest.mark.proof)])
def test_every_inverted_channel_is_named(campaign: Campaign, step: int) -> None:
    spectra = made(campaign.table, seed=1)
    assert len(_signs(campaign.table)) == 22
    assert [one.channels for one in _signs(campaign.table)[::step] if not _names(spectra, one)] == []


@pytest.mark.parametrize("step", [6, pytest.param(1, marks=pytest.mark.proof)])
def test_every_exchange_within_a_group_is_named(campaign: Campaign, step: int) -> None:
    spectra = made(campaign.table, seed=2)
    assert len(_swaps(campaign.table)) == 28 + 28 + 15
    assert [one.channels for one in _swaps(campaign.table)[::step] if not _names(spectra, one)] == []


@pytest.mark.parametrize(("which", "step"), [(0, 3), *(pytest.param(one, 1, marks=pytest.mark.proof) for one in (0, 1))])
def test_every_slip_of_a_unit_is_named(campaign: Campaign, which: int, step: int) -> None:
    spectra = made(campaign.table, seed=3 + which)
    assert [one.channels for one in _slips(campaign.table, which)[::step] if not _names(spectra, one)] == []


def test_two_mistakes_at_once_are_named_together_on_both_sides_and_on_one(campaign: Campaign) -> None:
    x1, z1, z2 = (Mistake(kind="polarity", channels=(name,), factor=-1.0) for name in ("cover-x1", "cover-z1", "table-z2"))
    for first, second in ((x1, _swaps(campaign.table)[-1]), (z2, z1)):
        (accused, *_) = suspected(with_mistake(with_mistake(made(campaign.table), first), second))
        assert accused.explains
        assert {one.identifiers for one in accused.mistakes} == {first.identifiers, second.identifiers}


def test_mistakes_are_named_on_an_elastic_structure_as_well(campaign: Campaign) -> None:
    spectra = made(campaign.table, seed=5, terms=_sway(5.7))
    cells = [one for one in _swaps(campaign.table) if one.channels[0].startswith("fmd")]
    assert [one.channels for one in (*_signs(campaign.table)[::4], *cells[::4]) if not _names(spectra, one)] == []


def test_a_mistake_is_told_in_words_with_what_undoing_it_does(campaign: Campaign) -> None:
    wrong = found(with_mistake(made(campaign.table), Mistake(kind="polarity", channels=("fmd-z2",), factor=-1.0)))
    assert not wrong["channels"].holds
    assert wrong["channels"].text.startswith("it looks as if fmd-z2 has the wrong sign (undone, the misfit falls from ")
    assert not wrong["parity"].holds
    assert wrong["redundancy"].holds
    swapped = Mistake(kind="channel-swap", channels=("cover-z1", "cover-x1"))
    assert "cover-z1 and cover-x1 are exchanged" in found(with_mistake(made(campaign.table), swapped))["channels"].text
    slip = Mistake(kind="unit", channels=("table-y2",), factor=1 / 9.80665)
    assert (
        "table-y2 has the wrong unit: m/s^2 for g, a factor of 0.101972"
        in found(with_mistake(made(campaign.table), slip))["channels"].text
    )


@pytest.mark.parametrize(
    ("name", "entry", "said"),
    [
        ("symmetry", (0, 4), "not symmetric in f_x by beta"),
        ("equal masses", (2, 2), "are not one, or they couple"),
        ("coupling", (1, 4), "not skew in f_y by beta"),
        ("diagonal", (5, 5), "the diagonal is negative for gamma"),
    ],
)
def test_each_check_of_the_dynamic_mass_sees_its_own_departure(
    campaign: Campaign, name: str, entry: tuple[int, int], said: str
) -> None:
    """One entry of H changed by hand: the others of Eq. 1 are as they were, and only what that entry is part of fails."""
    spectra = made(campaign.table, offset=0.0)
    mass = from_runs(resultants(spectra).values, base_motion(spectra).values, spectra.frequency).dynamic_mass
    matrix = np.array(mass.matrix)
    matrix[:, entry[0], entry[1]] *= 1.2 if entry[0] != 5 else -1
    matrix[:, entry[0], entry[1]] += 0.5 if entry == (1, 4) else 0
    broken = {one.name: one for one in consistency.checks(replace(mass, matrix=matrix), spectra)}
    assert said in broken[name].text
    assert not broken[name].holds
    assert broken["phase"].holds
    assert broken["channels"].holds  # the spectra themselves are sound
    turned = {one.name: one for one in consistency.checks(replace(mass, matrix=mass.matrix * np.exp(0.2j)), spectra)}
    assert not turned["phase"].holds


def test_what_reads_the_same_may_be_exchanged_and_what_all_share_leaves_no_trace(campaign: Campaign) -> None:
    table = campaign.table
    twin = replace(table.channels[6], name="cover-z1-twin")
    doubled = ChannelTable(channels=(*table.channels[:7], twin, *table.channels[7:]), origin=table.origin)
    spectra = made(doubled)
    assert suspected(with_mistake(spectra, Mistake(kind="channel-swap", channels=("cover-z1", "cover-z1-twin")))) == ()
    cells = tuple(channel.name for channel in table.channels if channel.quantity == "force")
    assert suspected(with_mistake(made(table), Mistake(kind="unit", channels=cells, factor=1e3))) == ()


def test_a_sign_that_all_load_cells_share_is_named_beside_that_of_all_pick_ups(campaign: Campaign) -> None:
    cells = tuple(channel.name for channel in campaign.table.channels if channel.quantity == "force")
    pick_ups = tuple(channel.name for channel in campaign.table.channels if channel.quantity == "acceleration")
    accused = suspected(with_mistake(made(campaign.table), Mistake(kind="polarity", channels=cells, factor=-1.0)))
    assert {one.mistakes[0].channels for one in accused} == {cells, pick_ups}


def test_a_unit_of_the_whole_cover_plate_is_named_beside_the_inverse_on_the_table(campaign: Campaign) -> None:
    cover = tuple(channel.name for channel in campaign.table.channels if channel.group == "cover")
    below = tuple(channel.name for channel in campaign.table.channels if channel.group == "table")
    slip = Mistake(kind="unit", channels=cover, factor=1 / 9.80665)
    accused = {one.mistakes[0].channels: one.mistakes[0].factor for one in suspected(with_mistake(made(campaign.table), slip))}
    assert set(accused) == {cover, below}
    np.testing.assert_allclose([accused[cover], accused[below]], [1 / 9.80665, 9.80665], rtol=1e-12)  # the same product


def test_pick_ups_that_do_not_feel_a_tilt_are_no_mistake_and_those_that_wrongly_say_so_show(campaign: Campaign) -> None:
    table = campaign.table
    optical = tuple(replace(one, senses_gravity=one.group != "table") for one in table.channels)
    kinematic = ChannelTable(channels=optical, origin=table.origin)
    assert [one.text for one in found(made(kinematic)).values() if not one.holds] == []
    wrong = replace(made(kinematic, offset=0.0), table=table)
    assert found(wrong)["redundancy"].value > 2 * found(made(table, offset=0.0))["redundancy"].value


def test_a_dynamic_mass_of_other_lines_is_refused(campaign: Campaign) -> None:
    spectra = made(campaign.table)
    mass = from_runs(resultants(spectra).values, base_motion(spectra).values, spectra.frequency).dynamic_mass
    short = replace(mass, frequency=mass.frequency[1:], matrix=mass.matrix[1:])
    with pytest.raises(BadInput, match="the dynamic mass has 28 lines, the spectra have 29 others"):
        consistency.checks(short, spectra)


SOUND = Identified(
    way="self-calibrated",
    inertia=Inertia(parameters=np.array([33.0, 0, 0, 9, 15, 15, 2, 0, 0, 0])),
    covariance=np.eye(10),
    band=(4.0, 32.0),
    misfit=1.2,
    surprise=145.0,
    tolerances=120,
)
TOLD = {"m": "trustworthy: ±1 %", "mz": "dominated by elasticity: ±9 %", "Ixx": "not identifiable from this data: ±30 %"}


def test_sound_data_and_a_misfit_that_is_not_known_keep_their_verdicts() -> None:
    """The largest misfit and sum z² of simulated laboratories with ordinary tolerances."""
    assert failures(SOUND) == failures(replace(SOUND, misfit=float("nan"))) == ()
    assert judged(TOLD, (), ()) == TOLD


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"misfit": 1.1 * MISFIT}, "times what noise and model error explain"),
        ({"surprise": 1.1 * BENT * 120}, "the fit moved the 120 tolerances by"),
        ({"converged": False}, "did not converge"),
    ],
)
def test_a_failed_model_takes_back_trust_but_for_what_elasticity_explains(changes: dict[str, float], said: str) -> None:
    failed = failures(replace(SOUND, **changes))
    assert len(failed) == 1
    assert said in failed[0]
    verdicts = judged(TOLD, (), failed)
    assert verdicts["mz"] == TOLD["mz"]
    for name in ("m", "Ixx"):
        assert verdicts[name].startswith(f"not trustworthy: {failed[0]}")
    assert verdicts["Ixx"].endswith(TOLD["Ixx"])


def test_a_channel_in_a_wrong_unit_comes_first_in_every_verdict(campaign: Campaign) -> None:
    sound = spectra(campaign, band=(4.0, 6.0))
    assert contradictions(consistency.of_spectra(sound)) == ()
    factor = np.ones(len(sound.table))
    factor[sound.table.names.index("fmd-z2")] = 1 / 4.4482216152605  # lbf taken for N
    against = contradictions(consistency.of_spectra(replace(sound, values=sound.values * factor)))
    assert "fmd-z2 has the wrong unit" in against[0]
    for said in judged(TOLD, against, ("the fit did not converge",)).values():
        assert said.startswith("not trustworthy: it looks as if fmd-z2 has the wrong unit")
        assert "campaign.toml" in said


def test_checks_without_a_suspect_speak_beyond_all_that_sound_data_reach() -> None:
    def failed(value: float) -> consistency.Finding:
        return consistency.Finding(name="symmetry", holds=False, value=value, text="the dynamic mass is not symmetric")

    assert contradictions([failed(0.9 * BROKEN)]) == ()
    assert contradictions([failed(1.1 * BROKEN)]) == ("the dynamic mass is not symmetric",)


LOW_LINES = np.arange(4.0, 32.01, 0.05)
MASS_MATRIX = np.diag([50.0, 50.0, 50.0, 10.0, 10.0, 1.0])


def measured(frequency: float, damping: float = 0.02, noise: float = 0.02) -> DynamicMass:
    """One mode along y and alpha; `noise` as a share of the level."""
    terms = ElasticTerms(
        frequency=np.array([frequency]),
        damping=np.array([[4 * np.pi * frequency * damping]]),
        participation=np.array([[0.0, 4.0, 0.0, 2.0, 0.0, 0.0]]),
    )
    rng = np.random.default_rng(0)
    H = dynamic_mass(MASS_MATRIX, terms, LOW_LINES)
    spread = np.sqrt(np.outer(np.diag(MASS_MATRIX), np.diag(MASS_MATRIX)))
    return DynamicMass(frequency=LOW_LINES, matrix=H + noise * spread * rng.standard_normal(H.shape))


@pytest.mark.parametrize("frequency", [6.0, 11.6, 25.0])
@pytest.mark.parametrize("damping", [0.002, 0.05])
def test_the_first_resonance_is_found_through_noise(frequency: float, damping: float) -> None:
    found = first_resonance(measured(frequency, damping))
    assert found is not None
    assert abs(found / frequency - 1) < 2 * damping + 0.01  # the peak, broad as it is, and a line


def test_a_rigid_body_resonates_nowhere() -> None:
    assert first_resonance(measured(300.0)) is None


def test_a_resonance_just_beyond_the_band_counts_as_at_its_end() -> None:
    found = first_resonance(measured(33.0, noise=0.0))
    assert found == LOW_LINES[-1]
