"""What the channels of every campaign of a series should read by one model, with the derivative of every parameter.

    reduced matrices of what stands on the cover plate        structure, tolerances     effects of the structure
    -> dynamic mass about its origin                          dynamic_mass
    -> carried to F, the FMD beside it                        its ten parameters        effects of the body
    -> A0 + A1 H of the measurement chain                     laboratory                parameters that effects open
    -> what is written into the file                                                    effects of the channels, noise

Campaigns of one hardware share the parameters of chain and FMD by name; those of the structure belong to parts, which they share
as well, and to the modes of a configuration. A structural effect acts wherever its part or its place exists.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import inf
from pathlib import Path

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.sensors import AXES, Channel, Place
from identification.campaign import Campaign, Processing
from identification.chain import Chain, chain
from identification.load_cells import LOSES, LOSS
from identification.self_calibration.solve import smoothed_level
from identification.spectra.line_spectra import Spectra, hann
from identification.spectra.noise import of_block, of_full_record
from identification.spectra.of_campaign import OTHERWISE, between, by_level, lines_of, spectra, stated_drives
from validation.effects.catalogue import FAMILIES, There, acts
from validation.effects.effect import AMPLITUDE, BODY_STAGE, CHANNEL_STAGE, NOISE_STAGE, OPENED, PROCESSING, STRUCTURE_STAGE
from validation.effects.stages import ChannelResponse, NoiseModel, leak
from validation.estimation import problem
from validation.estimation.fit import FLOOR
from validation.model.model import Added, Model
from validation.model.setups import on_fmd
from validation.model.tolerance_classes import METROLOGY
from validation.prediction import dynamic_mass
from validation.prediction import effects as prediction_effects
from validation.prediction.dynamic_mass import AttachedResponse, BaseDrive, Finite, SolvedStructure, SupportedDynamicMass, drives
from validation.prediction.mounting import MountedArticle, accelerometers, mounted_article, moving_part

# The measurement chain of one campaign as a model knows it, in the engine's words.

HELD = 1.0
"""Standard deviation by which the chain opens what an effect needs; `validation.prediction.effects.opened` says which it has."""

KINDS = {"fmd-compliance": problem.IDENTIFIED, "cell-stiffness": problem.DECLARED, LOSS: problem.DECLARED}
"""What is of the FMD and not of a sensor, like its inertia: every laboratory that calibrates an FMD learns how its cells share a
load and how far they give; the former, and what they lose, within what is declared of the cells."""


def laboratory(model: Model, campaign: Campaign, effects: Sequence[Added]) -> Chain:
    """The chain of `campaign`, with every parameter open that `effects` need.

    Raises
    ------
    BadInput : as `identification.chain.chain`.
    """
    made = partial(
        chain,
        campaign.table,
        model.tolerances,
        stiffness=model.cell_stiffness if on_fmd(campaign) else inf,
        gravity=campaign.gravity,
        on_article=tuple(accelerometers(model, campaign)[0]),
    )
    drawn = made()
    families = {name.partition(":")[0] for name in drawn.possible}
    overrides = {family: size for family, size in model.opened.items() if family in families}
    needed = [one.named.id for one in effects if FAMILIES[one.named.family].stage == OPENED]
    overrides |= {name: HELD for name in needed if name in drawn.possible}
    return made(overrides=overrides) if overrides else drawn


# From a campaign to `Measured`: the complex lines of the channels that the chain predicts; forces are judged.


@dataclass(frozen=True, eq=False, kw_only=True)
class Made:
    """Spectra as the engine wants them.

    Attributes
    ----------
    measured : the data set
    method : by which they were made
    remarks : which lines were left out, and why
    """

    measured: problem.Measured
    method: str
    remarks: tuple[str, ...] = ()


def measured(
    campaign: Campaign,
    of: Chain,
    name: str,
    *,
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    lines: npt.ArrayLike | None = None,
    progress: "Progress | None" = None,
) -> Made:
    """The data set `name` of `campaign`; where neither `band` nor `lines` are given, at the lines that every run drives.

    Raises
    ------
    BadInput : as `identification.spectra.of_campaign.spectra`; runs that drive no line in common.
    """
    if band is not None or lines is not None:
        found = spectra(campaign, method=method, band=band, frequency=lines, progress=progress)
        return Made(measured=_measured(campaign, found, of, name), method=found.method, remarks=found.warnings)
    stated = stated_drives(campaign)
    found = spectra(campaign, method=method, band=stated, progress=progress)
    forces = [of.columns[k] for k in of.forces.columns]  # are judged; inputs are estimated from the others
    kept, remarks = by_level(campaign, found, (forces, [column for column in of.columns if column not in forces]))
    lines = lines_of(campaign)
    if stated is not None and (left := int(np.sum(~between(lines, *stated)))):
        which = f"{left} of the {len(lines)} lines of {campaign.source}, {lines[0]:g} to {lines[-1]:g} Hz, are left out"
        why = f"all of its runs together drive {stated[0]:g} to {stated[1]:g} Hz, as they state"
        remarks = (f"{which}: {why}; {OTHERWISE}", *remarks)
    return Made(measured=_measured(campaign, found.at(kept), of, name), method=found.method, remarks=(*found.warnings, *remarks))


def names(campaigns: Sequence[Campaign]) -> tuple[str, ...]:
    """What the data sets are called: after their folders, or after what was tested where there is none; each its own."""
    called: list[str] = []
    for one in campaigns:
        stem = Path(one.source).name if Path(one.source).is_dir() else one.article
        same = [f"{stem}-{k}" for k in range(2, len(campaigns) + 2)]
        called.append(next(name for name in (stem, *same) if name not in called))
    return tuple(called)


def per_rms(campaign: Campaign, method: str) -> Array:
    """(r,) standard deviation of a line for broadband noise of 1 SI unit rms in the record; zeros of stored spectra."""
    recorded = [campaign.recordings[run.name] for run in campaign.runs]
    rates = np.array([one.sampling_rate or 0.0 for one in recorded])
    if not np.all(rates > 0):
        return np.zeros(len(recorded))
    density = (1 / rates)[:, None, None]
    if method == "full-record":
        return of_full_record(density, np.array([one.duration for one in recorded])).ravel()
    return of_block(density, rates, hann((campaign.processing or Processing()).block_size)).ravel()


def _measured(campaign: Campaign, found: Spectra, of: Chain, name: str) -> problem.Measured:
    columns = list(of.columns)
    sd = {one.name.partition(":")[2]: one.tolerance for one in of.parameters if one.unit == "s"}
    made = problem.Measured(
        name=name,
        configuration=campaign.article,
        hardware=campaign.hardware,
        runs=found.runs,
        axes=found.axes,
        channels=of.names,
        judged=np.isin(np.arange(len(columns)), of.forces.columns),
        frequency=found.frequency,
        values=found.values[:, :, columns],
        noise=found.noise[:, :, columns],
        noise_scatter=found.noise_scatter,
        noise_spread=found.noise_spread,
        late=np.array([sd.get(name, 0.0) * is_read(name) for name in of.names]),
    )
    return _with_their_size(made, campaign)


# A single-axis shaker: the base moves along the other five axes as well, a little, and nobody measured how. These motions are
# inputs like any other, latent, and what is known of them stands beside the data: a pick-up of F along each that reads nothing,
# with their size as its noise. Its row is a constant, so that no model can make such a motion cheaper, and eliminating the
# inputs marginalises them with that Gaussian prior.
#
# A table that turns as it is driven goes on turning at the next line: what all lines have in common is one unknown and not a
# hundred. Each pick-up therefore reads u - c(f) u_d of the driven motion u_d. The complex share c lies on straight lines over
# log f between knots an octave apart (what a table does besides changes slowly between its own resonances), and both parts of it
# at each knot are tolerances of the stated size. At each line a motion of that size is left beside it.

UNMEASURED = "unmeasured-"
"""How these pick-ups begin."""

SHARE = "cross-motion"
"""Family of the parameters c."""

UNTOLD = ("accelerometer-misalignment", "accelerometer-position")
"""By these a pick-up reads more or less of what the base does that nobody recorded. What is left of a line fits any such motion,
and a fit would turn a pick-up until it may: they act on what is driven, and on what the article bends."""


def is_read(channel: str) -> bool:
    """Whether something was recorded of a channel: it is none of these pick-ups."""
    return not channel.startswith(UNMEASURED)


def shares(tested: "TestedCampaign", frequency: Array) -> Iterator[tuple[problem.Parameter, int, ComplexArray]]:
    """Of a campaign that states `cross_motion` the parameters of c, and how much an offset of each changes which row: the channel
    and (n, 6)."""
    of, size = tested.measured, tested.campaign.cross_motion
    if not size:
        return
    driven = np.eye(len(MOTIONS))[MOTIONS.index(of.axes[0])]
    within = problem.WITHIN * size  # a plain fit moves it as well: no record tells it
    declared = problem.Parameter(name=SHARE, unit="1", kind=problem.DECLARED, tolerance=size, within=within)
    low, high = np.log2(of.frequency[[0, -1]])
    knots = np.linspace(low, high, 1 + max(1, int(np.ceil(high - low))))
    for column, channel in enumerate(of.channels):
        for k, knot in enumerate(() if is_read(channel) else knots):
            hat = np.interp(np.log2(frequency), knots, np.eye(len(knots))[k])[:, None]
            name = f"{SHARE}:{of.name}:{channel.removeprefix(UNMEASURED)}:{2**knot:.3g}Hz"
            for part, unit in (("re", 1.0), ("im", 1j)):
                yield replace(declared, name=f"{name}:{part}"), column, -unit * hat * driven


def with_unmeasured(campaign: Campaign) -> Campaign:
    """`campaign` with a pick-up for each of the five motions that are not driven, where it states how large these are.

    Raises
    ------
    BadInput : runs that are not all along one of x, y, z, or no accelerometer on the base along it.
    """
    if not campaign.cross_motion:
        return campaign
    driven = {run.axis for run in campaign.runs}
    along = next((k for k, axis in enumerate(MOTIONS[:3]) if driven == {axis}), None)
    if along is None:
        problem = f"is stated, and its runs are driven along {', '.join(sorted(map(str, driven)))}"
        remedy = "Make a campaign of the runs along each of x, y and z; rotations need measured base motions"
        raise BadInput(campaign.source, "campaign.cross_motion", problem, remedy)
    if not _base_along(campaign, along):
        problem = f"is stated, and no accelerometer on the base reads along {MOTIONS[along]}"
        raise BadInput(campaign.source, "campaign.cross_motion", problem, "Add it to [[channel]]")
    made, e, size = list[Channel](), np.eye(3), campaign.cross_motion  # `_with_their_size` has it as a share of each line
    for k, axis in enumerate(MOTIONS):
        turned = e[k % 3]  # about it, or along it
        arm, way = next((e[j], np.cross(turned, e[j])) for j in range(3) if j != k % 3 and not np.cross(turned, e[j])[along])
        place = Place(position=campaign.table.origin, direction=turned)
        if k >= 3:
            place = Place(position=campaign.table.origin + arm, direction=way)
        if k != along:
            name = UNMEASURED + axis
            made.append(
                Channel(name=name, quantity="acceleration", group="cover", places=(place,), senses_gravity=False, noise_rms=size)
            )
    table = replace(campaign.table, channels=(*campaign.table.channels, *made))
    names, recordings = tuple(one.name for one in table.channels), {}
    for name, one in campaign.recordings.items():
        silent = np.zeros((len(one.values), len(made)), dtype=one.values.dtype)
        recordings[name] = replace(one, names=names, values=np.column_stack([one.values, silent]))
    return replace(campaign, table=table, recordings=recordings)


def _with_their_size(of: problem.Measured, campaign: Campaign) -> problem.Measured:
    """Spectra in which the pick-ups of `with_unmeasured` read nothing, as well as the stated share of the driven motion."""
    quiet = np.array([not is_read(name) for name in of.channels])
    if not np.any(of.judged):  # no load cells
        of = replace(of, judged=np.isin(of.channels, [one.name for one in campaign.table.channels if one.group == "article"]))
    if not campaign.cross_motion:
        return of
    along = pilots(campaign)
    level = smoothed_level(of.frequency, of.values)[:, :, np.isin(of.channels, along)].max(axis=2, keepdims=True)
    noise = np.where(quiet, campaign.cross_motion * level, of.noise)
    unmeasured = tuple(name for name in of.channels if not is_read(name))
    return replace(of, values=np.where(quiet, 0.0, of.values), noise=noise, pilots=tuple(along), unmeasured=unmeasured)


def pilots(campaign: Campaign) -> list[str]:
    """Of a single-axis shaker the accelerometers on the base along the driven axis: slanted or beside their place they read what
    a base that goes across lets them read."""
    return _base_along(campaign, MOTIONS.index(str(campaign.runs[0].axis))) if campaign.cross_motion else []


def _base_along(campaign: Campaign, axis: int) -> list[str]:
    """Accelerometers on the base that tell its motion along `axis`, an index of `MOTIONS`."""
    base = [one for one in campaign.table.channels if one.quantity == "acceleration" and one.group != "article"]
    return [one.name for one in base if abs(one.places[0].direction[axis]) > ALONG]


ALONG = 0.9
"""[1] Cosine between a pick-up on the base and the driven axis from which it tells the driven motion."""

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
) -> "tuple[SeriesPrediction, ...]":
    """A prediction of each of `campaigns` by `model`.

    Parameters
    ----------
    band : (low, high) [Hz] of the lines; by default what all runs drive, see `validation.prediction.series`
    method : of `identification.campaign.METHODS`, for time histories
    lines : (n,) [Hz]; by default those of the campaign's processing, or of its files, within the band
    progress : called with the share done

    Raises
    ------
    BadInput : campaigns of several hardwares, an article that the model cannot describe, whatever makes no spectra.
    """
    by_hardware = {one.hardware: one.source for one in campaigns if one.hardware}
    if len(by_hardware) > 1:
        listed = "; ".join(f"{hardware} in {source}" for hardware, source in by_hardware.items())
        problem = f"one model holds for one FMD and its sensors, found {listed}"
        raise BadInput("series", "hardware", problem, "Compare campaigns of one hardware at a time, each with a model of its own")
    found, tell, count = [], progress or (lambda share: None), len(campaigns)
    for k, (stated, name) in enumerate(zip(campaigns, names(campaigns), strict=True)):
        campaign = with_unmeasured(stated)
        of = laboratory(model, campaign, ())
        done = partial(lambda before, share: tell((before + share) / count), k)
        made = measured(campaign, of, name, band=band, method=method, lines=lines, progress=done)
        driven, stands = drives(campaign, made.method), mounted_article(model, campaign, float(made.measured.frequency[-1]))
        upon = [one.name for one in campaign.table.channels if one.group != "table"]
        if stands.unread and made.measured.inputs is None and not {*upon} & {*made.measured.channels}:
            problem = (
                f"nothing is left that tells more than the base: {next(one for one in stands.remarks if stands.unread[0] in one)}"
            )
            raise BadInput(campaign.source, "channel", problem, "Or measure the forces below it")
        unread = ", ".join(name for name in of.left_out if name not in stands.unread)
        why = f"not used: {unread}, which read no motion of cover plate, table or article, and no load of the FMD"
        tested = TestedCampaign(
            model=model,
            campaign=replace(campaign, recordings={}),
            measured=replace(made.measured, discrepancy=float(model.tolerance_class != METROLOGY)),
            carried=supported_dynamic_mass(model, campaign, stands, name),
            drives=tuple(driven[run] for run in made.measured.runs),
            per_rms=per_rms(campaign, made.method),
            method=made.method,
            remarks=(why, *made.remarks) if unread else made.remarks,
        )
        found.append(SeriesPrediction(tested=tested, effects=model.effects))
    return tuple(found)


@dataclass(frozen=True, eq=False, kw_only=True)
class TestedCampaign:
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
    measured: problem.Measured
    carried: SupportedDynamicMass
    drives: tuple[BaseDrive, ...]
    per_rms: Array
    method: str = "full-record"
    remarks: tuple[str, ...] = ()
    _opened: dict[frozenset[str], tuple[Chain, list[problem.Parameter]]] = field(default_factory=dict, init=False, repr=False)

    def opened(self, effects: Sequence[Added]) -> tuple[Chain, list[problem.Parameter]]:
        """The chain as `effects` need it, and all parameters but those that are of effects; made once for all that need the same.

        Raises
        ------
        BadInput : as `laboratory`.
        """
        needed = frozenset(one.named.id for one in effects if FAMILIES[one.named.family].stage == OPENED)
        if needed not in self._opened:
            carried, model, of = self.carried, self.model, laboratory(self.model, self.campaign, effects)
            carries = carried.moving.mass_matrix + carried.standing.rigid
            square = np.linalg.eigvals(of.springs.compliance({}) @ carries).real.max()  # 1 / omega² of what swings on the cells
            if LOSES * square * (2 * np.pi * self.measured.frequency[-1]) ** 2 > FLOOR:
                of = laboratory(replace(model, opened={LOSS: LOSES, **model.opened}), self.campaign, effects)
            structural = () if carried.nuisances is None else carried.nuisances.parameters
            unread = {k for k, name in enumerate(of.names) if not is_read(name)}
            # What nobody recorded moves a mode by the participation that is computed: were that free as well, the motion of every
            # line would fit the noise of the readings by it
            unknown = {name.removeprefix(UNMEASURED) for name in of.names if not is_read(name)}
            own = [
                *(one for one in structural if one.family != "participation" or one.name.rpartition(":")[2] not in unknown),
                *(() if carried.exact else dynamic_mass.parameters(carried.moving, model.fmd_tolerance)),
                *carried.mounted,
                *(one for one, _, _ in shares(self, self.measured.frequency[:1])),
            ]
            for one in of.parameters:  # what is offset by its logarithm is 1 + its relative change there
                if one.channels and unread.issuperset(one.channels):
                    continue  # of no pick-up, nor of a board that has none
                standing, (_, name, word) = carried.standing, f"{one.name}::".split(":")[:3]
                if standing.reduced is not None and name in standing.sensors:  # it cannot leave what it sits on
                    way = standing.pose.rotation.T @ AXES.get(word, (0.0, 0.0, 0.0))
                    one = prediction_effects.limited(one, standing.reduced.structure, standing.sensors[name], way)
                own.append(replace(one, channels=(), kind=KINDS.get(one.family, problem.SENSOR)))
            # Without load cells nobody reads by what an FMD could be identified: it is what is declared of it
            known = [family for family, kind in KINDS.items() if kind == problem.DECLARED]
            declared = {*known} if of.forces.columns else {*KINDS, dynamic_mass.FMD}
            for k, one in enumerate(own):
                if one.family in declared:
                    own[k] = replace(one, kind=problem.DECLARED, within=problem.WITHIN * one.tolerance)
            self._opened[needed] = of, own if model.learnt is None else [model.learnt.known(one) for one in own]
        return self._opened[needed]

    def on(self, runs: Sequence[str]) -> "TestedCampaign":
        """Of the runs named alone."""
        kept = [k for k, run in enumerate(self.measured.runs) if run in runs]
        chosen = tuple(self.drives[k] for k in kept)
        return replace(self, measured=self.measured.on(runs), drives=chosen, per_rms=self.per_rms[kept])


@dataclass(frozen=True, eq=False, kw_only=True)
class SeriesPrediction:
    """A model of one campaign of a series: a `validation.estimation.problem.Prediction`.

    Attributes
    ----------
    tested : the campaign
    effects : of the model, in the order in which they act; those that reach nothing here do nothing here
    """

    tested: TestedCampaign
    effects: tuple[Added, ...] = ()

    @property
    def measured(self) -> problem.Measured:
        """The data."""
        return self.tested.measured

    @property
    def there(self) -> There:
        """What effects can act on."""
        read = tuple(filter(is_read, self.measured.channels))
        return replace(self.tested.carried.standing.there, channels=read)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was assumed, and which lines were left out."""
        of = self.tested
        standing = of.carried.standing
        return (
            *of.campaign.warnings,
            *of.remarks,
            *standing.remarks,
            *((prediction_effects.ASSUMED,) if standing.assumed else ()),
        )

    @property
    def structure(self) -> prediction_effects.Nuisances | None:
        """What stands on the cover plate, before any effect."""
        return self.tested.carried.nuisances

    @property
    def parameters(self) -> tuple[problem.Parameter, ...]:
        """All that may move here: of the structure, the FMD, the chain, and the effects."""
        return self._opened[0]

    def on(self, runs: Sequence[str]) -> "SeriesPrediction":
        """The same model of the runs named alone."""
        some = replace(self, tested=self.tested.on(runs))
        vars(some).update({name: getattr(self, name) for name in OF_CHANNELS})
        return some

    def with_effects(self, effects: Sequence[Added]) -> "SeriesPrediction":
        """The same campaign by a model with these `effects` instead of its own."""
        return replace(self, effects=tuple(effects))

    def dynamic_mass(self, offsets: problem.Offsets, lines: problem.Lines | None = None) -> ComplexArray:
        """(n, 6, 6) about F of all that the cells carry, at `offsets` and the lines with these indices; all by default.

        Of a structure that answers to the amplitude, that of the first run.
        """
        chosen = self._lines(lines)
        return self._carried(self._at(offsets), chosen, self._variants[0][0], derivatives=False)[0][:, :6]

    def by_load(self, offsets: problem.Offsets, lines: problem.Lines | None = None) -> ComplexArray:
        """(n, c, 6) what the channels read for a unit of every load on the cells, at `offsets`; all lines by default."""
        frequency, at = self._lines(lines), self._at(offsets)
        theta = np.array([at.get(one.name, 0.0) for one in self._chain.parameters])
        rows = self._chain.rows(theta, frequency)[1][:, :, :6]
        still = np.zeros((len(frequency), len(self._chain.names)))
        reading = ChannelResponse(frequency=frequency, channels=self._chain.names, rows=rows, amplitude=still)
        return self._written(reading, {}, prediction_effects.at(self._reaching, at))[0].rows

    def moved(self, offsets: problem.Offsets, lines: problem.Lines | None = None) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """By place of the article (n, 3, 6) its accelerations along the axes of F for a unit of every motion of F; and the same
        beyond those of a rigid article."""
        at = self._at(offsets)
        return self.tested.carried.moved(at, prediction_effects.at(self._reaching, at), self._lines(lines))

    def by(self, structure: prediction_effects.Nuisances) -> "SeriesPrediction":
        """The same data by another model of the structure."""
        made, carried = structure.reduced, self.tested.carried
        standing = carried.standing if made is None else replace(carried.standing, matrices=made.matrices, reduced=made)
        other = replace(carried, nuisances=structure, standing=standing)
        return replace(self, tested=replace(self.tested, carried=other))

    def attached(self, offsets: problem.Offsets, lines: problem.Lines, rows: Array, inputs: ComplexArray) -> AttachedResponse:
        """What a mass at places would change, to first order, as `validation.prediction.structure_tests.OnNodes` has it."""
        f, at = self._lines(lines), self._at(offsets)
        effects = tuple(replace(one, fixed=True) for one in prediction_effects.at(self._reaching, at))
        carried, names = self.tested.carried, [one.name for one in self._chain.article.channels]
        theta = np.array([at.get(one.name, 0.0) for one in self._chain.parameters])
        A0, A1 = self._chain.rows(theta, f)
        solved = carried.solved(at, effects, f, derivatives=False)
        assert solved is not None  # what has nodes stands there
        made = np.empty((len(inputs), len(f), A1.shape[1], 3 * len(rows)), dtype=np.complex128)
        for drive, runs in self._variants:
            some = list(runs)
            made[some] = carried.attached(solved, at, effects, drive, names, rows.reshape(3 * len(rows), -1), A1, inputs[some])
            if not prediction_effects.channels_pass(effects):
                H = self._carried(at, f, drive, derivatives=False, solved=solved)[0]
                reading = self._reading(f, A0 + A1 @ H, drive)
                for run in some:
                    made[run] = prediction_effects.channels(reading, {"": made[run]}, effects)[1][""]
        spring = np.broadcast_to(-1 / (2 * np.pi * f) ** 2, made.shape[:2]).astype(np.complex128)
        return AttachedResponse(readings=made.reshape(*made.shape[:3], len(rows), 3), spring=spring)

    def finite(self, offsets: problem.Offsets, lines: problem.Lines) -> Finite:
        """What is read with a mass or a spring of any size at a place."""
        f, at = self._lines(lines), self._at(offsets)
        effects = prediction_effects.at(self._reaching, at)
        solved = self.tested.carried.solved(at, effects, f, derivatives=False)
        assert solved is not None  # what has nodes stands there
        loaded = self.tested.carried.loaded(solved)

        def of_place(row: Array) -> Callable[[Array, Array], ComplexArray]:
            made = loaded(row)

            def read(mass: Array, spring: Array) -> ComplexArray:
                with np.errstate(divide="raise", over="raise", invalid="raise"):  # as of `at`
                    there = made(mass, spring)
                    rows = [self._read(at, f, drive, derivatives=False, solved=there).rows for drive, _ in self._variants]
                return rows[0] if len(rows) == 1 else np.stack([rows[k] for k in self._order])

            return read

        return of_place

    def at(
        self, offsets: problem.Offsets, lines: problem.Lines | None = None, *, derivatives: problem.Wanted = True
    ) -> problem.Predicted:
        """As of any prediction."""
        with np.errstate(divide="raise", over="raise", invalid="raise"):  # a breakdown is an error, and no warning on a terminal
            return self._predicted(offsets, lines, derivatives=derivatives)

    def _predicted(
        self, offsets: problem.Offsets, lines: problem.Lines | None, *, derivatives: problem.Wanted
    ) -> problem.Predicted:
        frequency, at = self._lines(lines), self._at(offsets)
        found = [self._read(at, frequency, drive, derivatives=derivatives) for drive, _ in self._variants]
        noise = self._noise(at, lines, frequency)
        if len(found) == 1:
            return problem.Predicted(rows=found[0].rows, changes=found[0].changes, noise=noise)
        order, changes = self._order, {}
        for name in dict.fromkeys(name for one in found for name in one.changes):
            of = [one.changes[name] for one in found]
            channels = tuple(sorted({k for one in of for k in one.channels}))
            changes[name] = problem.Change(channels=channels, rows=np.stack([_on(of[k], channels) for k in order]))
        return problem.Predicted(rows=np.stack([found[k].rows for k in order]), changes=changes, noise=noise)

    @cached_property
    def _reaching(self) -> tuple[Added, ...]:
        """The effects that reach this campaign."""
        return tuple(one for one in self.effects if acts(one.named, self.there))

    @cached_property
    def _chain(self) -> Chain:
        return self.tested.opened(self._reaching)[0]

    @cached_property
    def _opened(self) -> tuple[tuple[problem.Parameter, ...], problem.Offsets]:
        """The parameters, and the offsets of those that stand at a given size."""
        left, given = prediction_effects.opened(self.tested.opened(self._reaching)[1], self._reaching)
        equations = [one for one in self._reaching if _stage(one) in EQUATIONS]
        return (*left, *prediction_effects.parameters(equations, self.structure)), given

    @cached_property
    def _variants(self) -> tuple[tuple[BaseDrive, tuple[int, ...]], ...]:
        """Runs that are read alike: all of them, unless an effect asks how they were driven."""
        drives, families = self.tested.drives, [FAMILIES[one.named.family] for one in self._reaching]
        sides, stages = (AMPLITUDE, PROCESSING), (BODY_STAGE, CHANNEL_STAGE)
        if not any(one.side in sides and one.stage in stages for one in families):
            return ((BaseDrive(), tuple(range(len(drives)))),)
        return tuple((drive, (k,)) for k, drive in enumerate(drives))

    @cached_property
    def _order(self) -> Integers:
        """(r,) which of `_variants` each run is read by."""
        order = np.zeros(len(self.measured.runs), dtype=np.int64)
        for k, (_, runs) in enumerate(self._variants):
            order[list(runs)] = k
        return order

    def _lines(self, lines: problem.Lines | None) -> Array:
        return self.measured.frequency if lines is None else self.measured.frequency[lines]

    def _at(self, offsets: problem.Offsets) -> problem.Offsets:
        at, learnt = {**offsets, **self._opened[1]}, self.tested.model.learnt
        return at if learnt is None else learnt.at(at, [*at, *(one.name for one in self._opened[0])])

    def _aimed(self, at: problem.Offsets) -> dict[str, Array]:
        """By accelerometer on the article the unit vector (3,) along which it reads."""
        return self._chain.article.directions({one.name: at.get(one.name, 0.0) for one in self._chain.parameters})

    def _carried(
        self,
        at: problem.Offsets,
        frequency: Array,
        drive: BaseDrive,
        *,
        derivatives: problem.Wanted,
        solved: SolvedStructure | None = None,
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """Loads on the cells, behind them what the article bends at its accelerometers, (n, 6 + 3 a, 6), and how they change, the
        latter along what they read alone, (n, 6 + a, 6). `solved` is the structure there, where it is no longer that of effects.
        """
        effects, every, sensors = prediction_effects.at(self._reaching, at), self.measured.frequency, self._aimed(at)
        carried, families = self.tested.carried, [FAMILIES[one.named.family] for one in effects]
        # Where what an effect does at a line depends on the lines beside it, it must see all of them
        if solved is not None or sensors or not any(one.side == PROCESSING and one.stage == BODY_STAGE for one in families):
            return carried.at(at, effects, frequency, drive, derivatives=derivatives, solved=solved, sensors=sensors)
        H, changes = carried.at(at, effects, every, drive, derivatives=derivatives)
        chosen = np.searchsorted(every, frequency)
        return H[chosen], {name: change[chosen] for name, change in changes.items()}

    def _read(
        self,
        at: problem.Offsets,
        frequency: Array,
        drive: BaseDrive,
        *,
        derivatives: problem.Wanted,
        solved: SolvedStructure | None = None,
    ) -> problem.Predicted:
        """What the channels read of runs that were driven by `drive`; `solved` as of `_carried`."""
        H, structural = self._carried(at, frequency, drive, derivatives=derivatives, solved=solved)
        theta = np.array([at.get(one.name, 0.0) for one in self._chain.parameters])
        A0, A1 = self._chain.rows(theta, frequency)
        changes: dict[str, problem.Change | problem.Conveyed] = {}
        rows, of = A0 + A1 @ H, self._chain
        unknown = [k for k, axis in enumerate(MOTIONS) if UNMEASURED + axis in of.names]
        nominal = np.where([one.family in UNTOLD for one in of.parameters], 0.0, theta)
        if unknown:
            rows[:, :, unknown] += (of.rows(nominal, frequency)[0] - A0)[:, :, unknown]
        if derivatives:
            loaded = tuple(int(k) for k in np.flatnonzero(np.any(A1 != 0, axis=(0, 2))))
            along = np.array([*self._aimed(at).values()]).reshape(-1, 3)
            every = np.concatenate([A1[:, :, :6], np.sum(A1[:, :, 6:].reshape(*A1.shape[:2], -1, 3) * along, axis=-1)], axis=2)
            through = every[:, loaded]
            beside = {name: structural.pop(name) for name in [*structural] if name.startswith(UNTOLD[1])}
            changes = {name: problem.Conveyed(channels=loaded, through=through, quantities=dH) for name, dH in structural.items()}
            names = [one.name for one in of.parameters if problem.is_wanted(one.name, derivatives)]
            made = of.derivatives(theta, frequency, H, names)
            still = [of.derivatives(x, frequency, 0 * H, names) if unknown else made for x in (theta, nominal)]
            for name, derivative, here, there in zip(names, made, *still, strict=True):
                own = np.array(derivative.rows)
                own[:, :, unknown] += ((name.partition(":")[0] not in UNTOLD) * there.rows - here.rows)[:, :, unknown]
                if name in beside:  # it sits where the article bends otherwise, too
                    own += every[:, list(derivative.channels)] @ beside[name]
                changes[name] = problem.Change(channels=derivative.channels, rows=own)
        for one, column, change in shares(self.tested, frequency):
            rows[:, column] += at.get(one.name, 0.0) * change
            if problem.is_wanted(one.name, derivatives):
                changes[one.name] = problem.Change(channels=(column,), rows=change[:, None])
        effects = prediction_effects.at(self._reaching, at)
        reading, changes = self._written(self._reading(frequency, rows, drive), changes, effects)
        for name in self._opened[1]:
            changes.pop(name, None)
        return problem.Predicted(rows=reading.rows, changes=changes)

    def _reading(self, frequency: Array, rows: ComplexArray, drive: BaseDrive) -> ChannelResponse:
        """What the channels read, before anything happens to it."""
        return ChannelResponse(
            frequency=frequency,
            channels=self._chain.names,
            rows=rows,
            amplitude=np.abs(rows @ drive.amplitude),
            peak=np.abs(rows @ drive.nominal).max(axis=0, initial=0.0),
        )

    def _written(
        self, reading: ChannelResponse, changes: dict[str, problem.Change | problem.Conveyed], effects: Sequence[Added]
    ) -> tuple[ChannelResponse, dict[str, problem.Change | problem.Conveyed]]:
        """What the file holds of what the channels read."""
        if prediction_effects.channels_pass(effects):
            written, own = prediction_effects.channels(reading, {}, effects)
            return written, {**changes, **{name: _changing(rows) for name, rows in own.items()}}
        every = tuple(range(len(reading.channels)))
        tangents = {name: _on(change, every) for name, change in changes.items()}
        written, tangents = prediction_effects.channels(reading, tangents, effects)
        return written, {name: _changing(rows) for name, rows in tangents.items()}

    def _noise(self, at: problem.Offsets, lines: problem.Lines | None, frequency: Array) -> Array | None:
        """(r, n, c) where an effect on it acts."""
        effects, of = [one for one in prediction_effects.at(self._reaching, at) if _stage(one) == NOISE_STAGE], self.measured
        if not effects:
            return None
        chosen = of.noise if lines is None else of.noise[:, lines]
        quantities = tuple(self.tested.campaign.table.channels[k].quantity for k in self._chain.columns)
        from validation.virtual_test.plan import MAINS

        # (n, c) what the mains' ordinary hum leaves at the lines of a full record; empty of other spectra, where it is not known
        ordinary = np.array([MAINS.get(quantity, 0.0) for quantity in quantities])
        hum = np.outer(leak(frequency), ordinary) if self.tested.method == "full-record" else np.zeros((0, 0))
        found = []
        for deviation, per_rms in zip(chosen, self.tested.per_rms, strict=True):
            floor = NoiseModel(
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


def supported_dynamic_mass(model: Model, campaign: Campaign, stands: MountedArticle, name: str) -> SupportedDynamicMass:
    """What the cells carry in `campaign`, the data set `name`, in which `stands` stands on the cover plate."""
    of_structure = None
    if stands.matrices is not None:
        of_structure = prediction_effects.nuisances(
            campaign.article,
            stands.matrices,
            stands.frequency,
            stands.losses,
            model.structure,
            highest=stands.highest,
            part_tolerances=stands.part_tolerances,
            weighed=model.mounting.inertia,
            assumed=stands.assumed,
            reduced=stands.reduced,
        )
    return SupportedDynamicMass(
        standing=stands,
        moving=moving_part(model),
        exact=model.fmd_tolerance == 0 or not on_fmd(campaign),
        nuisances=of_structure,
        mounted=dynamic_mass.Seated.parameters(name, stands, model.mounting),
    )


def _on(change: problem.Change | problem.Conveyed, channels: tuple[int, ...]) -> ComplexArray:
    """Its rows (n, len(channels), k), zeros where it changes nothing."""
    own = change.rows
    rows = np.zeros((len(own), len(channels), own.shape[-1]), dtype=np.complex128)
    rows[:, [channels.index(k) for k in change.channels]] = own
    return rows


def _changing(rows: ComplexArray) -> problem.Change:
    """A change of the rows (n, c, k) of all channels as one of those that do change."""
    channels = tuple(int(k) for k in np.flatnonzero(np.any(rows != 0, axis=(0, 2))))
    return problem.Change(channels=channels, rows=rows[:, channels])


def _stage(added: Added) -> str:
    return FAMILIES[added.named.family].stage
