"""Where a rigid band ends, and no verdict that the data contradict."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.dynamic_mass import DynamicMass
from geometry.inertia import Inertia
from identification.campaign import Campaign
from identification.consistency import Finding, of_spectra
from identification.elastic.model import ElasticTerms, dynamic_mass
from identification.identify import BENT, BROKEN, MISFIT, contradictions, failures, first_resonance, judged
from identification.request import Identified
from identification.spectra.of_campaign import spectra

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


def test_sound_data_keep_their_verdicts() -> None:
    """The largest misfit and sum z² of simulated laboratories with ordinary tolerances."""
    assert failures(SOUND) == ()
    assert judged(TOLD, (), ()) == TOLD


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"misfit": 1.1 * MISFIT}, "times what noise and model error explain"),
        ({"surprise": 1.1 * BENT * 120}, "the 120 tolerances had to be bent by"),
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


def test_a_misfit_that_is_not_known_says_nothing() -> None:
    assert failures(replace(SOUND, misfit=float("nan"))) == ()


def test_a_channel_in_a_wrong_unit_comes_first_in_every_verdict(campaign: Campaign) -> None:
    sound = spectra(campaign, band=(4.0, 6.0))
    assert contradictions(of_spectra(sound)) == ()
    factor = np.ones(len(sound.table))
    factor[sound.table.names.index("fmd-z2")] = 1 / 4.4482216152605  # lbf taken for N
    against = contradictions(of_spectra(replace(sound, values=sound.values * factor)))
    assert "fmd-z2 has the wrong unit" in against[0]
    for said in judged(TOLD, against, ("the fit did not converge",)).values():
        assert said.startswith("not trustworthy: it looks as if fmd-z2 has the wrong unit")
        assert "campaign.toml" in said


def test_checks_without_a_suspect_speak_beyond_all_that_sound_data_reach() -> None:
    def failed(value: float) -> Finding:
        return Finding(name="symmetry", holds=False, value=value, text="the dynamic mass is not symmetric")

    assert contradictions([failed(0.9 * BROKEN)]) == ()
    assert contradictions([failed(1.1 * BROKEN)]) == ("the dynamic mass is not symmetric",)


# A band for the rigid way: below the first resonance that the dynamic mass shows, and all of it where there is none


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
