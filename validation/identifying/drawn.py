"""The pictures of `massline identify`: what each of them shows, from the findings."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from identification.elastic.model import dynamic_mass
from identification.elastic.terms import ElasticTerms
from validation.article_reference import file_name
from validation.identifying.findings import Findings, Lines, Study
from validation.identifying.reported import Reported
from validation.pictures import identification as pages
from validation.pictures.curves import LEFT_OUT, MEASURED, Curve, diagonal, full
from validation.statement import QUANTITIES

PRODUCT = 1e3
"""Products are shown in g m²: as a share of a product that is almost zero their deviation says nothing."""

FINE = 1401
"""Lines of the fitted curve: narrow resonances stay round."""

SHARP = 0.05
"""Damping ratio above which a term is no resonance that could be pointed at, but bends the curve where the others leave it."""

QUOTIENT = "#b9a5dd"
"""Of the quotient, beneath what is measured with all runs."""

POINT = "about F; loads of the table on the article"


@dataclass(frozen=True, eq=False, kw_only=True)
class _Terms:
    """Elastic terms as resonances to be marked, in ascending order."""

    frequency: Array
    effective_mass: Array


def draw(found: Findings, folder: Path) -> tuple[Path, ...]:
    """Write every picture that `found` has the evidence for into `folder`, and say where they are."""
    made = []

    def to(name: str) -> Path:
        made.append(folder / f"{file_name(f'identify-{found.article}-{name}')}.png")
        return made[-1]

    if found.lines is not None:
        _lines(found, found.lines, to("lines"))
    if found.dynamic_mass is not None:
        _diagonal(found, found.dynamic_mass, to("dynamic-mass"))
        _full(found, found.dynamic_mass, to("dynamic-mass-6x6"))
    if found.residuals is not None:
        _residuals(found, found.residuals, to("residuals"))
    if found.study is not None:
        for number, what in enumerate(found.study.maps):
            _stability(found, found.study, what, to(f"stability{'-rigid' if number else ''}"))
    if any(one.quality.shares for one in found.results):
        _shares(found, to("shares"))
    return tuple(made)


def _lines(found: Findings, lines: Lines, path: Path) -> None:
    spectra = found.spectra
    drawn = pages.DrawnLines(
        frequency=lines.frequency,
        condition=lines.condition,
        limit=lines.limit,
        left_out=lines.kept == 0,
        runs=() if spectra is None else spectra.runs,
        unexplained=np.zeros((0, len(lines.frequency))) if spectra is None else 1 - spectra.quality,
    )
    note = "Condition number of the base motions of all runs at a line, every axis divided by its nominal level."
    pages.draw_lines(f"{_stack(found)}: lines of the spectra", drawn, path, note)


def _stack(found: Findings) -> str:
    """What was on the load cells: pictures of measurements are about all of it."""
    return found.request.campaign.article


def curves(found: Findings, H: DynamicMass) -> tuple[Curve, ...]:
    """The measured dynamic mass H about F, lines that were left out apart, and what was fitted to it."""
    own = found.result.identified.inertia.mass_matrix
    rigid, modes = own if found.rigid is None else found.rigid, _Terms(frequency=np.zeros(0), effective_mass=np.zeros((0, 6)))
    terms = found.result.identified.elastic
    fine = np.linspace(H.frequency[0], H.frequency[-1], FINE)
    fitted = np.tile(rigid + 0j, (FINE, 1, 1)) if terms is None else dynamic_mass(rigid, terms, fine)
    count = 0 if terms is None else len(terms.frequency)
    if terms is not None:
        modes = _marks(terms)
    kept = np.ones(len(H.frequency), dtype=bool) if found.lines is None else found.lines.kept > 0
    model = DynamicMass(frequency=fine, matrix=fitted, reference_point=H.reference_point)
    drawn = [
        *_quotient(found, H, rigid, modes),
        Curve(name="measured, channels as they are", mass=_at(H, kept), rigid=rigid, modes=modes, dots=MEASURED),
        Curve(name=f"{found.result.identified.way}, {count} elastic terms", mass=model, rigid=rigid, modes=modes),
    ]
    if not kept.all():
        drawn.append(Curve(name="left out", mass=_at(H, ~kept), rigid=rigid, modes=modes, dots=LEFT_OUT))
    return tuple(drawn)


def _quotient(found: Findings, H: DynamicMass, rigid: Array, modes: _Terms) -> list[Curve]:
    if found.crossed is None:
        return []
    mass = DynamicMass(frequency=H.frequency, matrix=found.crossed.quotient, reference_point=H.reference_point)
    return [Curve(name="quotient of the driven axis, Eq. 8a", mass=mass, rigid=rigid, modes=modes, dots=QUOTIENT)]


def _at(H: DynamicMass, chosen: np.ndarray) -> DynamicMass:
    return DynamicMass(frequency=H.frequency[chosen], matrix=H.matrix[chosen], reference_point=H.reference_point)


def _marks(terms: ElasticTerms) -> _Terms:
    sharp = np.flatnonzero(terms.damping_ratio < SHARP)
    order = sharp[np.argsort(terms.frequency[sharp])]
    return _Terms(frequency=terms.frequency[order], effective_mass=terms.participation[order] ** 2)


def _diagonal(found: Findings, H: DynamicMass, path: Path) -> None:
    note = f"Blocked, {POINT}. {_measured(found)} Dashed: rigid body identified. Ticks: elastic terms [Hz]."
    diagonal(f"{_stack(found)}: dynamic mass", curves(found, H), path, note)


def _measured(found: Findings) -> str:
    """Why dots and line need not lie on each other."""
    told = "Dots: Eqs. 9 to 11"
    if found.result.identified.way == "plain":
        return f"{told}."
    return f"{told}, channels uncorrected; line: sensors put right, which moves what is small."


def _full(found: Findings, H: DynamicMass, path: Path) -> None:
    note = f"Blocked, {POINT}. {_measured(found)} Dashed: rigid body identified."
    full(f"{_stack(found)}: dynamic mass, rows loads, columns base motions", curves(found, H), path, note)


def _residuals(found: Findings, residuals: pages.DrawnResiduals, path: Path) -> None:
    note = (
        "What a pick-up reads beyond the motion that all of them agree on, and what redundant load cells contradict each other "
        "by, as a share of the readings of their kind at the line."
    )
    pages.draw_residuals(f"{_stack(found)}: what redundant channels disagree by", residuals, path, note)


def _stability(found: Findings, study: Study, what: str, path: Path) -> None:
    maps = [_map(study, what, found.result, k) for k in range(len(QUANTITIES))]
    counts, *_ = study.maps
    at = np.asarray(np.isfinite(study.maps[what]).any(axis=(0, 2)))
    note = (
        f"Plain fits, Eqs. 9 to 11, with {what} over each band, less the plain fit with {counts} over the chosen band (square). "
        "Cross: apart by more than the 95 % interval of the difference. Grey: too few lines."
    )
    title = f"{_alone(found)}: stability over the band, plain fits with {what}"
    pages.draw_stability(title, [_rows(one, at) for one in maps], study.start, study.stop[at], study.chosen, path, note)


def _rows(one: pages.DrawnMap, at: npt.NDArray[np.bool_]) -> pages.DrawnMap:
    """Without the stops of which nothing is known."""
    return replace(one, deviation=one.deviation[:, at], half_width=one.half_width[:, at])


def _alone(found: Findings) -> str:
    """What the result is about, where that is not all that was on the load cells."""
    return f"{found.article} alone, FMD taken off" if found.article != _stack(found) else found.article


def _map(study: Study, what: str, chosen: Reported, k: int) -> pages.DrawnMap:
    quantity, value = QUANTITIES[k], chosen.values[k]
    kind = "mm" if 1 <= k <= 3 else "g m²" if k >= 7 else "%"
    scale = {"mm": 1e3, "g m²": PRODUCT, "%": 100 / abs(value)}[kind]
    apart = study.maps[what][..., k] - study.reference[k]
    half = np.full(apart.shape, chosen.half_width[k])
    if what in study.half_widths:
        half = np.hypot(half, study.half_widths[what][..., k])
    return pages.DrawnMap(
        label=quantity.label, unit=kind, deviation=scale * apart, half_width=scale * half, most=_most(kind, chosen)
    )


def _most(kind: str, chosen: Reported) -> float:
    """Deviation of the darkest colour at most: what lies beyond is wrong, by how much is no matter."""
    return {"mm": 20.0, "g m²": 0.05 * PRODUCT * float(np.abs(chosen.values[4:7]).min()), "%": 5.0}[kind]


def _shares(found: Findings, path: Path) -> None:
    drawn = [
        pages.DrawnShares(
            way=one.identified.way,
            parameters=tuple(quantity.label for quantity in QUANTITIES),
            intervals=tuple(f"{half * q.per_si:.2g} {q.unit}" for half, q in zip(one.half_width, QUANTITIES, strict=True)),
            shares=one.quality.shares,
        )
        for one in found.results
        if one.quality.shares
    ]
    note = "What every input contributes to the variance of mass, CoG, and moments and products about the CoG."
    pages.draw_shares(f"{_alone(found)}: where the uncertainty comes from", drawn, path, note)
