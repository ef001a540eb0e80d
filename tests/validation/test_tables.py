"""Printed tables, word for word, and what every format must keep."""

import csv
import io
import json
import re

import numpy as np
import pytest

from geometry.inertia import Inertia
from validation.output import fixed, to_json
from validation.reference import published
from validation.reference.reference import ReferenceTable, route_statement
from validation.reference.statement import QUANTITIES
from validation.report import document, reference

BODY = Inertia.from_cog(32.95, [0, 0, 0.2706], np.diag([6.42, 6.00, 0.77]))


def table(article: str = "clumod-1") -> ReferenceTable:
    said = published.published(article)
    return ReferenceTable(
        article=article,
        columns={"occ": route_statement("occ", BODY), **said.statements},
        note="A test's own body.",
        agreement="occ agrees with itself",
        footnotes=said.footnotes,
    )


@pytest.mark.parametrize("article", ["clumod-1", "clumod-4"])
def test_no_printed_digit_is_lost_and_decimal_points_line_up(article):
    shown = reference.values(table(article))
    for k, column in enumerate(zip(*shown.lines, strict=True)):
        points = {len(cell) - len(cell[cell.index(".") :]) for cell in column if "." in cell}
        assert k == 0 or len(points) == 1, column
    text_of_all = " ".join(cell for line in shown.lines for cell in line)
    for figure in {"clumod-1": ("32.95", "270.60", "6.00", "283.61", "-5.45"), "clumod-4": ("47.230", "20.410", "47.400")}[
        article
    ]:
        assert re.search(rf"(?<![\d.]){re.escape(figure)}(?!\d)", text_of_all), figure


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [(-1e-9, 2, "0.00"), (-0.006, 2, "-0.01"), (8e-7, 7, "0.0000008"), (9_999_999.0, 1, "9999999.0")],
)
def test_figures_keep_their_decimals_and_what_rounds_to_zero_has_no_sign(value, decimals, text):
    assert fixed(value, decimals) == text


@pytest.mark.parametrize("scale", [1e-13, 1e18])
def test_what_is_very_large_or_small_has_an_exponent_and_its_points_still_line_up(scale):
    body = Inertia.from_cog(32.95 * scale, [0, 0, 0.2706], scale * np.diag([6.42, 6.00, 0.77]))
    lines = reference.values(ReferenceTable(article="huge", columns={"occ": route_statement("occ", body)}, footnotes=())).lines
    assert float(lines[0][1]) == pytest.approx(32.95 * scale, rel=1e-5)
    assert max(len(cell.strip()) for _, cell in lines) <= len("3.29500e+19")
    assert len({cell.index(".") for _, cell in lines if "." in cell}) == 1
    assert lines[3][1].strip() == "270.600"


@pytest.mark.parametrize("width", [50, 80, 100, 160])
def test_a_table_wider_than_the_terminal_goes_on_below_itself_and_loses_nothing(width):
    page = reference.text_render(table(), width)
    assert max(map(len, page.splitlines())) <= width
    for shown in (reference.values(table()), reference.deviations(table())):
        assert [cell for line in shown.lines for cell in line[1:-1] if cell.strip() not in page] == []
        for part in document.parts(shown, width):
            assert [line[0] for line in part.lines] == [line[0] for line in shown.lines]
        again = [cell for part in document.parts(shown, width) for cell in part.header[1:]]
        assert again == list(shown.header[1:])
    assert "…" not in page


def test_a_single_column_has_no_deviations_and_no_note_on_them():
    alone = ReferenceTable(article="x", columns={"trimesh": route_statement("trimesh", BODY)})
    assert len(reference.grids(alone)) == 1
    assert reference.remarks(alone) == ()


def test_markdown_shows_a_users_names_as_they_are():
    assert (
        document.markdown_escaped("a|b <c> _d_ *e* my_file_2.step Mass [kg]")
        == r"a\|b \<c> \_d\_ \*e\* my_file_2.step Mass \[kg\]"
    )
    assert "\n### clumod-1\n" in f"\n{reference.markdown_render(table())}"


def test_csv_has_one_line_for_each_stated_value():
    lines = list(csv.DictReader(io.StringIO(reference.render([table(), table("clumod-4")]))))
    assert len(lines) == (10 + 7 + 7) * 2
    assert {line["unit"] for line in lines} == {"kg", "mm", "kg m^2"}
    theta_yy = next(x for x in lines if (x["article"], x["column"], x["quantity"]) == ("clumod-1", "identified", "moi_yy"))
    assert (theta_yy["value"], theta_yy["reference"], theta_yy["within"]) == ("6.93", "6", "no")
    assert theta_yy["deviation_percent"].startswith("15.5")


def test_latex_is_balanced_and_holds_only_what_every_engine_reads():
    document = reference.latex_document([reference.latex_render(table()), reference.latex_render(table("clumod-4"))])
    for name in ("document", "table", "tabular", "itemize"):
        assert document.count(rf"\begin{{{name}}}") == document.count(rf"\end{{{name}}}") > 0
    assert document.isascii()
    assert document.count("{") == document.count("}")
    assert not re.search(r"(?<!\\)%", document), "a bare per cent sign comments the rest of its line out"
    for form, body in re.findall(r"\\begin\{tabular\}\{(\S+)\}\n(.*?)\\end\{tabular\}", document, re.DOTALL):
        widths = [line.count("&") + line.count("multicolumn{2}") for line in body.splitlines() if line.endswith(r"\\")]
        assert set(widths) == {len(form.replace("@{}", "")) - 1}


def test_latex_parts_a_figure_at_its_decimal_point_so_that_points_stand_below_each_other():
    page = reference.latex_render(table())
    assert r"CoG z [mm] & 270 & .600 & 270 & .60 & 283 & .61 $\pm$ 2.00 \\" in page
    assert r"CoG y [mm] & 0 & .00 mm & 0 & .0 & $-$5 & .45 mm & $-$2 & .7 & identified outside" in page


@pytest.mark.parametrize(
    ("plain", "spelled"),
    [
        ("5 % & {a}_b ± #$", r"5 \% \& \{a\}\_b $\pm$ \#\$"),
        ("Θxx [kg m²]", r"$\Theta_{xx}$ [kg m$^2$]"),
        ("-5.45, ->999, 4.1e-06, 2026-11-21", r"$-$5.45, $-$$>$999, 4.1e-06, 2026-11-21"),
        ("fork-and-frame <1|2>", "fork-and-frame $<$1$|$2$>$"),
        ("Träger ≤ 3 kg, Öse Č, 梁", r"Träger $\le$ 3 kg, Öse C, U+6881"),
    ],
)
def test_latex_spells_out_what_it_would_read_or_set_otherwise(plain, spelled):
    assert reference.escaped(plain) == spelled


def test_json_keeps_the_contract_and_says_null_for_what_nobody_states():
    value = json.loads(json.dumps(to_json(table()), allow_nan=False))
    assert set(value) >= {"routes", "published", "measured", "agree"}
    assert value["measured"] is None
    assert value["published"]["mass_kg"] == 32.95
    assert value["published"]["cog_mm"] == [0.0, 0.0, 270.6]
    assert value["published"]["moi_cog_kgm2"] == [6.42, 6.0, 0.77]
    assert value["published"]["poi_cog_kgm2"] == [None] * 3
    assert value["routes"]["occ"]["about"] == "cog"
    assert len(value["verdict"]) == len(QUANTITIES)


@pytest.mark.parametrize(("number", "article"), [(1, "clumod-4"), (2, "clumod-1")])
def test_the_page_shows_the_table_that_the_data_gives(root, number, article):
    page = (root / "docs" / "reference-tables.md").read_text(encoding="utf-8")
    shown = re.search(rf"<!-- table {number} -->\n(.*?)<!-- end -->", page, re.DOTALL)
    said = published.published(article)
    given = ReferenceTable(article=article, columns=said.statements, footnotes=said.footnotes)
    assert shown.group(1).strip() == reference.markdown_render(given).strip()


def test_a_cell_of_several_lines_takes_the_width_of_its_longest_and_each_line_ends_where_its_column_does():
    """The list of effects was cut to "act..." and split in two, since such a cell counted as one long line."""
    grid = document.Grid(header=("id", "from to"), lines=(("a", "0 to 1"), ("b", "1 to 100 kg\n1 to 10 Hz\n0 to 1"), ("c", "0")))
    assert len(document.parts(grid, 20)) == 1
    ends = {len(line) for line in document.page("", (grid,), width=40).splitlines() if line.strip() and "─" not in line}
    assert len(ends) == 1
