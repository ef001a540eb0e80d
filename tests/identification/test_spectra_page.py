"""docs/spectra.md: its program runs, and its figures are those that are measured."""

import re
import runpy
import shutil
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "spectra.md"


def test_the_program_of_the_page_runs(written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:  # type: ignore[no-untyped-def]
    (program,) = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    shutil.copytree(written, tmp_path / "out" / "own-campaign" / "h5")
    monkeypatch.chdir(tmp_path)
    exec(compile(program, str(PAGE), "exec"), {})
    printed = capsys.readouterr().out
    assert printed.count("without cover-") == 8
    assert "'fmd-z1 - fmd-z2 + fmd-z3 - fmd-z4'" in printed


def test_the_bias_on_the_page_is_the_one_that_is_measured(root: Path) -> None:
    from identification.spectra.sweep_bias import sweep_bias

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
