"""docs/equations.md: every equation of the paper is there, beside the function that computes it, and its program can fail."""

import ast
import re
from pathlib import Path

import pytest

from tools.pages import blocks

PAGE = Path(__file__).parents[2] / "docs" / "equations.md"
SECTIONS = [text for text in re.split(r"^## ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:] if "```python" in text]
PROGRAM = "".join(block.text for block in blocks(PAGE) if block.language == "python")
CHECKS = [
    node for node in ast.walk(ast.parse(PROGRAM)) if isinstance(node, ast.Call) and ast.unparse(node.func) == "assert_allclose"
]


def equations(heading: str) -> set[str]:
    """The numbers that a heading names: "Eqs. 9, 10 and 11: ..." has three."""
    named = re.match(r"Eqs?\. ([^:]+):", heading)
    return set(re.findall(r"\d+[ab]?", named[1])) if named else set()


def test_every_equation_of_the_paper_has_a_section() -> None:
    assert set.union(*map(equations, SECTIONS)) == {*map(str, range(1, 8)), "8a", "8b", "9", "10", "11"}


@pytest.mark.parametrize("section", SECTIONS[1:], ids=lambda text: text.partition(":")[0].partition("\n")[0])
def test_a_section_has_its_formula_its_function_and_a_check(section: str) -> None:
    assert re.search(r"^```math\n.+?( = |\\approx|\\leftarrow)", section, re.MULTILINE | re.DOTALL), "the formula, typeset"
    assert re.search(r"\[`\w+(\.\w+)+`\]\(\.\./\w+/[\w/]+\.py\)", section), "the function, linked to its file"
    assert "assert_allclose(" in section


class OffByOnePerCent(ast.NodeTransformer):
    """What is written is made one per cent larger in the check that stands at `where`."""

    def __init__(self, where: tuple[int, int]) -> None:
        self.where = where

    def visit_Call(self, node: ast.Call) -> ast.Call:
        if (node.lineno, node.col_offset) == self.where and ast.unparse(node.func) == "assert_allclose":
            node.args[0] = ast.BinOp(left=ast.Constant(1.01), op=ast.Mult(), right=node.args[0])
        return node


@pytest.mark.parametrize("check", CHECKS, ids=lambda node: ast.unparse(node.args[0])[:40])
def test_an_equation_that_is_one_per_cent_off_is_seen(check: ast.Call) -> None:
    wrong = OffByOnePerCent((check.lineno, check.col_offset)).visit(ast.parse(PROGRAM))
    with pytest.raises(AssertionError):
        exec(compile(ast.fix_missing_locations(wrong), "equations.md", "exec"), {})
