"""docs/tutorial.md is the demo: its story is the demo's, command for command."""

from tools.demo import HIDDEN, STEPS
from tools.pages import ROOT, commands

TUTORIAL = commands(ROOT / "docs" / "tutorial.md")


def test_the_tutorial_types_what_the_demo_runs_in_the_same_order() -> None:
    told = iter(TUTORIAL)
    missing = [step.command for step in STEPS if HIDDEN in step.command and step.command not in told]
    assert missing == [], "of the demo, in this order"


def test_the_tutorial_needs_nothing_that_it_does_not_make() -> None:
    first, *rest = TUTORIAL
    assert first.startswith("massline simulate")
    assert f"--out {HIDDEN}" in first
    assert all(HIDDEN in line for line in rest)
