"""From the words of the command line to a `Setup`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.flexible_body.rope_pendulum import hung
from fem.flexible_body.rope_pendulum.suspension import lying
from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.article_reference import Asked, is_file, require_use
from validation.swing.setup import Setup, suspended

RADIUS, HEIGHT, LINKS = 0.3, 0.1, 8
"""Where nothing else is said: circle of three ropes [m], feet above the CoG [m], links of a rope that has mass."""

OPTIONS = {
    "radius": "length",
    "s1": "length",
    "s2": "length",
    "length": "length",
    "height": "length",
    "unequal": "length",
    "amplitude": "angle",
    "damping": "ratio",
    "rope_mass": "mass",
    "rope_stiffness": "force",
    "noise": "angle",
    "gravity": "acceleration",
    "step": "time",
}
"""Options that are quantities, and their dimension."""

OTHERS = ("ropes", "axis", "along", "off_centre", "links", "start", "cycles", "rate", "seed")
"""Options that are none."""

FIELDS = {"stiffness": "rope_stiffness", "extra": "unequal", "damping_ratio": "damping", "duration": "cycles"}
"""Fields of a suspension whose option is called otherwise."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Words:
    """The options of ``massline swing`` as they were typed; None where they were not."""

    texts: Mapping[str, str | None]
    ropes: int | None
    axis: str
    along: str | None
    off_centre: str | None
    links: int | None
    start: str
    cycles: float
    rate: float
    seed: int


def setup(article: str, words: Words, asked: Asked) -> Setup:
    """The pendulum test that `words` ask for.

    Raises
    ------
    BadInput : an option that cannot be used; it is named.
    """
    require_use([article], asked)
    value = {name: _quantity(text, name) for name, text in words.texts.items() if text is not None}
    radii = _radii(words, value)
    off_centre = _pair(words.off_centre)
    height = value.get("height", HEIGHT)
    rope_mass = value.get("rope_mass", 0.0)
    fields: dict[str, Any] = {
        "length": value["length"],
        "amplitude": value["amplitude"],
        "damping_ratio": value.get("damping", 0.0),
        "rope_mass": rope_mass,
        "links": words.links if words.links is not None else (LINKS if rope_mass else 1),
        "stiffness": value.get("rope_stiffness"),
        "start": words.start,
        "extra": value.get("unequal", 0.0) * np.eye(3)[0, : 2 if len(radii) == 2 else 3],
    }
    try:
        suspension = suspended(radii, height, off_centre, **fields)
        body = hung(inertia_of(article, asked), words.axis, words.along)
    except BadInput as error:
        raise as_option(error) from None
    more = {name: value[name] for name in ("gravity", "noise", "step") if name in value}
    return Setup(
        article=article,
        axis=words.axis,
        along=words.along or lying(words.axis),
        inertia=body,
        radii=radii,
        height=height,
        off_centre=off_centre,
        suspension=suspension,
        cycles=words.cycles,
        rate=words.rate,
        seed=words.seed,
        **more,
    )


def inertia_of(article: str, asked: Asked) -> Inertia:
    """Inertia of a built-in article or of a user's file.

    Raises
    ------
    BadInput : no such article, or a file of which no body can be made.
    """
    from geometry import multibody, user_article
    from geometry.articles import built_in, changes_of

    if not is_file(article):
        return multibody.inertia(built_in(article, changes_of(article, asked.changes)))
    loaded = user_article.load(article, unit=asked.unit, material=asked.material, chord=asked.chord)
    return next(iter(user_article.inertias(loaded).values()))


def as_option(error: BadInput) -> BadInput:
    """`error` about a field of the pendulum, said of the option that it came from; others pass unchanged."""
    name = FIELDS.get(error.field, error.field)
    if name not in (*OPTIONS, *OTHERS):
        return error
    return BadInput(source=f"--{name.replace('_', '-')}", problem=error.problem, remedy=error.remedy)


def _quantity(text: str, name: str) -> float:
    from geometry.quantities import quantity

    option = f"--{name.replace('_', '-')}"
    try:
        return float(quantity(text, OPTIONS[name], source=option, field="").nominal_value)
    except BadInput as error:
        raise BadInput(source=option, problem=error.problem, remedy=error.remedy) from None


def _radii(words: Words, value: Mapping[str, float]) -> tuple[float, ...]:
    """s1 and s2 [m] for two ropes, the one radius for three."""
    sides = [name for name in ("s1", "s2") if name in value]
    ropes = words.ropes or (2 if sides else 3)
    if ropes == 3 and not sides:
        return (value.get("radius", RADIUS),)
    if ropes == 2 and len(sides) == 2 and "radius" not in value:
        return value["s1"], value["s2"]
    if ropes == 2 and not sides and "radius" in value:
        return value["radius"], value["radius"]
    given = " and ".join(f"--{name}" for name in (*sides, "radius") if name in value) or "no sizes"
    remedy = "Give --s1 and --s2 (or --radius) for two ropes, --radius for three"
    raise BadInput(source="--ropes", problem=f"{ropes} ropes do not go with {given}", remedy=remedy)


def _pair(text: str | None) -> tuple[float, float]:
    """One length along the ropes' x, or two with a comma, the second across."""
    if text is None:
        return 0.0, 0.0
    parts = [_length(part) for part in text.split(",")]
    if len(parts) > 2:
        problem = f"one length or two are expected, found {text!r}"
        raise BadInput(source="--off-centre", problem=problem, remedy='Write "10 mm" or "10 mm, 5 mm"')
    return parts[0], parts[1] if len(parts) == 2 else 0.0


def _length(text: str) -> float:
    from geometry.quantities import quantity

    try:
        return float(quantity(text.strip(), "length", source="--off-centre", field="").nominal_value)
    except BadInput as error:
        raise BadInput(source="--off-centre", problem=error.problem, remedy=error.remedy) from None
