"""Every tolerance that is drawn shows in its channels, with its size and its sign."""

from collections.abc import Callable, Mapping
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import rigid_transformation, rotation_about
from geometry.sensors import ChannelTable, Tolerances
from identification.campaign import Campaign
from validation.virtual_test.layout import ChainTruth
from validation.virtual_test.plan import Plan, PlantedEffect, Scatter, exact
from validation.virtual_test.shaker import nominal_fmd
from validation.virtual_test.simulate import VirtualTest, laboratory, simulate

LINES = np.array([5.0, 12.0, 31.0])
RUNS = {"x", "y", "z", "alpha", "beta", "gamma"}
Change = Callable[[ChainTruth], ChainTruth]
Read = Mapping[str, np.ndarray]


@pytest.fixture(scope="module")
def read(
    rigid_plan: Callable[..., Plan], spectra: Callable[[Campaign, np.ndarray], Read], exact_test: VirtualTest
) -> Callable[..., tuple[Read, Read, ChannelTable]]:
    """``read(change)``: spectra by run without and with a change of the chain, and the table of channels."""
    before = spectra(exact_test.campaign, LINES)

    def made(change: Change) -> tuple[Read, Read, ChannelTable]:
        effect = PlantedEffect(id="test", chain=change)
        after = spectra(simulate(exact(rigid_plan(effects=(effect,)))).campaign, LINES)
        return before, after, exact_test.campaign.table

    return made


def motion(table: ChannelTable, values: np.ndarray, group: str) -> np.ndarray:
    """(n, 6) motion of the reference point by the accelerometers of a group."""
    chosen = table.select(group=group, quantity="acceleration")
    rows = [table.channels[k].places[0].direction @ rigid_transformation(table.channels[k].places[0].position) for k in chosen]
    return values[:, chosen] @ np.linalg.pinv(np.array(rows)).T


def test_gain_and_delay_act_on_their_channel_alone(read: Callable[..., tuple[Read, Read, ChannelTable]]) -> None:
    before, after, table = read(lambda chain: chain.more_gain("fmd-z2", 0.05).later("cover-x1", 3e-4).later("fmd-y23", -2e-3))
    assert before.keys() == after.keys() == RUNS
    expected = np.ones((len(LINES), len(table)), dtype=complex)
    expected[:, table.names.index("fmd-z2")] = 1.05
    expected[:, table.names.index("cover-x1")] = np.exp(-2j * np.pi * LINES * 3e-4)
    expected[:, table.names.index("fmd-y23")] = np.exp(2j * np.pi * LINES * 2e-3)
    for run in RUNS:
        assert_allclose(after[run], expected * before[run], rtol=0, atol=1e-9 * np.abs(before[run]).max())


@pytest.mark.parametrize("channel", ["cover-z3", "table-y2"])
def test_position_and_angle_are_those_of_the_true_sensor(
    channel: str, read: Callable[..., tuple[Read, Read, ChannelTable]]
) -> None:
    offset, angle = np.array([4e-3, -3e-3, 2e-3]), 0.02
    before, after, table = read(lambda chain: chain.moved(channel, offset).turned(channel, [angle, 0.0, 0.0]))
    k = table.names.index(channel)
    place = table.channels[k].places[0]
    true = rotation_about("x", angle) @ place.direction @ rigid_transformation(place.position + offset)
    for run in RUNS:
        u = motion(table, before[run], channel.split("-")[0])
        assert_allclose(after[run][:, k], u @ true, rtol=0, atol=1e-9 * np.abs(before[run]).max())
        assert_allclose(np.delete(after[run], k, axis=1), np.delete(before[run], k, axis=1), rtol=0, atol=1e-9)


def test_a_stiffer_cell_takes_more_of_the_load_and_the_sum_stays(read: Callable[..., tuple[Read, Read, ChannelTable]]) -> None:
    before, after, table = read(lambda chain: chain.stiffer(1, 2, 0.10))
    z = [table.names.index(f"fmd-z{number}") for number in (1, 2, 3, 4)]
    forces, were = after["z"][:, z], before["z"][:, z]
    assert_allclose(forces.sum(axis=1), were.sum(axis=1), rtol=1e-3)  # but for the table's motion below the cells
    pattern = ((forces - were) / were.sum(axis=1)[:, None]).real
    assert_allclose(pattern, np.outer(pattern[:, 1], [-1, 1, -1, 1]), rtol=0, atol=1e-5)  # what four cells can share freely
    assert_allclose(pattern[:, 1], 0.1 / 4 / 4, rtol=0.1)


def test_cross_talk_adds_its_share_of_a_resultant_to_all_channels_of_another_axis_alike(
    read: Callable[..., tuple[Read, Read, ChannelTable]],
) -> None:
    kappa = np.zeros((3, 3))
    kappa[2, 0] = 0.01  # zx: x shows in z
    before, after, table = read(lambda chain: replace(chain, crosstalk=kappa))
    z = [table.names.index(f"fmd-z{number}") for number in (1, 2, 3, 4)]
    x = [table.names.index(name) for name in ("fmd-x12", "fmd-x34")]
    fx = before["x"][:, x].sum(axis=1)
    added = after["x"][:, z] - before["x"][:, z]
    assert_allclose(added, np.tile(0.01 * fx[:, None] / 4, (1, 4)), rtol=1e-6)
    assert_allclose(after["x"][:, x], before["x"][:, x], rtol=1e-12)


def test_an_unmeasured_moment_is_missed_with_the_sign_of_the_catalogue(
    read: Callable[..., tuple[Read, Read, ChannelTable]],
) -> None:
    """M_y loses h F_x; and M_x gains h F_y, which is the same lever seen from the other axis."""
    before, after, table = read(lambda chain: replace(chain, plane_offset=np.array([2e-3, 3e-3])))
    names = [f"fmd-z{number}" for number in (1, 2, 3, 4)]
    z = [table.names.index(name) for name in names]
    at = np.array([table.channels[k].places[0].position for k in z])
    for run, pair, moment, h in (("x", ("fmd-x12", "fmd-x34"), -at[:, 0], -2e-3), ("y", ("fmd-y14", "fmd-y23"), at[:, 1], 3e-3)):
        lateral = before[run][:, [table.names.index(name) for name in pair]].sum(axis=1)
        assert_allclose((after[run] - before[run])[:, z] @ moment, h * lateral, rtol=1e-3)


def test_softer_cells_part_the_table_from_the_cover_plate_in_proportion(
    read: Callable[..., tuple[Read, Read, ChannelTable]],
) -> None:
    """The difference of both is w² K^-1 H u, so it doubles with the compliance along the force that is driven."""
    before, after, table = read(lambda chain: replace(chain, compliance=np.array([1.0, 2.0])))

    def parted(values: np.ndarray) -> np.ndarray:
        return (motion(table, values, "cover") / motion(table, values, "table"))[:, 2].real - 1

    assert np.all(parted(before["z"]) > 0)
    assert_allclose(parted(after["z"]) / parted(before["z"]), 2.0, rtol=0.03)  # a few per cent of cross motion do not double


def test_what_is_drawn_has_the_size_of_its_tolerance_and_grows_with_it() -> None:
    """Of 400 laboratories; a standard deviation from 400 draws lies within 10 % of its own (nearly three of its errors)."""
    plan, of = Plan(article="fmd"), Tolerances()
    layout = laboratory(plan).layout
    chains = [replace(plan, seed=seed).drawn_chain(layout) for seed in range(400)]
    for name, values, size in (
        ("gain", [chain.gain["cover-z1"] for chain in chains], of.gain),
        ("table gain", [chain.gain["table-z1"] for chain in chains], of.table_gain),
        ("delay", [chain.delay["fmd-x12"] for chain in chains], of.delay),
        ("position", [chain.position["cover-z2"][1] for chain in chains], of.position),
        ("angle", [chain.angle["cover-z2"][1] for chain in chains], of.angle),
        ("cell", [chain.cell_stiffness[2, 2] for chain in chains], of.cell_stiffness),
        ("cross-talk", [chain.crosstalk[1, 0] for chain in chains], of.crosstalk),
    ):
        assert_allclose(np.std(values), size, rtol=0.1, err_msg=name)
        assert abs(np.mean(values)) < 0.2 * size
    doubled = replace(plan, tolerances=of.scaled(2.0)).drawn_chain(layout)
    for one in ("gain", "delay"):
        assert_allclose(list(getattr(doubled, one).values()), 2 * np.array(list(getattr(chains[0], one).values())), rtol=1e-12)
    assert np.all([chain.angle["cover-z2"][2] == 0 for chain in chains])  # a turn about its own direction is none


def test_the_fmd_of_any_seed_is_a_body_within_its_tolerance() -> None:
    plan = Plan(article="fmd")
    nominal = nominal_fmd(plan)
    found = [replace(plan, seed=seed).drawn_moving_part(nominal) for seed in range(400)]
    assert_allclose(np.std([one.mass for one in found]) / nominal.mass, 0.05, rtol=0.1)
    assert_allclose(np.std([one.cog[0] for one in found]), Scatter().fmd_cog, rtol=0.1)
    spread = np.std([one.moments_cog for one in found], axis=0) / nominal.moments_cog
    assert np.all((spread > 0.03) & (spread < 0.06))
    for one in found:
        moments, _ = one.principal()
        assert moments[2] < moments[0] + moments[1]


def test_no_tolerance_at_all_draws_nothing(exact_test: VirtualTest) -> None:
    drawn_figures = exact_test.truth["tolerances"]
    relative = drawn_figures["fmd-inertia"]
    figures = [value for name, value in drawn_figures.items() if name != "fmd-inertia"]
    assert {one.name for one in fields(Tolerances)} == set(exact_test.truth["plan"]["tolerances"])
    assert not np.any(figures)
    assert_allclose([relative["mass"], *relative["cog_m"], *relative["moi_cog"]], 0, atol=1e-14)
