"""What the channels of every campaign of a series should read by one model, with the derivative of every parameter.

    reduced matrices of what stands on the cover plate        set_up, nuisances         effects of the structure
    -> dynamic mass about its origin                          condensation
    -> carried to F, the FMD beside it                        fmd                       effects of the body
    -> A0 + A1 H of the measurement chain                     laboratory                parameters that effects open
    -> what is written into the file                                                    effects of the channels, noise

Campaigns of one hardware share the parameters of chain and FMD by name; those of the structure belong to parts, which they share
as well, and to the modes of a configuration. A structural effect acts wherever its part or its place exists.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from identification.campaign import Campaign
from identification.measurement_chain import Chain
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE, BODY_STAGE, CHANNEL_STAGE, NOISE_STAGE, PROCESSING, STRUCTURE_STAGE
from validation.effects.reach import acts
from validation.effects.stages import Floor, Reading
from validation.engine.measured import Measured
from validation.engine.parameter import Parameter
from validation.engine.prediction import Change, Conveyed, Lines, Offsets, Predicted, Wanted
from validation.models.model import Added, Model
from validation.prediction import applied, fmd, nuisances
from validation.prediction import measured as data
from validation.prediction.amplitude import Drive, drives
from validation.prediction.carried import Carried
from validation.prediction.laboratory import laboratory
from validation.prediction.laboratory import parameters as parameters_of_chain
from validation.prediction.set_up import Standing, moving_part, standing

Progress = Callable[[float], None]

EQUATIONS = (STRUCTURE_STAGE, BODY_STAGE, CHANNEL_STAGE)
"""Stages whose effects change what is read, so that a fit can tell their sizes."""

OF_CHANNELS = ("_reaching", "_chain", "_opened")
"""What is worked out once for a campaign, whichever of its runs are asked for."""


def predictions(
    model: Model,
    campaigns: Sequence[Campaign],
    *,
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    lines: npt.ArrayLike | None = None,
    progress: Progress | None = None,
) -> tuple[SeriesPrediction, ...]:
    """A prediction of each of `campaigns` by `model`.

    Parameters
    ----------
    band : (low, high) [Hz] of the lines; by default what all runs drive, see `validation.prediction.driven`
    method : of `identification.campaign.METHODS`, for time histories
    lines : (n,) [Hz]; by default those of the campaign's processing, or of its files, within the band
    progress : called with the share done

    Raises
    ------
    BadInput : campaigns of several hardwares, an article that the model cannot describe, whatever makes no spectra.
    """
    _require_one_hardware(campaigns)
    found = []
    for k, (campaign, name) in enumerate(zip(campaigns, data.names(campaigns), strict=True)):
        found.append(_tested(model, campaign, name, band, method, lines, _share(progress, k, len(campaigns))))
    return tuple(SeriesPrediction(tested=one, effects=model.effects) for one in found)


@dataclass(frozen=True, eq=False, kw_only=True)
class Tested:
    """One campaign, as far as no effect changes it.

    Attributes
    ----------
    model : its laboratory and structure; its effects are not asked here
    campaign : without its recordings
    measured : its spectra
    carried : what the load cells carried
    drives : (r,) of the runs of `measured`
    per_rms : (r,) noise of a line for 1 SI unit rms in the record
    method : by which its spectra were made
    remarks : which lines were left out, and why
    """

    model: Model
    campaign: Campaign
    measured: Measured
    carried: Carried
    drives: tuple[Drive, ...]
    per_rms: Array
    method: str = "full-record"
    remarks: tuple[str, ...] = ()

    def on(self, runs: Sequence[str]) -> Tested:
        """Of the runs named alone."""
        kept = [k for k, run in enumerate(self.measured.runs) if run in runs]
        chosen = tuple(self.drives[k] for k in kept)
        return replace(self, measured=self.measured.on(runs), drives=chosen, per_rms=self.per_rms[kept])


@dataclass(frozen=True, eq=False, kw_only=True)
class SeriesPrediction:
    """A model of one campaign of a series: a `validation.engine.prediction.Prediction`.

    Attributes
    ----------
    tested : the campaign
    effects : of the model, in the order in which they act; those that reach nothing here do nothing here
    """

    tested: Tested
    effects: tuple[Added, ...] = ()

    @property
    def measured(self) -> Measured:
        """The data."""
        return self.tested.measured

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move here: of the structure, the FMD, the chain, and the effects."""
        return self._opened[0]

    def on(self, runs: Sequence[str]) -> SeriesPrediction:
        """The same model of the runs named alone."""
        some = replace(self, tested=self.tested.on(runs))
        vars(some).update({name: getattr(self, name) for name in OF_CHANNELS})
        return some

    def with_effects(self, effects: Sequence[Added]) -> SeriesPrediction:
        """The same campaign by a model with these `effects` instead of its own."""
        return replace(self, effects=tuple(effects))

    def dynamic_mass(self, offsets: Offsets, lines: Lines | None = None) -> ComplexArray:
        """(n, 6, 6) about F of all that the cells carry, at `offsets` and the lines with these indices; all by default.

        Of a structure that answers to the amplitude, that of the first run.
        """
        chosen = self._lines(lines)
        return self._carried(self._at(offsets), chosen, self._variants[0][0], derivatives=False)[0]

    def by_load(self, offsets: Offsets, lines: Lines | None = None) -> ComplexArray:
        """(n, c, 6) what the channels read for a unit of every load on the cells, at `offsets`; all lines by default."""
        frequency, at = self._lines(lines), self._at(offsets)
        theta = np.array([at.get(one.name, 0.0) for one in self._chain.parameters])
        rows = self._chain.rows(theta, frequency)[1]
        still = np.zeros((len(frequency), len(self._chain.names)))
        reading = Reading(frequency=frequency, channels=self._chain.names, rows=rows, amplitude=still)
        return self._written(reading, {}, applied.at(self._reaching, at))[0].rows

    def moved(self, offsets: Offsets, lines: Lines | None = None) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """By place of the article (n, 3, 6) its accelerations along the axes of F for a unit of every motion of F; and the same
        beyond those of a rigid article."""
        at = self._at(offsets)
        return self.tested.carried.moved(at, applied.at(self._reaching, at), self._lines(lines))

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """The prediction at `offsets` and the lines with these indices; all lines by default.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError, FloatingPointError : the model breaks down there.
        """
        with np.errstate(divide="raise", over="raise", invalid="raise"):  # a breakdown is an error, and no warning on a terminal
            return self._predicted(offsets, lines, derivatives=derivatives)

    def _predicted(self, offsets: Offsets, lines: Lines | None, *, derivatives: Wanted) -> Predicted:
        frequency, at = self._lines(lines), self._at(offsets)
        found = [self._read(at, frequency, drive, derivatives=derivatives) for drive, _ in self._variants]
        noise = self._noise(at, lines, frequency)
        if len(found) == 1:
            return Predicted(rows=found[0].rows, changes=found[0].changes, noise=noise)
        order = np.zeros(len(self.measured.runs), dtype=np.int64)
        for k, (_, runs) in enumerate(self._variants):
            order[list(runs)] = k
        return _joined(found, order, noise)

    @cached_property
    def _reaching(self) -> tuple[Added, ...]:
        """The effects that reach this campaign."""
        there = replace(self.tested.carried.standing.there, channels=self.measured.channels)
        return tuple(one for one in self.effects if acts(one.named, there))

    @cached_property
    def _chain(self) -> Chain:
        return laboratory(self.tested.model, self.tested.campaign, self._reaching)

    @cached_property
    def _opened(self) -> tuple[tuple[Parameter, ...], Offsets]:
        """The parameters, and the offsets of those that stand at a given size."""
        carried, model = self.tested.carried, self.tested.model
        own = [
            *(() if carried.nuisances is None else carried.nuisances.parameters),
            *fmd.parameters(carried.moving, model.fmd_tolerance),
            *parameters_of_chain(self._chain),
        ]
        left, given = applied.opened(own, self._reaching)
        equations = [one for one in self._reaching if _stage(one) in EQUATIONS]
        return (*left, *applied.parameters(equations)), given

    @cached_property
    def _variants(self) -> tuple[tuple[Drive, tuple[int, ...]], ...]:
        """Runs that are read alike: all of them, unless an effect asks how they were driven."""
        drives = self.tested.drives
        if not any(_asks(one) for one in self._reaching):
            return ((Drive(), tuple(range(len(drives)))),)
        return tuple((drive, (k,)) for k, drive in enumerate(drives))

    def _lines(self, lines: Lines | None) -> Array:
        return self.measured.frequency if lines is None else self.measured.frequency[lines]

    def _at(self, offsets: Offsets) -> Offsets:
        return {**offsets, **self._opened[1]}

    def _carried(
        self, at: Offsets, frequency: Array, drive: Drive, *, derivatives: bool
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        effects, every = applied.at(self._reaching, at), self.measured.frequency
        if not any(_looks_around(one) for one in effects):
            return self.tested.carried.at(at, effects, frequency, drive, derivatives=derivatives)
        H, changes = self.tested.carried.at(at, effects, every, drive, derivatives=derivatives)
        chosen = np.searchsorted(every, frequency)
        return H[chosen], {name: change[chosen] for name, change in changes.items()}

    def _read(self, at: Offsets, frequency: Array, drive: Drive, *, derivatives: Wanted) -> Predicted:
        """What the channels read of runs that were driven by `drive`."""
        H, structural = self._carried(at, frequency, drive, derivatives=bool(derivatives))
        theta = np.array([at.get(one.name, 0.0) for one in self._chain.parameters])
        A0, A1 = self._chain.rows(theta, frequency)
        changes: dict[str, Change | Conveyed] = {}
        if derivatives:
            loaded = tuple(int(k) for k in np.flatnonzero(np.any(A1 != 0, axis=(0, 2))))
            through = A1[:, loaded]
            changes = {name: Conveyed(channels=loaded, through=through, quantities=dH) for name, dH in structural.items()}
            names = [one.name for one in self._chain.parameters if derivatives is True or one.name in derivatives]
            of_chain = self._chain.derivatives(theta, frequency, H, names)
            for name, derivative in zip(names, of_chain, strict=True):
                changes[name] = Change(channels=derivative.channels, rows=derivative.rows)
        rows = A0 + A1 @ H
        reading = Reading(
            frequency=frequency,
            channels=self._chain.names,
            rows=rows,
            amplitude=np.abs(rows @ drive.amplitude),
            peak=np.abs(rows @ drive.nominal).max(axis=0, initial=0.0),
        )
        reading, changes = self._written(reading, changes, applied.at(self._reaching, at))
        for name in self._opened[1]:
            changes.pop(name, None)
        return Predicted(rows=reading.rows, changes=changes)

    def _written(
        self, reading: Reading, changes: dict[str, Change | Conveyed], effects: Sequence[Added]
    ) -> tuple[Reading, dict[str, Change | Conveyed]]:
        """What the file holds of what the channels read."""
        if applied.channels_pass(effects):
            written, own = applied.channels(reading, {}, effects)
            return written, {**changes, **{name: _changing(rows) for name, rows in own.items()}}
        every = tuple(range(len(reading.channels)))
        tangents = {name: _on(change, every) for name, change in changes.items()}
        written, tangents = applied.channels(reading, tangents, effects)
        return written, {name: _changing(rows) for name, rows in tangents.items()}

    def _noise(self, at: Offsets, lines: Lines | None, frequency: Array) -> Array | None:
        """(r, n, c) where an effect on it acts."""
        effects, of = [one for one in applied.at(self._reaching, at) if _stage(one) == NOISE_STAGE], self.measured
        if not effects:
            return None
        chosen = of.noise if lines is None else of.noise[:, lines]
        quantities = tuple(self.tested.campaign.table.channels[k].quantity for k in self._chain.columns)
        hum, found = data.hum(frequency, quantities, self.tested.method), []
        for deviation, per_rms in zip(chosen, self.tested.per_rms, strict=True):
            floor = Floor(
                frequency=frequency,
                channels=of.channels,
                quantities=quantities,
                deviation=deviation,
                per_rms=np.full(len(quantities), per_rms),
                hum=hum,
            )
            for one in effects:
                change = FAMILIES[one.named.family].change
                floor = floor if change is None else change(floor, one.named.targets, one.named.values)
            found.append(floor.deviation)
        return np.stack(found)


def _tested(
    model: Model,
    campaign: Campaign,
    name: str,
    band: tuple[float, float] | None,
    method: str,
    lines: npt.ArrayLike | None,
    progress: Progress | None,
) -> Tested:
    stands = standing(model, campaign)
    of = laboratory(model, campaign, ())
    made = data.measured(campaign, of, name, band=band, method=method, lines=lines, progress=progress)
    driven = drives(campaign, made.method)
    return Tested(
        model=model,
        campaign=replace(campaign, recordings={}),
        measured=made.measured,
        carried=carried(model, campaign, stands),
        drives=tuple(driven[run] for run in made.measured.runs),
        per_rms=data.per_rms(campaign, made.method),
        method=made.method,
        remarks=made.remarks,
    )


def carried(model: Model, campaign: Campaign, stands: Standing) -> Carried:
    """What the cells carry in `campaign`, in which `stands` stands on the cover plate."""
    of_structure = None
    if stands.matrices is not None:
        of_structure = nuisances.of(campaign.article, stands.matrices, stands.frequency, stands.losses, model.structure)
    return Carried(standing=stands, moving=moving_part(model), exact=model.fmd_tolerance == 0, nuisances=of_structure)


def _joined(found: Sequence[Predicted], order: npt.NDArray[np.int64], noise: Array | None) -> Predicted:
    """Runs that are read differently, `order` (r,) says which of `found` each is."""
    changes = {}
    for name in dict.fromkeys(name for one in found for name in one.changes):
        of = [one.changes[name] for one in found]
        channels = tuple(sorted({k for one in of for k in one.channels}))
        changes[name] = Change(channels=channels, rows=np.stack([_on(of[k], channels) for k in order]))
    return Predicted(rows=np.stack([found[k].rows for k in order]), changes=changes, noise=noise)


def _on(change: Change | Conveyed, channels: tuple[int, ...]) -> ComplexArray:
    """Its rows (n, len(channels), k), zeros where it changes nothing."""
    own = change.rows
    rows = np.zeros((len(own), len(channels), own.shape[-1]), dtype=np.complex128)
    rows[:, [channels.index(k) for k in change.channels]] = own
    return rows


def _changing(rows: ComplexArray) -> Change:
    """A change of the rows (n, c, k) of all channels as one of those that do change."""
    channels = tuple(int(k) for k in np.flatnonzero(np.any(rows != 0, axis=(0, 2))))
    return Change(channels=channels, rows=rows[:, channels])


def _stage(added: Added) -> str:
    return FAMILIES[added.named.family].stage


def _looks_around(added: Added) -> bool:
    """Whether what an effect does at a line depends on the lines beside it, so that it must see all of them."""
    family = FAMILIES[added.named.family]
    return family.side == PROCESSING and family.stage == BODY_STAGE


def _asks(added: Added) -> bool:
    """Whether an effect asks how a run was driven."""
    family = FAMILIES[added.named.family]
    return family.side in (AMPLITUDE, PROCESSING) and family.stage in (BODY_STAGE, CHANNEL_STAGE)


def _share(progress: Progress | None, k: int, count: int) -> Progress | None:
    return None if progress is None else lambda done: progress((k + done) / count)


def _require_one_hardware(campaigns: Sequence[Campaign]) -> None:
    stated = {one.hardware: one.source for one in campaigns if one.hardware}
    if len(stated) > 1:
        listed = "; ".join(f"{hardware} in {source}" for hardware, source in stated.items())
        raise BadInput(
            source="series",
            field="hardware",
            problem=f"one model holds for one FMD and its sensors, found {listed}",
            remedy="Compare campaigns of one hardware at a time, each with a model of its own",
        )
