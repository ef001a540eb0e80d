"""The joint fit: annealed, with as many poles as pay, and its covariance told apart by input."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from geometry.dynamic_mass import DynamicMass
from geometry.frames import Array, Integers
from geometry.inertia import Inertia
from identification import request
from identification.dynamic_mass import from_runs
from identification.elastic import model
from identification.elastic.model import ElasticTerms
from identification.request import Evidence, Identified, Settings
from identification.self_calibration import likelihood
from identification.self_calibration.likelihood import residual
from identification.self_calibration.problem import FAMILY, Assembly, Layout, NearPart, Part, assembled, felt, normals, of_article
from identification.self_calibration.solve import CLOSE, MOST, NOTHING, Solution, inverse, minimise, total

# One pole more, where lines do not fit: closer to its neighbours, or weaker, than the errors of the plain chain let one see.
#
# With the chain as the joint fit found it, Eqs. 6 to 11 give a dynamic mass in which a per mille is left of the per cents by
# which sensors were off. What it holds beyond the fitted one at the line that fits worst is, at a resonance, -i l l^T / (2
# zeta): its leading eigenvector is where the participation of a further pole begins.

MISFIT = 8.0
"""How far above the median of all lines a line may lie before a pole is looked for."""

DAMPING = 0.003
"""Damping ratio at which a further pole begins."""

REACH_OF_POLE = (1.1, 1.2, 1.35, 1.6)
"""Where a pole above the band may begin, in the end of the band."""

ELASTIC = "elastic:article"


def dynamic_mass(problem: Assembly, x: Array) -> DynamicMass:
    """The dynamic mass of the article's campaign at its chosen lines, by Eqs. 6 to 11 with the chain as it is at `x`."""
    part = problem.parts(1.0)[0]
    chain, f = part.chain, part.observed.frequency
    a0, a1 = chain.rows(x[part.offsets], f)
    y = part.observed.values[..., None]
    cover, force = ([chain.names.index(one.name) for one in group.channels] for group in (chain.cover, chain.forces))
    motion, load = (np.linalg.pinv(rows[:, at]) @ y[:, :, at] for rows, at in ((a0, cover), (a1, force)))
    return from_runs(load[..., 0], motion[..., 0], f, problem.campaigns[0].spectra.table.origin).dynamic_mass


def with_one_more(problem: Assembly, x: Array, line: int) -> tuple[Assembly, Array] | None:
    """The problem with a pole at `line`, and where to begin; None where what is left there is no resonance."""
    structure, layout = problem.campaigns[0].structure, problem.layout
    measured = dynamic_mass(problem, x)
    f = measured.frequency
    left = (measured.matrix - structure.dynamic_mass(layout, x, f))[line].imag / np.outer(model.SCALE, model.SCALE)
    values, vectors = np.linalg.eigh(-(left + left.T) / 2)
    if values[-1] <= 0:
        return None
    pole = model.SCALE * vectors[:, -1] * np.sqrt(2 * DAMPING * values[-1])
    return _longer(problem, x, float(f[line]), pole)


def with_one_beyond(problem: Assembly, x: Array) -> tuple[Assembly, Array] | None:
    """The problem with a pole above the band, and where to begin; None where what is left over does not rise like one.

    What omega² R leaves of poles beyond rises with omega⁴: omega² / (omega_h² - omega²) is fitted to it beside 1 and omega².
    """
    structure, layout = problem.campaigns[0].structure, problem.layout
    measured = dynamic_mass(problem, x)
    f, of_fit = measured.frequency, structure.dynamic_mass(layout, x, measured.frequency)
    weight = 1 / np.abs(of_fit / np.outer(model.SCALE, model.SCALE)).max(axis=(1, 2))
    left = weight[:, None] * ((measured.matrix - of_fit).real / np.outer(model.SCALE, model.SCALE)).reshape(-1, 36)
    least, beyond, Q = np.inf, 0.0, np.zeros((6, 6))
    for pole in np.array(REACH_OF_POLE) * f[-1]:
        basis = weight[:, None] * np.stack([f**2 / (pole**2 - f**2), np.ones_like(f), f**2 / pole**2], axis=1)
        amplitudes = np.linalg.lstsq(basis, left)[0]
        squares = float(np.sum(np.square(left - basis @ amplitudes)))
        if squares < least:
            least, beyond, Q = squares, float(pole), amplitudes[0].reshape(6, 6)
    values, vectors = np.linalg.eigh((Q + Q.T) / 2)
    return _longer(problem, x, beyond, model.SCALE * vectors[:, -1] * np.sqrt(values[-1])) if values[-1] > 0 else None


def _longer(problem: Assembly, x: Array, frequency: float, participation: Array) -> tuple[Assembly, Array]:
    """One pole more: its damping is coupled to that of poles that feel it, others stay coupled as they are."""
    structure, layout = problem.campaigns[0].structure, problem.layout
    alone, before = structure.terms(layout, x), structure.elastic
    m = len(alone.frequency)
    C = np.zeros((m + 1, m + 1))
    C[:m, :m], C[m, m] = alone.damping, 4 * np.pi * DAMPING * frequency
    terms = ElasticTerms(
        frequency=np.append(alone.frequency, frequency),
        damping=C,
        participation=np.vstack([alone.participation, participation]),
        residual=alone.residual,
    )
    coupled = tuple(pair for pair in felt(terms) if m in pair)
    coupled = tuple(sorted((*(() if before is None else before.pairs), *coupled)))
    elastic, made = of_article(ELASTIC, structure.ten(layout, x), terms, pairs=coupled)
    return replaced(problem, x, elastic, Layout(blocks=tuple(made if b.name == ELASTIC else b for b in layout.blocks)))


def replaced(problem: Assembly, x: Array, elastic: model.ElasticLayout, layout: Layout) -> tuple[Assembly, Array]:
    """The problem with `elastic` terms of the article laid out anew in `layout`, and where to begin: at `x` in all else."""
    start = layout.start
    for one in layout.blocks:
        if one.name != ELASTIC:
            start[layout.at(one.name)] = x[problem.layout.at(one.name)]
    first, *others = problem.campaigns
    changed = replace(first, structure=replace(first.structure, elastic=elastic))
    return replace(problem, layout=layout, campaigns=(changed, *others)), start


# Poles and couplings that only errors of the chain called for go again, once the chain is free to explain them itself.
#
# The elastic terms begin from a plain dynamic mass, which gains, angles and positions falsify by per cents: some of its poles
# make up for a slope or a bump that sensors made. In the joint fit they are worth nothing. What chi² would rise by if a pole's
# participation were zero, all else refitted to second order, is l^T C_ll^-1 l (Wald; the exponent of Savage and Dickey's ratio
# with Gaussian priors). Poles go the weakest first, each time with what the others then are.

COUPLED = 1.0
"""Standard deviations from zero from which the coupled damping of a pair is kept: below, the prior at zero says as much."""


def pruned(problem: Assembly, solution: Solution, size: int, *, below: float = np.inf) -> tuple[Assembly, Array] | None:
    """The problem without what does not pay in the article's campaign, and where to begin; None where all of it pays.

    Parameters
    ----------
    size : real numbers in the data: a parameter must take ln(size) out of chi² (Schwarz 1978)
    below : [Hz] poles that may go; beyond the band several act as one as long as the rest is coarse
    """
    structure, layout, elastic = problem.campaigns[0].structure, problem.layout, problem.campaigns[0].structure.elastic
    if elastic is None or not elastic.modes:
        return None
    # Vector and covariance with the participation of weak poles held at zero, and which those are
    x, C, gone = solution.x, inverse(solution.normal.matrix), set[int]()
    stays = structure.terms(layout, x).frequency > below
    while left := {r: _participation(problem, r) for r in range(elastic.modes) if r not in gone and not stays[r]}:
        # What chi² would rise by without each pole
        worth = {r: float(x[at] @ np.linalg.solve(C[np.ix_(at, at)], x[at])) for r, at in left.items()}
        if worth[least := min(left, key=worth.__getitem__)] >= pole_penalty(size):
            break
        weak = left[least]
        gain = np.linalg.solve(C[np.ix_(weak, weak)], C[weak]).T
        x, C = x - gain @ x[weak], C - gain @ C[weak]
        gone.add(least)
    at = _first(problem) + np.arange(elastic.size)[elastic.blocks["pairs"]]
    known = np.abs(x[at]) > COUPLED * np.sqrt(np.maximum(np.diag(C)[at], 0.0))
    pairs = tuple(pair for pair, keep in zip(elastic.pairs, known, strict=True) if keep)
    rest = [r for r in range(elastic.modes) if r not in gone]
    kept = tuple((r, s) for r, s in pairs if r in rest and s in rest)
    if not gone and kept == elastic.pairs:
        return None
    place = {r: k for k, r in enumerate(rest)}
    terms = model.chosen(structure.terms(layout, x), rest)
    elastic, made = of_article(ELASTIC, structure.ten(layout, x), terms, pairs=tuple((place[r], place[s]) for r, s in kept))
    return replaced(problem, x, elastic, Layout(blocks=tuple(made if b.name == ELASTIC else b for b in layout.blocks)))


def pole_penalty(size: int) -> float:
    """What a pole - frequency, damping, participation - must take out of chi²."""
    return 8 * float(np.log(size))


def _first(problem: Assembly) -> int:
    """Where the elastic layout would begin: its own first ten are the block of the article."""
    return int(problem.layout.at(ELASTIC).start) - 10


def _participation(problem: Assembly, r: int) -> Integers:
    elastic = problem.campaigns[0].structure.elastic
    begin = 0 if elastic is None else elastic.blocks["participation"].start
    return np.asarray(_first(problem) + begin + 6 * r + np.arange(6))


# A bootstrap of the joint fit, linearised at its minimum, so that a thousand draws cost next to nothing.
#
# Near the minimum a change of the data moves the estimate by -C s, s the change of the gradient. The likelihood takes noise for
# independent from line to line; the block bootstrap draws from the residuals that are there: runs are cut into blocks of
# neighbouring lines, blocks are drawn with replacement (Kuensch, Ann. Statist. 17 (1989) 1217), and what each contributes to the
# gradient comes along with whatever correlation it has. Priors are drawn anew.

BLOCK = 1.0
"""[Hz] of a block: wider than a resonance."""

DRAWS = 2000


def bootstrap_scores(parts: Sequence[Part], layout: Layout, x: Array) -> list[Array]:
    """By campaign (b, k): what every block of lines of every run contributes to the gradient at `x`."""
    found = []
    for part in parts:
        by_line = likelihood.gradients(part.observed, part.rows(layout, x)) @ part.selection(layout)  # (r, n, k)
        f = part.observed.frequency
        at = np.floor((f - f[0]) / BLOCK).astype(np.int64)
        found.append(np.concatenate([np.stack([run[at == one].sum(axis=0) for one in np.unique(at)]) for run in by_line]))
    return found


def blocks(C: Array, found: Sequence[Array], rows: Array, rng: np.random.Generator, draws: int = DRAWS) -> Array:
    """(draws, k) changes of the estimate with blocks of residuals drawn with replacement, campaign by campaign."""
    change = rng.standard_normal((draws, len(rows))) @ rows
    for one in found:
        times = rng.multinomial(len(one), np.full(len(one), 1 / len(one)), size=draws) - 1.0
        change = change + times @ one
    return np.asarray(change @ C)


# From the joint minimum to an `Identified`: covariance, where it comes from, misfit and the price of the tolerances.
#
# The posterior covariance of the whole vector is C = (J^T J + A^T A)^-1 = C J^T J C + sum C A_b^T A_b C: what noise gives, and
# what every family b of tolerances leaves. Noise counts for elasticity as far as it would be less were the elastic terms known.

NOISE = "noise"

CHAIN = "chain:"
"""How the names of the blocks begin that hold tolerances of the measurement chain."""

SEED = 5
"""Of the block bootstrap: the same data give the same result."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Posterior:
    """The joint minimum to second order.

    Attributes
    ----------
    data : (k, k) J^T J, divided by the misfit where that is above 1: noise is then larger than was thought
    rows : (p, k) whitened knowledge
    families : (p,)
    covariance : (k, k)
    misfit : chi² of the data for each degree of freedom
    """

    data: Array
    rows: Array
    families: tuple[str, ...]
    covariance: Array
    misfit: float

    def parts(self, layout: Layout) -> dict[str, Array]:
        """By input its part (10, 10) of the covariance of the article's parameters; they add up to it."""
        article = layout.at("article")
        C = self.covariance[article]
        through = C @ self.rows.T
        families = np.array(self.families)
        split = {name: through[:, families == name] @ through[:, families == name].T for name in dict.fromkeys(self.families)}
        noise = C @ self.data @ C.T
        # The variance that noise gives the article's parameters where the elastic ones are known
        others = np.flatnonzero([not name.startswith("elastic:") for name in layout.owners])
        data, rows = self.data[np.ix_(others, others)], self.rows[:, others]
        held = inverse(data + rows.T @ rows)[np.searchsorted(others, np.arange(article.start, article.stop))]
        variance = np.sum((held @ data) * held, axis=1)
        kept = np.sqrt(np.minimum(variance / np.maximum(np.diag(noise), np.finfo(np.float64).tiny), 1.0))
        rigid = kept[:, None] * noise * kept
        split = {NOISE: rigid, **split, FAMILY: split.get(FAMILY, np.zeros((10, 10))) + noise - rigid}
        return {name: part for name, part in split.items() if np.any(np.diag(part) > 0)}

    def gained(self, problem: Assembly) -> dict[str, Array]:
        """By classical fact, how many times wider every interval of the ten would be without it, (10,)."""
        article = problem.layout.at("article")
        with_all = np.diag(self.covariance)[article]
        families = np.array(self.families)
        widened = {}
        for fact in problem.facts:
            rows = self.rows[families != request.name(fact)]
            widened[request.name(fact)] = np.sqrt(np.diag(inverse(self.data + rows.T @ rows))[article] / with_all)
        return widened


def posterior(problem: Assembly, solution: Solution, settings: Settings) -> Posterior:
    """The covariance of everything that was estimated."""
    rows = problem.knowledge(solution.x)[1]
    size = sum(part.observed.size for part in problem.parts(settings.floor))
    effective = float(np.sum(inverse(solution.data.matrix + rows.T @ rows) * solution.data.matrix))
    misfit = 2 * solution.data.cost / max(size - effective, 1.0)
    data = solution.data.matrix / max(misfit, 1.0)
    return Posterior(data=data, rows=rows, families=problem.families, covariance=inverse(data + rows.T @ rows), misfit=misfit)


def identified(problem: Assembly, solution: Solution, settings: Settings) -> Identified:
    """The article's ten parameters at the joint minimum."""
    layout, article = problem.layout, problem.layout.at("article")
    found = posterior(problem, solution, settings)
    split = found.parts(layout)
    if np.any(problem.drift):
        split[FAMILY] = split.get(FAMILY, np.zeros((10, 10))) + np.outer(problem.drift, problem.drift)
    covariance = np.sum(list(split.values()), axis=0)
    structure, warnings = problem.campaigns[0].structure, problem.warnings
    if not solution.converged:
        far = f"after {solution.evaluations} evaluations the next step is still {solution.decrement:.3g} standard deviations"
        warnings = (*warnings, f"the joint fit did not converge: {far}; do not trust its figures")
    tolerances = [one for one in layout.blocks if one.name.startswith(CHAIN)]
    scores = bootstrap_scores(problem.parts(settings.floor), layout, solution.x)
    scaled = [one / max(found.misfit, 1.0) for one in scores]
    draws = blocks(found.covariance, scaled, found.rows, np.random.default_rng(SEED))
    return Identified(
        way="self-calibrated",
        inertia=Inertia(parameters=solution.x[article]),
        covariance=covariance,
        band=problem.band,
        elastic=None if structure.elastic is None else structure.terms(layout, solution.x),
        shares={name: np.diag(part) / np.diag(covariance) for name, part in split.items()},
        misfit=found.misfit,
        surprise=float(sum(np.sum(np.square(one.rows @ solution.x[layout.at(one.name)])) for one in tolerances)),
        tolerances=sum(len(one.families) for one in tolerances),
        converged=solution.converged,
        parts=split,
        gained=found.gained(problem),
        resampled=np.asarray(np.cov(draws[:, article].T)),
        warnings=warnings,
    )


_DEFAULT = Settings()

ANNEALED = (0.02, 0.005)
"""Model-error floors that come before the one asked for: a coarse likelihood is found from farther."""

FURTHER = 1
"""Poles that are added at most where the joint fit shows lines that do not fit."""

MOST_BEYOND = 3
"""Poles beyond the band up to which one more is tried: the residual mass leaves of those there what rises with omega⁴."""

LET_IN = 16.0
"""What such a pole must take out of chi², twice its eight parameters (Akaike 1974): there are poles beyond for certain."""

ROUNDS = 6
"""Points about which the cost is told to second order in H before all is evaluated at every step."""

NEAR = 30
"""Evaluations near each of them."""

FURTHER_STEPS = 20
"""Evaluations after which a further pole that does not pay yet is given up."""


def calibrated(
    evidence: Evidence, settings: Settings = _DEFAULT, *, progress: Callable[[float], None] | None = None
) -> Identified:
    """The article's ten parameters about F with every tolerance of the measurement chain estimated beside them.

    Without a tare and without a known FMD the result includes the FMD, and a warning says so.

    Parameters
    ----------
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : tare and article of different `hardware` without `settings.any_hardware`; a channel table that differs.
    """
    tell = progress or (lambda share: None)
    problem = assembled(evidence, settings)
    tell(0.3)
    searched = settings.modes is None
    problem, x = _annealed(problem, settings, prune=searched)
    solution = _minimum(problem, settings.floor, x, progress=lambda share: tell(0.3 + 0.5 * share))
    if searched:
        problem, solution = _completed(problem, solution, settings)
        # Poles in the band that do not pay at the floor asked for go; those beyond it were let in by what they took
        shorter = pruned(problem, solution, _size(problem, settings.floor), below=problem.band[1])
        if shorter is not None and shorter[0].modes < problem.modes:
            problem, solution = shorter[0], _minimum(shorter[0], settings.floor, shorter[1])
    there = _minimum(problem, settings.floor, solution.x, most=1)  # its covariance is made of the equations of the place itself
    found = identified(problem, replace(solution, seen=there.seen, normal=there.normal, data=there.data), settings)
    tell(1.0)
    return found


def _annealed(problem: Assembly, settings: Settings, *, prune: bool = False) -> tuple[Assembly, Array]:
    """Down through the annealed floors: the problem, plainer where poles do not pay any longer, and where they led."""
    x = problem.layout.start
    for floor in [one for one in ANNEALED if one > settings.floor]:
        coarse = _minimum(problem, floor, x, close=0.3, most=8)
        # The normal equations at the place of a `coarse` solution with the weights of another `settings.floor`
        at_last = _minimum(problem, settings.floor, coarse.x, most=0) if prune else coarse
        shorter = pruned(problem, at_last, _size(problem, settings.floor), below=problem.band[1]) if prune else None
        problem, x = shorter or (problem, coarse.x)
    return problem, x


def _completed(problem: Assembly, solution: Solution, settings: Settings) -> tuple[Assembly, Solution]:
    """The fit with a few further poles where they pay: beyond the band, and where lines do not fit."""
    for _ in range(MOST_BEYOND - problem.modes_beyond(solution.x) if problem.modes else 0):
        more = _paid(with_one_beyond(problem, solution.x), solution, settings, LET_IN)
        if more is None:
            break
        problem, solution = more
    for _ in range(FURTHER):
        part = problem.parts(settings.floor)[0]
        left = residual(part.observed, part.rows(problem.layout, solution.x, changes=False))
        by_line = np.mean(np.abs(left) ** 2, axis=(0, 2))
        worst, usual = int(np.argmax(by_line)), max(float(np.median(by_line)), np.finfo(np.float64).tiny)
        longer = with_one_more(problem, solution.x, worst) if by_line[worst] / usual > MISFIT else None
        price = pole_penalty(_size(problem, settings.floor))
        problem, solution = _paid(longer, solution, settings, price) or (problem, solution)
    return problem, solution


def _paid(
    longer: tuple[Assembly, Array] | None, solution: Solution, settings: Settings, price: float
) -> tuple[Assembly, Solution] | None:
    """The minimum with one pole more; None where it takes less than `price` out of chi²."""
    if longer is None:
        return None
    worth = solution.normal.cost - price / 2
    more = _minimum(longer[0], settings.floor, longer[1], most=FURTHER_STEPS, worth=worth)
    if more.normal.cost > worth:
        return None
    return longer[0], more if more.converged else _minimum(longer[0], settings.floor, more.x)


def _size(problem: Assembly, floor: float) -> int:
    return sum(part.observed.size for part in problem.parts(floor))


def fitted(problem: Assembly, settings: Settings, *, progress: Callable[[float], None] | None = None) -> Solution:
    """The joint minimum, down through the annealed floors."""
    return _minimum(problem, settings.floor, _annealed(problem, settings)[1], progress=progress)


def _minimum(
    problem: Assembly,
    floor: float,
    start: Array,
    *,
    close: float = CLOSE,
    most: int = MOST,
    progress: Callable[[float], None] | None = None,
    worth: float = np.inf,
) -> Solution:
    """The minimum for the weights of `floor`, of the cost near one point after another; of the cost itself where that fails.

    It is given up where it will not come below a cost of `worth`.
    """
    parts, layout, size, found = problem.parts(floor), problem.layout, _size(problem, floor), None
    least = partial(minimise, knowledge=problem.knowledge, close=close, asked=layout.at("article"), size=size, worth=worth)
    best, lowest, x = start, np.inf, start
    about: list[NearPart] = []
    for _ in range(ROUNDS if most > 1 else 0):
        about[:] = [part.near(layout, x, 0.5 * close**2) for part in parts]
        if found is not None and found.converged and all(one.known for one in about):
            return found
        here = sum(one.exact for one in about) + 0.5 * float(np.sum(np.square(problem.knowledge(x)[0])))
        if not here < lowest + NOTHING:
            break
        best, lowest = x, here
        found = least(
            lambda to: total([one.normal(to) for one in about], len(to)),
            x,
            most=NEAR,
            cost=lambda to: sum(one.cost(to) for one in about),
        )
        x = found.x
        if not found.converged and found.beyond_hope(worth):
            return found
    return least(
        lambda x: total(normals(parts, layout, x), len(x)),
        best,
        most=most,
        progress=progress,
        cost=lambda x: sum(part.cost(layout, x) for part in parts),
    )
