"""`Bent`: what an amplitude-dependent effect makes of the readings of runs at several levels, by the catalogue's equations.

The equations say what a channel reads of a sine of given amplitude, or what a body weighs that is shaken so hard. They are
applied to the readings themselves, whose amplitude in time follows from the level that a run states and from what its
accelerometers read,

    a_c(f) = |y_c(f)| level / |u(f)|

and undone by iteration: readings z that the effect would turn into those found. So no resonance need be where the model has it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.frames import rigid_transformation_6
from identification.recording import Recording
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
    peak : (r, c) largest reading in time of every channel in the run at the strongest level of the same axis
    """

    one: SeriesPrediction
    of: Driven
    lines: Indices
    peak: Array

    def bent(self, named: Named, run: int) -> ComplexArray:
        """(n, c) what `named` has added to the readings of the run with index `run`."""
        if FAMILIES[named.family].stage == BODY_STAGE:
            return self._of_body(named, run)
        return self._of_channels(named, run)

    def _of_channels(self, named: Named, run: int) -> ComplexArray:
        partner = int(self.of.partner[run])
        straight = self._straight(named, partner, self.peak[partner], rising=True)[1]
        return np.asarray(self.of.values[run] - self._straight(named, run, straight, rising=False)[0])

    def _straight(self, named: Named, run: int, peak: Array, *, rising: bool) -> tuple[ComplexArray, Array]:
        """Readings (n, c) of a run that `named` would turn into those found, and the peak (c,) that goes with them.

        Where the peak is that of this run (`rising`), it was bent as well: what a cubic takes of a peak is 4/3 of what it takes
        of the fundamental.
        """
        change, y = FAMILIES[named.family].change, self.of.values[run]
        loudest = np.argmax(np.abs(y), axis=0), np.arange(y.shape[1])
        z, found = y, peak
        for _ in range(ROUNDS if change is not None else 0):
            amplitude = self._per_unit[run][:, None] * np.abs(z)
            reading = Reading(
                frequency=self.of.frequency, channels=self.of.channels, rows=z[..., None], amplitude=amplitude, peak=found
            )
            z = z + y - change(reading, named.targets, named.values).rows[..., 0]  # type: ignore[misc]
            if rising:
                found = peak * (np.abs(z[loudest]) / np.maximum(np.abs(y[loudest]), TINY)) ** (4 / 3)
        return np.asarray(z), np.asarray(found)

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
        """(r, n, 6) of the base."""
        return _motion(self.of)

    @cached_property
    def _per_unit(self) -> Array:
        """(r, n) amplitude in time for a unit of a line."""
        return _per_unit(self.one, self._motion)

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


def bent(one: SeriesPrediction, of: Driven, lines: Indices, recordings: Mapping[str, Recording]) -> Bent:
    """The runs `of` the prediction `one` at `lines`; peaks by its `recordings`, or by its spectra where these are not in time."""
    amplitude = _per_unit(one, _motion(of))[..., None] * np.abs(of.values)
    peak = np.stack([_peak(recordings.get(run), of.channels, amplitude[k]) for k, run in enumerate(of.runs)])
    return Bent(one=one, of=of.at(lines), lines=lines, peak=peak[of.partner])


def _peak(recorded: Recording | None, channels: Sequence[str], amplitude: Array) -> Array:
    """(c,) largest reading of one run."""
    if recorded is None or recorded.is_spectrum or len(recorded) == 0:
        return np.asarray(amplitude.max(axis=0))
    values = recorded.values[:, [recorded.names.index(name) for name in channels]]
    return np.asarray(np.abs(values - values.mean(axis=0)).max(axis=0))


def _motion(of: Driven) -> ComplexArray:
    """(r, n, 6) of the base, by the accelerometers: at a resonance these need no structure."""
    moved = ~of.judged
    return np.asarray((np.linalg.pinv(of.rows[:, moved]) @ of.values[..., moved, None])[..., 0])


def _per_unit(one: SeriesPrediction, motion: ComplexArray) -> Array:
    """(r, n) amplitude in time for a unit of a line."""
    found = np.zeros(motion.shape[:2])
    for k, drive in enumerate(one.tested.drives):
        driven = drive.amplitude > 0
        share = np.abs(motion[k][:, driven]) / drive.amplitude[driven]
        found[k] = np.sqrt(driven.sum()) / np.maximum(np.linalg.norm(share, axis=1), TINY)
    return found


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
