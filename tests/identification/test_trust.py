"""No verdict is trusted where the data contradict themselves, and none is lost where they do not."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.inertia import Inertia
from identification.campaign import Campaign
from identification.consistency import Finding, of_spectra
from identification.identify import BENT, BROKEN, MISFIT, contradictions, failures, judged
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
