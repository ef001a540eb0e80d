"""docs/reference-tables.md shows the tables that the program renders from the published data, to the letter."""

import re
from pathlib import Path

import pytest

from validation.reference.published import published
from validation.reference.reference import ReferenceTable
from validation.report import document


def rendered(article: str) -> str:
    said = published(article)
    return document.markdown_render(ReferenceTable(article=article, columns=said.statements, footnotes=said.footnotes))


@pytest.mark.parametrize(("number", "article"), [(1, "clumod-4"), (2, "clumod-1")])
def test_the_page_shows_the_table_that_the_data_gives(root: Path, number: int, article: str) -> None:
    page = (root / "docs" / "reference-tables.md").read_text(encoding="utf-8")
    shown = re.search(rf"<!-- table {number} -->\n(.*?)<!-- end -->", page, re.DOTALL)
    assert shown.group(1).strip() == rendered(article).strip()
