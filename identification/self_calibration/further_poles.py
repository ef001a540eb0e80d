"""One pole more, where lines do not fit: closer to its neighbours, or weaker, than the errors of the plain chain let one see.

With the chain as the joint fit found it, Eqs. 6 to 11 give a dynamic mass in which a per mille is left of the per cents by which
sensors were off. What it holds beyond the fitted one at the line that fits worst is, at a resonance, -i l l^T / (2 zeta): its
leading eigenvector is where the participation of a further pole begins.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from identification.dynamic_mass import from_runs
from identification.elastic import model
from identification.elastic.terms import ElasticTerms
from identification.self_calibration import elastic_block
from identification.self_calibration.assembly import Assembly
from identification.self_calibration.layout import Layout
from identification.self_calibration.likelihood import residual

MISFIT = 8.0
"""How far above the median of all lines a line may lie before a pole is looked for."""

DAMPING = 0.003
"""Damping ratio at which a further pole begins."""

BEYOND = (1.1, 1.2, 1.35, 1.6)
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


def worst(problem: Assembly, x: Array, floor: float) -> tuple[int, float]:
    """The line of the article's campaign that fits worst, and its misfit in the median of all lines."""
    part = problem.parts(floor)[0]
    by_line = np.mean(np.abs(residual(part.observed, part.rows(problem.layout, x, changes=False))) ** 2, axis=(0, 2))
    k = int(np.argmax(by_line))
    return k, float(by_line[k] / max(float(np.median(by_line)), np.finfo(np.float64).tiny))


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
    tried = {share: _rising(left, weight, f, share * float(f[-1])) for share in BEYOND}
    share = min(tried, key=lambda one: tried[one][1])
    beyond, Q = share * float(f[-1]), tried[share][0]
    values, vectors = np.linalg.eigh((Q + Q.T) / 2)
    return _longer(problem, x, beyond, model.SCALE * vectors[:, -1] * np.sqrt(values[-1])) if values[-1] > 0 else None


def _rising(left: Array, weight: Array, f: Array, beyond: float) -> tuple[Array, float]:
    """Amplitudes (6, 6) of a pole at `beyond` [Hz] in what is `left` (n, 36), weighted, and the squares that remain."""
    basis = weight[:, None] * np.stack([f**2 / (beyond**2 - f**2), np.ones_like(f), f**2 / beyond**2], axis=1)
    found = np.linalg.lstsq(basis, left)[0]
    return found[0].reshape(6, 6), float(np.sum(np.square(left - basis @ found)))


def _longer(problem: Assembly, x: Array, frequency: float, participation: Array) -> tuple[Assembly, Array]:
    """One pole more: its damping is coupled to that of poles that feel it, others stay coupled as they are."""
    structure, layout = problem.campaigns[0].structure, problem.layout
    before, terms = structure.elastic, _extended(structure.terms(layout, x), frequency, participation)
    new = len(terms.frequency) - 1
    coupled = tuple(pair for pair in elastic_block.felt(terms) if new in pair)
    coupled = tuple(sorted((*(() if before is None else before.pairs), *coupled)))
    elastic, made = elastic_block.of_article(ELASTIC, structure.ten(layout, x), terms, pairs=coupled)
    return replaced(problem, x, elastic, Layout(blocks=tuple(made if b.name == ELASTIC else b for b in layout.blocks)))


def _extended(terms: ElasticTerms, frequency: float, participation: Array) -> ElasticTerms:
    m = len(terms.frequency)
    C = np.zeros((m + 1, m + 1))
    C[:m, :m], C[m, m] = terms.damping, 4 * np.pi * DAMPING * frequency
    return ElasticTerms(
        frequency=np.append(terms.frequency, frequency),
        damping=C,
        participation=np.vstack([terms.participation, participation]),
        residual=terms.residual,
    )


def replaced(problem: Assembly, x: Array, elastic: model.Layout, layout: Layout) -> tuple[Assembly, Array]:
    """The problem with `elastic` terms of the article laid out anew in `layout`, and where to begin: at `x` in all else."""
    start = layout.start
    for one in layout.blocks:
        if one.name != ELASTIC:
            start[layout.at(one.name)] = x[problem.layout.at(one.name)]
    first, *others = problem.campaigns
    changed = replace(first, structure=replace(first.structure, elastic=elastic))
    return replace(problem, layout=layout, campaigns=(changed, *others)), start
