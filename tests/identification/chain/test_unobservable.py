"""What the channels can never tell: the combinations known beforehand are found, and nothing shows of those that are found."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.sensors import ChannelTable
from identification.chain import Chain, chain
from identification.quality import seen_changes, unobservable

FREQUENCY = np.linspace(4.0, 32.0, 6)
H = np.diag([50.0, 50, 50, 7, 6, 2])
H[0, 4] = H[4, 0] = 9.0
H[1, 3] = H[3, 1] = -9.0


@pytest.fixture(scope="module")
def made(paper: ChannelTable) -> Chain:
    return chain(paper, stiffness=(1e8, 1e8, 4e8))


def test_a_common_gain_and_a_common_delay_are_never_seen(made: Chain) -> None:
    texts = [one.text for one in unobservable(made, np.zeros(len(made.parameters)), FREQUENCY, H)]
    assert "+1 force-gain (all 8) +1 accelerometer-gain (all 14)" in texts
    assert "+1 force-delay (all 8) +1 accelerometer-delay (all 14)" in texts


def test_the_common_softness_of_all_cells_is_that_of_each_of_them(made: Chain) -> None:
    """All stiffer and their common compliance higher: nothing has changed. Of cells that one channel sums, the sum counts."""
    found = unobservable(made, np.zeros(len(made.parameters)), FREQUENCY, H)
    expected = [
        {"fmd-compliance:vertical": 1.0, **{f"cell-stiffness:{k}z": 1.0 for k in range(1, 5)}},
        {"fmd-compliance:lateral": 1.0, **{f"cell-stiffness:{k}{a}": 1.0 for k in range(1, 5) for a in "xy"}},
        {"cell-stiffness:1x": 1.0, "cell-stiffness:2x": -1.0},
        {"cell-stiffness:1y": 1.0, "cell-stiffness:4y": -1.0},
        {"force-gain:fmd-x12": 1.0},
    ]
    seen = [outside(made, found, weights) for weights in expected]
    assert_allclose(seen[:4], 0, atol=1e-9)
    assert seen[4] > 0.1
    assert len(found) == 8


def outside(made: Chain, found: tuple, weights: dict[str, float]) -> float:
    """How much of a direction lies outside the combinations `found`, relative to its length in tolerances."""
    names = [one.name for one in made.parameters]

    def vector(offsets: dict[str, float]) -> np.ndarray:
        v = np.array([offsets.get(name, 0.0) for name in names]) / made.tolerances
        return v / np.linalg.norm(v)

    basis = np.linalg.qr(np.array([vector(dict(one.weights)) for one in found]).T)[0]
    v = vector(weights)
    return float(np.linalg.norm(v - basis @ (basis.T @ v)))


def test_nothing_shows_of_a_combination_however_far_it_is_driven(made: Chain) -> None:
    """Not in the Jacobian only: a delay of a quarter of a millisecond of all channels leaves every reading to another motion."""
    theta = made.theta({name: 2.5e-4 for one in made.parameters if (name := one.name).split("-")[1].startswith("delay")})
    A0, A1 = made.rows(theta, FREQUENCY)
    B0, B1 = made.rows(np.zeros(len(theta)), FREQUENCY)
    A, B = A0 + A1 @ H, B0 + B1 @ H
    for a, b in zip(A, B, strict=True):
        a, b = (m / np.linalg.norm(b, axis=1)[:, None] for m in (a, b))
        left = a - b @ np.linalg.lstsq(b, a, rcond=None)[0]
        assert_allclose(left, 0, atol=1e-12)


def test_an_unknown_mass_hides_the_ratio_of_the_gains(made: Chain) -> None:
    """With H known the ratio is seen; with all of H unknown in proportion it is not: that is what the tare is for."""
    theta = np.zeros(len(made.parameters))
    known = unobservable(made, theta, FREQUENCY, H)
    unknown = unobservable(made, theta, FREQUENCY, H, structure={"all of H": 0.01 * H})
    assert len(unknown) == len(known) + 1
    assert "+1 accelerometer-gain (all 14) -1 fmd-compliance (all 2) +100 all of H" in [one.text for one in unknown]


def test_without_channels_to_spare_nothing_is_seen(paper: ChannelTable) -> None:
    """Six accelerations and no force: any reading is a motion."""
    ups = ChannelTable(channels=tuple(channel for channel in paper.channels if channel.group == "table"))
    made = chain(ups, stiffness=np.inf)
    J = seen_changes(made, np.zeros(len(made.parameters)), FREQUENCY, H)
    assert_allclose(J, 0, atol=1e-14)
    assert len(unobservable(made, np.zeros(len(made.parameters)), FREQUENCY, H)) == len(made.parameters)
