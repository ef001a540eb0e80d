"""`massline league`: real tests that others made, each diagnosed from its study file, in one table: expected, said, and left."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from geometry import toml_file
from geometry.errors import BadInput, CheckFailed
from validation.classical import files, pendulum
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import NOTHING, UNKNOWN, Answer, Diagnosis, headline
from validation.diagnose.pendulum import only_classical
from validation.model import model_file
from validation.output import json_text, stages
from validation.report import document as doc
from validation.study import Study

FILE = "league.toml"
KEYS = ("name", "folder", "study", "data", "hold_out", "expected", "tuned_on")
FIRST = 3
"""Names of the ranking that JSON has of a set, accepted or not."""

REFUSED = "refused"
"""Verdict on a set of which no diagnosis came."""


@dataclass(frozen=True, kw_only=True)
class RealSet:
    """One real set.

    Attributes
    ----------
    name : of the set, and of its folder among the data where no other is named
    folder : among the data
    study : its model file; or pendulum periods, which are reduced and held against the published results that are its data
    data : campaigns and tests beside those that the study names, or weights and periods alone
    hold_out : see `validation.study.Options`
    expected : what a good answer is, and whose word that is
    tuned_on : whether anything of the program was chosen by looking at it
    """

    name: str
    folder: str = ""
    study: Path
    data: tuple[Path, ...] = ()
    hold_out: tuple[str, ...] = ()
    expected: str
    tuned_on: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """What was said of a set.

    Attributes
    ----------
    entry : the set
    verdict : of the diagnosis, or `REFUSED`
    said : in a sentence
    found : the diagnosis; None where it refused, or nothing was diagnosed
    before, after : [%] plain errors of a diagnosis; of results that were reduced the largest deviation from what is published
    """

    entry: RealSet
    verdict: str
    said: str
    found: Answer | None = None
    before: float | None = None
    after: float | None = None

    @property
    def as_json(self) -> Mapping[str, Any]:
        """As `massline league --json` has it."""
        of = self.found
        return {
            "expected": self.entry.expected,
            "verdict": self.verdict,
            "said": self.said,
            "accepted": [] if of is None else [one.id for one in of.accepted],
            "class": [] if of is None else list(of.equivalence_class),
            "left": None if of is None else of.left,
            "first": [] if of is None else [one.id for one in of.ranking[:FIRST]],
            "error_before_percent": self.before,
            "error_after_percent": self.after,
            "tuned_on": self.entry.tuned_on,
        }


def real_sets(folder: Path, data: Path) -> tuple[RealSet, ...]:
    """The sets that ``league.toml`` in `folder` names, whose data lie in `data`.

    Raises
    ------
    BadInput : no such file, an unknown or missing key.
    """
    source = folder / FILE
    table = toml_file.read(source, remedy="Name the folder of study files with --studies")
    toml_file.require_format(table, str(source))
    toml_file.require_known(table, ("format", "set"), source=str(source))
    found = []
    for k, one in enumerate(table.get("set", []), start=1):
        where = f"set[{k}]"
        toml_file.require_known(one, KEYS, source=str(source), where=where)
        toml_file.require_present(one, ("name", "study", "expected", "tuned_on"), source=str(source), where=where)
        paths = tuple(folder / name if (folder / name).is_file() else data / name for name in one.get("data", ()))
        found.append(
            RealSet(
                name=one["name"],
                folder=one.get("folder", one["name"]),
                study=folder / one["study"],
                data=paths,
                hold_out=tuple(one.get("hold_out", ())),
                expected=one["expected"],
                tuned_on=bool(one["tuned_on"]),
            )
        )
    return tuple(found)


def result(entry: RealSet, *, quiet: bool = False) -> Result:
    """What a diagnosis says of one set."""
    try:
        with stages(entry.name, quiet=quiet) as told:
            if _is_measurement(entry.study):
                return _reduced(entry)
            if entry.data and all(map(_is_measurement, entry.data)):
                alone = only_classical(model_file.read(entry.study), [str(path) for path in entry.data])
                said = alone.text.partition(" Chi² ")[0]
                return Result(entry=entry, verdict=alone.verdict, said=said, found=alone)
            study = Study.open(entry.study, entry.data, hold_out=entry.hold_out, progress=told)
            found: Diagnosis = diagnosed(study, progress=told)
    except (BadInput, CheckFailed) as error:
        return Result(entry=entry, verdict=REFUSED, said=str(error))
    before, after = float(found.before.plain.percent), float(found.after.plain.percent)
    return Result(entry=entry, verdict=found.verdict, said=headline(found), found=found, before=before, after=after)


def _is_measurement(path: Path) -> bool:
    """Whether a file holds weights, periods, or what somebody made of them."""
    return path.suffix == ".toml" and toml_file.read(path).get("kind") in files.KINDS


def _reduced(entry: RealSet) -> Result:
    """What comes out of pendulum periods beside what their authors published of them."""
    ours = pendulum.reduce(files.read(str(entry.study), ("pendulum",))).results
    theirs = {
        key: value for path in entry.data for key, value in files.reduce(files.read(str(path), ("results",))).results.items()
    }
    off = {key: ours[key].nominal_value - value.nominal_value for key, value in theirs.items()}
    share = {key: 100 * abs(one / theirs[key].nominal_value) for key, one in off.items()}
    worst = max(share, key=lambda key: share[key])
    far = [key for key, one in off.items() if abs(one) > theirs[key].std_dev]
    said = (
        f"{', '.join(share)} as published: {worst} is {share[worst]:.2g} % off, "
        + ("beyond" if far else "within")
        + " its tolerance"
    )
    return Result(entry=entry, verdict=UNKNOWN if far else NOTHING, said=said, after=share[worst])


@dataclass(frozen=True, eq=False, kw_only=True)
class League:
    """The results of all sets, and the names of those whose data are not here."""

    results: tuple[Result, ...]
    absent: tuple[str, ...] = ()

    def document(self) -> doc.Document:
        """The table."""
        return doc.Document(title="Real tests that others made", blocks=(self._table(),), notes=tuple(self._notes()))

    def _table(self) -> doc.Table:
        return doc.Table(
            caption="What was expected, what was said, and the plain error before and after",
            rows=self.results,
            columns=(
                doc.Column("set", lambda one: one.entry.name, words=True),
                doc.Column("before", lambda one: one.before, ".3g", unit="%"),
                doc.Column("after", lambda one: one.after, ".3g", unit="%"),
                doc.Column("tuned on", lambda one: "yes" if one.entry.tuned_on else "no"),
                doc.Column("expected, and said", lambda one: f"{one.entry.expected}. Said: {one.said}", words=True),
            ),
        )

    def _notes(self) -> Iterator[str]:
        if self.absent:
            yield f"Not here: {', '.join(self.absent)}. Name the folder of the data with --data or MASSLINE_DATA."


def answer(folder: Path, data: Path, names: tuple[str, ...], *, as_json: bool) -> None:
    """Diagnose the sets called `names`, all where none is, and print the table, or JSON.

    Raises
    ------
    BadInput : see `real_sets`; a name that no set has; none of the data are there.
    """
    every = real_sets(folder, data)
    if unknown := set(names) - {one.name for one in every}:
        known = ", ".join(one.name for one in every)
        problem = f"no set is called {', '.join(sorted(unknown))}"
        raise BadInput(source="NAME", problem=problem, remedy=f"There are {known}")
    chosen = [one for one in every if not names or one.name in names]
    here = [one for one in chosen if (data / one.folder).is_dir()]
    if not here:
        problem = f"it holds none of {', '.join(one.name for one in chosen)}"
        raise BadInput(source=str(data), field="--data", problem=problem, remedy="docs/league.md says where they come from")
    found = League(
        results=tuple(result(one, quiet=as_json) for one in here),
        absent=tuple(one.name for one in chosen if one not in here),
    )
    if as_json:
        click.echo(json_text({"sets": {one.entry.name: one.as_json for one in found.results}, "absent": list(found.absent)}))
    else:
        click.echo(found.document().text(), nl=False)
