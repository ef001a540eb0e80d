"""What other programs rely on."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest

from validation.diagnose.diagnosis import VERDICTS, Diagnosis
from validation.output import json_text, to_json

KEYS = {"verdict", "text", "accepted", "ranking", "equivalence_class", "next_measurement", "leftover", "errors"}
EFFECT = {"id", "value", "unit", "interval90", "evidence_nats", "text"}
ERRORS = {"plain_before_percent", "plain_after_percent", "heldout_before_percent", "heldout_after_percent"}


@pytest.mark.parametrize("verdict", VERDICTS)
def test_every_verdict_has_the_keys_of_the_contract(verdict: str, made: Callable[[str], Diagnosis]) -> None:
    found = json.loads(json_text(to_json(made(verdict))))
    assert found.keys() >= KEYS
    assert found["errors"].keys() >= ERRORS
    assert found["verdict"] == verdict
    for one in (*found["accepted"], *found["ranking"]):
        assert one.keys() >= EFFECT
    assert found["leftover"] is None or isinstance(found["leftover"], str)


def test_every_number_of_a_cause_is_in_si(made: Callable[[str], Diagnosis]) -> None:
    (gain,) = json.loads(json_text(to_json(made("missing"))))["accepted"]
    assert (gain["value"], gain["unit"], gain["evidence_nats"]) == (0.0793, "1", 208.3)
    assert gain["interval90"] == pytest.approx([0.0793 * 0.97, 0.0793 * 1.03], rel=1e-12)
    assert gain["written"] == "force-gain:fmd-z2=0.0793"
    assert gain["values"][0]["interval90"] == gain["interval90"]


def test_settings_of_any_kind_are_json(made: Callable[[str], Diagnosis]) -> None:
    found = to_json(made("missing"))["settings"]
    assert found == {"method": "full-record", "band_hz": [4.0, 32.0], "worth_nats": {"": 8.0}, "lines": 560}
    assert to_json({"a": np.inf, "b": (None, True, {1})}) == {"a": None, "b": [None, True, [1]]}


def test_both_fits_with_every_parameter_are_told(made: Callable[[str], Diagnosis]) -> None:
    found = to_json(made("missing"))
    assert found["before"]["fitted"]["parameters"]["force-gain:fmd-z1"]["offset"] == pytest.approx(24 * 0.003, rel=1e-12)
    assert found["after"]["fitted"]["log_evidence_nats"] == -691.7
