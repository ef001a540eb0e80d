"""A family in words: its identifier, its sizes with their limits, its tolerance, and what is plausible of it."""

from collections.abc import Mapping, Sequence
from math import exp
from types import MappingProxyType
from typing import Any

from geometry.errors import BadInput
from geometry.toml_file import nearest
from validation.effects import effect
from validation.effects.catalogue import FAMILIES, SOURCES, parse
from validation.output import NONE, to_json, with_unit
from validation.report.document import Grid, page

DOES: Mapping[str, str] = MappingProxyType(
    {
        effect.STRUCTURE_STAGE: "changes masses, springs and losses of the structure",
        effect.BODY_STAGE: "changes the dynamic mass of the article on its place",
        effect.CHANNEL_STAGE: "changes what channels read",
        effect.NOISE_STAGE: "changes how much noise is expected",
        effect.PERIOD_STAGE: "changes the period of a pendulum",
        effect.OPENED: "opens the tolerance of its name as wide as a fault may be",
    }
)
"""By stage, what an effect does to a prediction."""


SHORT = MappingProxyType(
    {
        "force channel": "channel",
        "accelerometer": "channel",
        "lateral axis": "axis",
        "turning axis": "axis",
        "cell and axis": "cell",
        "pair of axes": "axes",
        "part with a layer": "part",
        "joint between parts": "joint",
        "direction at a joint": "axis",
        "direction of the joint": "direction",
        "direction of the FMD": "direction",
        "direction of a cable": "direction",
    }
)
"""Kinds of targets in one word."""

PREFIXED = MappingProxyType({"s": (1e-6, "µs"), "m": (1e-3, "mm"), "rad": (1e-3, "mrad")})
"""By unit of a size, the one in which its tolerance reads best, and its factor."""


def examples(family: effect.Family) -> tuple[str, ...]:
    """What can be typed."""
    return tuple(family.example.split(", or "))


def identifier(family: effect.Family) -> str:
    """``accelerometer-position:CHANNEL:AXIS``"""
    words = [SHORT.get(one, one).upper() for one in family.targets]
    last = f"[:{words.pop()}]" if family.optional else ""
    return ":".join((family.name, *words)) + last


def targets(family: effect.Family) -> str:
    """What it acts on, in words."""
    words = [*family.targets]
    if family.optional:
        words[-1] = f"[{words[-1]}]"
    return ", ".join(words) or NONE


def sizes(family: effect.Family) -> tuple[effect.SizeSpec, ...]:
    """All sizes that its value may hold, whatever the target, each once."""
    return tuple(dict.fromkeys((*family.sizes, *(one for varying in family.varying.values() for one in varying))))


def limits(size: effect.SizeSpec) -> str:
    """``m: 1e-06 to 100 kg``"""
    said = f"{size.low:g} or {size.high:g}" if size.whole else with_unit(f"{size.low:.3g} to {size.high:.3g}", size.unit)
    return _of(size, said)


def unit(family: effect.Family) -> str:
    """Of every size."""
    return ", ".join(dict.fromkeys(_of(size, size.unit) for size in sizes(family))) or NONE


def plausible(family: effect.Family) -> str:
    """Standard deviation of a fault, of every size that is fitted; × 7.4 is a factor either way."""
    said: dict[str, None] = {}
    for one in sizes(family):
        spread = f"× {_plain(exp(one.plausible))}" if one.logarithmic else _measured(one.plausible, one.unit)
        if one.plausible > 0:
            said["on or off" if one.whole else f"{one.key} {spread}".strip()] = None
    return ", ".join(said) or NONE


def tolerance(family: effect.Family) -> str:
    """Standard deviation of what a careful laboratory admits."""
    first = next(iter(sizes(family)), None)
    return _measured(family.tolerance, first.unit) if family.tolerance and first else NONE


def sentence(family: effect.Family, named: str = "") -> str:
    """What it means at the targets of `named`, ``one:two``, or at those of its example."""
    there = named or examples(family)[0].partition("=")[0].removeprefix(family.name).lstrip(":")
    words = there.split(":")
    return family.sentence.replace("{targets}", " and ".join(words)).replace("{target}", words[0])


def as_json(family: effect.Family) -> dict[str, Any]:
    """One entry of ``massline effects --json``."""
    return {
        "id": family.name,
        "side": family.side,
        "what": family.what,
        "sentence": sentence(family),
        "targets": list(family.targets),
        "last_target_optional": family.optional,
        "sizes": to_json(family.sizes),
        "sizes_by_target": to_json(family.varying),
        "tolerance": family.tolerance or None,
        "changes": family.stage,
        "equation": family.equation,
        "mistaken_for": list(family.mistaken_for),
        "confirmed_by": family.confirmed_by,
        "reference": family.reference,
        "examples": list(examples(family)),
        "from": SOURCES.get(family.name, "massline"),
    }


def _of(size: effect.SizeSpec, said: str) -> str:
    return f"{size.key}: {said}" if size.key else said


def _measured(value: float, unit: str) -> str:
    """``0.3 %``, ``20 µs``, ``0.5 mm``: as people write it."""
    if unit == "1":
        return f"{_plain(100 * value)} %"
    scale, prefixed = PREFIXED.get(unit, (1.0, unit))
    return f"{_plain(value / scale)} {prefixed}"


def _plain(value: float) -> str:
    """Two digits, without an exponent from a thousandth to a million."""
    return f"{float(f'{value:.2g}'):g}".replace("e-0", "e-")


# `massline effects`: the catalogue as a table, or one family on a page of its own.


NOTE = "`massline effects ID` says more about one: what it means, its equation, what it is mistaken for, what would confirm it."


def chosen(names: Sequence[str]) -> tuple[tuple[effect.Family, str], ...]:
    """The families that ``family`` or ``family:target`` name, each with its target; all of them where none is named.

    Raises
    ------
    BadInput : no such family, with the nearest; a target that it does not have.
    """
    if not names:
        return tuple((family, "") for family in FAMILIES.values())
    found = []
    for name in names:
        family, _, target = name.partition("=")[0].partition(":")
        if family not in FAMILIES:
            remedy = f"{nearest(family, FAMILIES)}`massline effects` lists all of them"
            raise BadInput("massline effects", name, f"no effect is called {family!r}", remedy)
        known = FAMILIES[family]
        if target:
            value = examples(known)[0].partition("=")[2]
            parse(f"{family}:{target}={value}" if value else f"{family}:{target}", source="massline effects")
        found.append((known, target))
    return tuple(found)


def table() -> str:
    """All families as text, side by side of the laboratory."""
    pages = []
    for side in effect.SIDES:
        families = [family for family in FAMILIES.values() if family.side == side]
        lines = tuple((identifier(family), tolerance(family), plausible(family), family.what) for family in families)
        if lines:
            pages.append((side, Grid(header=("effect", "tolerance", "plausible", "what"), lines=lines, words=True)))
    last = len(pages) - 1
    return "\n".join(page(side.capitalize(), (grid,), (NOTE,) if k == last else ()) for k, (side, grid) in enumerate(pages))


def whole(family: effect.Family, target: str = "") -> str:
    """One family as text, at `target` where one is named."""
    lines = (
        ("means", sentence(family, target)),
        ("acts on", targets(family)),
        ("unit", unit(family)),
        ("size", "\n".join(map(limits, sizes(family))) or "there or not"),
        ("tolerance", tolerance(family)),
        ("plausible", plausible(family)),
        ("does", DOES[family.stage]),
        ("equation", family.equation),
        ("mistaken for", ", ".join(family.mistaken_for)),
        ("confirmed by", family.confirmed_by),
        ("reference", family.reference),
        ("written", "\n".join(examples(family))),
        ("from", SOURCES.get(family.name, "massline")),
    )
    grid = Grid(header=("", family.what), lines=lines, words=True)
    return page(identifier(family), (grid,))


# `massline simulate --list-effects`: what can be planted, with targets, units and limits.


NOTES = (
    "Write --effect ID=VALUE as in the first column, in SI. It may be repeated, with other targets as well.",
    "`massline effects ID` says more about one.",
)


def page_of_effects() -> str:
    """All of it as text, one line a family."""
    lines = tuple(
        (examples(family)[0], targets(family), "\n".join(map(limits, sizes(family))) or NONE, family.what)
        for family in FAMILIES.values()
        if family.plant is not None
    )
    grid = Grid(header=("for example", "acts on", "from to", "what"), lines=lines, words=True)
    return page("Effects that a virtual test can plant", (grid,), NOTES)
