"""Effects applied to a stage of a prediction, with all its derivatives carried through and their own added.

An effect that the model holds for known is no parameter. Effects act in their order; one whose place or part the stage has not
leaves it alone, so that one model serves a series of articles.

Derivatives by the size of an effect are differences of its equation. Those of reduced matrices are central and exact for the
polynomials of second degree that masses, springs and resonators are; those of a dynamic mass and of channels take five points, at
steps so small that a resonance of a per mille does not notice them. Derivatives that come from before pass an equation of the
matrices as they are, because it adds, unless they change the share of a part that it reads; they pass one of a dynamic mass by a
directional difference, and one of the channels, which is linear, by the equation itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from geometry.dynamic_mass import ComplexArray
from validation.effects.catalogue import FAMILIES, Named, There, acts
from validation.effects.effect import BODY_STAGE, CHANNEL_STAGE, OPENED, STRUCTURE_STAGE, Family, SizeSpec
from validation.effects.stages import ChannelResponse, Matrices, MountedDynamicMass
from validation.estimation.problem import EFFECT, Parameter
from validation.model.model import Added
from validation.prediction.nuisances import Tangent, between, plus

COARSE = 1e-3
"""Step of matrices, as a share of the size: polynomials do not care, and rounding least."""

FINE = 1e-5
"""Step of transfers: small beside the width of a resonance, large beside rounding."""


def parameters(effects: Sequence[Added]) -> tuple[Parameter, ...]:
    """One for every size that a fit may move, of the effects that have an equation.

    Offset 0 of an additive one is no effect, of a logarithmic one the size as it stands; a fit starts at the size as it stands.
    """
    return tuple(_parameter(added.named, size) for added in effects for size in _free(added))


def name(named: Named, key: str) -> str:
    """How the parameter for the size `key` of an effect is called."""
    return f"{named.id}[{key}]" if key else named.id


def at(effects: Sequence[Added], offsets: Mapping[str, float]) -> tuple[Added, ...]:
    """`effects` with the sizes that `offsets` say; where they say nothing of a free size it stands at offset 0."""
    return tuple(_at(added, offsets) for added in effects)


def opened(parameters: Sequence[Parameter], effects: Sequence[Added]) -> tuple[tuple[Parameter, ...], dict[str, float]]:
    """Parameters of which effects without an equation are faults, and the offsets of those that are no parameter any more.

    A parameter by the name of an effect leaves its tolerance; that of a fixed effect leaves the list.
    """
    by_name = {added.named.id: added for added in effects if _family(added.named).stage == OPENED}
    left, known = [], {}
    for one in parameters:
        added = by_name.get(one.name)
        if added is None:
            left.append(one)
        elif added.fixed:
            known[one.name] = one.offset(added.named.value)
        else:
            (size,) = added.named.sizes
            start = one.offset(added.named.value)
            low, high = bounds(one, size)
            left.append(replace(one, tolerance=size.plausible, kind=EFFECT, start=start, within=inf, low=low, high=high))
    return tuple(left), known


def structure(
    stage: Matrices, tangents: Mapping[str, Tangent], effects: Sequence[Added], *, derivatives: bool = True
) -> tuple[Matrices, dict[str, Tangent]]:
    """The effects on reduced matrices, and by parameter their derivatives."""
    found = dict(tangents)
    for added in _of(effects, STRUCTURE_STAGE):
        if not acts(added.named, There(article="article", parts=tuple(stage.parts), places=tuple(stage.places))):
            continue
        after = _changed(added.named, stage)
        if not _is_nothing(added.named):
            found = {key: _through(added.named, stage, after, tangent) for key, tangent in found.items()}
        for size in _free(added) if derivatives else ():
            named = added.named
            value, scale, slope = _scale(named, size)
            step = COARSE * scale
            below, above = (_changed(_with(named, size, value + side * step), stage) for side in (-1, 1))
            found[name(added.named, size.key)] = between(below, above, 2 * step / slope)
        stage = after
    return stage, found


def body(
    stage: MountedDynamicMass, tangents: Mapping[str, ComplexArray], effects: Sequence[Added], *, derivatives: bool = True
) -> tuple[MountedDynamicMass, dict[str, ComplexArray]]:
    """The effects on a dynamic mass, and by parameter its derivatives (n, 6, 6)."""
    found = dict(tangents)
    for added in _of(effects, BODY_STAGE):
        own = {name(added.named, size.key): _of_matrix(added.named, size, stage) for size in _free(added) if derivatives}
        if not _is_nothing(added.named):
            found = {key: _directional(added.named, stage, tangent) for key, tangent in found.items()}
        found |= own
        stage = _changed(added.named, stage)
    return stage, found


def channels(
    stage: ChannelResponse, tangents: Mapping[str, ComplexArray], effects: Sequence[Added], *, derivatives: bool = True
) -> tuple[ChannelResponse, dict[str, ComplexArray]]:
    """The effects on what the channels read, and by parameter its derivatives (n, c, k)."""
    found = dict(tangents)
    for added in _of(effects, CHANNEL_STAGE):
        own = {name(added.named, size.key): _of_rows(added.named, size, stage) for size in _free(added) if derivatives}
        if not _is_nothing(added.named):
            found = {key: _changed(added.named, replace(stage, rows=rows)).rows for key, rows in found.items()}
        found |= own
        stage = _changed(added.named, stage)
    return stage, found


def channels_pass(effects: Sequence[Added]) -> bool:
    """Whether derivatives pass all effects on what the channels read as they are: none of them changes anything yet."""
    return all(_is_nothing(added.named) for added in _of(effects, CHANNEL_STAGE))


def _family(named: Named) -> Family:
    return FAMILIES[named.family]


def _is_nothing(named: Named) -> bool:
    """Whether it stands at the size at which its equation changes nothing, so that derivatives pass as they are."""
    sizes = named.fitted_sizes
    return bool(sizes) and all(named.values[size.key] == size.null and not size.logarithmic for size in sizes)


def _of(effects: Sequence[Added], stage: str) -> Iterator[Added]:
    return (added for added in effects if _family(added.named).stage == stage)


def _free(added: Added) -> tuple[SizeSpec, ...]:
    """Sizes that a fit may move; none of an opened effect, whose parameter is somebody else's."""
    if added.fixed or _family(added.named).change is None:
        return ()
    return added.named.fitted_sizes


def _parameter(named: Named, size: SizeSpec) -> Parameter:
    value = named.values[size.key]
    made = Parameter(
        name=name(named, size.key),
        unit=size.unit,
        tolerance=size.plausible,
        kind=EFFECT,
        nominal=value if size.logarithmic else size.null,
        logarithmic=size.logarithmic,
        start=0.0 if size.logarithmic else value - size.null,
    )
    low, high = bounds(made, size)
    return replace(made, low=low, high=high)


def bounds(one: Parameter, size: SizeSpec) -> tuple[float, float]:
    """Least and greatest offset of `one` at which `size` is what its family allows; that of no effect is always allowed."""
    if one.logarithmic:
        return one.offset(size.low), one.offset(size.high)
    return one.offset(min(size.low, size.null)), one.offset(max(size.high, size.null))


def _at(added: Added, offsets: Mapping[str, float]) -> Added:
    sizes = {size.key: _parameter(added.named, size) for size in _free(added)}
    values = {key: one.value(offsets.get(one.name, 0.0)) for key, one in sizes.items()}
    return replace(added, named=replace(added.named, values={**added.named.values, **values}))


def _changed(named: Named, stage: Any) -> Any:
    change = _family(named).change
    if change is None:
        raise ValueError(f"`{named.id}` has no equation")
    return change(stage, named.targets, named.values)


def _with(named: Named, size: SizeSpec, value: float) -> Named:
    return replace(named, values={**named.values, size.key: value})


def _scale(named: Named, size: SizeSpec) -> tuple[float, float, float]:
    """A size as it stands, what to measure steps by, and d size / d offset."""
    value = named.values[size.key]
    return (value, abs(value), value) if size.logarithmic else (value, max(abs(value), size.plausible), 1.0)


def _through(named: Named, stage: Matrices, after: Matrices, tangent: Tangent) -> Tangent:
    """`tangent` behind the equation: as it is, and what the equation reads of the parts that it changes."""
    if not tangent.parts:
        return tangent
    parts = {**stage.parts, **{part: stage.parts[part] + change for part, change in tangent.parts.items()}}
    read = between(after, _changed(named, replace(stage, parts=parts)), 1.0)
    return plus(replace(tangent, parts={}), read, len(after.mass))


def _of_matrix(named: Named, size: SizeSpec, stage: MountedDynamicMass) -> ComplexArray:
    return _slope(named, size, lambda one: np.asarray(_changed(one, stage).matrix))


def _of_rows(named: Named, size: SizeSpec, stage: ChannelResponse) -> ComplexArray:
    return _slope(named, size, lambda one: np.asarray(_changed(one, stage).rows))


def _slope(named: Named, size: SizeSpec, of: Callable[[Named], ComplexArray]) -> ComplexArray:
    """d of / d offset at the size as it stands, exact to the fourth power of the step."""
    value, scale, slope = _scale(named, size)
    step = FINE * scale
    two_below, below, above, two_above = (of(_with(named, size, value + k * step)) for k in (-2, -1, 1, 2))
    return np.asarray((8 * (above - below) - (two_above - two_below)) / (12 * step) * slope)


def _directional(named: Named, stage: MountedDynamicMass, tangent: ComplexArray) -> ComplexArray:
    """d matrix behind the equation along `tangent` before it."""
    size = np.abs(tangent).max(initial=0.0)
    if not size:
        return tangent
    step = COARSE * np.abs(stage.matrix).max() / size
    below, above = (_changed(named, replace(stage, matrix=stage.matrix + side * step * tangent)).matrix for side in (-1, 1))
    return np.asarray((above - below) / (2 * step))
