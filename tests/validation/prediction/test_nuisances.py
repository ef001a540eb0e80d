"""What a model declares to know within tolerances: identities, derivatives, and the damping law."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from fem.beam import articles
from fem.damping import Damping
from fem.modes import fixed_base
from geometry.articles import built_in
from validation.effects.catalogue import parse
from validation.estimation.problem import DECLARED, STRUCTURAL
from validation.model.model import Added, StructureTolerances
from validation.prediction import dynamic_mass, effects
from validation.prediction import structure as prediction_structure
from validation.prediction.effects import Nuisances
from validation.prediction.tangents import DAMPING_LAW, LOSS_COUPLING, Tangent, full, with_damping_law

LINES = np.array([5.0, 11.5, 12.4, 28.0])

DIFFERENCE = 1e-5
"""Of the largest entry: a central difference of steps of 1e-4 tolerances is as near as that at a resonance."""


@pytest.fixture(scope="module", params=["clumod-1", "clumod-1 by ratio", "clumod-4"])
def one(request) -> Nuisances:
    name, by, _ = f"{request.param}  ".split(" ", 2)
    return made(name, Damping(ratio=0.01) if by else None)


def made(article: str, damping: Damping | None) -> Nuisances:
    structure = articles.structure(article)
    modes = fixed_base(structure, 20, damping=damping)
    found = prediction_structure.of_structure(structure, modes, damping=damping, article=built_in(article))
    found = replace(found, unresolved={"mast": 0.02 * found.parts["mast"]})
    losses = structure.loss_factors if damping is None else {}
    return effects.nuisances(article, found, modes.frequency, losses, highest=20.0, weighed=0.002)


def away(one: Nuisances) -> dict[str, float]:
    """Offsets of one tolerance, this way and that."""
    generator = np.random.default_rng(7)
    return {parameter.name: parameter.tolerance * float(generator.standard_normal()) for parameter in one.parameters}


def test_every_derivative_is_its_difference(one):
    at = away(one)
    m, tangents = one.at(at)
    found = dynamic_mass.transfer_tangents(dynamic_mass.dynamic_mass(m, LINES), tangents)
    own = [parameter for parameter in one.parameters if parameter.name != DAMPING_LAW]  # which acts behind effects
    assert set(found) == {parameter.name for parameter in own}
    for parameter in own:
        step = 1e-4 * parameter.tolerance
        above, below = (
            dynamic_mass.dynamic_mass(one.at({**at, parameter.name: at[parameter.name] + side * step})[0], LINES).matrix
            for side in (1, -1)
        )
        scale = np.abs(found[parameter.name]).max()
        assert scale > 0, parameter.name
        rounding = 1e-12 * np.abs(above).max() / step
        np.testing.assert_allclose(
            found[parameter.name],
            (above - below) / (2 * step),
            rtol=0,
            atol=DIFFERENCE * scale + rounding,
            err_msg=parameter.name,
        )


def test_nothing_moves_at_no_offset_and_a_tolerance_of_nothing_is_no_parameter(one):
    m, _ = one.at({})
    for name in ("mass", "stiffness", "viscous", "structural"):
        np.testing.assert_array_equal(getattr(m, name), getattr(one.nominal, name))
    exact = StructureTolerances(
        modulus=0, mesh=0, frequency=0, damping=0, mode_damping=0, damping_law=0, participation=0, mode_coupling=0
    )
    closed = effects.nuisances(one.configuration, one.nominal, one.frequency, one.losses, exact)
    assert closed.parameters == ()


def test_a_body_of_denser_material_carries_all_masses_with_it(one):
    """M (1 + d) beside K (1 + d) answers (1 + d) times as much: its modes keep their frequencies, what hangs on them is less."""
    d = 0.03
    stiffer = {name: np.log1p(d) for name in (f"modulus:{part}" for part in one.nominal.parts)}
    same, denser = replace(one, nominal=replace(one.nominal, viscous=0 * one.nominal.viscous)), f"density:{one.configuration}"
    before, after = (dynamic_mass.dynamic_mass(same.at(at)[0], LINES).matrix for at in ({}, {**stiffer, denser: d}))
    assert_allclose(after, (1 + d) * before, rtol=1e-9, atol=1e-9 * np.abs(before).max())
    assert denser not in {each.name for each in replace(one, weighed=0.0).parameters}


def test_a_part_that_loses_more_than_the_others_may_couple_no_modes_though_all_were_drawn_with_one_loss_factor():
    """A base drives it: beside the effect the class may take away what it couples, as a test that damps by mode does."""
    one = made("clumod-1", None)
    of = replace(one, tolerances=replace(one.tolerances, loss_coupling=0.5))
    assert len({of.losses[part] for part in of.lossy}) == 1
    assert LOSS_COUPLING in {each.name for each in of.parameters}
    lossier = Added(named=parse("structural-damping:mast=0.03"))
    (coupled, _), (alone, _) = (
        dynamic_mass.structure(of, {DAMPING_LAW: 0.0, LOSS_COUPLING: share}, (lossier,), derivatives=False)
        for share in (0.0, 1.0)
    )
    own = slice(of.nominal.base, of.nominal.base + 5)
    beside = ~np.eye(5, dtype=bool)
    assert np.abs(coupled.structural[own, own][beside]).max() > np.diag(coupled.structural)[own].min()
    assert_allclose(alone.structural[own, own][beside], 0.0)
    assert_allclose(np.diag(alone.structural), np.diag(coupled.structural))


def test_a_mode_that_loses_more_than_its_parts_say_loses_more_of_what_an_effect_adds_to_them_too():
    of, r = made("clumod-1", None), "damping:clumod-1:2"
    lossier = tuple(Added(named=parse(f"structural-damping:{part}=0.03")) for part in ("mast", "lower-1"))
    at = {**away(of), "loss:mast": -1.0, "loss:lower-1": -1.0}
    of = replace(of, losses={part: eta for part, eta in of.losses.items() if part in ("mast", "lower-1")})
    found, tangents = dynamic_mass.structure(of, at, lossier, derivatives=True)
    more, _ = dynamic_mass.structure(of, {**at, r: at[r] + np.log(2.0)}, lossier, derivatives=False)
    own = of.nominal.base + 1
    assert_allclose(more.structural[own, own], 2 * found.structural[own, own], rtol=1e-9)
    step = 1e-4
    above, below = (dynamic_mass.structure(of, {**at, r: at[r] + x}, lossier, derivatives=False)[0] for x in (step, -step))
    for name in ("structural", "viscous"):
        told = full(tangents[r], name, len(found.mass))
        change = (getattr(above, name) - getattr(below, name)) / (2 * step)
        assert_allclose(told, change, atol=1e-6 * np.abs(change).max())


def test_matrices_stay_symmetric_and_positive_at_ten_tolerances(one):
    m, _ = one.at(
        {name: 10 * offset for name, offset in away(one).items() if not name.startswith(("coupling", "participation", "loss"))}
    )
    for name in ("stiffness", "structural", "viscous"):
        matrix = getattr(m, name)[6:, 6:]
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * np.abs(matrix).max())
        assert np.linalg.eigvalsh(matrix)[0] >= -1e-9 * np.abs(matrix).max()


def test_however_far_off_a_mesh_is_taken_to_be_the_stiffness_stays_positive(one):
    K = one.at({"mesh:mast": 1e6})[0].stiffness[6:, 6:]
    assert np.linalg.eigvalsh(K)[0] > 0
    little = one.at({"mesh:mast": 0.1})[0].stiffness - one.nominal.stiffness
    np.testing.assert_allclose(little, -0.1 * one.nominal.unresolved["mast"], rtol=1e-3, atol=1e-9)


def test_a_mesh_of_shells_leaves_every_mode_unsure_by_itself_by_more_than_one_of_solids(one):
    shell = replace(one, nominal=replace(one.nominal, shells=("mast",)))
    np.testing.assert_allclose(shell.apart_by_mesh, 0.8 / 0.25 * one.apart_by_mesh)


def test_parameters_are_called_and_known_as_agreed(one):
    by_name = {parameter.name: parameter for parameter in one.parameters}
    of, name = StructureTolerances(), one.configuration
    by_mesh = 0.25 * of.mesh * 0.02 * one.nominal.parts["mast"][6, 6] / (2 * np.pi * one.frequency[0]) ** 2 / 2
    expected = {
        "modulus:mast": (of.modulus, DECLARED),
        "mesh:mast": (of.mesh, DECLARED),
        f"frequency:{name}:1": (np.hypot(of.frequency, by_mesh), DECLARED),
        f"damping:{name}:2": (of.mode_damping if one.losses else of.damping, DECLARED),
        f"participation:{name}:1:alpha": (of.participation, STRUCTURAL),
        f"coupling:{name}:1:2": (of.mode_coupling, STRUCTURAL),
    }
    if one.losses:
        expected["loss:mast"] = (of.damping, DECLARED)
    assert {key: (by_name[key].tolerance, by_name[key].kind) for key in expected} == expected
    assert all(each.within == 2.5 * each.tolerance for each in by_name.values() if each.kind == DECLARED)


def test_a_modulus_is_a_relative_change_that_leaves_the_part_some_stiffness(one):
    (modulus,) = (parameter for parameter in one.parameters if parameter.name == "modulus:mast")
    assert modulus.value(0.0) == 0.0
    m, _ = one.at({"modulus:mast": modulus.offset(0.3)})
    np.testing.assert_allclose(m.stiffness - one.nominal.stiffness, 0.3 * one.nominal.parts["mast"], atol=1e-6)
    assert modulus.value(-5.0) > -1


def test_frequencies_and_damping_are_those_asked_for(one):
    name = one.configuration
    m, _ = one.at({f"frequency:{name}:1": 0.01, f"damping:{name}:1": 0.2})
    before, after = (np.diag(x.stiffness)[6] for x in (one.nominal, m))
    np.testing.assert_allclose(after, before * np.exp(0.02), rtol=1e-12)
    loss = [
        np.diag(x.structural)[6] / np.diag(x.stiffness)[6] + np.diag(x.viscous)[6] / np.sqrt(np.diag(x.stiffness)[6])
        for x in (one.nominal, m)
    ]
    np.testing.assert_allclose(loss[1], loss[0] * np.exp(0.2), rtol=1e-12)


def test_a_part_that_loses_more_is_the_structure_with_that_loss_factor():
    """The layer of a blade twice as lossy: structural damping of modes that know nothing of it, beside those that do."""
    structure, more = articles.structure("clumod-4"), 1.0
    one = made("clumod-4", None)
    losses = {**structure.loss_factors, "upper-short-silicone": 2 * structure.loss_factors["upper-short-silicone"]}
    lossier = made("clumod-4", Damping(loss_factors=losses)).nominal
    assert np.abs(lossier.structural - one.nominal.structural).max() > 0.01 * np.abs(one.nominal.structural).max()
    m, _ = one.at({"loss:upper-short-silicone": more})
    scale = np.abs(lossier.structural).max()
    np.testing.assert_allclose(m.structural, lossier.structural, rtol=0, atol=1e-9 * scale)
    np.testing.assert_array_equal(m.stiffness, one.nominal.stiffness)


def test_a_loss_factor_is_one_for_all_sheets_and_articles_and_damping_by_mode_free_by_mode_alone():
    one, four = (made(article, None) for article in ("clumod-1", "clumod-4"))
    assert set(one.lossy) == {"mast", "lower-1"} <= set(four.lossy)
    assert "upper-short" in four.lossy
    shared = [{parameter.name: parameter for parameter in each.parameters}["loss:mast"] for each in (one, four)]
    assert shared[0] == shared[1]
    assert shared[0].value(1.0) == pytest.approx(1.0)  # a relative change, as of a modulus
    parts, ratio = made("clumod-1", None), made("clumod-1", Damping(ratio=0.01))
    both = effects.nuisances("clumod-1", ratio.nominal, ratio.frequency, parts.losses)
    of = StructureTolerances()
    for one, tolerance in ((parts, of.mode_damping), (ratio, of.damping), (both, of.damping)):
        found = {each.tolerance for each in one.parameters if each.name.startswith("damping:")}
        assert found == {tolerance}
    assert not any(each.name.startswith("loss:") for each in ratio.parameters)


def test_a_stated_damping_ratio_stays_when_a_modulus_moves_the_frequency_and_a_held_structure_has_no_participation(held):
    one = made("clumod-1", Damping(ratio=0.01))
    m, _ = one.at({"modulus:mast": 0.1, "frequency:clumod-1:2": 0.02})
    at = slice(6, 6 + len(one.frequency))
    ratio = np.diag(m.viscous)[at] / (2 * np.sqrt(np.diag(m.stiffness)[at]))
    np.testing.assert_allclose(ratio, 0.01, rtol=1e-9)
    structure = articles.structure("clumod-1")
    still = held(structure, {"top": structure.points[-1]})
    found = effects.nuisances("clumod-1", still.matrices, still.frequency, structure.loss_factors, highest=20.0)
    assert not any(parameter.name.startswith("participation") for parameter in found.parameters)
    m, tangents = found.at({"frequency:clumod-1:1": 1e-3})
    assert {*tangents, DAMPING_LAW} == {parameter.name for parameter in found.parameters}
    assert m.stiffness[0, 0] > still.matrices.stiffness[0, 0]


@pytest.fixture(scope="module")
def of():
    return made("clumod-1", None)


def answered(of, share, lines, apart=0.0):
    made, tangents = of.at({})
    laws = {DAMPING_LAW: share, LOSS_COUPLING: apart}
    changed, behind = with_damping_law(made, tangents, of.nominal, laws, derivatives=True)
    return dynamic_mass.dynamic_mass(changed, lines), behind


def test_both_laws_lose_the_same_at_a_resonance_and_not_beside_it(of):
    f = float(of.frequency[0])
    (at, _), (viscous, _) = answered(of, 0.0, [f, 0.5 * f]), answered(of, 1.0, [f, 0.5 * f])
    x = np.unravel_index(np.abs(at.matrix[0]).argmax(), (6, 6))
    # what remains at the peak is what the other modes lose there
    assert_allclose(viscous.matrix[0][x], at.matrix[0][x], rtol=0.01)
    ratio = viscous.matrix[1][x].imag / at.matrix[1][x].imag
    assert 0.35 < ratio < 0.55  # omega / omega_r of this mode, and less of those above


def test_its_derivative_and_those_behind_it_are_differences(of):
    lines, share, step = np.array([5.0, 11.6, 14.0]), 0.3, 1e-4
    here, behind = answered(of, share, lines)
    slopes = dynamic_mass.transfer_tangents(here, behind)
    above, below = (answered(of, share + side * step, lines)[0].matrix for side in (1, -1))
    scale = np.abs(slopes[DAMPING_LAW]).max()
    assert_allclose(slopes[DAMPING_LAW], (above - below) / (2 * step), atol=1e-6 * scale)
    for name in ("loss:mast", "modulus:mast"):
        sides = []
        for side in (1, -1):
            made, _ = of.at({name: side * step})
            changed, _ = with_damping_law(made, {}, of.nominal, {DAMPING_LAW: share}, derivatives=False)
            sides.append(dynamic_mass.dynamic_mass(changed, lines).matrix)
        assert_allclose(slopes[name], (sides[0] - sides[1]) / (2 * step), atol=1e-4 * np.abs(slopes[name]).max(), err_msg=name)


def test_without_coupling_every_mode_loses_by_itself_and_the_derivatives_know_it(of):
    """Nothing is left beside the diagonal of what parts lose; and on the way there slopes are differences."""
    made, _ = of.at({})
    apart, _ = with_damping_law(made, {}, of.nominal, {LOSS_COUPLING: 1.0}, derivatives=False)
    assert_allclose(apart.structural, np.diag(np.diag(made.structural)))
    lines, step, at = np.array([5.0, 11.6, 14.0]), 0.02, {"share": 0.3, "apart": 0.4}  # one blade: there is little to couple
    here, behind = answered(of, lines=lines, **at)
    slopes = dynamic_mass.transfer_tangents(here, behind)
    for name, key in ((LOSS_COUPLING, "apart"), (DAMPING_LAW, "share")):
        above, below = (answered(of, lines=lines, **at | {key: at[key] + side * step})[0].matrix for side in (1, -1))
        assert_allclose(slopes[name], (above - below) / (2 * step), atol=2e-3 * np.abs(slopes[name]).max(), err_msg=name)
    laws, step = {DAMPING_LAW: 0.3, LOSS_COUPLING: 0.4}, 1e-4
    sides = []
    for side in (1, -1):
        made, _ = of.at({"loss:mast": side * step})
        changed, _ = with_damping_law(made, {}, of.nominal, laws, derivatives=False)
        sides.append(dynamic_mass.dynamic_mass(changed, lines).matrix)
    difference, scale = (sides[0] - sides[1]) / (2 * step), np.abs(slopes["loss:mast"]).max()
    assert_allclose(slopes["loss:mast"], difference, atol=1e-4 * scale)


def test_modes_that_an_effect_turns_lose_each_by_itself_or_what_they_lost_before_and_the_derivatives_know_it():
    """Losses that are told by mode: 60 g on a satellite's boom were a resonator of a gram as well, since its modes had turned."""
    one = made("clumod-4", Damping(ratio=0.01))
    of = replace(one, tolerances=replace(one.tolerances, loss_coupling=0.5), weighed=0.0)
    name, (r, s) = LOSS_COUPLING, of.pairs[0]
    assert name in {each.name for each in of.parameters}
    softer = (Added(named=parse("modulus:upper-long=-0.4"), fixed=False),)
    (as_before, _), (apart, _) = (dynamic_mass.structure(of, {name: at}, softer, derivatives=False) for at in (0.0, 1.0))
    assert_allclose(as_before.viscous, of.nominal.viscous)
    told = slice(of.nominal.base, of.nominal.base + 20)
    squares, shapes = eigh(as_before.stiffness[told, told], as_before.mass[told, told])
    before, after = (shapes.T @ each.viscous[told, told] @ shapes for each in (as_before, apart))
    f = np.sqrt(squares)
    beyond = np.abs(f - f[:, None]) > 0.3 * np.maximum(f, f[:, None])
    assert_allclose(np.diag(after), np.diag(before), rtol=1e-9)
    assert np.abs(after[beyond]).max() < 0.1 * np.abs(before[beyond]).max()
    coupled = {f"coupling:clumod-4:{r + 1}:{s + 1}": 0.3, "damping:clumod-4:2": 0.2, "frequency:clumod-4:1": 0.01, name: 0.6}
    at = {**coupled, "modulus:mast": 0.02, DAMPING_LAW: 0.0}

    def answer(offsets: dict[str, float], **sized: float) -> tuple[dynamic_mass.CondensedTransfer, dict[str, Tangent]]:
        added = (replace(softer[0], named=replace(softer[0].named, values={"": sized.get("size", -0.4)})),)
        found, tangents = dynamic_mass.structure(of, offsets, added, derivatives=True)
        return dynamic_mass.dynamic_mass(found, LINES), tangents

    here, tangents = answer(at)
    slopes, step = dynamic_mass.transfer_tangents(here, tangents), 1e-4
    for key in at if DAMPING_LAW in slopes else [key for key in at if key != DAMPING_LAW]:
        above, below = (answer({**at, key: at[key] + side * step})[0].matrix for side in (1, -1))
        assert_allclose(slopes[key], (above - below) / (2 * step), atol=1e-4 * np.abs(slopes[key]).max(), err_msg=key)
    size = next(key for key in slopes if key == "modulus:upper-long" or key.startswith("modulus:upper-long["))
    above, below = (answer(at, size=-0.4 + side * step)[0].matrix for side in (1, -1))
    by_size = (above - below) / (2 * step)
    scale = np.vdot(slopes[size], by_size).real / np.vdot(slopes[size], slopes[size]).real
    assert_allclose(scale * slopes[size], by_size, atol=1e-4 * np.abs(by_size).max())


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_what_couples_two_modes_follows_the_law_by_which_they_lose(share):
    """Two that have turned into each other lose as before; and what parts couple them by may be away without it."""
    one = made("clumod-1", None)
    one = replace(one, tolerances=replace(one.tolerances, loss_coupling=0.5), losses={**one.losses, "mast": 0.03})
    (r, s), b = one.pairs[0], one.nominal.base
    at = {f"coupling:clumod-1:{r + 1}:{s + 1}": 0.2, DAMPING_LAW: share, LOSS_COUPLING: 1.0}
    found, _ = dynamic_mass.structure(one, at, (), derivatives=False)
    of, none = (found.viscous, found.structural) if share else (found.structural, found.viscous)
    assert_allclose(of[b + r, b + s], 0.2 * np.sqrt(of[b + r, b + r] * of[b + s, b + s]), rtol=1e-9)
    assert_allclose(none[b + r, b + s], 0.0, atol=1e-12 * np.abs(none).max())


def test_it_is_open_where_parts_lose_something_and_one_for_all_structures(of):
    of = replace(of, tolerances=replace(of.tolerances, loss_coupling=0.4), losses={**of.losses, "mast": 0.03})
    shares = {one.name: one for one in of.parameters if one.name in (DAMPING_LAW, LOSS_COUPLING)}
    assert [one.tolerance for one in shares.values()] == [of.tolerances.damping_law, 0.4]
    # Beyond, and with less than no loss, a structure would be driven by itself; of a satellite 1.25 of the coupling was gone
    assert {(one.low, one.high) for one in shares.values()} == {(0.0, 1.0)}
    assert {one.low for one in of.parameters if one.family == "loss"} == {-1.0}
    bare = effects.nuisances("clumod-1", of.nominal, of.frequency, {})
    assert DAMPING_LAW not in {one.name for one in bare.parameters}
