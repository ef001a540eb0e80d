"""docs/measurement-chain.md: its program runs, and its table holds the families and tolerances of the code."""

import re
from math import exp
from pathlib import Path

import pytest

from geometry.sensors import ChannelTable
from identification.chain import ASSUMED, STATED, chain

PAGE = Path(__file__).parents[3] / "docs" / "measurement-chain.md"


def families_of_the_page() -> dict[str, str]:
    """By family what the page says of its tolerance."""
    found = {}
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| `") and len(cells) == 5:
            found |= dict.fromkeys(re.findall(r"`([\w-]+)`", cells[0]), cells[3])
    return found


def test_the_table_holds_every_family_with_its_tolerance(paper: ChannelTable) -> None:
    said = families_of_the_page()
    ordinary = chain(paper).parameters
    everything = chain(paper, overrides={family: 1.0 for family, tolerance in said.items() if tolerance == "-"}).parameters
    assert set(said) == {one.family for one in everything}
    assert {family for family, tolerance in said.items() if tolerance != "-"} == {one.family for one in ordinary}
    for one in ordinary:
        figures = [float(figure) for figure in re.findall(r"(?<![\^\w])\d[\d.e-]*", said[one.family])]
        if one.family != "fmd-compliance":
            assert any(abs(figure - one.tolerance) < 1e-3 * one.tolerance for figure in figures), one.name
    exponents = [float(figure) for figure in re.findall(r"e\^([\d.]+)", said["fmd-compliance"])]
    assert exponents == [pytest.approx(ASSUMED, abs=5e-3), STATED]
    assert exp(ASSUMED) == pytest.approx(5.0)
