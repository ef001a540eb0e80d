"""What `massline pretest` was asked, checked at the door: from options to plans of the article's campaign and of the tare."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import isfinite
from pathlib import Path

import numpy as np

from fem.base_excitation.rig import dynamic_mass
from fem.modes import Modes
from geometry import routes
from geometry.articles import NAMES, built_in, changes_of, locations
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, Pose, rigid_transformation_6
from geometry.inertia import of_motions, of_resultants
from geometry.sensors import ChannelTable, Tolerances
from identification import campaign_file
from identification.base_motion import base_motion, groups_used, resultants
from identification.campaign import Processing
from identification.chain import chain
from identification.dynamic_mass import from_runs
from identification.identify import expected
from identification.request import QUANTITIES, Evidence, Known, Settings, TareSpectra
from identification.spectra import noise
from identification.spectra.line_spectra import Spectra, full_record
from validation.flexible.model import Flexible, FlexibleOptions, flexible, nearest_part
from validation.flexible.modes import displacement
from validation.identify.identify import Reported, by_kind, reported
from validation.identify.request import tolerances_of
from validation.output import derived, entry, inertia_json, unwritten
from validation.virtual_test import simulate
from validation.virtual_test.plan import BEAM, NOISE, Plan, Scatter
from validation.virtual_test.shaker import nominal_fmd
from validation.virtual_test.simulate import laboratory, runs

FMD = "fmd"

NO_TARE = "none"


@dataclass(frozen=True, eq=False, kw_only=True)
class PretestOptions:
    """What was asked.

    Attributes
    ----------
    plan : of the article's campaign
    tare : of the tare's; None where there is none
    table : the user's own sensors; None for those of the virtual shaker
    tolerances : of the laboratory
    condition_limit : scaled condition number above which a line is left out
    rigid : elastic share up to which a place counts as rigid
    lost : whether every channel is left out in turn
    """

    plan: Plan
    tare: Plan | None
    table: ChannelTable | None
    tolerances: Tolerances
    condition_limit: float
    rigid: float
    lost: bool

    @property
    def above(self) -> str:
        """What stands on the FMD."""
        return self.plan.on_fmd


def question(
    *,
    article: str,
    tare: str,
    sensors: Path | None,
    pattern: str,
    runs: int | None,
    level: float,
    band: tuple[float, float],
    octaves_per_minute: float,
    cross: float,
    seed: int,
    tolerances: Sequence[str],
    noise: str,
    damping_ratio: float | None,
    condition_limit: float,
    rigid_percent: float,
    lost: bool,
    settings: Sequence[str],
) -> PretestOptions:
    """The options, checked.

    Raises
    ------
    BadInput : one of them cannot be; what was found, and what to write.
    """
    known = tolerances_of(tolerances)
    _require(condition_limit, "--condition-limit", "a condition number is above 1", above=1.0)
    _require(rigid_percent, "--rigid", "a share above 0 % is expected", above=0.0)
    stacks = [_on_fmd(article), *([] if tare == NO_TARE else [_on_fmd(tare)])]
    if len(set(stacks)) < len(stacks):
        problem = f"the tare is the article itself, {article}"
        raise BadInput("--tare", "", problem, f"Name another known article, or --tare {NO_TARE}")
    plans = simulate.question(
        articles=stacks,
        out=Path("out"),
        effects=(),
        seed=seed,
        levels=f"{level:g}",
        sealed=None,
        pattern=pattern,
        runs=runs,
        band=band,
        octaves_per_minute=octaves_per_minute,
        cross=cross,
        tolerances=simulate.OFF,
        noise=noise,
        mains=simulate.OFF,
        model=BEAM,
        damping_ratio=damping_ratio,
        rate=564.0,
        form="h5",
        units=(),
        settings=settings,
    ).plans
    return PretestOptions(
        plan=plans[0],
        tare=plans[1] if len(plans) > 1 else None,
        table=None if sensors is None else _sensors(sensors, plans[0].noise_rms),
        tolerances=known,
        condition_limit=condition_limit,
        rigid=rigid_percent / 100,
        lost=lost,
    )


def _on_fmd(article: str) -> str:
    """The stack with the FMD below it: what is tested here always stands on one."""
    return article if article.split("+")[0] not in NAMES or article.split("+")[0] == FMD else f"{FMD}+{article}"


def _sensors(folder: Path, floors: Mapping[str, float]) -> ChannelTable:
    """The channel table of a campaign, which must tell six motions and six resultants; ordinary noise where it states none."""
    table = campaign_file.read_description(folder).table
    groups_used(table)
    verdict = of_resultants(table)
    if not verdict.complete:
        problem = f"the load cells of {folder} do not tell the six resultants: {verdict.text}"
        raise BadInput("--sensors", "", problem, f"Add a cell that sees {', '.join(verdict.missing)}")
    channels = []
    for one in table.channels:  # each with its floor times the factor that was asked for
        ordinary, asked = NOISE.get(one.quantity, 0.0), floors.get(one.quantity, 0.0)
        factor = asked / ordinary if ordinary else 1.0
        channels.append(replace(one, noise_rms=factor * (ordinary if one.noise_rms is None else one.noise_rms)))
    return ChannelTable(channels=tuple(channels), origin=table.origin)


def _require(value: float, option: str, words: str, *, above: float) -> None:
    if not (isfinite(value) and value > above):
        raise BadInput(option, "", f"{words}, found {value:g}", "Leave it out for the ordinary one")


# A planned campaign as the spectra that an exact laboratory would get: the base motions of the pattern, the model, the channels.
#
# The table's motion, cross motion included, is sampled and transformed as a record would be; what the channels read of it
# follows from the nominal measurement chain and the model of what stands on the load cells. Noise is what the plan states, over
# the length of the record. The table's motion is taken for that of the cover plate: the cells' give changes no interval.


REST = 8.0
"""[s] recorded behind the drive."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PlannedCampaign:
    """A planned campaign.

    Attributes
    ----------
    spectra : of exact channels, with the noise that is planned
    dynamic_mass : of all that stands on the load cells, about F
    seat : (3,) [m] of the origin of what stands on the FMD, from F
    stiffness : (3,) [N/m] of one load cell
    """

    spectra: Spectra
    dynamic_mass: DynamicMass
    seat: Array
    stiffness: Array

    @property
    def condition(self) -> Array:
        """(n,) scaled condition number of the base motions at every line."""
        loads, motion = resultants(self.spectra), base_motion(self.spectra)
        return from_runs(loads.values, motion.values, self.spectra.frequency).condition


def planned(plan: Plan, table: ChannelTable | None = None) -> PlannedCampaign:
    """The campaign of `plan`, its structure as drawn, with the sensors of `table` (by default those of the virtual shaker).

    Raises
    ------
    BadInput : an article that cannot be built, channels that the chain cannot predict, a drive that cannot be.
    """
    lab = laboratory(replace(plan, tolerances=Tolerances().scaled(0.0), scatter=Scatter().scaled(0.0)))
    channels = lab.layout.table if table is None else table
    low, high = plan.band
    lines = np.asarray(low + Processing().step * np.arange(round((high - low) / Processing().step) + 1), dtype=np.float64)
    H = dynamic_mass(replace(lab.rig, cells=()), lines)
    driven = runs(plan)
    tables = [run.motion(plan, plan.rate, REST + plan.quiet) for run in driven]
    durations = [len(one.acceleration) / plan.rate for one in tables]
    # (r, n, c): what the nominal chain reads of the table's motions (r, n, 6); 0 in channels on the structure
    motions = np.stack([full_record(one.acceleration, plan.rate, lines) for one in tables])
    of = chain(channels, stiffness=np.asarray(lab.rig.cells[0].stiffness), gravity=plan.gravity)
    A0, A1 = of.rows(np.zeros(len(of.parameters)), H.frequency)
    values = np.zeros((*motions.shape[:2], len(channels)), dtype=np.complex128)
    values[:, :, list(of.columns)] = np.einsum("nck,rnk->rnc", A0 + A1 @ H.matrix, motions)
    floors = np.array([one.noise_rms or 0.0 for one in channels.channels])
    density = np.broadcast_to(floors**2 / plan.rate, values.shape)
    spectra = Spectra(
        table=channels,
        frequency=lines,
        values=values,
        noise=noise.of_full_record(density, np.array(durations)),
        quality=np.ones(values.shape[:2]),
        runs=tuple(run.name for run in driven),
        axes=tuple(run.axis for run in driven),
    )
    return PlannedCampaign(
        spectra=spectra, dynamic_mass=H, seat=np.asarray(lab.rig.seat), stiffness=np.asarray(lab.rig.cells[0].stiffness)
    )


# Where on an article a pick-up moves with the base alone: how large its elastic motion is, place by place.
#
# Relative to a base that accelerates along axis k, a point moves in the fixed-base modes by
#
#     a_el(omega) = sum_r phi_r L_rk omega² / (omega_r² - omega² + 2 i zeta_r omega_r omega)            (Eq. 8b's factor)
#
# The *elastic share* is |a_el| over what a rigid article would do there: the base's acceleration, of rotations times the
# distance from F. A pick-up is meant for places where it stays below a per cent or so over the band. The cover plate is rigid in
# all models here, and so is every place of an article without modes.


NEAREST = 0.05
"""[m] Distance from F below which a rotation is not taken to move less."""

STEPS = 400
"""Points on the axis of an article."""

COARSE = 0.2
"""[Hz] between the lines at which whole surfaces are judged; eigenfrequencies are added."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Rigidity:
    """How rigid one place is.

    Attributes
    ----------
    name : of the place
    position : (3,) [m] from F
    at_start : the largest elastic share of the six axes at the lowest line [1]
    largest : the same over the band
    axis, frequency : where it is reached: of `MOTIONS`, [Hz]
    up_to : [Hz] below which the share stays under the limit on every axis; None where it is above from the start
    within : share of the lines at which it stays under the limit on every axis
    """

    name: str
    position: Array = entry("position_m", unit="m")
    at_start: float = entry("elastic_share_at_start")
    largest: float = entry("elastic_share")
    axis: str
    frequency: float = entry("frequency_hz", unit="Hz")
    up_to: float | None = entry("rigid_up_to_hz", unit="Hz")
    within: float = entry("share_of_lines")


def judged(model: Flexible, places: Mapping[str, Array], seat: Array, frequency: Array, limit: float) -> tuple[Rigidity, ...]:
    """Every one of `places` (3,) [m] in the article's own frame, the most rigid first; `seat` (3,) [m] of that frame from F."""
    if not places:
        return ()
    points = np.array(list(places.values()))
    moved = _displacement(model, points)
    shares = elastic_share(moved, points + seat, model.modes, seat, frequency)
    found = []
    for name, position, share in zip(places, points + seat, shares, strict=True):
        line, axis = np.unravel_index(int(np.argmax(share)), share.shape)
        under = np.all(share <= limit, axis=1)
        first = int(np.argmin(under)) if not under.all() else len(under)
        one = Rigidity(
            name=name,
            position=position,
            at_start=float(share[0].max()),
            largest=float(share[line, axis]),
            axis=MOTIONS[int(axis)],
            frequency=float(frequency[line]),
            up_to=float(frequency[first - 1]) if first else None,
            within=float(under.mean()),
        )
        found.append(one)
    # Places that mirror each other are equally rigid, whatever the last digits are on this machine: as they are declared
    return tuple(sorted(found, key=lambda one: (float(f"{one.largest:.6g}"), one.position[2])))


def elastic_share(moved: Array, points: Array, modes: Modes, seat: Array, frequency: Array) -> Array:
    """(p, n, 6) elastic shares of `points` (p, 3) [m] from F whose displacement in the modes is `moved` (p, 3, m)."""
    return np.stack(list(_by_line(moved, points, modes, seat, frequency)), axis=1)


def largest_share(moved: Array, points: Array, modes: Modes, seat: Array, frequency: Array) -> tuple[Array, Array]:
    """(p,) and (p,): the largest of the six elastic shares at the first line, and over all lines; in the memory of one line."""
    lines = (share.max(axis=1) for share in _by_line(moved, points, modes, seat, frequency))
    first = next(lines)
    most = first.copy()
    for share in lines:
        np.maximum(most, share, out=most)
    return first, most


def _by_line(moved: Array, points: Array, modes: Modes, seat: Array, frequency: Array) -> Iterator[Array]:
    """Line by line the elastic shares (p, 6)."""
    L = modes.participation.T @ rigid_transformation_6(seat)  # (m, 6) about F
    omega, omega_r = 2 * np.pi * frequency[:, None], 2 * np.pi * modes.frequency
    factor = omega**2 / (omega_r**2 - omega**2 + 2j * modes.damping_ratio * omega_r * omega)  # (n, m)
    arm = np.maximum(np.linalg.norm(points, axis=1), NEAREST)[:, None]
    flat = moved.reshape(-1, moved.shape[2])
    for row in factor:
        answer = row[:, None] * L
        parts = (flat @ np.hstack([answer.real, answer.imag])).reshape(len(points), 3, 2, 6)
        share = np.sqrt(np.sum(parts**2, axis=(1, 2)))
        share[:, 3:] /= arm
        yield share


def rigid_height(model: Flexible, top: float, seat: Array, frequency: Array, limit: float) -> float | None:
    """[m] above F up to which the article's axis, x = y = 0 of its frame from 0 to `top` [m], stays within `limit` over the band.

    None where all of it does.
    """
    points = np.zeros((STEPS + 1, 3))
    points[:, 2] = np.linspace(0.0, top, STEPS + 1)
    lines = coarse_lines(frequency, model.modes)
    _, most = largest_share(_displacement(model, points), points + seat, model.modes, seat, lines)
    soft = np.flatnonzero(most > limit)
    return float(seat[2] + points[max(soft[0] - 1, 0), 2]) if len(soft) else None


def coarse_lines(frequency: Array, modes: Modes) -> Array:
    """Fewer lines over the same band, with every eigenfrequency in it."""
    low, high = float(frequency[0]), float(frequency[-1])
    own = modes.frequency[(modes.frequency > low) & (modes.frequency < high)]
    even = np.linspace(low, high, max(round((high - low) / COARSE), 1) + 1)
    return np.unique(np.concatenate([even, own]))


def _displacement(model: Flexible, points: Array) -> Array:
    """(p, 3, m): nothing moves in the modes of a model that is not there."""
    if model.structure is None:
        return np.zeros((len(points), 3, len(model.modes.frequency)))
    article = model.article_of_primitives
    parts = np.zeros(len(points), dtype=np.intp) if article is None else nearest_part(article, points)
    return displacement(model.structure, model.modes.shapes, article, points, parts)


# The answer of a pretest: condition of every line, expected intervals, what dominates them, rigid places.


MODES = 40


@dataclass(frozen=True, eq=False, kw_only=True)
class PretestFindings:
    """What a pretest found.

    Attributes
    ----------
    question : that it answers
    spectra : planned, of the article's campaign
    condition : (n,) scaled condition number of its base motions at every line
    best, plain : expected results with their intervals, in the article's own frame
    untared : (10,) half-widths without a tare; None where none is planned
    without : by channel (10,) half-widths when it is lost
    lost : by channel, what the plain way cannot tell without it, in words; empty where it still can
    places : the named places of the article, the most rigid first
    rigid_height : [m] above F up to which the axis of the article is rigid; None where all of it is
    model : of what stands on the FMD; None for the FMD alone
    seat : (3,) [m] of its frame from F
    warnings : sentences
    """

    question: PretestOptions = unwritten()
    spectra: Spectra = unwritten()
    condition: Array
    best: Reported = unwritten()
    plain: Reported = unwritten()
    untared: Array | None = unwritten()
    without: Mapping[str, Array] = unwritten()
    lost: Mapping[str, str] = unwritten()
    rigid_height: float | None = entry("rigid_height_m", unit="m")
    places: tuple[Rigidity, ...]
    model: Flexible | None = unwritten()
    seat: Array = unwritten()
    warnings: tuple[str, ...] = ()

    @property
    def left_out(self) -> Array:
        """(n,) bool: lines whose condition number is above the limit."""
        return np.asarray(self.condition > self.question.condition_limit)

    @property
    @derived("", before="condition")
    def planned(self) -> dict[str, object]:
        """What would be measured, by its keys in JSON."""
        tare = self.question.tare
        return {
            "article": self.question.plan.article,
            "tare": None if tare is None else tare.article,
            "origin": "article",
            "runs": self.spectra.runs,
            "frequency_hz": self.spectra.frequency,
        }

    @property
    @derived("", before="rigid_height_m")
    def figures(self) -> dict[str, object]:
        """What would be found, by its keys in JSON."""
        lost = {name: {"half_width95": by_kind(half), "plain_loses": self.lost[name]} for name, half in self.without.items()}
        ways = {
            key: {
                "half_width95": by_kind(one.half_width),
                "shares": {name: dict(zip(QUANTITIES, share, strict=True)) for name, share in one.quality.shares.items()},
                "verdict": {name: one.quality.verdict[name] for name in QUANTITIES},
            }
            for key, one in (("self_calibrated", self.best), ("plain", self.plain))
        }
        return {
            "condition_limit": self.question.condition_limit,
            "lines_left_out": np.sum(self.left_out),
            "inertia": inertia_json(self.best.inertia),
            **ways,
            "without_tare": None if self.untared is None else {"half_width95": by_kind(self.untared)},
            "without": lost,
            "rigid_share": self.question.rigid,
        }

    @property
    @derived("tolerances", before="warnings")
    def tolerances(self) -> dict[str, float]:
        """Of the laboratory."""
        return asdict(self.question.tolerances)


def findings(question: PretestOptions, progress: Callable[[float], None] | None = None) -> PretestFindings:
    """The answer to `question`.

    Raises
    ------
    BadInput : an article that cannot be built, runs that leave a base motion undriven, channels that do not tell six motions.
    """
    article = planned(question.plan, question.table)
    tare = None if question.tare is None else planned(question.tare, question.table)
    condition = article.condition
    settings = Settings(tolerances=question.tolerances, stiffness=article.stiffness, gravity=question.plan.gravity)
    fmd = Known.within(nominal_fmd(question.plan), question.tolerances.fmd_inertia or 1e-6)
    tares: tuple[TareSpectra, ...] = ()
    if tare is not None and question.tare is not None:
        of = question.tare
        there = Known.nothing()
        if of.on_fmd:
            own = routes.inertia(built_in(of.on_fmd, changes_of(of.on_fmd, of.dimensions)))
            there = Known.within(own.placed(Pose(position=tare.seat)))
        tares = (TareSpectra(spectra=tare.spectra, known=there, name=of.article),)
    evidence = Evidence(article=article.spectra, tares=tares, fmd=None if tares else fmd)
    found = expected(evidence, settings, fmd, lost=question.lost, progress=progress)
    pose = Pose(position=article.seat) if question.above else Pose()
    best = reported(found.best, pose)
    # The beam model of what stands on the FMD, and its rigid places; none for the FMD alone
    plan, limit, lines = question.plan, question.rigid, article.spectra.frequency
    model: Flexible | None = None
    places: tuple[Rigidity, ...] = ()
    height: float | None = None
    if plan.on_fmd:
        changes = changes_of(plan.on_fmd, plan.dimensions)
        model = flexible(plan.on_fmd, plan.model, FlexibleOptions(count=MODES, damping=plan.damping, changes=changes))
        named = locations(plan.on_fmd, changes)
        places = judged(model, named, article.seat, lines, limit)
        height = rigid_height(model, max(float(point[2]) for point in named.values()), article.seat, lines, limit)
    warnings = [] if found.best.converged else ["the joint fit of the planned data did not converge: its intervals are rough"]
    if over := int(np.sum(condition > question.condition_limit)):
        above = f"at {over} of {len(condition)} lines the condition number is above {question.condition_limit:g}"
        warnings.append(f"{above}: drive the axes in runs of their own")
    return PretestFindings(
        question=question,
        spectra=article.spectra,
        condition=condition,
        best=best,
        plain=reported(found.plain, pose),
        untared=None if found.untared is None else _half(best, found.untared, pose),
        without={name: _half(best, covariance, pose) for name, covariance in found.without.items()},
        lost={name: _lost(article.spectra.table, name) for name in found.without},
        places=places,
        rigid_height=height,
        model=model,
        seat=article.seat,
        warnings=tuple(warnings),
    )


def _half(best: Reported, covariance: Array, pose: Pose) -> Array:
    return reported(replace(best.identified, covariance=covariance), pose).half_width


def _lost(table: ChannelTable, gone: str) -> str:
    """What the plain way (Eqs. 6 and 7, six resultants) has without the channel `gone`; empty where it has all it needs."""
    if table.channels[table.names.index(gone)].group == "fmd":
        return "no resultants: what its cells carry is not seen"
    left = table.subset([k for k, name in enumerate(table.names) if name != gone])
    try:
        groups = groups_used(left)
    except BadInput:
        return f"no base motion: {', '.join(of_motions(left, groups_used(table)).missing)} cannot be told"
    return "" if groups == groups_used(table) else f"the base motion of the {groups[0]} only"
