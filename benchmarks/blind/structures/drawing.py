"""`draw`: a seed becomes structures, laboratories and faults; each structure serves once with nothing missing, as a null.

What a fault's limit is, is said by the diagnosis' own screening of the null (`limits_of`): a draw makes it before it plants.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from benchmarks.blind.drawing.case import LEFT_OUT, NULL, PAIR, SINGLE
from benchmarks.blind.structures import shapes
from geometry.frames import Array
from validation.effects.effect import at_position
from validation.virtual_test.layout import stream

STRUCTURES = 38
"""[count] of a draw: 38 nulls, 114 single faults of the structure and 38 of a sensor, 19 pairs and 19 that have no name."""

STRUCK = 30
"""[count] of the first of them: those behind stand on a base that moves."""

MULTIPLES = (5.0, 15.0, 2.0)
"""Sizes over the detection limit, in the order in which they are drawn."""

ATTACHED = ("point-mass", "cable", "absorber", "slosh", "rigid-inertia")
"""Families that a diagnosis does without of what is attached somewhere and has no name then."""

BASE, BASE_FORCES = ON_BASE = ("base-motion", "base-motion-and-forces")
"""Accelerations of a base and on the structure, and the forces below it, too: in turn of frames, trusses, boxes and barrels."""

FUNCTIONS, TABLE = TESTS = ("response-functions", "modal-table")
"""In turn."""

OF_SENSORS = ("accelerometer-gain", "accelerometer-misalignment", "accelerometer-position", "accelerometer-delay")
"""Families of what one accelerometer may read wrongly; late it is in functions alone."""

LARGEST: Mapping[str, float] = MappingProxyType(
    {
        "modulus": 0.6,
        "mass": 1.0,
        "thickness": 0.4,
        "support-stiffness": 20.0,
        "connection-compliance": 1e-4,
        "structural-damping": 0.5,
        "point-mass": 1e3,
        "cable": 1e8,
        "accelerometer-gain": 0.6,
        "accelerometer-misalignment": 0.5,
        "accelerometer-position": 0.05,
        "accelerometer-delay": 1e-3,
    }
)
"""By family, beyond which a fault is none of a laboratory: nobody overlooks it."""


Wanted = tuple[str, int, int, float]
"""A family, which of its faults, a sign, and the size over the limit."""


@dataclass(frozen=True, kw_only=True)
class StructureCase:
    """One sealed test; its first fields are those of `benchmarks.blind.drawing.case.Case`.

    Attributes
    ----------
    name, kind, laboratory, leave_out, null : as there
    shape : of `benchmarks.blind.structures.shapes.KINDS`
    structure : seed of it and of its sensors
    test : of `TESTS` or `ON_BASE`
    wanted : its faults
    before : those of the single faults of the structure before this one, none of which it may have again
    """

    name: str
    kind: str
    laboratory: int
    shape: str
    structure: int
    test: str
    wanted: tuple[Wanted, ...] = ()
    before: tuple[Wanted, ...] = ()
    leave_out: tuple[str, ...] = ()
    null: str = ""


def draw(seed: int, kinds: Sequence[str], structures: int) -> tuple[StructureCase, ...]:
    """The cases of `seed` on so many structures, the kinds of structures in turn."""
    found: list[StructureCase] = []
    for number in range(structures):
        generator = stream(seed, "structure", f"{number}")
        name, shape = f"structure-{number:03d}", shapes.KINDS[number % len(shapes.KINDS)]
        test = TESTS[(number // len(shapes.KINDS)) % 2]
        if number >= STRUCK:
            held = [one for one in shapes.KINDS if one != shapes.PLATE]
            shape, test = held[(number - STRUCK) % len(held)], ON_BASE[((number - STRUCK) // len(held)) % 2]
        of = StructureCase(
            name=f"{name}-null",
            kind=NULL,
            laboratory=int(generator.integers(1, 2**31)),
            shape=shape,
            structure=int(generator.integers(1, 2**31)),
            test=test,
            null=f"{name}-null",
        )
        found += [one for one in _of(of, name, number, generator) if one.kind in kinds]
    return tuple(found)


def _of(null: StructureCase, name: str, number: int, generator: np.random.Generator) -> Iterator[StructureCase]:
    yield null
    named = ["modulus", "mass", *(["thickness"] if null.shape in (shapes.PLATE, shapes.BARREL) else [])]
    named += ["support-stiffness"] if null.shape in (shapes.FRAME, shapes.TRUSS) and null.test in TESTS else []
    named += 2 * ["connection-compliance"] if null.shape == shapes.BOXES else []
    named += ["structural-damping"] if null.test != TABLE else []
    everywhere = ("point-mass", "cable")

    def one(family: str, multiple: float) -> Wanted:
        return family, int(generator.integers(1 << 30)), int(generator.choice([-1, 1])), multiple

    def made(what: str, kind: str, *wanted: Wanted, leave_out: tuple[str, ...] = ()) -> StructureCase:
        return replace(null, name=f"{name}-{what}", kind=kind, wanted=wanted, leave_out=leave_out)

    first, second = (str(each) for each in generator.choice(named, 2))
    order = [MULTIPLES[(number + k) % 3] for k in range(3)]
    singles = one(first, order[0]), one(second, order[1]), one(everywhere[number % 2], order[2])
    for k, wanted in enumerate(singles):
        yield replace(made(f"single-{k + 1}", SINGLE, wanted), before=singles[:k])
    if number % 2:
        yield made("pair", PAIR, one(first, 15.0), one(everywhere[(number // 2) % 2], 15.0))
    else:
        family = everywhere[(number // 2) % 2]
        yield made("left-out", LEFT_OUT, one(family, 15.0), leave_out=ATTACHED)
    misread = [family for family in OF_SENSORS if null.test == FUNCTIONS or family != "accelerometer-delay"]
    yield made("sensor", SINGLE, one(str(generator.choice(misread)), order[0]))


@dataclass(frozen=True, eq=False, kw_only=True)
class Fault:
    """One fault at its size.

    Attributes
    ----------
    id : as the catalogue has it; of a place without a name by its coordinates
    size : SI
    multiple : size over the limit
    """

    id: str
    size: float
    multiple: float


def planted(case: StructureCase, limits: Mapping[str, float]) -> tuple[Fault, ...]:
    """The faults of `case` at their sizes. For what the data would not tell below what is plausible stands a modulus, and where
    they tell none of that, whatever they tell; of a sensor what they tell of sensors."""
    found: list[Fault | None] = []
    for family, which, sign, multiple in (*case.before, *case.wanted):
        taken = {one.id for one in found if one is not None}
        alike = [one for one in LARGEST if (one in OF_SENSORS) == (family in OF_SENSORS)]
        each = (fault((one, which, sign, multiple), limits, taken) for one in dict.fromkeys((family, *alike)))
        found.append(next((one for one in each if one is not None), None))
    return tuple(one for one in found[len(case.before) :] if one is not None)


def fault(wanted: Wanted, limits: Mapping[str, float], taken: Container[str] = ()) -> Fault | None:
    """What is `wanted` at its size and not `taken`; None where the data would not tell it below what is plausible."""
    family, which, sign, multiple = wanted
    ids = sorted(id for id in limits if id.partition(":")[0] == family and id not in taken)
    for k in range(len(ids)):
        id = ids[(which + k) % len(ids)]
        for times in dict.fromkeys((multiple, *(each for each in (5.0, 2.0) if each < multiple))):
            size = times * limits[id]
            if size > LARGEST[family]:
                continue
            if family == "support-stiffness":
                return Fault(id=id, size=1 + size if sign > 0 else 1 / (1 + size), multiple=times)
            both = family in ("modulus", "thickness", *OF_SENSORS) or (family == "mass" and size < 0.6)
            negative = sign < 0 and both
            return Fault(id=id, size=-size if negative else size, multiple=times)
    return None


def at_node(family: str, node: Array, axis: str) -> str:
    """The id of a fault at a node."""
    place = at_position(node.tolist())
    return f"{family}:{place}:{axis}" if family == "cable" else f"{family}:{place}"
