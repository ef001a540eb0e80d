"""`simulate`: a `Plan` becomes a `Campaign`, and the truth behind it.

    drawn chain and FMD -> rig -> driven in time -> sensors -> delays and anti-alias filter -> noise, mains -> campaign

The chain is linear from the table to the recorder but for what an effect makes of it.
"""

import json
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from hashlib import sha256
from math import isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from fem.base_excitation import first_order_hold
from fem.base_excitation import response as recorder
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import Rig, RigStructure
from fem.damping import Damping
from geometry import atomic, toml_file
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Pose
from geometry.inertia import PARAMETERS, Inertia
from geometry.sensors import SI, Tolerances
from identification.campaign import UNITS, Campaign, Excitation, Recording, Run
from validation.effects.catalogue import Named, parse_all
from validation.effects.effect import Vocabulary, built_in_places
from validation.excite.question import LARGEST_LEVEL, drive, require_rate
from validation.output import json_text
from validation.reference import reference
from validation.virtual_test import plan as planning
from validation.virtual_test.layout import ACCELEROMETERS, CELLS, FORCES, ChainTruth, Layout, mavis, stream, token
from validation.virtual_test.plan import MAINS as PLAN_MAINS
from validation.virtual_test.planted import planted, reaching, require_planted, require_reaching
from validation.virtual_test.shaker import Sensors, SetUp, accelerometers, middles_of_cells, nominal_fmd, require_stack, set_up

if TYPE_CHECKING:
    from fem.base_excitation.patterns import CrossMotion, Pattern


# `Laboratory`: what a plan puts on the shaker - nominal layout, drawn chain and rig, effects in both.


@dataclass(frozen=True, eq=False, kw_only=True)
class ShakerLaboratory:
    """What is on the shaker.

    Attributes
    ----------
    layout : channels as the file states them
    chain : as it is
    made : what stands on the table before effects change it
    rig : what is driven
    sensors : of `chain`
    """

    layout: Layout
    chain: ChainTruth
    made: SetUp
    rig: Rig
    sensors: Sensors


def laboratory(plan: planning.Plan) -> ShakerLaboratory:
    """What `plan` has on the shaker.

    Raises
    ------
    BadInput : an article that does not stand on the FMD or cannot be built; an effect at a place or part that it has not.
    """
    require_stack(plan.article)
    require_planted(plan)
    layout = mavis(middles_of_cells(plan), plan.noise_rms, accelerometers(plan))
    chain = plan.drawn_chain(layout)
    for effect in plan.effects:
        chain = effect.chain(chain)
    made = set_up(plan, chain)
    rig = planning.changed_rig(made.rig, plan.effects)
    return ShakerLaboratory(layout=layout, chain=chain, made=made, rig=rig, sensors=Sensors.of(layout, chain, plan.gravity))


# The runs of a plan: what is driven in each, by which name, and how the campaign file states it.


DIAGONALS = (("x", "y"), ("y", "z"), ("z", "x"), ("alpha", "beta"), ("beta", "gamma"), ("gamma", "alpha"))
"""Axes that are driven together, in phase, each at 1 / sqrt(2) of its level."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrivenRun:
    """One run before it is driven.

    Attributes
    ----------
    name : unique in the campaign
    axis : of `MOTIONS`; empty where several are driven
    pattern : what the table is driven with
    excitation : the same as the campaign file states it
    level : factor on the nominal one
    """

    name: str
    axis: str
    pattern: "Pattern"
    excitation: Excitation
    level: float = 1.0

    def motion(self, plan: planning.Plan, rate: float, rest: float) -> BaseMotion:
        """What the table does, sampled at `rate` [Hz], with `rest` [s] after the drive."""
        cross = cross_motion(plan, self.name)
        found: BaseMotion = self.pattern.motion(rate, ring_down=rest, cross=cross)  # type: ignore[attr-defined]
        return found


def runs(plan: planning.Plan) -> tuple[DrivenRun, ...]:
    """All runs of `plan`, level by level.

    Raises
    ------
    BadInput : a band or a rate that no sweep can have.
    """
    from fem.base_excitation.patterns import MultiAxis, Sweep, phased_sweeps

    swept = {"start": plan.band[0], "stop": plan.band[1], "rate": plan.octaves_per_minute, "delay": plan.quiet}

    def of_one(level: float, ending: str = "", phase: float = 0.0) -> list[DrivenRun]:
        sweeps = [Sweep(axis=axis, level=level, phase=phase, **swept) for axis in MOTIONS if plan.axis in ("", axis)]
        stated = [_stated("sine-sweep", plan, level=sweep.amplitude) for sweep in sweeps]
        return [
            DrivenRun(name=f"{one.axis}{ending}", axis=one.axis, pattern=one, excitation=said)
            for one, said in zip(sweeps, stated, strict=True)
        ]

    def of_several(name: str, pattern: "Pattern", sweeps: Sequence[Any]) -> DrivenRun:
        driven: dict[str, Sweep] = {sweep.axis: sweep for sweep in sweeps}
        levels = tuple(float(driven[axis].level * LEVELS[axis]) if axis in driven else 0.0 for axis in MOTIONS)
        return DrivenRun(name=name, axis="", pattern=pattern, excitation=_stated("multi-axis", plan, levels=levels))

    found: list[DrivenRun] = []
    for level in plan.levels:
        if plan.pattern == planning.MULTI:
            phased = phased_sweeps(level, **swept)
            of_level = [of_several(f"multi-{k}", one, one.patterns) for k, one in enumerate(phased, start=1)]
        else:
            of_level = of_one(level)
        if plan.pattern == planning.TWICE:
            of_level += of_one(level, "-2", np.pi / 2)
        if plan.pattern == planning.DIAGONAL:
            for axes in DIAGONALS:
                sweeps = tuple(Sweep(axis=axis, level=level / np.sqrt(2), **swept) for axis in axes)
                of_level.append(of_several("-".join(axes), MultiAxis(patterns=sweeps), sweeps))
        ending = "" if level == plan.levels[0] else f"-at-{level:g}"
        found += [replace(run, name=f"{run.name}{ending}", level=level) for run in of_level]
    return tuple(found)


def cross_motion(plan: planning.Plan, run: str) -> "CrossMotion | None":
    """What the table does besides in `run`; None for a table that does nothing else."""
    from fem.base_excitation.patterns import drawn

    return drawn(stream(plan.seed, "cross-motion", plan.article, run), plan.cross) if plan.cross else None


def _stated(kind: str, plan: planning.Plan, **more: float | tuple[float, ...]) -> Excitation:
    start, stop = plan.band
    figures = {"start_hz": start, "stop_hz": stop, "octaves_per_minute": plan.octaves_per_minute, **more}
    return Excitation(kind=kind, figures=figures)


# One run: the rig driven, read by the sensors, delayed, filtered and brought down to the rate of the record.
#
# All of it goes block by block, so that the memory of a run is that of its record. Only an effect on the signals of the
# simulation needs them whole: then table, cover plate and cells are kept as well, for the effect to look at.


WIDTHS = (6, 6, 3 * CELLS)
"""Signals of load, cover plate and cells."""


def record(plan: planning.Plan, lab: ShakerLaboratory, run: DrivenRun) -> Array:
    """What the recorder gets of `run`, (m, c) at the rate of the record, without noise.

    Raises
    ------
    BadInput, CheckFailed : as `fem.base_excitation.response.streamed`.
    """
    if not lab.rig.linear or any(effect.signals is not planning.same for effect in plan.effects):
        read = _whole(plan, lab, run)
        for effect in plan.effects:
            read = effect.signals(read)
        return recorder.decimated_channels(read.values, read.sampling_rate, plan.rate, lab.sensors.delay)
    rate = _rate(plan)
    late, more = lab.sensors.delay * rate, _driven(plan, run)
    return recorder.recorded(lab.rig, run.pattern, rate, lab.sensors.channels, plan.rate, late, **more)


def _whole(plan: planning.Plan, lab: ShakerLaboratory, run: DrivenRun) -> planning.Sensed:
    """What all sensors read in `run` at the rate of the simulation, and what there was to read.

    A rig that is not linear - a cell that lifts off, a loose part that slips - is integrated by exudyn, whole, which costs twenty
    times and more what the recursion does. The sensors read the same signals with the same rows. The tilt of the cover plate,
    which counts only where one half of gravity is off, is then taken to be that of the table: cells let the two differ by
    microradians.
    """
    rate = _rate(plan)
    if not lab.rig.linear and plan.on_article:
        problem = "accelerometers on the article are read of what is linear, and an effect here is not"
        raise BadInput("--response", "", problem, "Leave them out")
    if not lab.rig.linear:
        from fem.base_excitation import response as ring_down
        from fem.exudyn import driven_run

        at_rest = run.motion(plan, rate, 0.0)
        length = ring_down.needed(lab.rig, at_rest, plan.ringing)
        motion = run.motion(plan, rate, length - at_rest.driven + plan.quiet)
        response = driven_run.respond(lab.rig, motion)
        tilt = motion.displacement[:, 3:5]
        signals = [response.table, response.cover, response.cells.reshape(len(response.table), -1), tilt, tilt]
        return sensed(plan, lab.layout, run, np.hstack(signals) @ lab.sensors.rows.T, rate, response)

    def wanted(structure: RigStructure) -> first_order_hold.Channels:
        cover = first_order_hold.accelerations(structure.cover, "the cover plate")
        parts = [
            lab.sensors.channels(structure),
            first_order_hold.load(structure),
            cover,
            first_order_hold.cell_forces(structure),
        ]
        return first_order_hold.stacked(parts)

    pieces = recorder.streamed(lab.rig, run.pattern, rate, wanted, **_driven(plan, run))
    table, every = (np.hstack(one).T for one in zip(*((piece.acceleration, piece.values) for piece in pieces), strict=True))
    values, loads, cover, cells = np.split(every, np.cumsum([len(lab.sensors.rows), *WIDTHS])[:-1], axis=1)
    response = recorder.Response(
        sampling_rate=rate, table=table, cover=cover, load=loads, cells=cells.reshape(len(cells), CELLS, 3)
    )
    return sensed(plan, lab.layout, run, values, rate, response)


def sensed(
    plan: planning.Plan, layout: Layout, run: DrivenRun, values: Array, rate: float, response: recorder.Response | None = None
) -> planning.Sensed:
    """`values` (n, c) of `run` as effects get them."""
    what = "record" if response is None else "signals"
    return planning.Sensed(
        values=values,
        table=layout.table,
        sampling_rate=rate,
        run=run.name,
        level=run.level,
        response=response,
        generator=stream(plan.seed, "effects", plan.article, run.name, what),
    )


def _driven(plan: planning.Plan, run: DrivenRun) -> dict[str, Any]:
    """How the table goes beside `run`, and how long the record goes on."""
    return {"cross": cross_motion(plan, run.name), "quiet": plan.quiet, "share": plan.ringing}


def _rate(plan: planning.Plan) -> float:
    return recorder.simulation_rate(plan.rate, plan.simulation_rate)


# What a recorder adds: noise of every channel and the mains' hum, at the rate of the record.


MAINS = 50.0
"""[Hz]."""

DRIFT = 0.02
"""[Hz] by which the mains' frequency differs from run to run, standard deviation."""

HARMONICS = {1: 1.0, 3: 0.3, 5: 0.1}
"""Amplitude of each harmonic over that of the fundamental."""


Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; it may raise to end the work."""

LARGEST_OF_CROSS = 3.0
"""[factor] on the average cross motion of a table that a campaign of a single-axis shaker states: twice that, times the square
root of 2 away from the middle frequency, is the largest that `fem.base_excitation.patterns.drawn` draws."""


@dataclass(frozen=True, eq=False, kw_only=True)
class VirtualTest:
    """A campaign and what nobody would know of a real one; `truth` holds JSON values only."""

    campaign: Campaign
    truth: Mapping[str, object]


def simulate(plan: planning.Plan, progress: Progress | None = None) -> VirtualTest:
    """The virtual test of `plan`.

    Raises
    ------
    BadInput : an article that does not stand on the FMD or cannot be built, a band, rate or cross motion that cannot be, an
        effect of the catalogue that cannot act here.
    CheckFailed : something on the table swings freely.
    """
    recorder.require_recorded(max(run.pattern.highest for run in runs(plan)), plan.rate, planning.SOURCE)
    lab = laboratory(plan)
    mounting = Pose(position=lab.made.rig.seat) if plan.on_fmd else None
    campaign = recorded(plan, lab.layout, lab.chain, partial(record, plan, lab), mounting, progress)
    return VirtualTest(campaign=campaign, truth=truth(plan, lab.chain, lab.made, lab.rig))


def recorded(
    plan: planning.Plan,
    layout: Layout,
    chain: ChainTruth,
    of: Callable[[DrivenRun], Array],
    mounting: Pose | None,
    progress: Progress | None = None,
) -> Campaign:
    """The campaign of all runs of `plan`, of which the recorder gets what `of` says, without noise."""
    driven, recordings = runs(plan), {}
    for k, run in enumerate(driven):
        recordings[run.name] = recording(plan, layout, chain, run, of(run))
        if progress is not None:
            progress((k + 1) / len(driven))
    table = layout.table
    if plan.axis:
        kept = [k for k, name in enumerate(table.names) if plan.is_read(name)]
        table = replace(table, channels=tuple(table.channels[k] for k in kept))
        recordings = {
            name: replace(one, names=table.names, values=np.asarray(one.values)[:, kept]) for name, one in recordings.items()
        }
    return Campaign(
        title=f"Virtual test of {plan.article}",
        article=plan.article,
        hardware=f"fmd-{token(plan.seed, 'fmd')}/sensors-{token(plan.seed, 'sensors')}",
        notes=f"virtual test, {len(driven)} runs",
        table=table,
        cross_motion=LARGEST_OF_CROSS * plan.cross if plan.axis else 0.0,
        runs=tuple(Run(name=run.name, file=f"{run.name}.h5", axis=run.axis, excitation=run.excitation) for run in driven),
        recordings=recordings,
        mounting=mounting,
        gravity=plan.gravity,
        source=planning.SOURCE,
    )


def recording(plan: planning.Plan, layout: Layout, chain: ChainTruth, run: DrivenRun, values: Array) -> Recording:
    """What the recorder that gets `values` (m, c) holds after `run`, noise and hum in it."""
    names = layout.table.names
    time = np.arange(len(values)) / plan.rate
    hum = stream(plan.seed, "mains", plan.article, run.name)
    # (h, m) rotating phasors of unit mains and its harmonics; zero for those that the record cannot hold
    frequency = MAINS + DRIFT * hum.standard_normal()
    phasor = np.exp(2j * np.pi * frequency * time)
    held = {order: share if order * frequency < plan.rate / 2 else 0.0 for order, share in HARMONICS.items()}
    waves = np.array([share * phasor**order for order, share in held.items()])
    phases = np.exp(1j * hum.uniform(0.0, 2 * np.pi, (len(names), len(HARMONICS))))
    mains = np.array([chain.mains.get(name, 0.0) for name in names])
    samples = np.asarray(values.T + (mains[:, None] * phases @ waves).imag).T
    for k, name in enumerate(names):
        if rms := chain.noise_rms.get(name, 0.0):
            samples[:, k] += rms * stream(plan.seed, "noise", plan.article, run.name, name).standard_normal(len(time))
    got = sensed(plan, layout, run, samples, plan.rate)
    for effect in plan.effects:
        got = effect.record(got)
    return Recording(names=names, values=got.values, sampling_rate=plan.rate, source=run.name)


# The truth of a virtual test as JSON values: every figure that was drawn, under its id of the catalogue, and what follows.


FORMAT = 1

LINES = (4.0, 8.0, 12.0, 16.0, 24.0, 32.0)
"""[Hz] at which the dynamic mass is stated."""

SWINGING = ("appendage", "absorber", "slosh")
"""Families of effects that belong to no rigid body."""

Json = dict[str, object]


def truth(plan: planning.Plan, chain: ChainTruth, made: SetUp, rig: Rig) -> Json:
    """Everything about the virtual test of `plan`; `rig` is the one that was driven."""
    from importlib.metadata import version

    from fem.base_excitation import rig as body

    # Inertia of what stands on the FMD about its own origin
    # The rig with all effects but those that swing on a spring of their own: some weigh along one axis only, as no body does
    without_resonators = planning.changed_rig(
        made.rig, [effect for effect in plan.effects if effect.id.partition(":")[0] not in SWINGING]
    )
    article = Inertia.from_mass_matrix(without_resonators.article.reduced.mass[:6, :6])
    # How the FMD's moving part differs from its drawing: relative, the centre of gravity in metres
    cover = Inertia(parameters=np.zeros(10)) if rig.cover is None else rig.cover
    found, nominal = (
        cover if plan.on_fmd else cover.scaled(2.0),
        nominal_fmd(plan),
    )  # one half of a bare FMD stands for the article
    relative = {
        "mass": found.mass / nominal.mass - 1,
        "cog_m": listed(found.cog - nominal.cog),
        "moi_cog": listed(found.moments_cog / nominal.moments_cog - 1),
    }
    if made.modes is None:
        modes: Json = {"frequency_hz": [], "damping_ratio": []}
    else:
        modes = {"frequency_hz": listed(made.modes.frequency), "damping_ratio": listed(made.modes.damping_ratio)}
    parts: dict[str, float] = {}
    for name, part in made.parts.items():
        parts |= {f"modulus:{name}": part.modulus, f"loss:{name}": part.loss}
    # Of all that the cells carry, about F: on a rigid table in their place, and without what is loose
    H = body.dynamic_mass(replace(rig, cells=(), frictions=()), LINES).matrix
    names = ("massline", "numpy", "scipy")
    versions = {"python": platform.python_version(), **{name: version(name) for name in names}}
    return {
        "format": FORMAT,
        "seed": plan.seed,
        "plan": {
            **{name: getattr(plan, name) for name in ("article", "model", "pattern")},
            "levels": list(plan.levels),
            "band_hz": list(plan.band),
            "octaves_per_minute": plan.octaves_per_minute,
            "cross": plan.cross,
            **({"axis": plan.axis} if plan.axis else {}),
            "noise_rms": dict(plan.noise_rms),
            "mains": dict(plan.mains),
            "rate_hz": plan.rate,
            "simulation_rate_hz": plan.simulation_rate,
            "quiet_s": plan.quiet,
            "ringing": plan.ringing,
            "highest_hz": plan.highest,
            "gravity": plan.gravity,
            "dimensions": dict(plan.dimensions),
            "tolerances": asdict(plan.tolerances),
            "scatter": asdict(plan.scatter),
        },
        "effects": [{"id": effect.id, "value": dict(effect.value)} for effect in plan.effects],
        "tolerances": dict(chain.deviations()) | parts | {"fmd-inertia": relative},
        "fmd": inertia(found),
        "article": {"own_frame": inertia(article), "about_F": inertia(article.moved(rig.seat))} if plan.on_fmd else None,
        "mounting_origin_m": listed(rig.seat),
        "modes": modes,
        "cell_stiffness_N_per_m": [listed(cell.stiffness) for cell in rig.cells],
        "dynamic_mass": {
            "frequency_hz": list(LINES),
            "re": H.real.tolist(),
            "im": H.imag.tolist(),
            "about": "F",
            "order": list(MOTIONS),
        },
        "versions": dict(versions),
    }


def inertia(of: Inertia) -> Json:
    """Ten parameters about the origin of the frame, and the usual way to say them."""
    return {
        "parameters": dict(zip(PARAMETERS, listed(of.about(np.zeros(3)).parameters), strict=True)),
        "mass_kg": of.mass,
        "cog_mm": listed(1e3 * of.cog),
        "moi_cog_kgm2": listed(of.moments_cog),
        "poi_cog_kgm2": listed(of.products_cog),
        "about": "cog",
    }


def listed(values: npt.ArrayLike) -> list[float]:
    """Plain numbers."""
    return [float(value) for value in np.ravel(np.asarray(values, dtype=np.float64))]


# What `massline simulate` was asked, checked at the door: from options to plans, and to the folders that they go to.


FORMATS = ("h5", "uff", "csv", "mat")

SWEEP = "sweep"
PATTERNS = {
    SWEEP: {6: planning.SINGLE, 12: planning.TWICE},
    planning.DIAGONAL: {12: planning.DIAGONAL},
    planning.MULTI: {6: planning.MULTI},
}
"""Pattern of a plan by pattern and number of runs as they are asked for; the first number is the one that holds unasked."""

LARGEST_FACTOR = 100.0

CHANNELS = (*ACCELEROMETERS, *FORCES)

OFF = "off"


@dataclass(frozen=True, eq=False, kw_only=True)
class SimulateOptions:
    """What was asked.

    Attributes
    ----------
    plans : one a campaign
    effects : that are planted in all of them
    out : folder of the campaign, or the one above those of a series
    sealed : where the truth goes; None for beside
    ending : of the signal files
    units : of the signal files, by quantity
    """

    plans: tuple[planning.Plan, ...]
    effects: tuple[Named, ...]
    out: Path
    sealed: Path | None
    ending: str
    units: dict[str, str]

    def folder(self, plan: planning.Plan) -> Path:
        """Where the campaign of `plan` goes."""
        return self.out if len(self.plans) == 1 else self.out / plan.article

    def truth(self, plan: planning.Plan) -> Path:
        """Where its truth goes."""
        folder = self.folder(plan)
        beside = folder.parent / f"{folder.name}.truth.json"
        if self.sealed is None:
            return beside
        return self.sealed if len(self.plans) == 1 else self.sealed / beside.name


def question(
    *,
    articles: Sequence[str],
    out: Path,
    effects: Sequence[str],
    seed: int,
    levels: str,
    sealed: Path | None,
    pattern: str,
    runs: int | None,
    band: tuple[float, float],
    octaves_per_minute: float,
    cross: float,
    tolerances: str,
    noise: str,
    mains: str,
    model: str,
    damping_ratio: float | None,
    rate: float,
    form: str,
    units: Sequence[str],
    settings: Sequence[str],
    responses: Sequence[str] = (),
    axis: str = "",
) -> SimulateOptions:
    """The options of `massline simulate`, checked.

    Raises
    ------
    BadInput : one of them cannot be; what was found, and what to write.
    """
    for article in articles:
        require_stack(article)
    if twice := next((article for article in articles if list(articles).count(article) > 1), None):
        raise BadInput(f"article {twice}", "", "it is named twice", "Name each once, or change --seed and --out")
    toml_file.one_of(model, planning.MODELS, source="--model", where="")
    toml_file.one_of(form, FORMATS, source="--format", where="")
    upon = [point.replace(":", "-") for point in responses]
    words = Vocabulary(places=built_in_places())
    named = parse_all(effects, replace(words, accelerometers=(*(words.accelerometers or ()), *upon)))
    planted(named)  # whatever the articles: what no virtual test can plant is refused first
    factors = tuple(_number("--levels", part.strip(), "Write for example 1, or 1,0.5") for part in levels.split(","))
    for level in factors:
        if not 0 < level <= LARGEST_LEVEL:
            problem = f"a level must lie above 0 and up to {LARGEST_LEVEL:g}, found {level:g}"
            raise BadInput("--levels", "", problem, "1 is the nominal level, 0.5 half of it")
    if len(set(factors)) < len(factors):
        raise BadInput("--levels", "", f"one of them stands there twice, found {levels}", "Name each once")
    for level in factors:  # what a drive of `massline excite` may be, this one may be too
        drive(
            axes=(),
            every=True,
            pattern=SWEEP,
            band=band,
            octaves_per_minute=octaves_per_minute,
            level=level,
            cross=cross,
            seed=seed,
            duration=None,
            ring_down="auto",
        )
    require_rate(rate)
    try:
        recorder.require_recorded(band[1], rate, "--rate")
    except BadInput as error:
        raise BadInput("--rate", "", error.problem, "Record faster, or end lower with --band") from None
    changes = reference.read(settings)
    reference.require_used(articles, changes)
    share = factor("--tolerances", tolerances)
    plans = tuple(
        planning.Plan(
            article=article,
            seed=seed,
            model=model,
            tolerances=Tolerances().scaled(share),
            scatter=planning.Scatter().scaled(share),
            damping=None if damping_ratio is None else Damping(ratio=damping_ratio),
            pattern=_pattern(pattern, runs),
            levels=factors,
            band=band,
            octaves_per_minute=octaves_per_minute,
            cross=cross,
            noise_rms=_scaled(planning.NOISE, factor("--noise", noise)),
            mains=_scaled(PLAN_MAINS, factor("--mains", mains)),
            rate=rate,
            dimensions=changes,
            on_article=tuple(responses),
            axis=axis,
        )
        for article in articles
    )
    if axis:
        toml_file.one_of(axis, tuple(MOTIONS[:3]), source="--axis", where="")
        if pattern != SWEEP or not responses or not cross:
            wrong = "--pattern" if pattern != SWEEP else "--cross" if responses else "--response"
            problem = "a single-axis shaker sweeps, its base moves besides, and accelerometers on the article read it"
            raise BadInput(wrong, "", problem, "Write --axis z --response mast-top:z, and leave the others out")
        unread = [one for one in named for name in one.targets if name in CHANNELS and not plans[0].is_read(name)]
        for one in unread:
            problem = f"a single-axis shaker along {axis} does not read that channel"
            raise BadInput("--effect", one.id, problem, "Choose one on the article, or leave out --axis")
    for plan in plans:
        accelerometers(plan)
    require_reaching(named, plans)
    plans = tuple(replace(plan, effects=planted(reaching(named, plan))) for plan in plans)
    return SimulateOptions(plans=plans, effects=named, out=out, sealed=sealed, ending=f".{form}", units=_units(units))


def factor(option: str, text: str) -> float:
    """The factor that `text` is, 0 for off.

    Raises
    ------
    BadInput : it is none.
    """
    if text.strip() == OFF:
        return 0.0
    remedy = f"1 is the ordinary one, {OFF} is none"
    found = _number(option, text, remedy)
    if not 0 <= found <= LARGEST_FACTOR:
        raise BadInput(option, "", f"must lie between 0 and {LARGEST_FACTOR:g}, found {text}", remedy)
    return found


def _number(option: str, text: str, remedy: str) -> float:
    try:
        found = float(text)
    except ValueError:
        found = nan
    if not isfinite(found):
        raise BadInput(option, "", f"a number is expected, found {text!r}", remedy)
    return found


def _scaled(ordinary: Mapping[str, float], factor: float) -> dict[str, float]:
    return {quantity: factor * size for quantity, size in ordinary.items()}


def _pattern(pattern: str, runs: int | None) -> str:
    toml_file.one_of(pattern, PATTERNS, source="--pattern", where="")
    known = PATTERNS[pattern]
    if runs is None:
        return next(iter(known.values()))
    if runs not in known:
        problem = f"the pattern {pattern} has {' or '.join(map(str, known))} runs, found {runs}"
        others = ", ".join(f"{name} ({' or '.join(map(str, counts))})" for name, counts in PATTERNS.items())
        raise BadInput("--runs", "", problem, f"There are {others}; --levels adds runs too")
    return known[runs]


def _units(units: Sequence[str]) -> dict[str, str]:
    """The units of the files by quantity, SI where nothing is said."""
    found: dict[str, str] = {}
    quantities = {unit: quantity for quantity in ("acceleration", "force") for unit in UNITS[quantity]}
    for unit in units:
        if unit not in quantities:
            remedy = f"{toml_file.nearest(unit, quantities)}Known are {', '.join(quantities)}"
            raise BadInput("--unit", "", f"no unit of acceleration or force is called {unit!r}", remedy)
        if quantities[unit] in found:
            problem = f"{found[quantities[unit]]} and {unit} are both units of {quantities[unit]}"
            raise BadInput("--unit", "", problem, "Keep one of them")
        found[quantities[unit]] = unit
    return {**{quantity: SI[quantity] for quantity in ("acceleration", "force")}, **found}


# Where a virtual test goes: its folder and its truth, both whole or not at all, and nothing of anybody else's is replaced.
#
# The truth lists every file of its campaign with its SHA-256. A folder that its truth vouches for, file by file, can be made
# again from the seed, and may be replaced; any other is left alone.


KIND = "virtual test"
FILES = "files_sha256"


def require_free(folder: Path, truth: Path) -> None:
    """Refuse, before anything is computed, a folder or a truth that would destroy what is there.

    Raises
    ------
    BadInput : `folder` holds something else than the virtual test that `truth` vouches for; `truth` is another file, or lies in
        the folder.
    """
    if truth.resolve().is_relative_to(folder.resolve()):
        problem = f"{truth} lies in the campaign folder, which whoever is not to see the truth will read"
        raise BadInput("--sealed", "", problem, "Name a file elsewhere")
    known: dict[str, str] | None = None
    try:
        found = json.loads(truth.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        found = None
    if isinstance(found, dict) and found.get("kind") == KIND and isinstance(found.get(FILES), dict):
        known = dict(found[FILES])
    if truth.exists() and known is None:
        problem = f"{truth} is there and is no truth of a virtual test"
        raise BadInput(str(truth), "", problem, "Name another file; it is not overwritten")
    if folder.exists() and any(folder.iterdir()) and digests(folder) != known:
        problem = "it is there, and not empty, and no virtual test that its truth vouches for"
        raise BadInput(str(folder), "--out", problem, "Name a new folder, or remove this one yourself")


def require_folder(path: Path) -> None:
    """Refuse the folder in which the command runs or one around it, which cannot be replaced.

    Raises
    ------
    BadInput : `path` is such a folder.
    """
    if Path.cwd().is_relative_to(path.resolve()):
        raise BadInput(str(path), "--out", "the command runs in this folder", "Name a folder in it, such as out/campaign")


def write(folder: Path, truth: Path, content: Mapping[str, object], fill: Callable[[Path], None]) -> None:
    """Let `fill` make the new `folder`, and write its truth, `content` and the digests of its files; see `require_free`.

    Raises
    ------
    OSError : one of them cannot be written.
    """

    def both(new: Path) -> None:
        fill(new)
        stated = {"kind": KIND, **content, FILES: digests(new)}
        atomic.write_text(truth, json_text(stated) + "\n")  # before the folder is in place: no campaign is ever without its truth

    atomic.write_folder(folder, both)


def digests(folder: Path) -> dict[str, str]:
    """SHA-256 of everything in `folder` by name; a subfolder has none."""
    return {path.name: sha256(path.read_bytes()).hexdigest() if path.is_file() else "" for path in sorted(folder.iterdir())}
