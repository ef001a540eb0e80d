"""The pictures of `massline compare`: what each of them shows, from the comparison."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from validation.article_reference import file_name
from validation.comparing.comparison import Comparison, WorstPair, worst_pairs
from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.comparing.pairs import Pairs
from validation.comparing.table import SIGNS
from validation.comparing.verdicts import MISFIT, absurd, expected_z2, misfit
from validation.comparing.words import SENSED, run
from validation.pictures import comparison as pages
from validation.pictures.curves import MEASURED, Curve, chosen

PAIRS = 6

NOTE = "Deviation at the plain fit over what noise, a model error of 0.15 % and all tolerances that were not fitted let expect. "
THRESHOLD = f"Beyond {pages.THRESHOLD:g} (black bar of the scale) it is no chance. Triangles: modes of the model."


@dataclass(frozen=True, eq=False, kw_only=True)
class _Marks:
    """Modes as resonances to be marked."""

    frequency: Array
    effective_mass: Array


def draw(found: Comparison, folder: Path) -> tuple[Path, ...]:
    """Write every picture that `found` has the evidence for into `folder`, and say where they are."""
    made: list[Path] = []

    def to(name: str) -> Path:
        made.append(folder / f"{file_name(f'compare-{name}')}.png")
        return made[-1]

    _errors(found, to("errors"))
    _runs(found, to("runs"))
    for of, modes in zip(found.maps, found.modes, strict=True):
        draw_channels(of, modes, to(f"{of.data_set}-channels"))
        if of.pairs is not None:
            _pairs(of.pairs, modes, to(f"{of.data_set}-pairs"))
    if any(of.pairs is not None for of in found.maps):
        _dynamic_mass(found, to("dynamic-mass"))
    return tuple(made)


def _errors(found: Comparison, path: Path) -> None:
    of = found.evaluation
    nominal, plain, fitted, held = found.errors
    bars = [
        pages.DrawnError(name="nominal", percent=of.nominal.percent, verdict=nominal.verdict),
        pages.DrawnError(name="plain", percent=of.plain.percent, verdict=plain.verdict),
    ]
    if of.held_out is not None:
        bars.append(pages.DrawnError(name="held out, plain", percent=of.held_out.percent, verdict=held.verdict))
    price = of.fitted.tolerance_z2 / max(expected_z2(of.fitted), 1.0)
    prices = [
        pages.DrawnError(name="chi² per degree of freedom", percent=misfit(of.fitted), verdict=_chi2(found)),
        pages.DrawnError(name="z² of the tolerances", percent=price, verdict="failed" if absurd(of.fitted) else "good"),
    ]
    note = f"Fitted: {fitted.text}."
    pages.draw_errors(f"{found.title}: the four errors", bars, found.explained.measurement, prices, path, note)


def _chi2(found: Comparison) -> str:
    return "failed" if misfit(found.evaluation.fitted) > MISFIT else "good"


def _runs(found: Comparison, path: Path) -> None:
    columns = tuple(dict.fromkeys(name for of in found.maps for name in of.runs))
    sigma = np.full((len(found.maps), len(columns)), np.nan)
    percent = sigma.copy()
    for a, of in enumerate(found.maps):
        for k, name in enumerate(of.runs):
            at = (a, columns.index(name))
            sigma[at] = of.sigma[k].max()
            percent[at] = found.evaluation.plain.by_run.get(f"{of.data_set}/{name}", np.nan)
    drawn = pages.DrawnRuns(rows=found.data_sets, columns=columns, sigma=sigma, percent=percent)
    pages.draw_runs(f"{found.title}: runs", drawn, path, "The worst cell of each run in sigmas, and its plain error in per cent.")


def draw_channels(of: Map, modes: Sequence[NamedMode], path: Path) -> None:
    """Write the map of channels and loads over frequency, a panel a run."""
    rows = tuple(SENSED.get(name, name) for name in of.rows)
    sigma = np.where(np.isfinite(of.expected), of.sigma, np.nan)
    maps = [
        pages.DrawnMap(
            title=run(name, axis),
            frequency=of.frequency,
            rows=rows,
            sigma=sigma[k],
            modes=_frequencies(modes),
            rules=_rules(of),
        )
        for k, (name, axis) in enumerate(zip(of.runs, of.axes, strict=True))
    ]
    note = NOTE + THRESHOLD
    pages.draw_maps(f"{of.data_set}: channels and loads", maps, path, note)


def _frequencies(modes: Sequence[NamedMode]) -> tuple[float, ...]:
    return tuple(one.frequency for one in modes)


def _rules(of: Map) -> tuple[int, ...]:
    """Between channels of different kinds, told by the first part of their names, and the loads."""
    kinds = [name.partition("-")[0] for name in of.rows[: of.channels]]
    changes = [k for k in range(1, len(kinds)) if kinds[k] != kinds[k - 1]] if len(set(kinds)) <= 4 else []
    return (*changes, *([of.channels] if of.channels < len(of.rows) else []))


def _pairs(of: Pairs, modes: Sequence[NamedMode], path: Path) -> None:
    pairs = [(i, j) for i in range(6) for j in range(6)]
    rows = tuple(f"{SIGNS[i]}{SIGNS[j]}" for i, j in pairs)
    sigma = pages.DrawnMap(
        title="in sigmas",
        frequency=of.frequency,
        rows=rows,
        sigma=of.sigma.reshape(len(of.frequency), 36),
        modes=_frequencies(modes),
        rules=(6, 12, 18, 24, 30),
    )
    percent = replace(sigma, title="in per cent of the dynamic mass", sigma=of.percent.reshape(len(of.frequency), 36))
    note = f"Predicted beside measured, about F; sigma as in the maps of the channels. {THRESHOLD}"
    pages.draw_pairs(f"{of.campaign}: dynamic mass, load and base motion", sigma, percent, path, note)


def _dynamic_mass(found: Comparison, path: Path) -> None:
    by_name = {of.data_set: (of.pairs, modes) for of, modes in zip(found.maps, found.modes, strict=True) if of.pairs is not None}
    panels = [_entry(pair, *by_name[pair.data_set]) for pair in worst_pairs(found.maps, PAIRS)]
    note = "Blocked, about F: the pairs of axes that differ most. Dots: Eqs. 9 to 11. Line: model, plain fit, made likewise."
    chosen(f"{found.title}: predicted beside measured", panels, path, note)


def _entry(pair: WorstPair, of: Pairs, modes: Sequence[NamedMode]) -> tuple[str, int, int, tuple[Curve, ...]]:
    marks = _Marks(frequency=np.array(_frequencies(modes)), effective_mass=np.full((len(modes), 6), np.inf))
    both = ((of.predicted, "predicted", ""), (of.measured, "measured", MEASURED))
    curves = tuple(
        Curve(name=name, mass=DynamicMass(frequency=of.frequency, matrix=matrix), rigid=np.zeros((6, 6)), modes=marks, dots=dots)
        for matrix, name, dots in both
    )
    return f"{pair.data_set}, {pair.sigma:.0f} σ at {pair.frequency:.1f} Hz", pair.load, pair.motion, curves
