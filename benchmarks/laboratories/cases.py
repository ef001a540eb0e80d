"""Cases: a seed becomes benches, laboratories, articles, and what is planted there in units of what a null would have named."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.laboratories.shaking import Bench, Faults
from validation.effects.catalogue import FAMILIES

ARTICLES = (
    ("fmd+disc+cuboid", "fmd+clumod-1"),
    ("fmd+clumod-1",),
    ("fmd+disc+cuboid", "fmd+clumod-4"),
    ("fmd+disc+cuboid",),
    ("fmd+disc+cuboid", "fmd+clumod-1"),
    ("fmd+clumod-4",),
)
"""Of a series, in turn."""

CUBOID, BLADES = ("disc", "top"), ("hub-2", "mast-top", "lower-1+", "flange")
"""Places."""

CHANNEL = ("fmd-x12", "fmd-y23", "fmd-z2", "fmd-z4", "cover-x1", "cover-y2", "cover-z1", "cover-z3")

FAULTS: Mapping[str, tuple[str, ...]] = {
    **{f"{one}": (*CUBOID, *BLADES) for one in ("point-mass", "absorber", "slosh")},
    "cable": tuple(f"{place}:{way}" for place in ("top", "mast-top", "hub-1") for way in ("lateral", "vertical")),
    "rigid-inertia": ("m", "mx", "mz", "Ixx", "Izz"),
    "modulus": ("mast", "lower-1", "upper-long"),
    "structural-damping": ("mast", "lower-1"),
    "layer-damping": ("upper-short",),
    "appendage": ("x", "y", "z"),
    "joint-compliance": ("rotation", "lateral"),
    "orientation": ("z",),
    "mounting-offset": ("x", "y"),
    "force-gain": CHANNEL[:4],
    "force-delay": CHANNEL[:4],
    "force-highpass": CHANNEL[:4],
    "force-crosstalk": ("xy", "xz", "zx"),
    "force-plane-offset": ("x", "y"),
    "load-path-shunt": ("x", "z"),
    "board-delay": ("force", "cover"),
    "cell-stiffness": ("1x", "2y", "3z"),
    "fmd-compliance": ("lateral",),
    "accelerometer-gain": CHANNEL[4:],
    "accelerometer-delay": CHANNEL[4:],
    "accelerometer-position": ("cover-x1:y", "cover-z1:x", "cover-z3:y"),
    "accelerometer-misalignment": ("cover-z3:x", "cover-y2:x", "cover-x1:z"),
    "cover-plate-flexibility": ("",),
}
"""Families that are planted, and where."""

FOREIGN: Mapping[str, tuple[str, tuple[float, float]]] = {
    "damper": ("mast-top:lateral", (10.0, 60.0)),
    "rotor": ("seat", (0.3, 3.0)),
    "slipping": ("seat", (5e-7, 5e-6)),
    "hanging": ("mast-top", (0.1, 0.6)),
    "creeping": ("mast", (0.02, 0.1)),
    "rising": ("fmd-z2", (0.03, 0.15)),
}
"""Physics of no family: where, and from what size to what."""

NEEDS = {"modulus": ARTICLES[0], "structural-damping": ARTICLES[0], "layer-damping": ARTICLES[2], "creeping": ARTICLES[0]}
"""Series of what acts on blades alone."""

MULTIPLES = (2.0, 5.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Case:
    """One laboratory, as a null and with what is planted there.

    Attributes
    ----------
    number : in its draw
    laboratory : seed of its hardware
    sheet : class that it is drawn from and that its analyst states
    articles : of its series
    bench : what it has
    kind : "null", "single", "pair" or "unknown"
    multiples : by id of what is planted, times the smallest size that its null would have named; of the unknown SI
    resonance : [Hz] and damping ratio of a resonator
    """

    number: int
    laboratory: int
    sheet: str
    articles: tuple[str, ...]
    bench: Bench
    kind: str
    multiples: Mapping[str, float]
    resonance: tuple[float, float]

    def faults(self, smallest: Mapping[str, float]) -> Faults | None:
        """What is planted, where the null would have named `smallest`; None where one of it could not be named at any size."""
        sizes: dict[str, tuple[float, ...]] = {}
        for id, times in self.multiples.items():
            family = FAMILIES.get(id.partition(":")[0])
            if family is None:
                sizes[id] = (times,)
                continue
            if id not in smallest:
                return None
            size = family.sizes_at(tuple(id.split(":")[1:]))[0]
            first = min(max((size.null or 0.0) + times * smallest[id], size.low), size.high)
            sizes[id] = (first, *self.resonance) if len(family.sizes) == 3 else (first,)
        return Faults(sizes=sizes)


KINDS = ("single", "single", "pair", "single", "single", "unknown", "single")
"""In turn; a null goes before each of them."""


def draw(seed: int) -> Iterator[Case]:
    """Cases without end."""
    families, number, singles = tuple(FAULTS), 0, 0
    while True:
        generator = np.random.default_rng([seed, number])
        kind, articles = KINDS[number % len(KINDS)], ARTICLES[number % len(ARTICLES)]
        if kind == "single":
            family = families[singles % len(families)]
            articles = NEEDS.get(family, articles)
            chosen, times = {_at(family, articles, generator)}, MULTIPLES[singles // len(families) % 2]
            singles += 1
        elif kind == "pair":
            one, two = generator.choice(len(families), 2, replace=False)
            chosen, times = {_at(families[k], articles, generator) for k in (one, two)}, MULTIPLES[-1]
        else:
            name = tuple(FOREIGN)[int(generator.integers(len(FOREIGN)))]
            at, (low, high) = FOREIGN[name]
            articles = NEEDS.get(name, articles)
            at = at if "clumod" in articles[-1] else at.replace("mast-top", "top")
            chosen, times = {f"{name}:{at}"}, float(low * (high / low) ** generator.random())
        yield Case(
            number=number,
            laboratory=int(generator.integers(1, 10**9)),
            sheet=("calibrated", "as-delivered")[number // 2 % 2],
            articles=articles,
            bench=Bench.drawn(generator) if number % 4 else Bench(),
            kind=kind,
            multiples=dict.fromkeys(sorted(chosen), times),
            resonance=(float(generator.uniform(5.5, 22.0)), float(generator.uniform(0.01, 0.05))),
        )
        number += 1


def _at(family: str, articles: tuple[str, ...], generator: np.random.Generator) -> str:
    """An id of `family` where the last of `articles` has such a place or part; the first there is where none is left."""
    blades = "clumod" in articles[-1]
    there = [one for one in FAULTS[family] if (one.partition(":")[0] not in (*CUBOID,) if blades else one not in BLADES)]
    target = str(generator.choice(there or list(FAULTS[family])))
    return f"{family}:{target}" if target else family
