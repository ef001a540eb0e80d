"""Table 2 as an inverse problem: its derivatives, its evidence, its information, and the page that tells it."""

import importlib
import json
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.testing import assert_allclose

from tools.pages import said_about

Names = dict[str, Any]
MODULES = ("candidates", "exact", "forward", "inference", "menu", "pictures", "published", "reading", "story", "tables", "ways")

NAMES = ("mass %", "CoG x mm", "CoG y mm", "CoG z mm", "Θxx %", "Θyy %", "Θzz %")
IDENTIFIED = (33.92, 0.39, -5.45, 283.61, 6.56, 6.93, 0.75)
REFERENCE = (32.95, 0.0, 0.0, 270.60, 6.42, 6.00, 0.77)
"""Table 2 as printed."""


@pytest.fixture(scope="module")
def program(root: Path) -> Iterator[Names]:
    """The modules of the example, found as a script finds them."""
    with pytest.MonkeyPatch.context() as patched:
        patched.syspath_prepend(str(root / "examples"))
        yield {one: importlib.import_module(f"table_2_parts.{one}") for one in MODULES} | {
            "main": importlib.import_module("table_2")
        }
    for name in [name for name in sys.modules if name.startswith("table_2")]:
        del sys.modules[name]


@pytest.fixture(scope="module", params=[pytest.param("whole", marks=pytest.mark.proof)])
def story(program: Names) -> Any:
    """All ways, faults and pairs of them: the tests below that ask for none of it show each step on one way."""
    return program["story"].told()


@pytest.fixture(scope="module")
def page(root: Path) -> str:
    return (root / "docs" / "table-2.md").read_text(encoding="utf-8")


def test_the_deviations_are_those_of_the_printed_columns(program: Names) -> None:
    identified, reference = np.array(IDENTIFIED), np.array(REFERENCE)
    share = np.array([True, False, False, False, True, True, True])
    off = np.where(share, 100 * (identified / np.where(share, reference, 1.0) - 1), identified - reference)
    assert_allclose(off, program["published"].DEVIATIONS, atol=0.0051)  # half of the last printed digit


def test_a_rigid_laboratory_without_faults_is_read_exactly(program: Names) -> None:
    way = program["ways"].Way(stop=0.0)
    assert_allclose(program["ways"].exact(way), 0.0, atol=1e-6)  # rounding of a difference of two set-ups


def test_a_quarter_turn_exchanges_the_moments_of_a_rigid_clumod(program: Names) -> None:
    of = program["published"].clumod().moments_cog
    expected = np.array([0, 0, 0, 0, 100 * (of[1] / of[0] - 1), 100 * (of[0] / of[1] - 1), 0])
    assert_allclose(program["ways"].exact(program["ways"].Way(stop=0.0, turned=True)), expected, atol=1e-6)


@pytest.mark.parametrize(
    "name",
    ["force-gain:fmd-z2", "accelerometer-misalignment:cover-z3:x", "modulus:mast", "point-mass:mast-top", "mounting-offset:x"],
)
def test_derivatives_are_those_of_the_reading_itself(program: Names, name: str) -> None:
    ways = program["ways"]
    way = ways.Way(stop=5.0, turned=True, rows="turning")
    known = ways.answer(way)
    k = [one.name for one in known.candidates].index(name)
    one, size = known.candidates[k], 1e-3 * known.candidates[k].plausible
    above, below = (ways.exact(way, [one.sized(side * size)]) for side in (1, -1))
    slope = (above - below) / (2 * size)
    assert_allclose(
        known.effects[:, k], slope, rtol=0.02, atol=0.02 * np.abs(slope).max()
    )  # weights follow H, the derivative's do not


def _tried(program: Names, **changes: Any) -> tuple[Any, Any]:
    """What is made of one candidate with these changes, and the answer it is one of."""
    known = program["ways"].answer(program["ways"].Way(stop=5.0))
    k = [one.name for one in known.candidates].index("load-path-shunt:z")
    one = replace(known.candidates[k], **changes)
    of = replace(known, candidates=(one,), effects=known.effects[:, [k]])
    return of, next(tried for tried in program["inference"]._of_way(of, 1.0, 1.0, 1) if tried.chosen.shape[1])


@pytest.mark.parametrize("one_sided", [False, True])
def test_evidence_is_the_integral_over_the_size(program: Names, one_sided: bool) -> None:
    of, tried = _tried(program, one_sided=one_sided)
    V = program["inference"].covariance(of)
    (one,), s = of.candidates, of.candidates[0].plausible
    x = np.linspace(0.0 if one_sided else -8 * s, 8 * s, 20001)
    off = program["published"].DEVIATIONS - of.nominal - np.outer(x, of.effects[:, 0])
    prior = (2.0 if one_sided else 1.0) * np.exp(-0.5 * (x / s) ** 2) / (s * np.sqrt(2 * np.pi))
    log_density = -0.5 * np.einsum("ni,ij,nj->n", off, np.linalg.inv(V), off)
    log_density -= 0.5 * np.linalg.slogdet(2 * np.pi * V)[1]
    top = log_density.max()
    expected = top + np.log(np.trapezoid(prior * np.exp(log_density - top), x))
    assert one.one_sided is one_sided
    assert_allclose(tried.log_evidence[0], expected, rtol=1e-6)  # of the quadrature


def test_information_is_all_the_doubt_where_predictions_lie_apart_and_none_where_they_agree(program: Names, story: Any) -> None:
    menu = program["menu"]
    best = story.pairs[0].of
    pair, even = [best, story.unturned[0].of], np.array([0.5, 0.5])
    assert_allclose(menu.information([best, best], even, menu.fmd_alone), 0.0, atol=1e-12)
    assert_allclose(menu.information(pair, even, menu.clumod_turned), np.log(2), rtol=0.01)
    assert all(0 <= value <= story.doubt for value in story.menu.values())


def test_posteriors_sum_up_to_one(story: Any) -> None:
    for shares in (story.found.of_counts(), story.found.of_ways(lambda way: way.stop), story.found.of_ways(lambda way: way.rows)):
        assert_allclose(sum(shares.values()), 1.0, rtol=1e-9)


def test_records_of_clumod_are_read_as_their_prediction_is(program: Names, story: Any) -> None:
    best, exact = story.pairs[0], program["exact"]
    test, effects = best.of.way.tests[1], exact.sized(best.of.faults, best.sizes)
    predicted = program["forward"].ten(test, effects)
    allowed = 1e-4 * program["menu"].scale(
        program["menu"].Inertia(parameters=predicted)
    )  # filters, cross motion, a sampled sweep
    assert np.all(np.abs(exact.of_records(test, effects) - predicted) < allowed)


def numbers(text: str) -> list[float]:
    """All figures of a cell, those of ids and units left aside."""
    return [float(one) for one in re.findall(r"(?<![\w:^-])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w^])", text)]


def rows(page: str, header: tuple[str, ...]) -> list[list[str]]:
    """The lines of the page's table with this header."""
    after = page.split("| " + " | ".join(header) + " |\n", 1)[1].splitlines()[1:]
    end = next(k for k, line in enumerate(after) if not line.startswith("|"))
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in after[:end]]


@pytest.mark.parametrize("table", ["elastic", "alone", "numbers", "singles", "leading", "families", "settings", "menu"])
def test_the_tables_of_the_page_are_those_of_this_run(program: Names, story: Any, page: str, table: str) -> None:
    tables = program["tables"]
    made = {
        "numbers": lambda: tables.numbers(story.leading),
        "singles": lambda: tables.effects(story, story.singles),
        "leading": lambda: tables.effects(story, story.leading),
    }
    grid = made[table]() if table in made else getattr(tables, table)(story)
    start = page.index("## Two and three") if table == "leading" else 0
    for printed, now in zip(rows(page[start:], grid.header), grid.lines, strict=True):
        for cell, text in zip(printed, now, strict=True):
            assert re.sub(r"[-+]?\d[\d.e+-]*", "#", cell) == re.sub(r"[-+]?\d[\d.e+-]*", "#", text.strip()), printed
            assert numbers(cell) == pytest.approx(numbers(text), rel=0.03, abs=0.02), printed


def said(page: str, words: str) -> list[float]:
    """The numbers that stand where `words`, broken anywhere, have a #."""
    pattern = r"\s+".join(re.escape(word).replace(r"\#", r"([-+]?\d[\d.]*(?:e-\d+)?)") for word in words.split())
    found = re.search(pattern, re.sub(r"\[([^]]+)\]\([^)]+\)", r"\1", page))  # words, wherever they lead
    assert found is not None, words
    return [float(figure.rstrip(".")) for figure in found.groups()]


def test_the_sentences_of_the_page_say_what_is_found_now(story: Any, page: str) -> None:
    right, turned = story.elastic[4.5]
    families, counts = story.found.of_families(), story.found.of_counts()
    bands = story.found.of_ways(lambda way: way.stop)
    best, triple, unturned = story.pairs[0], story.triples[0], story.unturned[0]
    offset = next(one for one in story.pairs if one.of.faults[0].named.family == "mounting-offset")
    share = 100 * np.exp(best.of.log_posterior - story.found.total)
    pairs: dict[str, list[float]] = {
        "makes # mm of CoG z and # % and # % of Θxx and Θyy": [right[3], right[4], right[5]],
        "Exchange x and y and it is # % and # %": [turned[4], turned[5]],
        "Posterior #, and": [families["x and y exchanged"]],
        "is the best guess (# and #)": [families["accelerometer-gain"], families["force-gain"]],
        "Two faults leave chi² #, three": [best.chi2],
        "within # sd, chi² #.": [np.abs(triple.left).max(), triple.chi2],
        "the best has # %": [share],
        "do not do it**: chi² # of seven numbers, chance #;": [story.alone[1.0, False].chi2, story.alone[1.0, False].probability],
        "three times as wide still # with the axes right, and # only if": [
            story.alone[3.0, False].probability,
            story.alone[3.0, True].probability,
        ],
        "with nothing on it, # of # nats": [story.menu["FMD alone"], story.doubt],
        "has nearly as much, #.": [story.menu["same records: redundant channels"]],
        "by 90° has nothing, #.": [story.menu["Cuboid turned by 90° on the FMD"]],
        "all tolerances is # % of mass, # mm of CoG y, # mm of CoG z and # % of Θyy": list(
            story.alone[1.0, False].scatter[[0, 2, 3, 5]]
        ),
        "the nearest is `channel-swap:fmd-x12:fmd-y23` with chi² #.": [story.mistake[1]],
        "A gain # % wrong is # times": [100 * best.sizes[0], best.sizes[0] / 0.003],
        "`mounting-offset:x`, # mm along": [-1e3 * offset.sizes[0]],
        "Θzz and Θxx stay # and # sd away": [-offset.left[6], offset.left[4]],
        "has to be wrong by # kg m², # % of Θyy, and Θzz stays # sd": [
            unturned.sizes[0],
            unturned.sizes[0] / 0.06,
            -unturned.left[6],
        ],
        "4-5 Hz has #, 4-4.5 Hz #, 4-6 Hz #, elasticity taken off #.": [bands[5.0], bands[4.5], bands[6.0], bands[0.0]],
        "No fault has #, one #, two #, three #:": [counts[0], counts[1], counts[2], counts[3]],
        "(# of the posterior, doubt # nats)": [story.share, story.doubt],
        "hold # nats in two": [story.menu["same records: redundant channels"]],
    }
    assert story.mistake[0] == "channel-swap:fmd-x12:fmd-y23"
    for words, found in pairs.items():
        assert said(page, words) == pytest.approx(found, rel=0.05, abs=0.006 if min(np.abs(found)) > 1e-3 else 0), words


def test_the_page_prints_of_the_records_what_their_prediction_is(story: Any, page: str) -> None:
    printed = rows(page, ("explanation", "path", *NAMES))
    for one, predicted, recorded in zip((story.pairs[0], story.unturned[0]), printed[::2], printed[1::2], strict=True):
        assert predicted[0] == " + ".join(one.of.names)
        for line in (predicted, recorded):
            assert [float(cell) for cell in line[2:]] == pytest.approx(one.alone, abs=0.02)


@pytest.mark.parametrize("name", ["table-2.png", "table-2-decide.png"])
def test_the_pictures_of_the_page_show_what_is_found_now(program: Names, story: Any, root: Path, name: str) -> None:
    then = json.loads(said_about(root / "docs" / "pictures" / name))
    now = json.loads(json.dumps(program["pictures"].figures(story)))
    again = "draw it again: python examples/table_2.py --out docs/pictures"
    assert then.keys() == now.keys(), again
    for kind in now:
        assert list(then[kind]) == list(now[kind]), again
        for key, value in now[kind].items():
            assert then[kind][key] == pytest.approx(value, rel=0.03, abs=0.02), again


def test_the_command_tells_all_and_draws(program: Names, story: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    main = program["main"]
    monkeypatch.setattr(main, "told", lambda records: story)
    answered = CliRunner().invoke(main.main, ["--out", str(tmp_path)])
    assert answered.exit_code == 0, answered.output
    assert "6  What would have decided" in answered.output
    for name in ("table-2.png", "table-2-decide.png"):
        assert (tmp_path / name).stat().st_size > 30_000
