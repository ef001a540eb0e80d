"""What a diagnosis rests on beside the data: limits, lines, band and what was asked, for its settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import version

from validation.diagnosing import accepting, afresh, asked_again, dictionary, searching
from validation.diagnosing.bench import Bench
from validation.effects.worth import ALIKE, WORTH, WORTH_OF
from validation.engine.fit import FLOOR


def of_bench(bench: Bench) -> Mapping[str, object]:
    """Of the data: which lines, by which processing, and what no fit sees."""
    return {
        "version": version("massline"),
        "random_numbers": "none: the same data give the same answer",
        "method": bench.made[0].tested.method,
        "band_hz": {
            one.measured.name: [float(one.measured.frequency[0]), float(one.measured.frequency[-1])] for one in bench.made
        },
        "hold_out": list(bench.hold_out),
        "worth_nats": {"": WORTH, **WORTH_OF},
        "alike_nats": ALIKE,
        "model_error_floor": FLOOR,
    }


def of_search() -> Mapping[str, object]:
    """Of the search: what is fitted, and when it ends."""
    return {
        "unlikely": accepting.UNLIKELY,
        "absurd_z": accepting.ABSURD,
        "promising_nats": searching.PROMISING,
        "short_nats": searching.SHORT,
        "tried_at_most": searching.TRIED,
        "effects_at_most": searching.MOST,
        "bent_chi2_per_dof": searching.BENT,
        "least_share_of_excess": searching.LEAST,
        "kept_share_of_promise": searching.KEPT,
        "afresh_at_most": searching.AFRESH,
        "afresh_octaves": [float(afresh.OCTAVES[0]), float(afresh.OCTAVES[-1])],
        "afresh_floor": afresh.ROUGH,
        "asked_again_at_most": asked_again.RIVALS,
        "asked_again_share": asked_again.SHARE,
        "instead_of_resonators_at_most": searching.INSTEAD,
        "resonators_beyond_band": dictionary.BEYOND,
    }


def of_question(only: Sequence[str], leave_out: Sequence[str]) -> Mapping[str, object]:
    """What was looked for; all of the catalogue that these data can show where nothing is said."""
    return {"only": list(only), "leave_out": list(leave_out)}
