"""What tests of the pretest ask for: questions with few lines, and one answer to share."""

from collections.abc import Callable
from typing import Any

import pytest

from validation.identify.pretest import PretestFindings, PretestOptions, findings, question

Ask = Callable[..., PretestOptions]


def asked(article: str = "disc+cuboid", **changes: Any) -> PretestOptions:
    """A question with the options' own defaults, but for a short band and no channel left out."""
    usual: dict[str, Any] = {
        "tare": "none",
        "sensors": None,
        "pattern": "sweep",
        "runs": None,
        "level": 1.0,
        "band": (6.0, 12.0),
        "octaves_per_minute": 4.0,
        "cross": 0.03,
        "seed": 0,
        "tolerances": (),
        "noise": "1",
        "damping_ratio": None,
        "condition_limit": 100.0,
        "rigid_percent": 1.0,
        "lost": False,
        "settings": (),
    }
    return question(article=article, **{**usual, **changes})


@pytest.fixture(scope="session")
def ask() -> Ask:
    return asked


@pytest.fixture(scope="session")
def tared() -> PretestFindings:
    """Disc and Cuboid beside the bare FMD as tare, every channel left out in turn."""
    return findings(asked(tare="fmd", lost=True))
