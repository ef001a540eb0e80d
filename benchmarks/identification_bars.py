"""The bars of the identification on simulated campaigns: ``python -m benchmarks.identification_bars [SEEDS] [PROCESSES]``.

Every seed draws a laboratory with ordinary tolerances and four campaigns in it: the bare FMD, Cuboid on disc, Clumod with one and
with four blades, six sweeps each, at the paper's level. The Cuboid is identified with the bare FMD for its tare, Clumod with the
Cuboid; plain and self-calibrated. What is finished is kept under ``out/bars`` and not done again: interrupting loses none of it.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
from rich.console import Console
from rich.table import Table

from geometry.arrays import Array
from geometry.atomic import write_text, write_with
from geometry.dynamic_mass import MOTIONS
from geometry.inertia import Inertia
from identification.classical import quantities
from identification.evidence import Evidence, Known, Settings, TareSpectra
from identification.identified import Identified
from identification.plain import plain
from identification.quality import quality
from identification.self_calibration.calibrated import calibrated
from identification.spectra.line_spectra import Spectra
from identification.spectra.of_campaign import spectra
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import NOISE, Plan
from validation.virtual_test.set_up import middles_of_cells
from validation.virtual_test.simulate import simulate

SEEDS = 200
FOLDER = Path("out/bars")
SIMULATION = ("geometry", "fem", "identification/spectra", "validation/virtual_test")
IDENTIFICATION = ("geometry", "identification")


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is identified with which tare, and the bars: mass [1], CoG [m], moments of inertia [1]."""

    name: str
    article: str
    tare: str
    bars: tuple[float, float, float]


CASES = (
    Case(name="Cuboid + disc", article="fmd+disc+cuboid", tare="fmd", bars=(0.005, 1e-3, 0.01)),
    Case(name="Clumod one blade", article="fmd+clumod-1", tare="fmd+disc+cuboid", bars=(0.01, 2.5e-3, 0.015)),
    Case(name="Clumod four blades", article="fmd+clumod-4", tare="fmd+disc+cuboid", bars=(0.02, 5e-3, 0.03)),
)

TABLE_2 = (0.0294, 13.01e-3, 0.1550)
"""The paper's largest deviations for one blade: mass, CoG, moments of inertia (Table 2)."""

Json = dict[str, Any]


def laboratory(seed: int) -> Json:
    """Errors and coverage of every case and way in the laboratory of `seed`."""
    articles = dict.fromkeys(article for case in CASES for article in (case.tare, case.article))
    made = {article: _measured(article, seed) for article in articles}
    return {case.name: _identified(case, made) for case in CASES}


def _measured(article: str, seed: int) -> tuple[Spectra, Inertia | None]:
    """Spectra of the campaign on `article`, kept from an earlier run of the same code or simulated, and what stood on the FMD."""
    file = FOLDER / code(SIMULATION) / f"{seed}-{article}.npz"
    if not file.exists():
        _simulate(article, seed, file)
    kept = np.load(file)
    table = mavis(middles_of_cells(Plan(article=article)), NOISE).table
    of = {name: kept[name] for name in ("frequency", "values", "noise", "quality")}
    made = Spectra(table=table, runs=MOTIONS, axes=MOTIONS, **of)
    return made, Inertia(parameters=kept["truth"]) if len(kept["truth"]) else None


def _simulate(article: str, seed: int, file: Path) -> None:
    test = simulate(Plan(article=article, seed=seed))
    found, stated = spectra(test.campaign), cast("dict[str, Any] | None", test.truth["article"])
    truth = [] if stated is None else list(stated["about_F"]["parameters"].values())
    of = {name: getattr(found, name) for name in ("frequency", "values", "noise", "quality")}
    file.parent.mkdir(parents=True, exist_ok=True)
    write_with(file, lambda temporary: np.savez(temporary, truth=np.array(truth), **of))


def _identified(case: Case, made: Mapping[str, tuple[Spectra, Inertia | None]]) -> Json:
    (article, truth), (tare, known) = made[case.article], made[case.tare]
    evidence = Evidence(
        article=article,
        tares=(TareSpectra(spectra=tare, known=Known.nothing() if known is None else Known.within(known), hardware="A"),),
        hardware="A",
    )
    settings = Settings()
    ways = {"plain": plain(evidence, settings), "self-calibrated": calibrated(evidence, settings)}
    return {way: _held_against(found, truth) for way, found in ways.items() if truth is not None}


def _held_against(found: Identified, truth: Inertia) -> Json:
    said, true = quality(found), quantities(truth.parameters)
    off = said.values - true
    return {
        "mass": off[0] / true[0],
        "cog": off[1:4].tolist(),
        "moments": (off[4:7] / true[4:7]).tolist(),
        "inside": [bool(low <= value <= high) for value, (low, high) in zip(true, said.intervals, strict=True)],
        "converged": found.converged,
        "modes": 0 if found.elastic is None else len(found.elastic.frequency),
        "misfit": found.misfit,
        "surprise": found.surprise,
    }


def finished(seeds: Iterable[int], processes: int, console: Console) -> Iterator[Json]:
    """The laboratories of `seeds`, those that are kept first."""
    missing = []
    for seed in seeds:
        if _kept(seed).exists():
            yield json.loads(_kept(seed).read_text())
        else:
            missing.append(seed)
    with ProcessPoolExecutor(processes) as pool:
        for number, future in enumerate(as_completed([pool.submit(_keep, seed) for seed in missing]), start=1):
            console.print(f"{number} of {len(missing)} laboratories", style="dim")
            yield future.result()


def _keep(seed: int) -> Json:
    found = laboratory(seed)
    write_text(_kept(seed), json.dumps(found))
    return found


def _kept(seed: int) -> Path:
    return FOLDER / code((*SIMULATION, *IDENTIFICATION)) / f"{seed}.json"


def code(rooms: tuple[str, ...]) -> str:
    """A hash of the code that figures come from: those of other code are never mixed in."""
    files = sorted(path for room in rooms for path in Path(room).rglob("*") if path.suffix in {".py", ".toml"})
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:12]


def sizes(results: list[Json], case: str, way: str) -> Array:
    """(n, 3) errors: mass, the largest of the CoG's three [m], the largest of the three moments."""
    found = [result[case][way] for result in results]
    return np.array([[abs(f["mass"]), np.abs(f["cog"]).max(), np.abs(f["moments"]).max()] for f in found])


def errors(results: list[Json]) -> Table:
    """Median and 95th percentile of every case and way, beside the bar and the paper's own."""
    table = Table(title=f"95th percentile (median) of {len(results)} laboratories")
    for title in ("case", "way", "mass %", "CoG mm", "MoI %", "bars"):
        table.add_column(title, justify="left" if title in ("case", "way") else "right")
    unit = np.array([100, 1e3, 100])
    for case in CASES:
        for way in ("plain", "self-calibrated"):
            found = sizes(results, case.name, way) * unit
            figures = [f"{np.percentile(c, 95):.3f} ({np.median(c):.3f})" for c in found.T]
            table.add_row(case.name, way, *figures, " / ".join(f"{bar:g}" for bar in case.bars * unit))
    table.add_row("one blade, 2002", "Table 2", *(f"{figure:.2f}" for figure in TABLE_2 * unit), "")
    return table


def coverage(results: list[Json]) -> Table:
    """How often the 95 % intervals hold the truth."""
    table = Table(title=f"95 % intervals that hold the truth, per cent of {len(results)} laboratories")
    for title in ("case", "way", "mass", "CoG x, y, z", "MoI xx, yy, zz", "PoI xy, xz, yz", "did not converge"):
        table.add_column(title, justify="left" if title in ("case", "way") else "right")
    for case in CASES:
        for way in ("plain", "self-calibrated"):
            found = [result[case.name][way] for result in results]
            shares = np.split(100 * np.mean([f["inside"] for f in found], axis=0), (1, 4, 7))
            lost = sum(not f["converged"] for f in found)
            table.add_row(case.name, way, *(" ".join(f"{s:.1f}" for s in share) for share in shares), str(lost))
    return table


def main(seeds: int = SEEDS, processes: int = 1) -> None:
    """Print both tables."""
    console = Console()
    results = list(finished(range(1, seeds + 1), processes, console))
    console.print(errors(results))
    console.print(coverage(results))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
