"""The page on classical measurements: its file reduces, its examples say what they claim. All pages run their commands."""

import json
import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner
from numpy.testing import assert_allclose

from validation.cli import predict, reference

PAGE = Path(__file__).parents[2] / "docs" / "classical-measurements.md"


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def commands() -> list[str]:
    return [line for block in blocks("sh") for line in block.splitlines() if line.startswith("massline ")]


def test_the_page_holds_its_commands() -> None:
    assert {line.split()[1] for line in commands()} == {"weigh", "cog", "pendulum", "swing"}


def test_the_recorded_example_finds_the_body_it_was_integrated_for_only_with_its_corrections(root: Path) -> None:
    command = reference.pendulum_command

    def value(*more: str) -> float:
        result = CliRunner().invoke(command, [str(root / "examples" / "clumod-4-upright.toml"), "--json", *more])
        return float(json.loads(result.stdout)["rows"][0]["value"])

    # the stated amplitude is good to 7 %, which leaves 0.03 % of the inertia; the uncorrected one is 0.25 % off
    assert_allclose(value(), 2.278, rtol=4e-4)
    assert value("--without", "amplitude") > 2.278 * 1.002


ROWS = re.findall(r"^\| `(--[^`]+)` \| ([-+.\d]+) \| ([-+.\d]+) \| ([-+.\d]+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def test_the_page_shows_every_effect_with_its_command() -> None:
    assert len(ROWS) == 12


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_figures_beside_a_command_are_those_it_prints(row: tuple[str, ...]) -> None:
    words = [
        "clumod-4",
        "--cycles",
        "8",
        *([] if "--amplitude" in row[0] else ["--amplitude", "1 mrad"]),
        *shlex.split(row[0]),
        "--json",
    ]
    result = CliRunner().invoke(predict.swing_command, words)
    told = json.loads(result.stdout)
    printed = [told["period_shift_percent"]["all"], told["moi_error_percent"]["eq5"], told["moi_error_percent"]["corrected"]]
    assert_allclose(printed, [float(figure) for figure in row[1:]], atol=1.5e-4)  # four digits, and rounding of another machine
