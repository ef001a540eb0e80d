"""`Bent`: what an amplitude-dependent effect makes of the readings of runs at several levels, by the catalogue's equations.

The equations say what a channel reads of a sine of given amplitude, or what a body weighs that is shaken so hard. They are applied
to the readings themselves, whose amplitude in time follows from the level that a run states and what its accelerometers read,

    a_c(f) = |y_c(f)| level / |u(f)|

and undone by iteration: readings z that the effect would turn into those found. So no resonance need be where the model has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.frames import rigid_transformation_6
from validation.diagnosing.driven import Driven, Indices
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE, BODY_STAGE
from validation.effects.identifiers import Named
from validation.effects.reach import acts
from validation.effects.stages import Mounted, Reading
from validation.effects.targets import Vocabulary
from validation.prediction import applied, fmd
from validation.prediction.laboratory import laboratory
from validation.prediction.series import SeriesPrediction

ROUNDS = 12
"""Iterations by which an equation is undone; each leaves at most half of what was left."""

TINY = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, eq=False, kw_only=True)
class Bent:
    """Runs of a campaign, ready to be held against effects.

    Attributes
    ----------
    one : the prediction that knows how they were driven and what they drove
    of : the runs at some lines
    lines : indices of these lines
    """

    one: SeriesPrediction
    of: Driven
    lines: Indices

    def bent(self, named: Named, run: int) -> ComplexArray:
        """(n, c) what `named` has added to the readings of the run with index `run`."""
        if FAMILIES[named.family].stage == BODY_STAGE:
            return self._of_body(named, run)
        return self._of_channels(named, run)

    def _of_channels(self, named: Named, run: int) -> ComplexArray:
        change = FAMILIES[named.family].change
        y = self.of.values[run]
        if change is None:
            return np.zeros_like(y)
        z = y
        for _ in range(ROUNDS):
            reading = Reading(
                frequency=self.of.frequency,
                channels=self.of.channels,
                rows=z[..., None],
                amplitude=self._per_unit[run][:, None] * np.abs(z),
                peak=self._peak[run],
            )
            left = y - change(reading, named.targets, named.values).rows[..., 0]
            z = z + left
        return np.asarray(y - z)

    def _of_body(self, named: Named, run: int) -> ComplexArray:
        change = FAMILIES[named.family].change
        stage = self._mounted(run)
        if change is None:
            return np.zeros_like(self.of.values[run])
        added = change(stage, named.targets, named.values).matrix - stage.matrix
        T = rigid_transformation_6(stage.seat)
        return np.asarray((self._felt @ (T.T @ added @ T) @ self._motion[run][..., None])[..., 0])

    @cached_property
    def _motion(self) -> ComplexArray:
        """(r, n, 6) of the base, by the accelerometers."""
        moved = ~self.of.judged
        return np.asarray((np.linalg.pinv(self.of.rows[:, moved]) @ self.of.values[..., moved, None])[..., 0])

    @cached_property
    def _per_unit(self) -> Array:
        """(r, n) amplitude in time for a unit of a line."""
        levels = np.stack([drive.amplitude for drive in self.one.tested.drives])
        found = np.zeros(self.of.values.shape[:2])
        for k, level in enumerate(levels):
            driven = level > 0
            share = np.abs(self._motion[k][:, driven]) / level[driven]
            found[k] = np.sqrt(driven.sum()) / np.maximum(np.linalg.norm(share, axis=1), TINY)
        return found

    @cached_property
    def _peak(self) -> Array:
        """(r, c) largest amplitude of every channel in the run at the strongest level of the same axis."""
        peak = np.max(self._per_unit[..., None] * np.abs(self.of.values), axis=1)
        return np.asarray(peak[self.of.partner])

    @cached_property
    def _felt(self) -> ComplexArray:
        """(n, c, 6) what the channels read of loads about F that the cells carry."""
        one, frequency = self.one, self.of.frequency
        chain = laboratory(one.tested.model, one.tested.campaign, one.effects)
        start = {parameter.name: parameter.start for parameter in one.parameters}
        rows = chain.rows(np.array([start.get(parameter.name, 0.0) for parameter in chain.parameters]), frequency)[1]
        linear = [effect for effect in one.effects if FAMILIES[effect.named.family].side != AMPLITUDE]
        reading = Reading(frequency=frequency, channels=self.of.channels, rows=np.asarray(rows, dtype=np.complex128))
        return applied.channels(reading, {}, linear, derivatives=False)[0].rows

    def _mounted(self, run: int) -> Mounted:
        """The article on its place, as the equations of a body want it."""
        carried, drive = self.one.tested.carried, self.one.tested.drives[run]
        pose, matrices = carried.standing.pose, carried.standing.matrices
        return Mounted(
            frequency=self.of.frequency,
            matrix=self._article,
            seat=pose.position,
            cog=np.zeros(3) if matrices is None else pose.rotation @ matrices.cog,
            amplitude=drive.amplitude,
            sweep_rate=drive.sweep_rate,
            block=drive.block,
        )

    @cached_property
    def _article(self) -> ComplexArray:
        """(n, 6, 6) dynamic mass of the article about its origin."""
        start = {parameter.name: parameter.start for parameter in self.one.parameters}
        own = fmd.at(self.one.tested.carried.moving, start).mass_matrix
        G = np.linalg.inv(rigid_transformation_6(self.one.tested.carried.standing.pose.position))
        return np.asarray(G.T @ (self.one.dynamic_mass(start, self.lines) - own) @ G)


def could_act(made: Sequence[SeriesPrediction], words: Vocabulary, channels: Sequence[str]) -> tuple[Named, ...]:
    """Every amplitude-dependent effect of the catalogue that acts on some campaign; of those on one channel, on `channels` alone.

    Sizes stand at the bounds of what is fitted, by the family's `high`.
    """
    there = [replace(one.tested.carried.standing.there, channels=one.measured.channels) for one in made]
    narrowed = replace(words, accelerometers=_in(words.accelerometers, channels), forces=_in(words.forces, channels))
    found = []
    for family in FAMILIES.values():
        if family.side != AMPLITUDE or family.change is None:
            continue
        for targets in product(*(narrowed.legal(kind) or () for kind in family.targets)):
            values = {size.key: size.high if size.default is None else size.default for size in family.sizes_at(targets)}
            named = Named(family=family.name, targets=targets, values=values)
            if any(acts(named, one) for one in there):
                found.append(named)
    return tuple(found)


def _in(names: Sequence[str] | None, chosen: Sequence[str]) -> tuple[str, ...]:
    return tuple(name for name in chosen if names is None or name in names)
