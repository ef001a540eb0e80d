"""Base motion (Eqs. 2, 3, 6, 7) and resultants: identities, noise as predicted, gravity, and combinations that must balance."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import rotation_about
from geometry.sensors import Channel, ChannelTable, Place, motion_rows, summation
from identification.base_motion import base_motion, groups_used, resultants, tilt, without_each
from identification.campaign import Campaign
from identification.spectra import of_campaign
from identification.spectra.line_spectra import Spectra

LINES = np.array([4.0, 9.0, 20.0, 32.0])


@pytest.fixture
def table(campaign: Campaign) -> ChannelTable:
    return campaign.table


def as_spectra(table: ChannelTable, values: np.ndarray, noise: float, seed: int) -> Spectra:
    """Exact `values` (r, n, c) with complex noise of standard deviation `noise`."""
    random, (runs, lines, _) = np.random.default_rng(seed), values.shape
    values = values + noise / np.sqrt(2) * (random.standard_normal(values.shape) + 1j * random.standard_normal(values.shape))
    return Spectra(
        table=table,
        frequency=4.0 + np.arange(lines) / lines if lines != len(LINES) else LINES,
        values=values,
        noise=np.full(values.shape, noise),
        quality=np.ones(values.shape[:2]),
        runs=tuple(f"run {k}" for k in range(runs)),
        axes=("",) * runs,
    )


def read(table: ChannelTable, motion: np.ndarray, noise: float = 0.0) -> Spectra:
    """What a rigid body makes of the motions (r, n, 6)."""
    pickups = list(table.select(quantity="acceleration"))
    values = np.zeros((*motion.shape[:2], len(table)), dtype=complex)
    values[:, :, pickups] = motion @ motion_rows([table.channels[k] for k in pickups], table.origin).T
    return as_spectra(table, values, noise, 1)


def some(runs: int = 2, lines: int = 4, seed: int = 0) -> np.ndarray:
    random = np.random.default_rng(seed)
    return random.standard_normal((runs, lines, 6)) + 1j * random.standard_normal((runs, lines, 6))


def test_exact_readings_give_the_motion_whatever_the_weights(table: ChannelTable) -> None:
    u = some()
    for weights in (None, np.geomspace(1, 1e4, 8)):
        found = base_motion(read(table, u), weights=weights)
        assert found.channels == tuple(name for name in table.names if name.startswith("cover"))
        assert found.redundancy == 2
        # weights over four decades cost four digits of the smaller ones
        assert_allclose(found.values, u, rtol=0, atol=1e-11)
        assert_allclose(found.residual, 0, atol=1e-11)


def test_equal_weights_are_equation_7(table: ChannelTable) -> None:
    spectra = read(table, some(), noise=0.3)
    chosen = table.select(group="cover")
    G = motion_rows([table.channels[k] for k in chosen], table.origin)
    expected = spectra.values[:, :, chosen] @ (np.linalg.inv(G.T @ G) @ G.T).T
    # the condition of the normal equations, below 100
    assert_allclose(base_motion(spectra).values, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_covariance_is_that_of_repeated_measurements(table: ChannelTable) -> None:
    found = base_motion(read(table, np.zeros((1, 20_000, 6), dtype=complex), noise=0.02))
    sample = np.einsum("rnk,rnl->kl", found.values, found.values.conj()).real / found.values.shape[1]
    scale = np.sqrt(np.diag(sample))
    # 20,000 complex samples: a relative standard deviation of 0.7 %
    assert_allclose(sample / np.outer(scale, scale), found.covariance[0, 0] / np.outer(scale, scale), atol=0.03)
    assert_allclose(found.sigmas, 1.0, atol=0.03)


def test_a_noisy_sensor_is_trusted_less_and_the_motion_gets_better_for_it(table: ChannelTable) -> None:
    noise = np.full(8, 0.01)
    noise[0] = 1.0
    spectra = read(table, np.zeros((1, 2000, 6), dtype=complex), noise=1.0)
    level = np.ones(len(table))
    level[list(table.select(group="cover"))] = noise
    spectra = replace(spectra, values=spectra.values * level, noise=spectra.noise * level)
    weighted, plain = base_motion(spectra), base_motion(spectra, weights=np.ones(8))
    z, both = MOTIONS.index("z"), [np.abs(one.values[0]) for one in (weighted, plain)]
    assert np.mean(both[0][:, z] ** 2) < 0.01 * np.mean(both[1][:, z] ** 2)
    assert_allclose(np.mean(both[0][:, z] ** 2), weighted.covariance[0, 0, z, z], rtol=0.1)  # 2000 samples: 2 %, five of them


def test_a_contradiction_of_the_sensors_is_seen_in_sigmas_and_per_cent(table: ChannelTable) -> None:
    spectra = read(table, some(1), noise=1e-3)
    values = spectra.values.copy()
    values[:, :, table.names.index("cover-z3")] *= 1.05
    found = base_motion(replace(spectra, values=values))
    z = [k for k, name in enumerate(found.channels) if "-z" in name]
    assert np.all(found.sigmas[0, z] > 10)
    assert np.all((found.percent[0, z] > 0.5) & (found.percent[0, z] < 5))


def test_sigmas_are_not_claimed_where_noise_is_not_known(table: ChannelTable) -> None:
    assert np.all(np.isnan(base_motion(read(table, some())).sigmas))
    assert np.all(np.isnan(resultants(read_loads(table, some_loads())).sigmas))


def test_a_pickup_that_feels_gravity_reads_the_apparent_motion() -> None:
    """From the rotation itself: a sensor along d on a body turned by R reads d·R^T (a - g), g pointing down."""
    frequency, gravity, small = 4.0, 9.81, 1e-6
    omega = 2 * np.pi * frequency
    for axis, name in enumerate("xyz"):
        kinematic = np.zeros(6)
        kinematic[3 + axis] = -(omega**2) * small  # acceleration at the moment of the largest angle
        weight = rotation_about(name, small).T @ np.array([0.0, 0.0, gravity]) - [0.0, 0.0, gravity]
        apparent = tilt([frequency], gravity)[0] @ kinematic
        assert_allclose(apparent[:3], weight, rtol=0, atol=gravity * small**2)  # the angle squared
        assert_allclose(apparent[3:], kinematic[3:])


def test_kinematic_pickups_and_others_agree_on_the_apparent_motion(table: ChannelTable) -> None:
    u = some()
    chosen = [table.names.index(f"cover-{name}") for name in ("x1", "y1", "z1")]
    channels = [replace(one, senses_gravity=k not in chosen) for k, one in enumerate(table.channels)]
    mixed = replace(read(table, u), table=replace(table, channels=tuple(channels)))
    values = mixed.values.copy()
    G = motion_rows([channels[k] for k in chosen], table.origin)
    kinematic = np.linalg.solve(tilt(LINES, 9.81), u[..., None])[..., 0]
    values[:, :, chosen] = kinematic @ G.T
    found = base_motion(replace(mixed, values=values), gravity=9.81)
    assert_allclose(found.values, u, rtol=0, atol=1e-13)
    assert_allclose(found.residual, 0, atol=1e-13)
    # and a fault shows: with the wrong gravity the sensors contradict each other
    assert np.abs(base_motion(replace(mixed, values=values), gravity=0.0).residual).max() > 1e-3


def test_the_table_serves_where_the_cover_plate_does_not_tell_and_says_so(table: ChannelTable) -> None:
    u = some()
    kept = table.subset([k for k, name in enumerate(table.names) if name not in ("cover-x1", "cover-x2")])
    assert groups_used(kept) == ("table",)
    found = base_motion(read(kept, u))
    assert_allclose(found.values, u, rtol=0, atol=1e-12)
    assert "cells are taken for rigid" in found.warnings[0]
    assert "x" in found.warnings[0]
    assert np.all(np.isnan(found.sigmas))  # six pick-ups for six motions: nothing is redundant


def test_neither_group_alone_is_refused_with_what_is_missing(table: ChannelTable) -> None:
    kept = table.subset([k for k, name in enumerate(table.names) if name not in ("cover-x1", "cover-x2", "table-z1")])
    with pytest.raises(BadInput, match="neither the cover plate") as caught:
        base_motion(read(kept, some()))
    assert "ask for both groups" in caught.value.remedy
    both = base_motion(read(kept, some()), groups=("table", "cover"))
    assert "load cells for rigid" in both.warnings[0]
    assert_allclose(both.values, some(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("weights", [[1.0], [0.0] * 8, [np.nan] * 8])
def test_weights_that_are_none_are_refused(table: ChannelTable, weights: list[float]) -> None:
    with pytest.raises(BadInput, match="a positive weight for each of 8 channels"):
        base_motion(read(table, some()), weights=weights)


def test_losing_a_sensor_moves_motions_by_what_it_contradicts(table: ChannelTable) -> None:
    spectra = read(table, some(1))
    assert all(np.abs(one.moved).max() < 1e-12 for one in without_each(spectra))
    values = spectra.values.copy()
    values[:, :, table.names.index("cover-y2")] *= 1.02
    found = {one.channel: one for one in without_each(replace(spectra, values=values))}
    # exact readings are left when the wrong one goes: what it moved is the whole error that it made
    wrong = base_motion(replace(spectra, values=values)).values - some(1)
    levels = np.array([2.5, 2.5, 2.5, 3.0, 3.0, 6.0])
    size = np.sqrt(np.mean(np.abs(base_motion(replace(spectra, values=values)).values / levels) ** 2, axis=1)).max()
    expected = np.sqrt(np.mean(np.abs(wrong / levels) ** 2, axis=1)) / size
    assert_allclose(found["cover-y2"].moved, expected, rtol=1e-9, atol=1e-12)


def test_noise_grows_without_a_sensor_as_the_covariances_say(table: ChannelTable) -> None:
    found = without_each(read(table, some(1), noise=0.01))
    for one in found:
        assert one.amplification.min() > 1 - 1e-9  # no sensor less was ever better
        kept = [k for k in table.select(group="cover") if table.names[k] != one.channel]
        G = motion_rows([table.channels[k] for k in kept], table.origin)
        whole = motion_rows([table.channels[k] for k in table.select(group="cover")], table.origin)
        expected = np.sqrt(np.diag(np.linalg.inv(G.T @ G)) / np.diag(np.linalg.inv(whole.T @ whole)))
        assert_allclose(one.amplification, expected, rtol=1e-9)


def test_the_sensor_that_alone_sees_a_motion_is_named(table: ChannelTable) -> None:
    lone = table.subset([k for k, name in enumerate(table.names) if name != "cover-x2"])
    found = {one.channel: one for one in without_each(read(lone, some(1)))}
    assert "x" in found["cover-x1"].lost
    assert "without cover-x1" in found["cover-x1"].text
    assert np.all(np.isinf(found["cover-x1"].amplification))
    assert not found["cover-z1"].lost


LATERAL, VERTICAL = "fmd-x12 - fmd-x34 + fmd-y14 - fmd-y23", "fmd-z1 - fmd-z2 + fmd-z3 - fmd-z4"


def read_loads(table: ChannelTable, loads: np.ndarray, noise: float = 0.0, stiffness: np.ndarray | None = None) -> Spectra:
    """What the channels read_loads of the loads (r, n, 6) when cells of the given stiffness share them."""
    chosen = list(table.select(quantity=("force", "moment")))
    of = summation([table.channels[k] for k in chosen], table.origin)
    B, K = of.gives.T, np.diag(np.ones(of.gives.shape[1]) if stiffness is None else stiffness)
    share = of.adds @ K @ B @ np.linalg.inv(B.T @ K @ B)
    values = np.zeros((*loads.shape[:2], len(table)), dtype=complex)
    values[:, :, chosen] = loads @ share.T
    return as_spectra(table, values, noise, 5)


def some_loads(lines: int = 5) -> np.ndarray:
    return np.random.default_rng(2).standard_normal((2, lines, 6)) + 0.5j


def crooked() -> ChannelTable:
    """Five three-component cells that nothing makes symmetric, read_loads singly."""
    random = np.random.default_rng(8)
    places = [(k, np.append(random.uniform(-0.2, 0.2, 2), 0.03 * k), along) for k in range(5) for along in np.eye(3)]
    channels = [
        Channel(name=f"c{n}", quantity="force", group="fmd", places=(Place(position=at, direction=along),))
        for n, (_, at, along) in enumerate(places)
    ]
    return ChannelTable(channels=tuple(channels), origin=np.array([0.01, -0.02, 0.0]))


def test_the_papers_box_leaves_one_lateral_and_one_vertical_combination(campaign: Campaign) -> None:
    found = resultants(read_loads(campaign.table, some_loads()))
    assert found.names == (LATERAL, VERTICAL)
    assert_allclose(np.linalg.norm(found.combinations, axis=1), 1.0)


@pytest.mark.parametrize("which", ["box", "crooked"])
def test_equal_cells_give_the_loads_and_balance(campaign: Campaign, which: str) -> None:
    table, loads = {"box": campaign.table, "crooked": crooked()}[which], some_loads()
    found = resultants(read_loads(table, loads))
    assert len(found.names) == len(found.channels) - 6
    # lever arms of a fifth of a metre: a condition of a few tens
    assert_allclose(found.values, loads, rtol=0, atol=1e-13 * 30)
    assert_allclose(found.parity, 0, atol=1e-12)


def test_a_wrong_gain_shows_in_its_own_combination_alone(campaign: Campaign) -> None:
    spectra = read_loads(campaign.table, some_loads())
    values = spectra.values.copy()
    values[:, :, campaign.table.names.index("fmd-x34")] *= 1.08
    found = resultants(replace(spectra, values=values))
    assert np.all(np.abs(found.parity[:, :, 0]) > 1e-3)
    assert_allclose(found.parity[:, :, 1], 0, atol=1e-13)
    # unit row: a quarter of the squares is the channel's
    assert_allclose(np.abs(found.parity[:, :, 0]), 0.04 * np.abs(spectra.values[:, :, campaign.table.names.index("fmd-x34")]))


def test_a_stiff_cell_leaves_resultants_alone_but_not_the_balance(campaign: Campaign) -> None:
    loads, stiffness = some_loads(), np.ones(12)
    stiffness[8] = 1.05
    found = resultants(read_loads(campaign.table, loads, stiffness=stiffness))
    assert_allclose(found.values, loads, rtol=0, atol=1e-12)
    size = np.abs(found.parity).max(axis=(0, 1))
    assert size.max() > 1e-3
    assert size.min() < 1e-12


def test_covariance_and_sigmas_are_those_of_repeated_measurements(campaign: Campaign) -> None:
    found = resultants(read_loads(campaign.table, np.zeros((1, 20_000, 6), dtype=complex), noise=0.3))
    sample = np.einsum("rnk,rnl->kl", found.values, found.values.conj()).real / 20_000
    scale = np.sqrt(np.diag(sample))
    assert_allclose(
        sample / np.outer(scale, scale), found.covariance[0, 0] / np.outer(scale, scale), atol=0.03
    )  # four times 0.7 %
    assert_allclose(found.sigmas, 1.0, atol=0.03)


def test_six_channels_leave_nothing_to_balance(campaign: Campaign) -> None:
    table = crooked().subset([0, 1, 2, 4, 8, 9])
    loads = some_loads()
    found = resultants(read_loads(table, loads))
    assert found.names == ()
    assert found.parity.shape == (2, 5, 0)
    assert_allclose(found.values, loads, rtol=0, atol=1e-11)


def test_a_resultant_that_nothing_sees_is_refused_by_name(campaign: Campaign) -> None:
    kept = [k for k, name in enumerate(campaign.table.names) if name not in ("fmd-x12", "fmd-x34")]
    table = campaign.table.subset(kept)
    spectra = read_loads(campaign.table, some_loads())
    with pytest.raises(BadInput, match="f_x"):
        resultants(replace(spectra, table=table, values=spectra.values[:, :, kept], noise=spectra.noise[:, :, kept]))


def test_quality_is_one_for_exact_channels_and_falls_with_a_fault_in_either_half(campaign: Campaign) -> None:
    from geometry.sensors import motion_rows

    table, u = campaign.table, some_loads()
    pickups = list(table.select(quantity="acceleration"))
    spectra = read_loads(table, some_loads())
    values = spectra.values.copy()
    values[:, :, pickups] = u @ motion_rows([table.channels[k] for k in pickups], table.origin).T
    assert_allclose(of_campaign.of_lines(replace(spectra, values=values), gravity=9.81), 1.0, atol=1e-12)
    for name in ("cover-y1", "fmd-z2"):
        k, wrong = table.names.index(name), values.copy()
        wrong[:, :, k] *= -1
        found = of_campaign.of_lines(replace(spectra, values=wrong), gravity=9.81)
        group = [j for j, one in enumerate(table.channels) if one.group == table.channels[k].group]
        share = np.abs(values[:, :, k]) ** 2 / np.sum(np.abs(values[:, :, group]) ** 2, axis=2)
        assert np.all(found < 1 - 0.2 * share)  # an inverted channel leaves at least a good part of itself unexplained


def test_quality_tests_nothing_where_nothing_is_redundant(campaign: Campaign) -> None:
    table = crooked().subset([0, 1, 2, 4, 8, 9])
    spectra = read_loads(table, some_loads())
    nonsense = replace(spectra, values=spectra.values + np.random.default_rng(1).standard_normal(spectra.values.shape))
    assert_allclose(of_campaign.of_lines(nonsense, gravity=9.81), 1.0, atol=1e-12)
