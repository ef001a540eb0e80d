"""`Setup`: an article, its ropes and its recorder as somebody asks for them, before anything is simulated."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fem.exudyn.rope_pendulum import Swing, small_period, swing
from fem.exudyn.rope_statics import Suspension, hung, lying, on_three_ropes, on_two_ropes, require_positive
from fem.exudyn.run import Progress
from geometry.atomic import write_text
from geometry.errors import BadInput
from geometry.frames import Array, frozen
from geometry.inertia import Inertia
from geometry.toml_file import STANDARD_GRAVITY, string
from validation.classical import pendulum
from validation.classical.files import read
from validation.classical.pendulum import LEAST_CYCLES, LEAST_SAMPLES, Decay, rope_amplitude_factor, rope_pendulum
from validation.model.setups import is_file
from validation.reference.reference import ArticleOptions, require_use

SMALL = 1e-3
"""Radians of a twist whose own effect on the period, 7e-8 of it, is nothing."""

MOST_CYCLES = 1000
"""Cycles of a record."""

MOST_SAMPLES = 200_000
"""Samples of a record: a thousand cycles at forty times the least."""

MOST_DAMPING, DIED_AWAY = 0.1, 0.12
"""Damping ratio ζ, and ζ² times the cycles, up to which the first look at a record, its spectrum, still finds the period.
Clean decays are lost from 0.26 at 3 cycles, 0.17 at 8, 0.10 at 20, 0.04 at 100 on (measured)."""

EFFECTS = ("amplitude", "damping", "rope-mass", "rope-stretch", "off-centre", "unequal ropes")
"""What Eq. 5 leaves out, in the order in which it is shown."""

SOURCE = "swing"


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """One pendulum test.

    Attributes
    ----------
    article : name
    axis, along : of the article: upright, and on x, where two ropes are
    inertia : of the body as it hangs, about its CoG at the origin
    radii : s1 and s2 [m] as they are thought to be, for two ropes; the one radius for three
    height : [m] of the feet above the CoG
    off_centre : (2,) [m] how far the CoG really is from where it is thought to be, along the ropes' x and across
    suspension : as it really is
    gravity : [m/s²]
    cycles : recorded
    rate : [Hz] of the recorder
    noise : [rad] standard deviation of the recorder's noise
    seed : of the noise
    step : [s] of the integration; None chooses
    """

    article: str
    axis: str
    along: str
    inertia: Inertia
    radii: tuple[float, ...]
    height: float
    off_centre: tuple[float, float]
    suspension: Suspension
    gravity: float = STANDARD_GRAVITY
    cycles: float = 20.0
    rate: float = 50.0
    noise: float = 0.0
    seed: int = 0
    step: float | None = None

    @property
    def s1_s2(self) -> tuple[float, float]:
        """s1 and s2 [m] of Eq. 5."""
        return self.radii[0], self.radii[-1]

    @property
    def reference(self) -> float:
        """Moment of inertia [kg m²] about the vertical through the CoG that the simulation was made with."""
        return float(self.inertia.tensor_cog[2, 2])

    @property
    def ideal_period(self) -> float:
        """[s] that Eq. 5 gives this inertia with the lengths as they are thought to be."""
        s1, s2 = self.s1_s2
        lengths = {"mass": self.inertia.mass, "gravity": self.gravity, "s1": s1, "s2": s2, "length": self.suspension.length}
        return float(np.sqrt(self.reference / rope_pendulum(**lengths, period=1.0)))

    @property
    def effects(self) -> tuple[str, ...]:
        """Those of `EFFECTS` that are in."""
        s = self.suspension
        there = (True, s.damping_ratio > 0, s.rope_mass > 0, s.stiffness is not None, any(self.off_centre), bool(s.extra.any()))
        return tuple(name for name, here in zip(EFFECTS, there, strict=True) if here)

    def alone(self, effect: str | None) -> "Setup":
        """The same with `effect` alone, on ropes that are ideal otherwise; None leaves nothing but the ideal."""
        s = self.suspension
        fields: dict[str, dict[str, Any]] = {
            "amplitude": {"amplitude": s.amplitude},
            "damping": {"damping_ratio": s.damping_ratio},
            "rope-mass": {"rope_mass": s.rope_mass, "links": s.links},
            "rope-stretch": {"stiffness": s.stiffness},
            "unequal ropes": {"extra": s.extra},
        }
        off_centre = self.off_centre if effect == "off-centre" else (0.0, 0.0)
        ideal = {"length": s.length, "amplitude": SMALL, "start": s.start, **fields.get(effect or "", {})}
        return replace(
            self, off_centre=off_centre, suspension=suspended(self.radii, self.height, off_centre, **ideal), noise=0.0, step=None
        )


def suspended(radii: Sequence[float], height: float, off_centre: Sequence[float], **fields: Any) -> Suspension:
    """Two ropes where `radii` (2,) [m] are s1 and s2, three where it is the one radius.

    Raises
    ------
    BadInput : a size that cannot be.
    """
    make = on_two_ropes if len(radii) == 2 else on_three_ropes
    return make(*radii, height=height, off_centre=off_centre, **fields)


def require_recordable(setup: Setup) -> None:
    """Refuse what no pendulum or no recorder can do, before anything is simulated.

    Raises
    ------
    BadInput : no mass or gravity, ropes that would cross or lie flat, too few cycles or too many, too slow a recorder or too
        fast, a twist that dies away too soon, negative noise or seed.
    """
    require_positive("mass", setup.inertia.mass, "kg")
    require_positive("gravity", setup.gravity, "m/s²")
    s1, s2 = setup.s1_s2
    kappa = setup.inertia.mass * s1 * s2 / setup.reference
    rope_amplitude_factor(setup.suspension.amplitude, (max(s1, s2) / setup.suspension.length) ** 2, kappa)
    if not LEAST_CYCLES <= setup.cycles <= MOST_CYCLES:
        least, remedy = f"at least {LEAST_CYCLES} are needed for a period", "Record longer"
        if setup.cycles > MOST_CYCLES:
            least, remedy = f"at most {MOST_CYCLES} are recorded", f"Record {MOST_CYCLES} or fewer"
        raise _refused("cycles", f"{least}, found {setup.cycles:g}", remedy)
    most, ratio = min(MOST_DAMPING, np.sqrt(DIED_AWAY / setup.cycles)), setup.suspension.damping_ratio
    if ratio > most:
        left = np.exp(-2 * np.pi * ratio * LEAST_CYCLES / np.sqrt(1 - ratio**2))
        problem = f"a twist damped by {ratio:g} has {100 * left:.2g} % left after {LEAST_CYCLES} of {setup.cycles:g} cycles"
        bearable = np.floor(1000 * most) / 1000
        remedy = f"Use {bearable:g} or less; fewer cycles bear more, up to {MOST_DAMPING:g}"
        raise _refused("damping_ratio", problem, remedy)
    if not setup.rate > 0 or setup.rate * setup.ideal_period < LEAST_SAMPLES:
        problem = f"{setup.rate:g} Hz is {setup.rate * setup.ideal_period:.2g} samples a cycle, {LEAST_SAMPLES} are needed"
        raise _refused("rate", problem, f"Record at {np.ceil(LEAST_SAMPLES / setup.ideal_period):g} Hz or more")
    samples = setup.cycles * setup.rate * setup.ideal_period
    if not samples <= MOST_SAMPLES:
        lasting = f"{setup.cycles:g} cycles of {setup.ideal_period:.3g} s"
        problem = f"{setup.rate:g} Hz over {lasting} are {samples:.3g} samples, more than the {MOST_SAMPLES} that are kept"
        raise _refused("rate", problem, f"Record at {0.9 * MOST_SAMPLES / setup.cycles / setup.ideal_period:.2g} Hz or less")
    if not 0 <= setup.noise < np.inf:
        raise _refused("noise", f"it must be finite and not negative, found {setup.noise:g} rad", "Give a standard deviation")
    if setup.seed < 0:
        raise _refused("seed", f"it must not be negative, found {setup.seed}", "Give a whole number from 0 on")


def _refused(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(SOURCE, field, problem, remedy)


# From the words of the command line to a `Setup`.


RADIUS, HEIGHT, LINKS = 0.3, 0.1, 8
"""Where nothing else is said: circle of three ropes [m], feet above the CoG [m], links of a rope that has mass."""

OPTIONS = {
    **dict.fromkeys(("radius", "s1", "s2", "length", "height", "unequal"), "length"),
    "amplitude": "angle",
    "damping": "ratio",
    "rope_mass": "mass",
    "rope_stiffness": "force",
    "noise": "angle",
    "gravity": "acceleration",
    "step": "time",
}
"""Options that are quantities, and their dimension."""

OTHERS = ("ropes", "axis", "along", "off_centre", "links", "start", "cycles", "rate", "seed")
"""Options that are none."""

FIELDS = {"stiffness": "rope_stiffness", "extra": "unequal", "damping_ratio": "damping", "duration": "cycles"}
"""Fields of a suspension whose option is called otherwise."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Words:
    """The options of ``massline swing`` as they were typed; None where they were not."""

    texts: Mapping[str, str | None]
    ropes: int | None
    axis: str
    along: str | None
    off_centre: str | None
    links: int | None
    start: str
    cycles: float
    rate: float
    seed: int


def setup(article: str, words: Words, asked: ArticleOptions) -> Setup:
    """The pendulum test that `words` ask for.

    Raises
    ------
    BadInput : an option that cannot be used; it is named.
    """
    require_use([article], asked)
    value = {name: _quantity(text, OPTIONS[name], name) for name, text in words.texts.items() if text is not None}
    # s1 and s2 [m] for two ropes, the one radius for three
    sides = [name for name in ("s1", "s2") if name in value]
    ropes = words.ropes or (2 if sides else 3)
    if ropes == 3 and not sides:
        radii: tuple[float, ...] = (value.get("radius", RADIUS),)
    elif ropes == 2 and len(sides) == 2 and "radius" not in value:
        radii = value["s1"], value["s2"]
    elif ropes == 2 and not sides and "radius" in value:
        radii = value["radius"], value["radius"]
    else:
        given = " and ".join(f"--{name}" for name in (*sides, "radius") if name in value) or "no sizes"
        remedy = "Give --s1 and --s2 (or --radius) for two ropes, --radius for three"
        raise BadInput("--ropes", "", f"{ropes} ropes do not go with {given}", remedy)
    # One length along the ropes' x, or two with a comma, the second across
    parts = () if words.off_centre is None else words.off_centre.split(",")
    lengths = [_quantity(part.strip(), "length", "off_centre") for part in parts]
    if len(lengths) > 2:
        problem = f"one length or two are expected, found {words.off_centre!r}"
        raise BadInput("--off-centre", "", problem, 'Write "10 mm" or "10 mm, 5 mm"')
    along, across, *_ = (*lengths, 0.0, 0.0)
    off_centre = along, across
    height = value.get("height", HEIGHT)
    rope_mass = value.get("rope_mass", 0.0)
    fields: dict[str, Any] = {
        "length": value["length"],
        "amplitude": value["amplitude"],
        "damping_ratio": value.get("damping", 0.0),
        "rope_mass": rope_mass,
        "links": words.links if words.links is not None else (LINKS if rope_mass else 1),
        "stiffness": value.get("rope_stiffness"),
        "start": words.start,
        "extra": value.get("unequal", 0.0) * np.eye(3)[0, : 2 if len(radii) == 2 else 3],
    }
    try:
        suspension = suspended(radii, height, off_centre, **fields)
        body = hung(inertia_of(article, asked), words.axis, words.along)
    except BadInput as error:
        raise as_option(error) from None
    more = {name: value[name] for name in ("gravity", "noise", "step") if name in value}
    return Setup(
        article=article,
        axis=words.axis,
        along=words.along or lying(words.axis),
        inertia=body,
        radii=radii,
        height=height,
        off_centre=off_centre,
        suspension=suspension,
        cycles=words.cycles,
        rate=words.rate,
        seed=words.seed,
        **more,
    )


def inertia_of(article: str, asked: ArticleOptions) -> Inertia:
    """Inertia of a built-in article or of a user's file.

    Raises
    ------
    BadInput : no such article, or a file of which no body can be made.
    """
    from geometry import routes, user_article
    from geometry.articles import built_in, changes_of

    if not is_file(article):
        return routes.inertia(built_in(article, changes_of(article, asked.changes)))
    loaded = user_article.load(article, unit=asked.unit, material=asked.material, chord=asked.chord)
    return next(iter(user_article.inertias(loaded).values()))


def as_option(error: BadInput) -> BadInput:
    """`error` about a field of the pendulum, said of the option that it came from; others pass unchanged."""
    name = FIELDS.get(error.field, error.field)
    if name not in (*OPTIONS, *OTHERS):
        return error
    return BadInput(f"--{name.replace('_', '-')}", "", error.problem, error.remedy)


def _quantity(text: str, dimension: str, name: str) -> float:
    """What was typed for the option `name`."""
    from geometry.toml_file import quantity

    option = f"--{name.replace('_', '-')}"
    try:
        return float(quantity(text, dimension, source=option, field="").nominal_value)
    except BadInput as error:
        raise BadInput(option, "", error.problem, error.remedy) from None


# The recorded swing: sampled, noisy, written as any recorder's file, and reduced by the code that reduces measured ones.


SURPLUS, LEAST_SURPLUS = 0.15, 0.05
"""Cycles recorded beyond those asked for, as foreseen and as found. Pitch and sway that no formula foresees may make
them longer than thought; where less than the second is left the pendulum swings once more, for longer."""

RECORD, MEASUREMENT = "record.csv", "pendulum.toml"


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """A swing and what the recorder made of it.

    Attributes
    ----------
    setup : that was simulated
    swing : by exudyn, sampled at the recorder's rate
    signal : (n,) [rad] yaw with noise
    decay : the decaying sinusoid fitted to it
    plain, corrected : moment of inertia [kg m²] by Eq. 5 alone and with every correction
    effects : relative change that each correction makes
    """

    setup: Setup
    swing: Swing
    signal: Array
    decay: Decay
    plain: float
    corrected: float
    effects: dict[str, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "signal", frozen(self.signal, np.shape(self.swing.yaw), "signal"))

    @property
    def period(self) -> float:
        """[s]"""
        return float(self.decay.period.nominal_value)

    @property
    def shift(self) -> float:
        """Of the period, relative to that of Eq. 5."""
        return self.period / self.setup.ideal_period - 1


def recorded(setup: Setup, progress: Progress | None = None) -> Record:
    """`setup` simulated, recorded and reduced.

    Raises
    ------
    BadInput : it cannot be hung, simulated or recorded like that.
    CheckFailed : exudyn failed, or a rope slacks.
    """
    require_recordable(setup)
    s1, s2 = setup.s1_s2
    small = small_period(setup.inertia, setup.suspension, setup.gravity)
    kappa = setup.inertia.mass * s1 * s2 / setup.reference
    cycle = small * rope_amplitude_factor(setup.suspension.amplitude, s1 * s2 / setup.suspension.length**2, kappa)
    more: dict[str, Any] = {"step": setup.step, "rate": setup.rate, "gravity": setup.gravity, "progress": progress}
    run = swing(setup.inertia, setup.suspension, duration=(setup.cycles + SURPLUS) * cycle, **more)
    # [s] of one cycle on average, from the passages through the middle of the twist
    y = run.yaw - np.mean(run.yaw)
    k = np.flatnonzero(np.signbit(y[1:]) != np.signbit(y[:-1]))
    t = run.time[k] + np.diff(run.time)[k] * y[k] / (y[k] - y[k + 1])
    took = float(2 * (t[-1] - t[0]) / (len(t) - 1)) if len(t) > 1 else 0.0
    if run.time[-1] <= (setup.cycles + LEAST_SURPLUS) * took:
        run = swing(setup.inertia, setup.suspension, duration=(setup.cycles + SURPLUS) * took, **more)
    noise = np.random.default_rng(setup.seed).normal(0.0, setup.noise, len(run.yaw)) if setup.noise else 0.0
    signal = run.yaw + noise
    try:
        decay = pendulum.from_signal(run.time, signal, "the simulated record")
    except BadInput as error:  # said of what can be changed here
        remedy = "Use less noise or a larger twist" if setup.noise else "Use a smaller twist, or lighter and more equal ropes"
        problem = f"its record cannot be reduced: {error.problem}"
        raise _refused("noise" if setup.noise else "amplitude", problem, remedy) from None
    with TemporaryDirectory() as folder:
        path = write(Path(folder), setup, run, signal, decay)
        file = read(str(path), ("pendulum",))
        with_all, plain = (pendulum.reduce(file, off) for off in ((), pendulum.TERMS))
    key = f"I{setup.axis}{setup.axis}"
    return Record(
        setup=setup,
        swing=run,
        signal=signal,
        decay=decay,
        plain=float(plain.results[key].nominal_value),
        corrected=float(with_all.results[key].nominal_value),
        effects=dict(with_all.terms[key]),
    )


def write(folder: Path, setup: Setup, run: Swing, signal: Array, decay: Decay) -> Path:
    """Write record and measurement file into `folder`; where the measurement file is."""
    head = f"# Simulated by massline swing with exudyn {run.settings['version']}, not measured. Columns: time [s], twist [rad]"
    rows = [f"{t:.9g},{y:.9g}" for t, y in zip(run.time, signal, strict=True)]
    write_text(folder / RECORD, "\n".join([head, *rows]) + "\n")
    # The measurement file: what the laboratory would know. Stretch and an off-centre CoG it would not.
    s, version = setup.suspension, run.settings["version"]
    radii = [f's{i} = "{radius!r} m"' for i, radius in enumerate(setup.radii, start=1)]
    lines = [
        "# What a laboratory would write down beside its record. Run: massline pendulum pendulum.toml",
        "format = 1",
        'kind = "pendulum"',
        f"title = {string(setup.article + f' on {s.ropes} ropes, twist simulated')}",
        f"origin = {string(f'simulated by exudyn {version}, not measured')}",
        f'gravity = "{setup.gravity!r} m/s^2"',
        "",
        "[article]",
        f"name = {string(setup.article)}",
        f'mass = "{setup.inertia.mass!r} kg"',
        "",
        "[[swing]]",
        f'about = "{setup.axis}"',
        'suspension = "ropes"',
        f'rope_length = "{s.length!r} m"',
        *(radii if len(setup.radii) == 2 else [f'radius = "{setup.radii[0]!r} m"']),
        f'signal = "{RECORD}"',
        f'amplitude = "{decay.amplitude:.9g} rad" # root mean square of the peaks over the record',
        *([f'rope_mass = "{s.rope_mass!r} kg"'] if s.rope_mass else []),
    ]
    write_text(folder / MEASUREMENT, "\n".join(lines) + "\n")
    return folder / MEASUREMENT


# What moves the period away from Eq. 5: every effect alone, each in a short run of its own, and all of them in the record.


CYCLES = 8.0
"""Cycles of a run that shows one effect."""

SAMPLES = 10 * LEAST_SAMPLES
"""Samples a cycle of such a run."""

Watched = Callable[[str], AbstractContextManager[Callable[[float], None] | None]]
"""Given what is being simulated, a block that shows how far it has come: `validation.output.share_done`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shift:
    """One effect alone, on ropes that are ideal otherwise.

    Attributes
    ----------
    name : one of `validation.classical.swing.EFFECTS`
    period : change of the period, relative to Eq. 5
    plain, corrected : error of the reduced moment of inertia, relative, without and with corrections
    """

    name: str
    period: float
    plain: float
    corrected: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Simulated:
    """The record, and every effect alone."""

    record: Record
    shifts: tuple[Shift, ...]

    @property
    def plain(self) -> float:
        """Error of the record's moment of inertia by Eq. 5 alone, relative."""
        return self.record.plain / self.record.setup.reference - 1

    @property
    def corrected(self) -> float:
        """The same with every correction."""
        return self.record.corrected / self.record.setup.reference - 1


def simulated(setup: Setup, watched: Watched = lambda words: nullcontext()) -> Simulated:
    """`setup` recorded, and every effect in it alone.

    Raises
    ------
    BadInput, CheckFailed : see `validation.classical.swing.recorded`.
    """
    with watched("swinging, all effects") as progress:
        record = recorded(setup, progress)
    return Simulated(record=record, shifts=tuple(shift(setup, effect, watched) for effect in setup.effects))


def shift(setup: Setup, effect: str, watched: Watched = lambda words: nullcontext()) -> Shift:
    """What `effect` alone does to `setup`.

    Raises
    ------
    BadInput, CheckFailed : see `validation.classical.swing.recorded`.
    """
    alone = replace(setup.alone(effect), cycles=CYCLES, rate=SAMPLES / setup.ideal_period)
    with watched(f"swinging, {effect} alone") as progress:
        found = recorded(alone, progress)
    plain, corrected = (inertia / setup.reference - 1 for inertia in (found.plain, found.corrected))
    return Shift(name=effect, period=found.shift, plain=plain, corrected=corrected)
