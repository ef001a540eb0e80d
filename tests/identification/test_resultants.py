"""Resultants of load-cell channels, their covariance, and the combinations that must balance."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.sensors import Channel, ChannelTable, Place, summation
from identification.campaign import Campaign
from identification.resultants import resultants
from identification.spectra import of_campaign
from identification.spectra.line_spectra import Spectra

LATERAL, VERTICAL = "fmd-x12 - fmd-x34 + fmd-y14 - fmd-y23", "fmd-z1 - fmd-z2 + fmd-z3 - fmd-z4"


def read(table: ChannelTable, loads: np.ndarray, noise: float = 0.0, stiffness: np.ndarray | None = None) -> Spectra:
    """What the channels read of the loads (r, n, 6) when cells of the given stiffness share them."""
    chosen = list(table.select(quantity=("force", "moment")))
    of = summation([table.channels[k] for k in chosen], table.origin)
    B, K = of.gives.T, np.diag(np.ones(of.gives.shape[1]) if stiffness is None else stiffness)
    share = of.adds @ K @ B @ np.linalg.inv(B.T @ K @ B)
    random = np.random.default_rng(5)
    values = np.zeros((*loads.shape[:2], len(table)), dtype=complex)
    values[:, :, chosen] = loads @ share.T
    values += noise / np.sqrt(2) * (random.standard_normal(values.shape) + 1j * random.standard_normal(values.shape))
    runs = tuple(f"run {k}" for k in range(len(loads)))
    return Spectra(
        table=table,
        frequency=4.0 + np.arange(loads.shape[1]) / loads.shape[1],
        values=values,
        noise=np.full(values.shape, noise),
        quality=np.ones(values.shape[:2]),
        runs=runs,
        axes=("",) * len(runs),
    )


def some(lines: int = 5) -> np.ndarray:
    return np.random.default_rng(2).standard_normal((2, lines, 6)) + 0.5j


def crooked() -> ChannelTable:
    """Five three-component cells that nothing makes symmetric, read singly."""
    random = np.random.default_rng(8)
    places = [(k, np.append(random.uniform(-0.2, 0.2, 2), 0.03 * k), along) for k in range(5) for along in np.eye(3)]
    channels = [
        Channel(name=f"c{n}", quantity="force", group="fmd", places=(Place(position=at, direction=along),))
        for n, (_, at, along) in enumerate(places)
    ]
    return ChannelTable(channels=tuple(channels), origin=np.array([0.01, -0.02, 0.0]))


def mixed() -> ChannelTable:
    """Four cells; x is summed on one side and read singly on the other, y and z singly."""
    corners = [np.array([0.13 * a, 0.13 * b, 0.0]) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    read_as = [((0, 1), 0), ((2,), 0), ((3,), 0), *(((k,), axis) for axis in (1, 2) for k in range(4))]
    channels = [
        Channel(
            name=f"{'xyz'[axis]}{''.join(str(k + 1) for k in cells)}",
            quantity="force",
            group="fmd",
            places=tuple(Place(position=corners[k], direction=np.eye(3)[axis]) for k in cells),
        )
        for cells, axis in read_as
    ]
    return ChannelTable(channels=tuple(channels))


def test_the_papers_box_leaves_one_lateral_and_one_vertical_combination(campaign: Campaign) -> None:
    found = resultants(read(campaign.table, some()))
    assert found.names == (LATERAL, VERTICAL)
    assert_allclose(np.linalg.norm(found.combinations, axis=1), 1.0)


@pytest.mark.parametrize("which", ["box", "crooked", "mixed"])
def test_equal_cells_give_the_loads_and_balance(campaign: Campaign, which: str) -> None:
    table, loads = {"box": campaign.table, "crooked": crooked(), "mixed": mixed()}[which], some()
    found = resultants(read(table, loads))
    assert len(found.names) == len(found.channels) - 6
    # lever arms of a fifth of a metre: a condition of a few tens
    assert_allclose(found.values, loads, rtol=0, atol=1e-13 * 30)
    assert_allclose(found.parity, 0, atol=1e-12)


def test_a_wrong_gain_shows_in_its_own_combination_alone(campaign: Campaign) -> None:
    spectra = read(campaign.table, some())
    values = spectra.values.copy()
    values[:, :, campaign.table.names.index("fmd-x34")] *= 1.08
    found = resultants(replace(spectra, values=values))
    assert np.all(np.abs(found.parity[:, :, 0]) > 1e-3)
    assert_allclose(found.parity[:, :, 1], 0, atol=1e-13)
    # unit row: a quarter of the squares is the channel's
    assert_allclose(np.abs(found.parity[:, :, 0]), 0.04 * np.abs(spectra.values[:, :, campaign.table.names.index("fmd-x34")]))


def test_a_stiff_cell_leaves_resultants_alone_but_not_the_balance(campaign: Campaign) -> None:
    loads, stiffness = some(), np.ones(12)
    stiffness[8] = 1.05
    found = resultants(read(campaign.table, loads, stiffness=stiffness))
    assert_allclose(found.values, loads, rtol=0, atol=1e-12)
    size = np.abs(found.parity).max(axis=(0, 1))
    assert size.max() > 1e-3
    assert size.min() < 1e-12


def test_covariance_and_sigmas_are_those_of_repeated_measurements(campaign: Campaign) -> None:
    found = resultants(read(campaign.table, np.zeros((1, 20_000, 6), dtype=complex), noise=0.3))
    sample = np.einsum("rnk,rnl->kl", found.values, found.values.conj()).real / 20_000
    scale = np.sqrt(np.diag(sample))
    assert_allclose(
        sample / np.outer(scale, scale), found.covariance[0, 0] / np.outer(scale, scale), atol=0.03
    )  # four times 0.7 %
    assert_allclose(found.sigmas, 1.0, atol=0.03)


def test_sigmas_are_not_claimed_where_noise_is_not_known(campaign: Campaign) -> None:
    assert np.all(np.isnan(resultants(read(campaign.table, some())).sigmas))


def test_six_channels_leave_nothing_to_balance(campaign: Campaign) -> None:
    table = crooked().subset([0, 1, 2, 4, 8, 9])
    loads = some()
    found = resultants(read(table, loads))
    assert found.names == ()
    assert found.parity.shape == (2, 5, 0)
    assert_allclose(found.values, loads, rtol=0, atol=1e-11)


def test_a_resultant_that_nothing_sees_is_refused_by_name(campaign: Campaign) -> None:
    kept = [k for k, name in enumerate(campaign.table.names) if name not in ("fmd-x12", "fmd-x34")]
    table = campaign.table.subset(kept)
    spectra = read(campaign.table, some())
    with pytest.raises(BadInput, match="f_x"):
        resultants(replace(spectra, table=table, values=spectra.values[:, :, kept], noise=spectra.noise[:, :, kept]))


def test_quality_is_one_for_exact_channels_and_falls_with_a_fault_in_either_half(campaign: Campaign) -> None:
    from geometry.sensors import motion_rows

    table, u = campaign.table, some()
    pickups = list(table.select(quantity="acceleration"))
    spectra = read(table, some())
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
    spectra = read(table, some())
    nonsense = replace(spectra, values=spectra.values + np.random.default_rng(1).standard_normal(spectra.values.shape))
    assert_allclose(of_campaign.of_lines(nonsense, gravity=9.81), 1.0, atol=1e-12)
