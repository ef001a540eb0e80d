"""Whatever comes from a file is text on the page, and a number of a table keeps all its digits."""

from hypothesis import given
from hypothesis import strategies as st

from validation.report.document import NOTHING, Column, Grid, Number, Safe, Table, joined, number, table, tag, toleranced, worded


@given(st.text())
def test_a_text_makes_no_element_and_with_back_quotes_none_but_code(text):
    made = str(tag("p", text, title=text)).removeprefix("<p ").removesuffix("</p>")
    assert "<" not in made
    assert made.count('"') == 2
    made = str(worded(text)).replace("<code>", "").replace("</code>", "")
    assert "<" not in made


def test_what_is_safe_stays_and_a_number_keeps_its_digits_and_shows_those_that_mean_something():
    assert joined("a < b", tag("b", "c")) == "a &lt; b<b>c</b>"
    assert tag("input", class_="wide", hidden=True, data_value=None) == '<input class="wide" hidden>'
    assert isinstance(joined("a"), Safe)
    assert toleranced(12.087654321, 0.0123) == Number(value=12.087654321, text="12.088")
    assert number(-0.5, "+.2f") == Number(value=-0.5, text="−0.50")
    assert number(None) == number(float("nan")) == number(float("inf")) == NOTHING


def test_a_table_has_one_number_a_cell_its_unit_in_the_head_and_a_button_and_a_grid_becomes_one():
    made = table("Masses", [Column(head="what", words=True), Column(head="mass", unit="kg")], [["a <b>", number(1 / 3)]])
    assert f'data-value="{1 / 3!r}"' in made
    assert '<span class="unit"> [kg]</span>' in made
    assert "a &lt;b&gt;" in made
    assert '<button type="button" class="copy"' in made
    assert table("Nothing", [Column(head="what")], []) == ""
    assert Column("mass", unit="kg").short == "mass [kg]"  # on a terminal, too
    rows = [("a", None, ""), ("b", None, "")]
    columns = [Column("x", lambda row: row[0], words=True), *(Column("y", lambda row, k=k: row[k], words=k == 2) for k in (1, 2))]
    assert str(Table(columns=columns, rows=rows).html()).count("scope=") == 3  # a column in which nothing stands is left out
    part = '<span class="kept">joint-compliance:</span><wbr><span class="kept">foot@floor-1</span>'
    assert part.replace("foot@", 'foot@</span><wbr><span class="kept">') in table(
        "Ids", [Column("x")], [["joint-compliance:foot@floor-1"]]
    )
    assert "<strong>structure</strong>" in Grid(header=("", "from"), lines=(("structure", ""), ("  mass", "1 g"))).html()
    digests = [["file", tag("code", 64 * "0")]] * 9
    assert 'class="table whole"' in table("Inputs", [Column("x", words=True)] * 2, digests)
    assert 'class="table whole"' not in table("Words", [Column("x", words=True)] * 2, [["word", 400 * "a"]] * 3)
    made = Grid(header=("", "how"), lines=(("1", "  use `massline check`"),), words=True, caption="Words").html()
    assert "use <code>massline check</code>" in made


def test_a_column_in_which_nothing_stands_is_on_no_terminal_and_no_page():
    columns = [Column(head, lambda row, k=k: row[k]) for k, head in enumerate(("mode", "frequency", "coherence"))]
    rows = [("first", 2.0, None), ("second", None, None)]
    assert Table(columns=columns, rows=rows).grid().header == ("mode", "frequency")
    assert "coherence" not in Table(columns=columns, rows=rows).html()
    assert Table(columns=columns, rows=[*rows, ("third", 3.0, 0.9)]).grid().header == ("mode", "frequency", "coherence")
