"""Stages to try an equation on, and the sizes at which it must change nothing.

The stages are those of no test: small, of figures that were drawn once, with every name that the catalogue knows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from typing import Any

import numpy as np

from validation.effects.family import BODY_STAGE, CHANNEL_STAGE, NOISE_STAGE, PERIOD_STAGE, STRUCTURE_STAGE, Family
from validation.effects.stages import Floor, Matrices, Mounted, Reading, Swing
from validation.effects.targets import COVER, FMD, PARTS, TABLE, built_in_places

BASE, OWN, LINES = 6, 3, 5
ROUNDING = 1e-12
"""Relative, of the largest entry: what an equation may change by rounding alone."""


def null_values(family: Family, targets: tuple[str, ...], example: Mapping[str, float]) -> dict[str, float] | None:
    """The sizes of no effect: the first at its `null`, all others as in the `example`; None for one that has no size."""
    sizes = family.sizes_at(targets)
    return {**example, sizes[0].key: sizes[0].null} if sizes else None


def unchanged(before: Any, after: Any) -> bool:
    """Whether two stages are alike to rounding; coordinates that were added may stand there, if nothing drives them."""
    return all(_alike(getattr(before, one.name), getattr(after, one.name)) for one in fields(before))


def arrays(before: Any, after: Any) -> Iterator[tuple[str, Any, Any]]:
    """By name, every array of two stages of one kind, those in mappings one by one."""
    for one in fields(before):
        was, now = getattr(before, one.name), getattr(after, one.name)
        pairs = (
            [(one.name, was, now)]
            if not isinstance(was, Mapping)
            else [(f"{one.name}[{key!r}]", was[key], now.get(key)) for key in was]
        )
        yield from ((name, old, new) for name, old, new in pairs if isinstance(old, np.ndarray) and old.dtype.kind in "fc")


def tried(stage: str) -> Any:
    """A stage to try an equation on; its arrays cannot be written to."""
    return _TRIED[stage]()


def _alike(before: Any, after: Any) -> bool:
    if isinstance(before, Mapping):
        return before.keys() == after.keys() and all(_alike(before[key], after[key]) for key in before)
    if not isinstance(before, np.ndarray):
        return bool(before == after or np.isclose(before, after, rtol=ROUNDING, atol=0))
    there = np.asarray(after)
    if there.ndim != before.ndim or any(n < m for n, m in zip(there.shape, before.shape, strict=True)):
        return False
    padded = np.zeros(there.shape, dtype=np.result_type(there, before))
    inside = tuple(slice(n) for n in before.shape)
    padded[inside] = before
    grown = np.array(there)
    if there.shape != before.shape and there.ndim == 2:
        own = [k for k in range(max(there.shape)) if k >= max(before.shape) and k < min(there.shape)]
        grown[own, own] = 0.0  # what an added coordinate is by itself
    return bool(np.allclose(grown, padded, rtol=0, atol=ROUNDING * max(float(np.max(np.abs(padded), initial=0.0)), 1e-300)))


def _drawn(*shape: int) -> Any:
    return _frozen(np.random.default_rng(sum(shape)).standard_normal(shape))


def _complex(*shape: int) -> Any:
    return _frozen(_drawn(*shape) + 1j * _drawn(*shape, 1)[..., 0])


def _frozen(values: Any) -> Any:
    made = np.array(values)
    made.setflags(write=False)
    return made


def _positive(n: int, scale: float) -> Any:
    A = _drawn(n, n)
    return _frozen(scale * (A @ A.T + n * np.eye(n)))


@cache
def _matrices() -> Matrices:
    n = BASE + OWN
    held = np.zeros((n, n))
    held[BASE:, BASE:] = _positive(OWN, 1e5)
    return Matrices(
        base=BASE,
        mass=_positive(n, 2.0),
        stiffness=held,
        viscous=1e-3 * held,
        structural=1e-2 * held,
        places={name: _frozen(_drawn(3, n) + k) for k, name in enumerate(built_in_places())},
        parts={name: _frozen(held / len(PARTS)) for name in (*PARTS, "upper-short-silicone")},
        cog=np.array([0.01, -0.02, 0.3]),
    )


@cache
def _mounted() -> Mounted:
    return Mounted(
        frequency=_frozen(np.linspace(10.0, 11.0, LINES)),
        matrix=_complex(LINES, 6, 6),
        seat=_frozen([0.01, 0.02, 0.05]),
        cog=_frozen([0.01, -0.02, 0.3]),
        amplitude=_frozen([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        sweep_rate=2 / 60,
        block=14.5,
    )


@cache
def _reading() -> Reading:
    channels = (*TABLE, *COVER, *FMD)
    return Reading(
        frequency=_frozen(np.linspace(10.0, 11.0, LINES)),
        channels=channels,
        rows=_complex(LINES, len(channels), 6),
        amplitude=_frozen(1.0 + np.abs(_drawn(LINES, len(channels)))),
        peak=_frozen(np.full(len(channels), 5.0)),
    )


@cache
def _floor() -> Floor:
    channels = (*TABLE, *COVER, *FMD)
    return Floor(
        frequency=_frozen(np.linspace(10.0, 11.0, LINES)),
        channels=channels,
        quantities=tuple("force" if name in FMD else "acceleration" for name in channels),
        deviation=_frozen(np.full((LINES, len(channels)), 0.1)),
        per_rms=_frozen(np.full(len(channels), 0.5)),
        hum=_frozen(np.full((LINES, len(channels)), 0.01)),
    )


@cache
def _swing() -> Swing:
    return Swing(period=2.1, mass=47.0, inertia=2.3, ropes=3, length=2.0, radii=_frozen([0.3, 0.3, 0.3]))


_TRIED = {
    STRUCTURE_STAGE: _matrices,
    BODY_STAGE: _mounted,
    CHANNEL_STAGE: _reading,
    NOISE_STAGE: _floor,
    PERIOD_STAGE: _swing,
}
