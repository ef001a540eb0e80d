"""Base motion from accelerometers (Eqs. 2, 3, 6, 7): identities, noise as predicted, gravity, and what is lost with a sensor."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import rotation_about
from geometry.sensors import ChannelTable, motion_rows
from identification.base_motion import base_motion, groups_used, tilt, without_each
from identification.campaign import Campaign
from identification.spectra.line_spectra import Spectra

LINES = np.array([4.0, 9.0, 20.0, 32.0])


@pytest.fixture
def table(campaign: Campaign) -> ChannelTable:
    return campaign.table


def read(table: ChannelTable, motion: np.ndarray, noise: float = 0.0, seed: int = 1) -> Spectra:
    """What a rigid body makes of the motions (r, n, 6), with complex noise of standard deviation `noise`."""
    pickups = list(table.select(quantity="acceleration"))
    values = np.zeros((*motion.shape[:2], len(table)), dtype=complex)
    values[:, :, pickups] = motion @ motion_rows([table.channels[k] for k in pickups], table.origin).T
    random = np.random.default_rng(seed)
    values += noise / np.sqrt(2) * (random.standard_normal(values.shape) + 1j * random.standard_normal(values.shape))
    runs = tuple(f"run {k}" for k in range(len(motion)))
    return Spectra(
        table=table,
        frequency=4.0 + np.arange(motion.shape[1]) if motion.shape[1] != len(LINES) else LINES,
        values=values,
        noise=np.full(values.shape, noise),
        quality=np.ones(values.shape[:2]),
        runs=runs,
        axes=("",) * len(runs),
    )


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
