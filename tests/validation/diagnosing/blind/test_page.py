"""The page about the proof says what the program does."""

import re
from pathlib import Path

import pytest
from click import Command
from click.testing import CliRunner

from benchmarks.blind import __main__ as drawing
from benchmarks.blind.drawing.case import FOREIGN, LEFT_OUT, NULL, PAIR, SINGLE
from benchmarks.blind.drawing.draw import COUNTS, draw
from benchmarks.blind.drawing.foreign import FOREIGN as PHYSICS
from benchmarks.blind.drawing.limits import STUDY
from benchmarks.blind.score import __main__ as scoring
from benchmarks.blind.score import page


@pytest.fixture(scope="module")
def text(root: Path) -> str:
    return (root / page.PAGE).read_text(encoding="utf-8")


def test_the_score_has_its_place(text: str) -> None:
    assert text.count(page.BEGIN) == text.count(page.END) == 1
    assert text.index(page.BEGIN) < text.index(page.END)


def test_the_kinds_and_their_numbers_are_those_of_the_draw(text: str) -> None:
    stated = dict(re.findall(r"^\| ([a-z-]+) \| .* \| (?:about )?(\d+) \|$", text, re.MULTILINE))
    assert {kind: int(stated[kind]) for kind in (NULL, PAIR, LEFT_OUT, FOREIGN)} == {
        kind: COUNTS[kind] for kind in (NULL, PAIR, LEFT_OUT, FOREIGN)
    }
    assert abs(len(draw(1, (SINGLE,))) - int(stated[SINGLE])) <= 5


def test_every_physics_that_no_family_describes_is_told(text: str) -> None:
    (told,) = re.findall(r"^The physics that no family describes: (.*?)\n\n", text, re.MULTILINE | re.DOTALL)
    assert len(told.split(",")) == len(PHYSICS)


def test_the_limits_of_the_study_are_told(text: str) -> None:
    for figure, size in {
        "1.5 %": 0.015,
        "0.1 kg": 0.1,
        "100 µs": 100e-6,
        "3.5 %": 0.035,
        "2.5 mm": 2.5e-3,
        "10 g": 0.010,
    }.items():
        assert figure in text
        assert size in STUDY.values()


@pytest.mark.parametrize(("module", "command"), [("benchmarks.blind", drawing.main), ("benchmarks.blind.score", scoring.main)])
def test_the_commands_of_the_page_know_the_options_that_stand_there(module: str, command: Command, text: str) -> None:
    (typed,) = re.findall(rf"^python -m {module} (--.*)$", text, re.MULTILINE)
    helped = CliRunner().invoke(command, ["--help"]).output
    assert all(option in helped for option in re.findall(r"--[a-z]+", typed))


def test_make_blind_runs_both(root: Path) -> None:
    (recipe,) = re.findall(r"^blind:.*?\n((?:\t.*\n)+)", (root / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert "benchmarks.blind $(ARGS)" in recipe
    assert "benchmarks.blind.score" in recipe
