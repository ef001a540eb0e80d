"""The answer of a pretest: condition of every line, expected intervals, what dominates them, rigid places."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from geometry import multibody
from geometry.arrays import Array
from geometry.articles import built_in, changes_of
from geometry.articles.locations import locations
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.observability import of_motions
from geometry.sensors import ChannelTable
from identification.base_motion import base_motion, groups_used
from identification.dynamic_mass import from_runs
from identification.evidence import Evidence, Known, Settings, TareSpectra
from identification.expected import Expected, expected
from identification.resultants import resultants
from identification.spectra.line_spectra import Spectra
from validation.flexible.model import Asked, Flexible, flexible
from validation.identifying.reported import Reported, reported
from validation.pretest.asked import Question
from validation.pretest.planned import Planned, planned
from validation.pretest.rigid_places import Rigidity, judged, rigid_height
from validation.virtual_test.plan import Plan
from validation.virtual_test.set_up import nominal_fmd

MODES = 40


@dataclass(frozen=True, eq=False, kw_only=True)
class Findings:
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

    question: Question
    spectra: Spectra
    condition: Array
    best: Reported
    plain: Reported
    untared: Array | None
    without: Mapping[str, Array]
    lost: Mapping[str, str]
    places: tuple[Rigidity, ...]
    rigid_height: float | None
    model: Flexible | None
    seat: Array
    warnings: tuple[str, ...] = ()

    @property
    def left_out(self) -> Array:
        """(n,) bool: lines whose condition number is above the limit."""
        return np.asarray(self.condition > self.question.condition_limit)


def findings(question: Question, progress: Callable[[float], None] | None = None) -> Findings:
    """The answer to `question`.

    Raises
    ------
    BadInput : an article that cannot be built, runs that leave a base motion undriven, channels that do not tell six motions.
    """
    article = planned(question.plan, question.table)
    tare = None if question.tare is None else planned(question.tare, question.table)
    condition = _condition(article.spectra)
    settings = Settings(tolerances=question.tolerances, stiffness=article.stiffness, gravity=question.plan.gravity)
    fmd = Known.within(nominal_fmd(question.plan), question.tolerances.fmd_inertia or 1e-6)
    tares = () if tare is None or question.tare is None else (_known(tare, question.tare),)
    evidence = Evidence(article=article.spectra, tares=tares, fmd=None if tares else fmd)
    found = expected(evidence, settings, fmd, lost=question.lost, progress=progress)
    pose = Pose(position=article.seat) if question.above else Pose()
    best = reported(found.best, pose)
    model = _model(question.plan)
    places, height = ((), None) if model is None else _rigid(model, question, article)
    return Findings(
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
        warnings=_warnings(found, condition, question),
    )


def _condition(spectra: Spectra) -> Array:
    motion, loads = base_motion(spectra).values, resultants(spectra).values
    return from_runs(loads, motion, spectra.frequency).condition


def _known(tare: Planned, plan: Plan) -> TareSpectra:
    if not plan.on_fmd:
        return TareSpectra(spectra=tare.spectra, known=Known.nothing(), name=plan.article)
    own = multibody.inertia(built_in(plan.on_fmd, changes_of(plan.on_fmd, plan.dimensions)))
    return TareSpectra(spectra=tare.spectra, known=Known.within(own.placed(Pose(position=tare.seat))), name=plan.article)


def _half(best: Reported, covariance: Array, pose: Pose) -> Array:
    return reported(replace(best.identified, covariance=covariance), pose).half_width


def _model(plan: Plan) -> Flexible | None:
    """The beam model of what stands on the FMD; None for the FMD alone."""
    if not plan.on_fmd:
        return None
    changes = changes_of(plan.on_fmd, plan.dimensions)
    return flexible(plan.on_fmd, plan.model, Asked(count=MODES, damping=plan.damping, changes=changes))


def _rigid(model: Flexible, question: Question, article: Planned) -> tuple[tuple[Rigidity, ...], float | None]:
    plan = question.plan
    named = locations(plan.on_fmd, changes_of(plan.on_fmd, plan.dimensions))
    found = judged(model, named, article.seat, article.spectra.frequency, question.rigid)
    top = max(float(point[2]) for point in named.values())
    return found, rigid_height(model, top, article.seat, article.spectra.frequency, question.rigid)


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


def _warnings(found: Expected, condition: Array, question: Question) -> tuple[str, ...]:
    over = int(np.sum(condition > question.condition_limit))
    unfinished = () if found.best.converged else ("the joint fit of the planned data did not converge: its intervals are rough",)
    limit = question.condition_limit
    many = f"at {over} of {len(condition)} lines the condition number is above {limit:g}: drive the axes in runs of their own"
    return (*unfinished, *([many] if over else []))
