"""What is between table and article and what is attached to it, as typed: preloads, joint compliance, cables, dampers, friction.

Keys, units and signs are those of the catalogue of effects: stiffness [N/m], damping [N s/m], compliance [m/N] and [rad/(N m)],
slip force [N].
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from fem.base_excitation.rig import LATERAL, Flange, Friction, Strut
from geometry import keys
from geometry.arrays import Array
from geometry.errors import BadInput

CELLS = ("1", "2", "3", "4")

COMPLIANT = {"lateral": (0, 1), "vertical": (2,), "rotation": (3, 4), "torsion": (5,)}
"""Which of x, y, z, alpha, beta, gamma a key of ``--flange`` means."""

ALONG = {"": (0, 1, 2), "lateral": (0, 1), "vertical": (2,)}
"""Which of x, y, z a strut acts along: all, or those after the colon."""

EXAMPLES = {
    "--preload": '--preload "2 kN", or for one cell --preload "3=500 N"',
    "--flange": "--flange rotation=1e-6",
    "--friction": "--friction x=3, or x=3,mass:2",
    "--cable": "--cable mast-top=1000, or mast-top:lateral=1000",
    "--damper": "--damper mast-top=20, or mast-top:vertical=20",
}


@dataclass(frozen=True, kw_only=True)
class Sane:
    """What a size may be: beyond it stiffnesses of one rig lie so far apart that rounding decides, or a unit was mistaken."""

    low: float
    high: float
    unit: str


SHIFTING, TURNING = Sane(low=1e-13, high=1e-3, unit="m/N"), Sane(low=1e-12, high=1e-2, unit="rad/(N m)")
SIZES = {"--cable": Sane(low=1e-3, high=1e9, unit="N/m"), "--damper": Sane(low=1e-3, high=1e7, unit="N s/m")}
SLIP_FORCE, LOOSE_MASS = Sane(low=1e-3, high=1e6, unit="N"), Sane(low=1e-3, high=1e3, unit="kg")


@dataclass(frozen=True, kw_only=True)
class Attached:
    """What the rig has beside the article.

    Attributes
    ----------
    cells : whether the FMD's load cells are springs
    preload : [N] by the number of a cell; empty for cells that never lift off
    flange : None for a rigid joint
    struts : cables to the ground, dampers to the table
    frictions : loose parts on the flange
    """

    cells: bool = False
    preload: Mapping[str, float] = field(default_factory=dict)
    flange: Flange | None = None
    struts: tuple[Strut, ...] = ()
    frictions: tuple[Friction, ...] = ()

    @property
    def options(self) -> tuple[str, ...]:
        """The options by which it was asked for."""
        to = {"ground": "--cable", "table": "--damper"}
        given = {"--cells": self.cells, "--preload": self.preload, "--flange": self.flange, "--friction": self.frictions}
        return (*(option for option, value in given.items() if value), *dict.fromkeys(to[strut.to] for strut in self.struts))


def attached(
    *,
    cells: bool,
    preload: Sequence[str],
    flange: Sequence[str],
    friction: Sequence[str],
    cable: Sequence[str],
    damper: Sequence[str],
) -> Attached:
    """What the options say; whether the article has such places is asked by `require_places`.

    Raises
    ------
    BadInput : a text that cannot be read, a value that is not positive or out of all proportion (`Sane`), something said twice, a
        preload without cells.
    """
    loads = _preloads(preload)
    if loads and not cells:
        problem = "only cells that are springs can lift off, and they are rigid here"
        raise BadInput(source="--preload", problem=problem, remedy="Add --cells, or leave the preload out")
    return Attached(
        cells=cells,
        preload=loads,
        flange=_flange(flange),
        struts=(
            *(Strut(place=place, to="ground", stiffness=size) for place, size in _struts("--cable", cable).items()),
            *(Strut(place=place, to="table", damping=size) for place, size in _struts("--damper", damper).items()),
        ),
        frictions=_frictions(friction),
    )


def require_places(struts: Sequence[Strut], places: Collection[str], article: str, why_none: str) -> None:
    """Refuse a strut that is fastened to a place that the article has not.

    Raises
    ------
    BadInput : such a strut, with the nearest place; `why_none` where there is none at all.
    """
    for strut in struts:
        if strut.place in places:
            continue
        option = "--cable" if strut.to == "ground" else "--damper"
        remedy = f"{keys.nearest(strut.place, places)}Its places are {', '.join(places)}" if places else why_none
        raise BadInput(source=option, problem=f"{article} has no place {strut.place!r}", remedy=remedy)


def _preloads(texts: Sequence[str]) -> dict[str, float]:
    loads: dict[str, float] = {}
    for text in texts:
        cell, equals, value = text.partition("=")
        numbers = (_known(cell.strip(), CELLS, "--preload", "cell"),) if equals else CELLS
        force = _force(value if equals else text)
        for number in numbers:
            _once(number in loads, "--preload", f"cell {number}")
            loads[number] = force
    return loads


def _force(text: str) -> float:
    from geometry.quantities import quantity

    try:
        force = float(quantity(text, "force", source="--preload", field="").nominal_value)
    except BadInput as error:
        raise _refused("--preload", error.problem) from None
    if force <= 0:
        raise _refused("--preload", f"a preload presses a cell together and must be positive, found {text.strip()}")
    return force


def _flange(texts: Sequence[str]) -> Flange | None:
    compliance = np.zeros(6)
    for text in texts:
        key, value = _pair("--flange", text)
        motions = list(COMPLIANT[_known(key, COMPLIANT, "--flange", "direction")])
        _once(bool(compliance[motions].any()), "--flange", key)
        compliance[motions] = _sane("--flange", key, value, SHIFTING if motions[0] < 3 else TURNING)
    return Flange(compliance=compliance) if texts else None


def _frictions(texts: Sequence[str]) -> tuple[Friction, ...]:
    found: dict[str, Friction] = {}
    for text in texts:
        axis, value = _pair("--friction", text)
        _known(axis, LATERAL, "--friction", "axis")
        _once(axis in found, "--friction", axis)
        force, *more = (part.strip() for part in value.split(","))
        given = {"axis": axis, "slip_force": _sane("--friction", axis, force, SLIP_FORCE), **_masses(more)}
        found[axis] = Friction(**given)  # type: ignore[arg-type]  # the axis was compared with those that are known
    return tuple(found.values())


def _masses(more: Sequence[str]) -> dict[str, float]:
    masses: dict[str, float] = {}
    for text in more:
        key, _, value = (part.strip() for part in text.partition(":"))
        _known(key, ("mass",), "--friction", "property")
        _once(bool(masses), "--friction", key)
        masses[key] = _sane("--friction", key, value, LOOSE_MASS)
    return masses


def _struts(option: str, texts: Sequence[str]) -> dict[str, Array]:
    """What acts at every place along x, y, z (3,)."""
    struts: dict[str, Array] = {}
    for text in texts:
        key, value = _pair(option, text)
        place, _, along = key.partition(":")
        if along:
            _known(along, [name for name in ALONG if name], option, "direction")
        axes, size = list(ALONG[along]), struts.setdefault(place, np.zeros(3))
        _once(bool(size[axes].any()), option, key)
        size[axes] = _sane(option, key, value, SIZES[option])
    return struts


def _pair(option: str, text: str) -> tuple[str, str]:
    key, equals, value = (part.strip() for part in text.partition("="))
    if not (key and equals and value):
        raise _refused(option, f"KEY=VALUE is expected, found {text!r}")
    return key, value


def _sane(option: str, key: str, text: str, sane: Sane) -> float:
    try:
        value = float(text)
    except ValueError:
        raise _refused(option, f"{key} must be a number in SI units, found {text!r}") from None
    if not 0 < value < np.inf:
        raise _refused(option, f"{key} must be positive and finite, found {text}")
    if not sane.low <= value <= sane.high:
        problem = f"{key} must lie between {sane.low:g} and {sane.high:g} {sane.unit}, found {text}"
        raise BadInput(source=option, problem=problem, remedy=f"Check its unit, or leave it out; for example {EXAMPLES[option]}")
    return value


def _known(word: str, known: Collection[str], option: str, what: str) -> str:
    if word in known:
        return word
    near = keys.nearest(word, known)
    raise BadInput(
        source=option, problem=f"no {what} is called {word!r}", remedy=f"{near}Known are {', '.join(known)}: {EXAMPLES[option]}"
    )


def _once(already: bool, option: str, what: str) -> None:
    if already:
        raise BadInput(source=option, problem=f"{what} is given twice", remedy="Keep one of them")


def _refused(option: str, problem: str) -> BadInput:
    return BadInput(source=option, problem=problem, remedy=f"Write for example {EXAMPLES[option]}")
