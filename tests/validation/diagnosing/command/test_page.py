"""What an engineer reads: the page of every verdict, line by line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from validation.diagnose import diagnosis
from validation.diagnose.diagnosis import VERDICTS, Diagnosis
from validation.report import diagnose

PAGES = Path(__file__).parent / "pages"
WIDTH = 110

Made = Callable[[str], Diagnosis]


def printed(found: Diagnosis, width: int = WIDTH) -> str:
    return replace(diagnose.document(found), title=diagnose.title("model.toml", ("cuboid", "clumod-1"))).text(width)


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_page_of_every_verdict_is_as_it_was_looked_at(verdict: str, made: Made) -> None:
    assert printed(made(verdict)) == (PAGES / f"{verdict}.txt").read_text(encoding="utf-8")


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_verdict_is_the_first_sentence_below_the_title(verdict: str, made: Made) -> None:
    lines = printed(made(verdict)).splitlines()
    sentence = diagnosis.headline(made(verdict))
    assert lines[3].split() == sentence.split()[: len(lines[3].split())]
    assert sentence.split()[0].strip(":").isupper()


@pytest.mark.parametrize("verdict", VERDICTS)
def test_no_line_is_longer_than_the_terminal(verdict: str, made: Made) -> None:
    assert max(map(len, printed(made(verdict)).splitlines())) <= WIDTH


def test_a_text_that_repeats_the_sentence_is_not_said_twice(made: Made) -> None:
    found = made("missing")
    once = replace(found, text=diagnosis.headline(found))
    assert diagnose.document(once).opening == (diagnosis.headline(found),)


def test_what_was_accepted_before_a_class_of_several_is_named_as_certain(made: Made) -> None:
    found = replace(made("several"), verdict="ambiguous", equivalence_class=("point-mass:mast-top", "rigid-inertia:m"))
    said = diagnosis.headline(found)
    assert said.startswith("MISSING IS force-gain:fmd-z2, +7.93 % (+7.69 to +8.17), and then one of these")
    assert said.endswith("point-mass:mast-top or rigid-inertia:m.")


def test_what_is_missing_beside_a_mistake_is_told_apart(made: Made) -> None:
    found = made("mistake")
    said = diagnosis.headline(replace(found, accepted=(*found.accepted, *made("missing").accepted)))
    assert said == (
        "A MISTAKE in the data: polarity:fmd-z2: a channel is inverted; and missing beside it: "
        "force-gain:fmd-z2, +7.93 % (+7.69 to +8.17)."
    )


def test_a_name_that_was_nearly_found_is_said_where_nothing_is_missing(made: Made) -> None:
    assert "The closest is point-mass:mast-top, +198.0 g" in " ".join(printed(made("nothing")).split())
    far = replace(made("nothing"), ranking=tuple(replace(one, evidence=1.0) for one in made("nothing").ranking))
    assert "The closest" not in printed(far)


def test_sentences_name_a_few_and_count_the_rest() -> None:
    assert diagnosis.listed(["a"]) == "a"
    assert diagnosis.listed(["a", "b"], "or") == "a or b"
    assert diagnosis.listed(list("abcdef")) == "a, b, c, d and 2 more"
    assert diagnosis.listed([]) == ""
