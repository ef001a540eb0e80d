"""`Outcome`: what one answer is worth, held against the truth of its case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from benchmarks.blind.names import Json
from validation.effects.catalogue import FAMILIES

NOTHING, MISSING, AMBIGUOUS, SEVERAL, UNKNOWN, MISTAKE = "nothing", "missing", "ambiguous", "several", "unknown", "mistake"
"""Verdicts of the contract that an answer may have here."""

NAMING = (MISSING, AMBIGUOUS, SEVERAL, MISTAKE)
"""Verdicts that name an effect."""

NO_VERDICT = ""

SWAP = "channel-swap"

TIED = 1.0
"""[nats] of which nobody would make a difference between explanations; 5 make a class."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One size: found over true less 1, and whether the 90 % interval holds the truth."""

    error: float
    inside: bool


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """One case.

    Attributes
    ----------
    name, kind, null : of the case
    planted : ids that are missing in truth
    multiple, told : least of all that is planted, see `benchmarks.blind.drawing.case.Planted`; 0 for what has no size
    sized : whether what is planted has a size that grows
    verdict : of the diagnosis; `NO_VERDICT` where there is none
    refused : whether the diagnosis refused, and `broken` whether it broke down
    claimed : ids that it says are missing, in its order
    alike : the class of ids that it cannot tell apart, the claims where it states none
    tied : ids that rank within `TIED` of the first
    size : the first of an effect that was planted alone, from where there is no effect; 0 for what has none
    detectable : size from which these data would name an effect, as the diagnosis says, by id
    sizes : of the claims that are true
    misfit : chi² per degree of freedom without any effect
    held_out : [%] plain error on what was held out, with what was accepted; None where there is none
    seconds, reading : of the diagnosis, and of reading and processing the data
    """

    name: str
    kind: str
    null: str
    planted: tuple[str, ...]
    multiple: float
    told: float
    sized: bool
    verdict: str
    refused: bool
    broken: bool
    claimed: tuple[str, ...]
    alike: tuple[str, ...]
    tied: tuple[str, ...]
    size: float
    detectable: Mapping[str, float]
    sizes: tuple[Measured, ...]
    misfit: float
    held_out: float | None
    seconds: float
    reading: float

    @property
    def first(self) -> bool:
        """Whether what is claimed first is one of those planted."""
        return bool(self.claimed) and self.claimed[0] in self.planted

    @property
    def inside(self) -> bool:
        """Whether all that is planted is in the class or claimed."""
        return bool(self.planted) and set(self.planted) <= {*self.alike, *self.claimed}

    @property
    def every(self) -> bool:
        """Whether all that is planted is claimed."""
        return bool(self.planted) and set(self.planted) <= set(self.claimed)

    @property
    def extra(self) -> bool:
        """Whether more is claimed than was planted."""
        return len(self.claimed) > len(self.planted)

    @property
    def stray(self) -> bool:
        """Whether a claim is none of what was planted, and stands in no class that holds some of it."""
        near = set(self.alike) if set(self.alike) & set(self.planted) else set()
        return bool({*self.claimed} - {*self.planted} - near)

    @property
    def answered(self) -> bool:
        """Whether there is a verdict: the diagnosis neither refused nor broke down."""
        return not (self.refused or self.broken)

    @property
    def families(self) -> tuple[str, ...]:
        """Of what is planted."""
        return tuple(one.partition(":")[0] for one in self.planted)


def outcome(truth: Json, answer: Json) -> Outcome:
    """What `answer` is worth."""
    verdict = str(answer.get("verdict", NO_VERDICT))
    claims = _claims(verdict, answer)
    planted = {canonical(one["id"]): one for one in truth["planted"]}
    sized = all(one["multiple"] > 0 for one in truth["planted"])
    seconds = answer.get("seconds", {})
    return Outcome(
        name=truth["name"],
        kind=truth["kind"],
        null=truth["null"],
        planted=tuple(planted),
        multiple=min((one["multiple"] for one in truth["planted"]), default=0.0),
        told=min((one["told"] for one in truth["planted"]), default=0.0),
        sized=bool(planted) and sized,
        verdict=verdict,
        refused="refused" in answer,
        broken="broken" in answer,
        claimed=tuple(claims),
        alike=tuple(map(canonical, answer.get("equivalence_class", ()))) or tuple(claims)[:1],
        tied=_tied(answer.get("ranking", ())),
        size=_size(truth["planted"]),
        detectable={one["id"]: one["size"] for one in answer.get("detectable", ())},
        sizes=tuple(one for id, claim in claims.items() if id in planted for one in _measured(planted[id]["sizes"], claim)),
        misfit=float(answer.get("before", {}).get("fitted", {}).get("chi2_per_dof", float("nan"))),
        held_out=answer.get("errors", {}).get("heldout_after_percent"),
        seconds=float(seconds.get("diagnosis", float("nan"))),
        reading=float(seconds.get("reading", float("nan"))),
    )


def canonical(id: str) -> str:
    """`id` with the two channels of a swap in one order: crossing them is the same either way."""
    family, *targets = id.split(":")
    return ":".join((family, *sorted(targets))) if family == SWAP else id


def _claims(verdict: str, answer: Json) -> dict[str, Json]:
    """What is said to be missing, by id: what was accepted, else, where the verdict names something, the first of its class."""
    accepted = {canonical(one["id"]): one for one in answer.get("accepted", ())}
    if accepted or verdict not in NAMING:
        return accepted
    first = [*answer.get("equivalence_class", ()), *(one["id"] for one in answer.get("ranking", ()))][:1]
    return {canonical(id): {"id": id, "values": []} for id in first}


def _tied(ranking: Sequence[Json]) -> tuple[str, ...]:
    known = [one for one in ranking if one["evidence_nats"] is not None]
    return tuple(canonical(one["id"]) for one in known if one["evidence_nats"] >= known[0]["evidence_nats"] - TIED)


def _size(planted: Sequence[Json]) -> float:
    if len(planted) != 1 or not planted[0]["sizes"]:
        return 0.0
    family, _, _ = planted[0]["id"].partition(":")
    key, value = next(iter(planted[0]["sizes"].items()))
    known = FAMILIES[family].sizes if family in FAMILIES else ()
    none = next((size.null for size in known if size.key == key), 0.0)
    return abs(float(value) - none)


def _measured(true: Mapping[str, float], claim: Json) -> Iterator[Measured]:
    for size in claim["values"]:
        value, (low, high) = true.get(size["key"]), size["interval90"]
        if value and low < high:  # what was not fitted has no interval, and what is zero no relative error
            yield Measured(error=abs(size["value"] / value - 1), inside=low <= value <= high)
