"""`Case`: what happens in one sealed series, and `Planted`, one effect of it."""

from __future__ import annotations

from dataclasses import dataclass

NULL, SINGLE, PAIR, LEFT_OUT, FOREIGN = KINDS = ("nulls", "singles", "pairs", "left-out", "foreign")
"""Nothing is missing; one effect; two; one whose family the diagnosis does not have; physics that no family describes."""

CUBOID, BLADE, BLADES = "fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4"

SERIES = (CUBOID, BLADE)
WHOLE_SERIES = (CUBOID, BLADE, BLADES)


@dataclass(frozen=True, kw_only=True)
class Planted:
    """One effect.

    Attributes
    ----------
    text : ``ID=VALUE`` as in `massline simulate --effect`; of physics that no family describes its name and size
    multiple : size over the detection limit; 0 for what is there or not
    told : size over the limit below which what a laboratory admits hides it; 0 likewise
    """

    text: str
    multiple: float = 0.0
    told: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Case:
    """One series.

    Attributes
    ----------
    name : unique in its draw, such as "singles-012"
    kind : of `KINDS`
    laboratory : seed of everything that a virtual test draws
    articles : of the series
    planted : what is missing in the model
    leave_out : families that the diagnosis does without
    hold_out : sweeps that no fit sees, ``article/axis``
    null : name of the case of the same laboratory in which nothing is missing; itself for a null
    """

    name: str
    kind: str
    laboratory: int
    articles: tuple[str, ...] = SERIES
    planted: tuple[Planted, ...] = ()
    leave_out: tuple[str, ...] = ()
    hold_out: tuple[str, ...] = ()
    null: str = ""
