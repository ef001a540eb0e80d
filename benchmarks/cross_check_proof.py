"""The proof of the cross-check on Clumod: ``python -m benchmarks.cross_check_proof [SEED] [CASE ...]``.

A series of virtual tests - Cuboid on disc and Clumod with one blade, with four where the effect needs them - is drawn with
ordinary tolerances and one effect planted in it. Then models are held against it, each as `massline add` would make it: the one
without the effect, the one with the right effect, and one with a wrong one, its most plausible neighbour. Two sweeps of each
campaign are held out of every fit.

    right     the plain error on the held-out sweeps comes to within 1.3 times that of a laboratory in which nothing is planted,
              and the size of the effect lies in its 90 % region
    wrong     it does not, or the evidence says which of the two is right

Everything that is finished is kept under ``out/cross_check_proof`` and not done again: interrupting loses none of it. What no
plain error can see, because the tolerances that it does not fit weigh as much as the fault, is said as that. Ends with 1 where a
family misses.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.identification_bars import code
from geometry.atomic import write_text
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from validation.effects.catalogue import Named, parse
from validation.effects.effect import Vocabulary, built_in_places, evidence_threshold
from validation.estimation.evaluate import evaluate, named, without
from validation.estimation.problem import EFFECT, Evaluation, Problem
from validation.history import add
from validation.history.add import starting_sizes
from validation.model.model import Model
from validation.prediction.series import SeriesPrediction, predictions
from validation.study import Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.planted import planted, reaching
from validation.virtual_test.simulate import VirtualTest, simulate

FOLDER = Path("out/cross_check_proof")
ROOMS = ("geometry", "fem", "identification", "validation/effects", "validation/engine", "validation/prediction")

CUBOID, BLADE, BLADES = "fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4"

WITHIN = 1.3
"""Times the plain error of a null model that the right effect may leave."""

LEAST = 0.1
"""[%] Plain error below which nothing is told apart: what is left of the noise once its mean is taken off."""

UNSEEN = ("y", "beta")
"""Sweeps of each campaign that no fit sees."""

SURE = 0.9
"""Probability of the region in which the size must lie."""

SWEEPS: Mapping[str, Any] = {"octaves_per_minute": 8.0}
"""Faster than the paper's by four: a line loses as much signal as noise."""

STIFFNESS = (4e8, 4e8, 2e9)
"""[N/m] of the cells of the FMD on which virtual tests stand."""

Json = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Case:
    """One planted effect.

    Attributes
    ----------
    planted : with its size, as in `massline simulate --effect`
    neighbour : the wrong effect that looks most like it
    articles : of the series
    """

    planted: str
    neighbour: str
    articles: tuple[str, ...] = (CUBOID, BLADE)

    @property
    def id(self) -> str:
        """Of what is planted."""
        return self.named.id

    @property
    def named(self) -> Named:
        """What is planted."""
        return parse(self.planted, words())


CASES = (
    Case(planted="point-mass:mast-top=0.5", neighbour="rigid-inertia:m"),
    Case(planted="rigid-inertia:Ixx=0.3", neighbour="force-plane-offset:y"),
    Case(planted="modulus:mast=0.15", neighbour="joint-compliance:rotation"),
    Case(planted="joint-compliance:rotation=4e-6", neighbour="modulus:mast"),
    Case(planted="structural-damping:mast=0.01", neighbour="structural-damping:lower-1"),
    Case(planted="layer-damping:upper-short=0.3", neighbour="structural-damping:upper-short", articles=(CUBOID, BLADE, BLADES)),
    Case(planted="appendage:z=m:0.3,f:21,zeta:0.02", neighbour="joint-compliance:vertical"),
    Case(planted="absorber:mast-top=m:0.3,f:21,zeta:0.02", neighbour="point-mass:mast-top"),
    Case(planted="slosh:mast-top=m:0.5,f:6,zeta:0.02", neighbour="point-mass:mast-top"),
    Case(planted="cable:mast-top:lateral=5000", neighbour="modulus:mast"),
    Case(planted="orientation:z=0.05", neighbour="rigid-inertia:Ixy"),
    Case(planted="mounting-offset:x=0.01", neighbour="rigid-inertia:mx"),
    Case(planted="gravity=0", neighbour="cable:mast-top:lateral"),
    Case(planted="force-gain:fmd-z2=0.15", neighbour="load-path-shunt:z"),
    Case(planted="load-path-shunt:x=0.1", neighbour="force-gain:fmd-x12"),
    Case(planted="force-delay:fmd-z2=2e-3", neighbour="board-delay:force"),
    Case(planted="board-delay:force=1e-3", neighbour="force-delay:fmd-z2"),
    Case(planted="force-highpass:fmd-x12=1", neighbour="force-delay:fmd-x12"),
    Case(planted="force-crosstalk:zx=0.05", neighbour="force-plane-offset:x"),
    Case(planted="force-plane-offset:x=0.02", neighbour="force-crosstalk:zx"),
    Case(planted="fmd-compliance:vertical=10", neighbour="accelerometer-gain:table-z1"),
    Case(planted="cell-stiffness:1z=1", neighbour="force-gain:fmd-z1"),
    Case(planted="accelerometer-gain:cover-z3=0.15", neighbour="accelerometer-position:cover-z3:x"),
    Case(planted="accelerometer-delay:cover-z3=2e-3", neighbour="board-delay:cover"),
    Case(planted="accelerometer-position:cover-z3:x=0.02", neighbour="accelerometer-gain:cover-z3"),
    Case(planted="accelerometer-misalignment:cover-z3:x=0.1", neighbour="accelerometer-position:cover-z3:y"),
    Case(planted="accelerometer-tilt=0", neighbour="gravity"),
    Case(planted="cover-plate-flexibility=2e-8", neighbour="joint-compliance:vertical"),
    Case(planted="polarity:fmd-z2", neighbour="force-gain:fmd-z2"),
    Case(planted="channel-swap:fmd-x12:fmd-y14", neighbour="force-crosstalk:zx"),
    Case(planted="unit:cover-z3=0.102", neighbour="accelerometer-gain:cover-z1"),
)
"""One of each family that acts in a linear test; friction, gap, saturation and what belongs to processing or pendulums do not."""


@cache
def words() -> Vocabulary:
    """What effects of virtual tests act on."""
    return Vocabulary(places=built_in_places())


@dataclass(frozen=True, eq=False, kw_only=True)
class Laboratory:
    """Where it happens.

    Attributes
    ----------
    plan : what every virtual test has in common
    model : what is known beforehand
    lines : (n,) [Hz] that are looked at; None for those of the paper
    """

    plan: Plan
    model: Model
    lines: Array | None = None

    @staticmethod
    def ordinary(seed: int) -> Laboratory:
        """Drawings, cells and tolerances as they are everywhere."""
        known = Model(source="proof", title="a virtual laboratory", article=BLADE, cell_stiffness=np.array(STIFFNESS))
        return Laboratory(plan=Plan(article=BLADE, seed=seed, **SWEEPS), model=known)


def proved(case: Case, lab: Laboratory, null: Json) -> Json:
    """Every figure of one case."""
    tests = series(case.articles, lab, case.planted)
    made = predictions(lab.model, [test.campaign for test in tests], lines=lab.lines)
    before = evaluated(Problem(made))
    right = added(case.id, made, before, lab.model)
    wrong = {case.neighbour: added(case.neighbour, made, before, lab.model)}
    return {
        "planted": case.planted,
        "null": null,
        "before": figures(before),
        "right": figures(right),
        "sizes": sizes(case.named, tests, right),
        "wrong": {name: figures(one) for name, one in wrong.items()},
    }


def series(articles: Sequence[str], lab: Laboratory, effect: str) -> list[VirtualTest]:
    """The series of `lab` with one `effect` wherever it acts; with nothing planted for none."""
    named = [parse(effect, words())] if effect else []
    plans = [replace(lab.plan, article=article) for article in articles]
    return [simulate(replace(plan, effects=planted(reaching(named, plan)))) for plan in plans]


def nothing_planted(articles: Sequence[str], lab: Laboratory) -> Json:
    """The figures of a null: a laboratory in which nothing is planted, and the model without effects."""
    campaigns = [test.campaign for test in series(articles, lab, "")]
    found = figures(evaluated(Problem(predictions(lab.model, campaigns, lines=lab.lines))))
    return found or {}


def added(name: str, made: Sequence[SeriesPrediction], before: Evaluation, known: Model) -> Evaluation | None:
    """The model with the effect `name` of open size, as `massline add` finds it; None where these data cannot hold it."""

    def problem(of: Model) -> Problem:
        return Problem(tuple(one.with_effects(of.effects) for one in made))

    try:
        effect, left = add.read(name, known, words(), fixed=False)
        study = Study(model=known, made=tuple(one.with_effects(()) for one in made))
        chosen = add.candidate(effect, left, study, allowed=True)
        start = starting_sizes(
            chosen.added, left, _fitted(problem(replace(known, effects=(chosen.added,)))), before.plain_fit.by_name
        )
        return evaluated(problem(replace(known, effects=(start,))), before)
    except (BadInput, CheckFailed):
        return None


def _fitted(problem: Problem) -> Problem:
    """What fits see of `problem`."""
    thinned = problem.thinned()
    return without(thinned, named(thinned, _unseen(thinned)))


def _unseen(problem: Problem) -> list[str]:
    return [f"{one.measured.name}/{run}" for one in problem.predictions for run in UNSEEN]


def evaluated(problem: Problem, parent: Evaluation | None = None) -> Evaluation:
    """The errors of a model, `UNSEEN` sweeps held out."""
    return evaluate(problem, hold_out=_unseen(problem), parent=parent)


def figures(of: Evaluation | None) -> Json | None:
    """Errors and evidence of one model."""
    if of is None:
        return None
    return {
        "plain": of.plain.percent,
        "sweeps": sweeps(of),
        "chi2_per_dof": of.fitted.chi2 / of.fitted.degrees_of_freedom,
        "tolerance_z2": of.fitted.tolerance_z2,
        "tolerances": of.fitted.tolerances,
        "log_evidence": of.fitted.log_evidence,
        "converged": of.plain_fit.converged and of.fitted.converged,
    }


def sweeps(of: Evaluation) -> dict[str, float]:
    """[%] of each sweep that was held out."""
    return dict(of.held_out.by_run) if of.held_out else {}


def overall(of: Json) -> float:
    """[%] of all sweeps."""
    return float(np.sqrt(np.mean(np.square(list(of["sweeps"].values())))))


def times(of: Json, null: Json) -> float:
    """The error of all sweeps as a multiple of that of the null."""
    return overall(of) / max(overall(null), LEAST)


def sizes(named: Named, tests: Sequence[VirtualTest], of: Evaluation | None) -> Json:
    """What was found of the sizes, the truth, and whether it lies in the joint region; empty where there is none to fit."""
    if of is None:
        return {}
    fit, truth = of.fitted, _truth(named, tests)
    at = [k for k, one in enumerate(fit.parameters) if one.kind == EFFECT]
    true = np.array([fit.parameters[k].offset(truth[_key(fit.parameters[k].name, named)]) for k in at])
    if not at:
        return {}
    off, C = fit.offsets[at] - true, fit.covariance[np.ix_(at, at)]
    found = {fit.parameters[k].name: fit.parameters[k].value(float(fit.offsets[k])) for k in at}
    return {
        "found": found,
        "truth": dict(zip(found, (truth[_key(name, named)] for name in found), strict=True)),
        "sigma": float(np.sqrt(off @ np.linalg.solve(C, off))),
        "inside": bool(off @ np.linalg.solve(C, off) <= _quantile(len(at))),
    }


def _truth(named: Named, tests: Sequence[VirtualTest]) -> dict[str, float]:
    """The sizes: what was planted on top of what the seed has drawn of the same."""
    drawn: Mapping[str, float] = dict(pair for test in tests for pair in _tolerances(test))
    return {key: drawn.get(named.id, value) if not key else value for key, value in named.values.items()}


def _tolerances(test: VirtualTest) -> Iterator[tuple[str, float]]:
    stated: Any = test.truth["tolerances"]
    yield from stated.items()


def _key(name: str, named: Named) -> str:
    return name.removeprefix(named.id).strip("[]")


def _quantile(count: int) -> float:
    from scipy.stats import chi2

    return float(chi2.ppf(SURE, count))


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What a case shows.

    Attributes
    ----------
    falls : the right effect brings the plain error to within `WITHIN` of the null's
    visible : before, it was not there
    inside : the size lies in its region; None where there is none to fit
    worth : the evidence speaks for the right effect
    beaten : no wrong effect brings the plain error there, or the evidence prefers the right one by what its family is asked for
    """

    falls: bool
    visible: bool
    inside: bool | None
    worth: bool
    beaten: bool

    @property
    def met(self) -> bool:
        """Whether nothing is missed."""
        return self.falls and self.inside is not False and self.worth and self.beaten

    @property
    def words(self) -> str:
        """What is missed, or that it is met."""
        missed = [
            (not self.falls, "right effect does not bring the error down"),
            (self.inside is False, "size outside its region"),
            (not self.worth, "evidence does not speak for it"),
            (not self.beaten, "a wrong effect does as well"),
        ]
        said = "; ".join(text for wrong, text in missed if wrong) or "met"
        return said if self.visible else f"{said} (plain error cannot see it)"


def verdict(found: Json) -> Verdict:
    """What the figures of one case show."""
    null, right, before = found["null"], found["right"], found["before"]
    visible = times(before, null) > WITHIN
    if right is None:
        return Verdict(falls=False, visible=visible, inside=None, worth=False, beaten=False)
    asked = evidence_threshold(parse(found["planted"], words()).family)
    return Verdict(
        falls=times(right, null) <= WITHIN,
        visible=visible,
        inside=found["sizes"].get("inside"),
        worth=right["log_evidence"] - before["log_evidence"] > asked,
        beaten=all(one is None or _is_beaten(one, right, null, asked) for one in found["wrong"].values()),
    )


def _is_beaten(wrong: Json, right: Json, null: Json, asked: float) -> bool:
    return times(wrong, null) > WITHIN or right["log_evidence"] - wrong["log_evidence"] > asked


def kept(case: Case, seed: int) -> Json:
    """The figures of `case`, from an earlier run of the same code or made."""
    file = _file(case.id, seed)
    if not file.exists():
        write_text(file, json.dumps(proved(case, Laboratory.ordinary(seed), _null(case.articles, seed))))
    found: Json = json.loads(file.read_text(encoding="utf-8"))
    return found


def _null(articles: tuple[str, ...], seed: int) -> Json:
    """Of a laboratory in which nothing is planted."""
    file = _file("null-" + "-".join(articles), seed)
    if not file.exists():
        write_text(file, json.dumps(nothing_planted(articles, Laboratory.ordinary(seed))))
    found: Json = json.loads(file.read_text(encoding="utf-8"))
    return found


def _file(name: str, seed: int) -> Path:
    folder = FOLDER / _code() / str(seed)
    folder.mkdir(parents=True, exist_ok=True)
    return folder / f"{name.replace(':', '_').replace('+', '_')}.json"


@cache
def _code() -> str:
    return code(ROOMS)


def row(case: Case, found: Json) -> list[str]:
    """One line of the table."""
    null, size = found["null"], found["sizes"]
    wrong = "\n".join(f"{name} {_percent(one, null)} {_nats(one, found)}" for name, one in found["wrong"].items())
    told = "\n".join(f"{size['found'][name]:.3g} ({size['truth'][name]:.3g})" for name in size["found"]) if size else "–"
    errors = [_percent(found[name], null) for name in ("null", "before", "right")]
    return [case.planted, *errors, _nats(found["right"], found), told, wrong, verdict(found).words]


def _percent(of: Json | None, null: Json) -> str:
    return "–" if of is None else f"{overall(of):.2f} ({times(of, null):.2f})"


def _nats(of: Json | None, found: Json) -> str:
    return "–" if of is None else f"{of['log_evidence'] - found['before']['log_evidence']:+.0f}"


def printed(rows: Sequence[list[str]], seed: int) -> Table:
    """The figures as a table."""
    table = Table(title=f"Plain error on held-out sweeps, % (times null); evidence gained, nats; laboratory {seed}")
    for head in ("planted", "null", "before", "right", "nats", "size (truth)", "wrong", "verdict"):
        table.add_column(head, justify="right" if head in ("null", "before", "right", "nats") else "left")
    for one in rows:
        table.add_row(*one)
    return table


def main(seed: int = 1, *names: str) -> int:
    """Print the table; 1 when a family misses."""
    console, rows, missed = Console(), [], 0
    for case in (one for one in CASES if not names or one.id in names or one.named.family in names):
        try:
            found = kept(case, seed)
        except CheckFailed as error:
            missed += 1
            rows.append([case.planted, *6 * ["–"], f"refused: {error}"])
            continue
        rows.append(row(case, found))
        missed += not verdict(found).met
        console.print(f"{case.id}: {verdict(found).words}", style="dim")
    console.print(printed(rows, seed))
    console.print(f"{len(rows) - missed} of {len(rows)} families met")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(*(int(one) if one.isdigit() else one for one in sys.argv[1:])))  # type: ignore[arg-type]
