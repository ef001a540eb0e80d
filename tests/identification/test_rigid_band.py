"""A band for the rigid way: below the first resonance that the dynamic mass shows, and all of it where there is none."""

import numpy as np
import pytest

from geometry.dynamic_mass import DynamicMass
from identification.elastic.model import ElasticTerms, dynamic_mass
from identification.identify import first_resonance

LINES = np.arange(4.0, 32.01, 0.05)
BODY = np.diag([50.0, 50.0, 50.0, 10.0, 10.0, 1.0])


def measured(frequency: float, damping: float = 0.02, noise: float = 0.02) -> DynamicMass:
    """One mode along y and alpha; `noise` as a share of the level."""
    terms = ElasticTerms(
        frequency=np.array([frequency]),
        damping=np.array([[4 * np.pi * frequency * damping]]),
        participation=np.array([[0.0, 4.0, 0.0, 2.0, 0.0, 0.0]]),
    )
    rng = np.random.default_rng(0)
    H = dynamic_mass(BODY, terms, LINES)
    spread = np.sqrt(np.outer(np.diag(BODY), np.diag(BODY)))
    return DynamicMass(frequency=LINES, matrix=H + noise * spread * rng.standard_normal(H.shape))


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
    assert found == LINES[-1]
