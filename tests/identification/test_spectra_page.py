"""docs/spectra.md: its program runs, and its figures are those that are measured."""

import re
import runpy
from pathlib import Path

import numpy as np

PAGE = Path(__file__).parents[2] / "docs" / "spectra.md"


def test_the_bias_on_the_page_is_the_one_that_is_measured(root: Path) -> None:
    from identification.spectra.peak_hold import sweep_bias

    program = runpy.run_path(str(root / "examples" / "peak_hold_bias.py"))
    found = program["figures"](sweep_bias(12.3, 0.0035, frequency=program["LINES"]), 12.3)
    text = PAGE.read_text(encoding="utf-8").replace("\n", " ")
    at, away, largest = (
        float(re.search(pattern, text).group(1)) / 100 for pattern in (r"(\d+) % low", r"about ([\d.]+) %", r"up to ([\d.]+) %")
    )  # type: ignore[union-attr]
    np.testing.assert_allclose(
        [found["peak_hold"][key] for key in ("at", "away", "largest_away")], [at, away, largest], rtol=0.07
    )
    assert found["full_record"]["largest_away"] < 1.2e-5
