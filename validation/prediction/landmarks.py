"""Landmarks of a test of a structure: what is compared while a model is still far from the data."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.modal_table import SOUND_SHAPE, ModalTable
from identification.resonances import Resonances, beside_axis, noise_beside_axis, resonances
from validation.estimation.problem import Offsets, Parameter, Predicted
from validation.model.model import Added
from validation.prediction import dynamic_mass, modal_table
from validation.prediction.modal_table import TableFrequencies, TableShapes, real_modes
from validation.prediction.response_functions import ResponseFunctionTest
from validation.prediction.structure_tests import StructurePrediction

# Where resonances of model and test do not overlap, lines say only that both are elsewhere, and their slopes point nowhere.
# Landmarks change smoothly all the way:
#
#     resonance frequencies   ln f_model / f                              of a table, or picked from functions
#     shapes                  what no factor brings from one to the other
#     levels                  ln |H_model / H| beside the axis, at s = (i + w) omega, where every peak is broad; of each run and
#                             line the channels count by what they share of the level, so that a small reading decides nothing,
#                             and what is between two resonances counts as much as what is between two others
#
# Logarithms of functions are compared because their sum of squares has one minimum over a shift of resonances where that of the
# functions has many (E. Balmès, Frequency domain identification of structural dynamics using the pole/residue parametrization,
# Proc. 14th IMAC, 1996). Each landmark has the deviation that a sound model may have there, beside that of what was measured.

SOUND_FREQUENCY = 0.01
"""[share] that a frequency of a sound model may be off, beside its tolerances. Held by test_landmarks.py."""

SOUND_LEVEL = 0.15
"""[log] that the level of a sound model may be off beside the axis. Held by test_landmarks.py."""

WIDTH = 0.05
"""[1] real over imaginary part of s at which levels are compared: peaks as broad as those of a damping ratio of that much more.
Held by test_landmarks.py."""

PER_OCTAVE = 6
"""[count] of levels in an octave: one in two of each `WIDTH` to either side. By definition."""

LEAST_SHARE = 0.02
"""[share] of the level of a run, squared, below which a channel is not compared there. By definition."""

SILENT = 1 / 3
"""[share] of a level that noise may be for it to be compared. Held by test_landmarks.py."""

TABLE_GAIN = 10.0
"""[share] that stands for a gain of which nothing is known. By definition."""

Compared = Callable[[Predicted, Sequence[str]], tuple[Array, dict[str, Array]]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Landmark:
    """Landmarks of one kind in one data set.

    Attributes
    ----------
    kind : "frequency", "shape", "level"
    prediction : what the model says there
    compared : residual (n,) of a prediction, and its derivatives by parameter
    deviation : (n,) standard deviation of the residual of a sound model
    where : (n,) in words
    number : of independent numbers among them
    """

    kind: str
    prediction: StructurePrediction
    compared: Compared
    deviation: Array
    where: tuple[str, ...]
    number: float

    def at(
        self, offsets: Offsets, effects: Sequence[Added], *, derivatives: Collection[str] = ()
    ) -> tuple[Array, dict[str, Array]]:
        """Residual (n,) in its deviations with `effects` on top of those of the model, and its derivatives by these parameters.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError, FloatingPointError : the model breaks down there.
        """
        one = self.prediction
        predicted = one.with_effects((*one.effects, *effects)).at(offsets, derivatives=frozenset(derivatives) or False)
        left, moved = self.compared(predicted, [name for name in derivatives if name in predicted.changes])
        return left / self.deviation, {name: change / self.deviation for name, change in moved.items()}

    @classmethod
    def of_tests(cls, tests: Sequence[StructurePrediction]) -> "tuple[Landmark, ...]":
        """Those of all `tests`."""
        found: list[Landmark] = []
        for one in tests:
            if isinstance(one, ResponseFunctionTest):
                shown = resonances(one.measured.frequency, one.measured.values, one.measured.noise)
                found += cls.of_levels(one, shown)
                for part in resonance_table(one, shown):
                    found.append(cls.of_frequencies(part) if isinstance(part, TableFrequencies) else cls.of_shapes(part))
            elif isinstance(one, TableFrequencies):
                found.append(cls.of_frequencies(one))
            elif isinstance(one, TableShapes):
                found.append(cls.of_shapes(one))
        return tuple(found)

    @classmethod
    def of_frequencies(cls, of: TableFrequencies) -> "Landmark":
        data = of.measured
        f, sd = data.values[:, 0, 0].real, data.noise[:, 0, 0]

        def compared(predicted: Predicted, names: Sequence[str]) -> tuple[Array, dict[str, Array]]:
            own = predicted.rows[:, 0, 0, 0].real
            return np.log(own / f), {name: _whole(predicted, name)[:, 0, 0, 0].real / own for name in names}

        return cls(
            kind="frequency",
            prediction=of,
            compared=compared,
            deviation=np.hypot(sd / f, SOUND_FREQUENCY),
            where=tuple(f"frequency of {run}" for run in data.runs),
            number=float(len(f)),
        )

    @classmethod
    def of_shapes(cls, of: TableShapes) -> "Landmark":
        data = of.measured
        y, sd = data.values[:, 0].real, data.noise[:, 0]  # noise has `SOUND_SHAPE` in it
        m, s = y.shape
        number = max(min(s - 1, m), 1)
        weight = SOUND_SHAPE / sd

        def compared(predicted: Predicted, names: Sequence[str]) -> tuple[Array, dict[str, Array]]:
            a, b = weight * predicted.rows[:, 0, :, 0].real, weight * y
            square = np.sum(a**2, axis=1, keepdims=True)
            factor = np.sum(a * b, axis=1, keepdims=True) / square
            moved = {}
            for name in names:
                d = weight * _whole(predicted, name)[:, 0, :, 0].real
                moved[name] = (factor * (d - a * np.sum(a * d, axis=1, keepdims=True) / square)).ravel()
            return (factor * a - b).ravel(), moved

        return cls(
            kind="shape",
            prediction=of,
            compared=compared,
            deviation=np.full(m * s, SOUND_SHAPE * np.sqrt(s / number)),
            where=tuple(f"shape of {run} at {channel}" for run in data.runs for channel in data.channels),
            number=float(m * number),
        )

    @classmethod
    def of_levels(cls, of: ResponseFunctionTest, shown: Resonances) -> "list[Landmark]":
        data = of.measured
        low, high = float(data.frequency[0]), float(data.frequency[-1])
        at = np.geomspace(low, high, max(int(PER_OCTAVE * np.log2(high / low)), 3))
        at = at[(at * (1 - WIDTH) > low) & (at * (1 + WIDTH) < high)]
        if not len(at):
            return []
        values = beside_axis(data.frequency, data.values, at, WIDTH)
        noise = noise_beside_axis(data.frequency, data.noise, at, WIDTH)
        level = np.maximum(np.abs(values), np.finfo(np.float64).tiny ** 0.25)  # a channel may be silent
        share = level**2 / np.sum(level**2, axis=2, keepdims=True)
        kept = (share > LEAST_SHARE) & (noise < SILENT * level)
        if not kept.any():
            return []
        share = np.where(kept, share / (1 + (noise / (SOUND_LEVEL * level)) ** 2), 0.0)  # what is noise counts less
        # What lies between two resonances, or beyond them, is a number of every run and channel that shares in it
        band = np.searchsorted(shown.frequency, at)
        weight, number = np.zeros(share.shape), 0.0
        for run, k in np.ndindex(len(data.runs), len(shown.frequency) + 1):
            own = share[run, band == k]
            if own.sum() > 0:
                channels = float(own.sum() ** 2 / np.sum(own.sum(axis=0) ** 2))
                weight[run, band == k] = channels * own / own.sum()
                number += channels
        log = np.log(level)
        moved_to = replace(
            of,
            measured=replace(
                data, frequency=at, values=values, noise=noise, inputs=np.ones((len(data.runs), len(at), 1), dtype=np.complex128)
            ),
            decay_rate=of.decay_rate + WIDTH * 2 * np.pi * at,
        )

        def compared(predicted: Predicted, names: Sequence[str]) -> tuple[Array, dict[str, Array]]:
            rows = predicted.rows[..., 0]
            moved = {name: (_whole(predicted, name)[..., 0] / rows).real[kept] for name in names}
            return (np.log(np.abs(rows)) - log)[kept], moved

        places = [f"level of {channel} about {f:.3g} Hz" for _ in data.runs for f in at for channel in data.channels]
        return [
            cls(
                kind="level",
                prediction=moved_to,
                compared=compared,
                deviation=SOUND_LEVEL / np.sqrt(weight[kept]),
                where=tuple(where for where, one in zip(places, kept.ravel(), strict=True) if one),
                number=number,
            )
        ]


def resonance_table(test: ResponseFunctionTest, shown: Resonances | None = None) -> tuple[TableFrequencies | TableShapes, ...]:
    """The resonances that the functions of `test` show, looked for where they are not known, as a table of modes.

    Nothing where they show none, or more than the model has.
    """
    data = test.measured
    found = shown or resonances(data.frequency, data.values, data.noise)
    m, s = found.shapes.shape
    modes = real_modes(dynamic_mass.structure(test.structure, {}, test.effects, derivatives=False)[0])
    if not 0 < m <= np.sum(np.isfinite(modes.squares)):
        return ()
    table = ModalTable(
        source=data.name,
        title=data.name,
        article=data.configuration,
        frequency=found.frequency,
        frequency_deviation=found.frequency * found.damping_ratio / 2,
        sensors=test.responses,
        shapes=found.shapes if s > 1 else None,
        shapes_deviation=np.full((m, s), 0.05) if s > 1 else None,
        gain=test.gain if isfinite(test.gain) else TABLE_GAIN,
        names=tuple(f"{f:.4g} Hz" for f in found.frequency),
    )
    return tuple(one.with_effects(test.effects) for one in modal_table.of(test.structure, table))


def _whole(predicted: Predicted, name: str) -> ComplexArray:
    """(r, n, c, 1) change of all channels."""
    change = predicted.changes[name]
    found = np.zeros(predicted.rows.shape, dtype=np.complex128)
    found[:, :, list(change.channels)] = change.rows
    return found


def tolerances(of: Sequence[Landmark], known: Sequence[Added]) -> dict[str, Parameter]:
    """The parameters of all landmarks with `known` effects, by name; a table that was picked shares those of the functions."""
    found: dict[str, Parameter] = {}
    for one in of:
        for parameter in one.prediction.with_effects((*one.prediction.effects, *known)).parameters:
            found.setdefault(parameter.name, parameter)
    return found
