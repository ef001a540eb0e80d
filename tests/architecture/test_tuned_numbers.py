"""Every tuned number of the search and of the fits stands alone on its line and says its unit, its meaning and what holds it.

"Held by" a test, by its name or, where several have that, by the end of its path: the test was seen to fail with the number
four (a small one a hundred) times as large or as small. "Exercised by": the test runs it, and whether it would notice was not
shown. Figures of `make blind` stand in docs/diagnosis-proven-blind.md.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROOMS = ("diagnose", "estimation")

UNITS = {
    *("share", "factor", "count", "probability", "index", "1", "log", "octave", "nats", "chi²", "chi²/dof", "cost/dof"),
    *("sd", "prior sd", "tolerance", "kg", "m", "Hz", "h", "deg"),
}

WITHOUT_TEST = 1
"""[count] of numbers that say "No test of its own": it may fall, not rise. Held by test_tuned_numbers.py."""


def is_number(node: ast.expr) -> bool:
    """Whether an expression is numbers only: one, a tuple of them, or a call of numpy with them."""
    if isinstance(node, ast.Tuple | ast.List):
        return bool(node.elts) and all(map(is_number, node.elts))
    if isinstance(node, ast.UnaryOp):
        return is_number(node.operand)
    if isinstance(node, ast.Call):
        return bool(node.args) and all(map(is_number, node.args))
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def constants(source: str) -> Iterator[tuple[ast.Assign, str]]:
    """Module-level assignments of numbers, each with the docstring beneath."""
    body = ast.parse(source).body
    for node, after in zip(body, [*body[1:], ast.Pass()], strict=True):
        if isinstance(node, ast.Assign) and is_number(node.value):
            told = after.value if isinstance(after, ast.Expr) else None
            yield node, str(told.value) if isinstance(told, ast.Constant) else ""


def faults(source: str) -> list[str]:
    """What is wrong with the numbers of a module."""
    found = []
    for node, told in constants(source):
        (target,) = node.targets
        name = ast.unparse(target)
        if not isinstance(target, ast.Name):
            found.append(f"{name}: several on one line")
        elif not (units := re.findall(r"^\[([^\]]+)\]", told)) or not UNITS.issuperset(units[:1]):
            found.append(f"{name}: no unit at the head of its docstring")
        elif not _held(told):
            found.append(f"{name}: no test that is there, nor `make blind`, nor a definition")
    return found


def _held(told: str) -> bool:
    """Whether a docstring names what a change of the number would meet."""
    told = " ".join(told.split())
    tests = re.findall(r"(?:\w+/)*test_\w+\.py", told)
    if tests:
        return all(len([*(ROOT / "tests").rglob(one)]) == 1 for one in tests)
    return "`make blind`" in told or told.endswith(("By definition.", "No test of its own."))


def modules() -> list[Path]:
    return sorted(path for room in ROOMS for path in (ROOT / "validation" / room).glob("*.py"))


@pytest.mark.parametrize("path", modules(), ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_every_number_is_alone_with_its_unit_and_with_what_holds_it(path: Path) -> None:
    assert faults(path.read_text(encoding="utf-8")) == []


def test_no_more_numbers_than_known_are_without_a_test() -> None:
    told = [text for path in modules() for _, text in constants(path.read_text(encoding="utf-8"))]
    assert sum(text.endswith("No test of its own.") for text in told) <= WITHOUT_TEST
    assert len(told) > 150  # the search for them finds them


@pytest.mark.parametrize(
    "source",
    [
        'A, B = 1, 0.25\n"""[share] Two at once. By definition."""',
        "A = 1.0",
        'A = 1.0\n"""Of something. By definition."""',
        'A = (1.0, 2.0)\n"""[share] Of something."""',
        'A = -1.0\n"""[share] Of something. Held by tests/validation/test_that_is_not_there.py."""',
    ],
)
def test_a_pair_a_riddle_and_a_number_without_proof_are_found(source: str) -> None:
    assert faults(source)
