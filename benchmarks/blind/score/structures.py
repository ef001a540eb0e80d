"""The score of random structures: the bars of issue 21, and one row a kind of structure and a kind of effect."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from benchmarks.blind.names import Json
from benchmarks.blind.score.outcome import NOTHING, UNKNOWN, Outcome, outcome
from benchmarks.blind.score.rates import Rate, rate
from benchmarks.blind.score.rows import LEFT_OUT, NULL, PAIR, SINGLE, Row
from benchmarks.blind.structures.drawing import OF_SENSORS
from validation.effects.effect import position

NEAR = 0.5
"""[distance of sensors] within which a place that is found counts as the one that is meant: sensors see no finer."""

CLASS = 3
"""[count] of a class in which what is named may stand."""


@dataclass(frozen=True, kw_only=True)
class StructureOutcome:
    """One case.

    Attributes
    ----------
    of : as any outcome; a place, by coordinates or a sensor's, that is near enough bears the name of the one that was planted
    shape : kind of structure
    test : kind of test
    away : distance from the planted place without a name to the one that was found, over that of sensors; None without one
    """

    of: Outcome
    shape: str
    test: str = ""
    away: float | None = None

    @property
    def right(self) -> bool:
        """Whether what is planted is named first, or stands in a class of at most `CLASS`."""
        return self.of.first or (self.of.inside and len(self.of.alike) <= CLASS)

    @property
    def wrong(self) -> bool:
        """Whether something else is named and nothing of what is planted is."""
        named = {*self.of.claimed, *self.of.alike}
        return bool(self.of.claimed) and not named & set(self.of.planted)


def structure_outcome(truth: Json, answer: Json) -> StructureOutcome:
    """What `answer` is worth."""
    spacing, aways = float(truth["spacing"] or 1.0), []
    renamed: dict[str, str] = {}
    for one in truth["planted"]:
        family, *targets = one["id"].split(":")
        true = position(targets[0]) if targets else None
        said = [each["id"] for key in ("accepted", "ranking") for each in answer.get(key) or ()]
        for id in dict.fromkeys((*said, *(answer.get("equivalence_class") or ()))):
            other, *at = id.split(":")
            place = (position(at[0]) or truth.get("places", {}).get(at[0])) if at else None
            if true is None or place is None or (other, at[1:]) != (family, targets[1:]):
                continue
            away = float(np.linalg.norm(np.array(place) - np.array(true))) / spacing
            if id in {each["id"] for each in answer.get("accepted") or ()}:
                aways.append(away)
            if away <= NEAR and one["id"] not in renamed.values():
                renamed[id] = one["id"]
    found = outcome(truth, _renamed(answer, renamed))
    return StructureOutcome(of=found, shape=truth["shape"], test=truth.get("test", ""), away=min(aways, default=None))


def _renamed(answer: Json, names: Mapping[str, str]) -> Json:
    def one(cause: Json) -> Json:
        return {**cause, "id": names.get(cause["id"], cause["id"])}

    lists: Json = {
        key: [one(each) for each in answer.get(key) or ()] for key in ("accepted", "ranking", "detectable") if key in answer
    }
    alike = [names.get(id, id) for id in answer.get("equivalence_class") or ()]
    return {**answer, **lists, "equivalence_class": alike}


def rows(found: Sequence[StructureOutcome]) -> list[Row]:
    """The table of bars."""
    nulls, every, pairs, unknown = ([one for one in found if one.of.kind == kind] for kind in (NULL, SINGLE, PAIR, LEFT_OUT))
    sensors = [one for one in every if set(one.of.families) <= set(OF_SENSORS)]
    singles = [one for one in every if one not in sensors]
    sizes = [each for one in every for each in one.of.sizes]
    aways = [one.away for one in singles if one.away is not None]
    error = median(each.error for each in sizes) if sizes else None
    distance = median(aways) if aways else None
    covered = rate(each.inside for each in sizes)
    return [
        _share("of a structure: first, or in the class of at most 3", (one.right for one in singles), "at least 90 %", 0.9),
        _share("single faults: named wrongly", (one.wrong for one in every), "at most 2 %", -0.02),
        Row(
            what="place found without a name: distance over that of sensors, median",
            figure="none yet" if distance is None else f"{distance:.2f} of {len(aways)}",
            bar="at most 0.3",
            met=None if distance is None else distance <= 0.3,
        ),
        _share("nulls: something is named", (one.of.verdict != NOTHING for one in nulls), "at most 1 %", -0.01),
        Row(
            what="size: median error",
            figure="none yet" if error is None else f"{100 * error:.1f} %",
            bar="at most 5 %",
            met=None if error is None else error <= 0.05,
        ),
        Row(
            what="size: 90 % interval holds",
            figure=str(covered),
            bar="85 to 95 %",
            met=None if not covered.count else 0.85 <= covered.share <= 0.95,
        ),
        _share("pairs: both", (one.of.every for one in pairs), "at least 80 %", 0.8),
        _share("left out of the catalogue: unknown", (one.of.verdict == UNKNOWN for one in unknown), "at least 90 %", 0.9),
        _share("of an accelerometer: first", (one.of.first for one in sensors), "at least 90 %", 0.9),
        _share("refused or broken", (not one.of.answered for one in found), "none", -0.0),
    ]


def _share(what: str, hits: Iterable[bool], bar: str, least: float) -> Row:
    """A row of a share; a negative `least` is the most that it may be."""
    of = rate(hits)
    met = None if not of.count else of.share >= least if least > 0 else of.share <= -least
    return Row(what=what, figure=str(of), bar=bar, met=met)


def by_group(found: Sequence[StructureOutcome]) -> list[tuple[str, Rate, Rate]]:
    """By kind of structure, of test and by family of a single fault: how many were right, and wrong."""
    singles = [one for one in found if one.of.kind == SINGLE]
    groups: dict[str, list[StructureOutcome]] = {}
    for one in singles:
        sizes = [f"{one.of.multiple:g} times its limit"] * len(one.of.families)
        for name in filter(None, (one.shape, one.test, *one.of.families, *sizes)):
            groups.setdefault(name, []).append(one)
    return [(name, rate(one.right for one in some), rate(one.wrong for one in some)) for name, some in sorted(groups.items())]
