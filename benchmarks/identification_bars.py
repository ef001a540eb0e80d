"""The bars of the identification, simulated: ``python -m benchmarks.identification_bars [SEEDS] [PROCESSES]``.

With ``--sheet calibrated`` or ``as-delivered`` laboratories are those that `benchmarks.laboratories` draws from data sheets, by
a simulator of its own: the tolerances are those of that class, and of a tare no more is known than its drawing says.

Every seed draws a laboratory with ordinary tolerances and four campaigns in it: the bare FMD, Cuboid on disc, Clumod with one and
with four blades, six sweeps each, at the paper's level. The Cuboid is identified with the bare FMD for its tare, Clumod with the
Cuboid; plain and self-calibrated. What is finished is kept under ``out/bars`` and not done again: interrupting loses none of it.
With ``--scheduler ADDRESS`` the workers of Dask do it.
Before that come the two bars without any error of measurement, and what a rigid body makes of one blade. The program ends with 1
when the self-calibrated way misses a bar.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.laboratories.shaking import Bench, mountings
from geometry import parallel
from geometry.atomic import write_text, write_with
from geometry.dynamic_mass import MOTIONS
from geometry.frames import Array
from geometry.inertia import Inertia
from identification.plain import plain
from identification.quality import quality
from identification.request import QUANTITIES, Evidence, Identified, Known, Settings, TareSpectra, quantities
from identification.self_calibration.fit import calibrated
from identification.spectra.line_spectra import Spectra
from identification.spectra.of_campaign import spectra
from validation.model.tolerance_classes import ToleranceClass
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import BEAM, NOISE, RIGID, Plan, exact
from validation.virtual_test.shaker import middles_of_cells
from validation.virtual_test.simulate import VirtualTest, simulate

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

EXACT = (
    Case(name="exact, rigid set-up", article="fmd+disc+cuboid", tare="fmd", bars=(1e-6, 1e-6, 1e-6)),
    Case(name="no noise, no tolerances, elastic", article="fmd+clumod-1", tare="fmd+disc+cuboid", bars=(1e-3, 0.2e-3, 1e-3)),
)
"""Time records without any error of measurement; the rigid one is exact but for rounding."""

RIGID_BAND = (4.0, 8.0)
"""[Hz] in which one blade, whose first resonance is at 11.6 Hz, is taken for a rigid body."""

TABLE_2 = (0.0294, 13.01e-3, 0.1550)
"""The paper's largest deviations for one blade: mass, CoG, moments of inertia (Table 2)."""

COUNTS = "self-calibrated"
UNITS = np.array([100, 1e3, 100])
"""Of errors as they are printed: per cent, mm, per cent."""

Json = dict[str, Any]


def laboratory(seed: int, sheet: str = "") -> Json:
    """Errors and coverage of every case and way in the laboratory of `seed`, from a data sheet where one is named."""
    articles = tuple(dict.fromkeys(article for case in CASES for article in (case.tare, case.article)))
    if not sheet:
        made = {article: _measured(article, seed) for article in articles}
        return {case.name: _identified(case, made) for case in CASES}
    of = ToleranceClass.named(sheet)
    found: dict[str, tuple[Spectra, Inertia | None]] = {}
    drawings: dict[str, Known] = {"fmd": Known.nothing()}
    for campaign, truth, drawing in mountings(seed, articles, sheet):
        found[campaign.article] = (spectra(campaign), truth if truth.mass else None)
        if drawing.mass:
            drawings[campaign.article] = Known.within(drawing, of.mounting.inertia)
    settings = Settings(tolerances=of.chain, stiffness=np.array(Bench().stiffness))
    return {case.name: _identified(case, found, settings, drawings[case.tare]) for case in CASES}


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
    found, standing = spectra(test.campaign), _standing(test)
    truth = np.zeros(0) if standing is None else standing.parameters
    of = {name: getattr(found, name) for name in ("frequency", "values", "noise", "quality")}
    file.parent.mkdir(parents=True, exist_ok=True)
    write_with(file, lambda temporary: np.savez(temporary, truth=truth, **of))


def _standing(test: VirtualTest) -> Inertia | None:
    """What stood on the FMD, about F; None for nothing."""
    stated = cast("dict[str, Any] | None", test.truth["article"])
    return None if stated is None else Inertia(parameters=np.array(list(stated["about_F"]["parameters"].values())))


def without_errors(case: Case) -> Json:
    """Errors of both ways where nothing was drawn and nothing is noisy; Cuboid and disc are rigid then."""
    model = RIGID if case.article == EXACT[0].article else BEAM
    made = {}
    for article in (case.tare, case.article):
        test = simulate(exact(Plan(article=article, model=model if article == case.article else RIGID)))
        made[article] = (spectra(test.campaign), _standing(test))
    return _identified(case, made)


def taken_for_rigid(seed: int) -> Json:
    """One blade in the laboratory of `seed` without elastic terms, in a band that ends below its first resonance."""
    case = CASES[1]
    made = {article: _measured(article, seed) for article in (case.tare, case.article)}
    return _identified(case, {name: (_low(found), truth) for name, (found, truth) in made.items()}, Settings(modes=0))


def _low(found: Spectra) -> Spectra:
    return found.at((found.frequency >= RIGID_BAND[0]) & (found.frequency <= RIGID_BAND[1]))


def _identified(
    case: Case,
    made: Mapping[str, tuple[Spectra, Inertia | None]],
    settings: Settings | None = None,
    drawing: Known | None = None,
) -> Json:
    """`drawing` is what is known of the tare: what stood there where nothing is said."""
    (article, truth), (tare, known) = made[case.article], made[case.tare]
    below = drawing or (Known.nothing() if known is None else Known.within(known))
    evidence = Evidence(
        article=article,
        tares=(TareSpectra(spectra=tare, known=below, hardware="A"),),
        hardware="A",
    )
    asked = settings or Settings()
    ways = {"plain": plain(evidence, asked), "self-calibrated": calibrated(evidence, asked)}
    return {way: _held_against(found, truth) for way, found in ways.items() if truth is not None}


def _held_against(found: Identified, truth: Inertia) -> Json:
    said, true = quality(found), quantities(truth.parameters)
    off = said.values - true
    return {
        "mass": off[0] / true[0],
        "cog": off[1:4].tolist(),
        "moments": (off[4:7] / true[4:7]).tolist(),
        "inside": [bool(low <= value <= high) for value, (low, high) in zip(true, said.intervals, strict=True)],
        "flagged": sum("elasticity" in said.verdict[name] for name in QUANTITIES),
        "converged": found.converged,
        "modes": 0 if found.elastic is None else len(found.elastic.frequency),
        "misfit": found.misfit,
        "surprise": found.surprise,
    }


def finished(seeds: Iterable[int], processes: int, console: Console, scheduler: str = "", sheet: str = "") -> Iterator[Json]:
    """The laboratories of `seeds`, those that are kept first; see `geometry.parallel.finished`."""
    missing = []
    for seed in seeds:
        if _kept(seed, sheet).exists():
            yield json.loads(_kept(seed, sheet).read_text())
        else:
            missing.append(seed)
    made = parallel.finished(_of, [(seed, sheet) for seed in missing], processes=processes, scheduler=scheduler)
    for number, ((seed, _), found) in enumerate(made, start=1):
        if isinstance(found, parallel.WorkerLost):
            raise found
        write_text(_kept(seed, sheet), json.dumps(found))
        console.print(f"{number} of {len(missing)} laboratories", style="dim")
        yield found


def _of(task: tuple[int, str]) -> Json:
    return laboratory(*task)


def _kept(seed: int, sheet: str) -> Path:
    rooms = (*SIMULATION, *IDENTIFICATION, *(("benchmarks/laboratories",) if sheet else ()))
    return FOLDER / code(rooms) / f"{sheet}{'-' if sheet else ''}{seed}.json"


def code(rooms: tuple[str, ...]) -> str:
    """A hash of the code that figures come from: those of other code are never mixed in."""
    root = Path(__file__).parents[1]
    files = sorted(path for room in rooms for path in (root / room).rglob("*") if path.suffix in {".py", ".toml"})
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:12]


def single(case: Case, result: Json) -> list[list[str]]:
    """Rows of one result that is held against the bars of `case`."""
    return [[case.name, way, *_figures(_size(result[way])), _words(case, way, _size(result[way]))] for way in result]


def _size(found: Json) -> Array:
    """(3,) errors: mass, the largest of the CoG's three [m], the largest of the three moments."""
    return np.array([abs(found["mass"]), np.abs(found["cog"]).max(), np.abs(found["moments"]).max()])


def _figures(size: Array) -> list[str]:
    return [f"{figure:.3g}" for figure in size * UNITS]


def _words(case: Case, way: str, size: Array) -> str:
    bars = " / ".join(f"{bar:g}" for bar in np.array(case.bars) * UNITS)
    return f"{bars}: {'met' if met(case, size) else 'missed'}" if way == COUNTS else bars


def met(case: Case, size: Array) -> bool:
    """Whether errors (3,) lie within the bars of `case`."""
    return bool(np.all(size <= np.array(case.bars)))


def errors(results: list[Json]) -> list[list[str]]:
    """95th percentile and median of every case and way, beside the bar."""
    rows = []
    for case in CASES:
        for way in ("plain", COUNTS):
            found = np.array([_size(result[case.name][way]) for result in results])
            worst, middle = np.percentile(found, 95, axis=0), np.median(found, axis=0)
            figures = [f"{a:.3f} ({b:.3f})" for a, b in zip(worst * UNITS, middle * UNITS, strict=True)]
            rows.append([case.name, way, *figures, _words(case, way, worst)])
    return rows


def printed(title: str, rows: list[list[str]]) -> Table:
    """`rows` of errors as a table."""
    table = Table(title=title)
    for head in ("case", "way", "mass %", "CoG mm", "MoI %", "bars"):
        table.add_column(head, justify="left" if head in ("case", "way", "bars") else "right")
    for row in rows:
        table.add_row(*row)
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


@click.command()
@click.argument("seeds", type=click.IntRange(min=1), default=SEEDS)
@click.argument("processes", type=click.IntRange(min=1), default=1)
@click.option("--sheet", default="", help="Laboratories of `benchmarks.laboratories` instead, of this class of data sheets.")
@click.option("--scheduler", default="", metavar="ADDRESS", help="Of Dask, whose workers do it instead of PROCESSES here.")
def main(seeds: int, processes: int, sheet: str, scheduler: str) -> None:
    """Print the tables; exit code 1 when the self-calibrated way misses a bar."""
    if processes > 1 and scheduler:
        raise click.BadParameter("the workers of --scheduler do the work, as many as they are; leave out PROCESSES")
    console = Console()
    if sheet:
        results = list(finished(range(1, seeds + 1), processes, console, scheduler, sheet))
        console.print(printed(f"95th percentile (median) of {len(results)} {sheet} laboratories", errors(results)))
        console.print(coverage(results))
        return
    alone = [(case, without_errors(case)) for case in EXACT]
    rigid = taken_for_rigid(1)
    rows = [row for case, result in alone for row in single(case, result)]
    rows += [
        ["rigid body, 4 to 8 Hz", way, *_figures(_size(rigid[way])), f"{rigid[way]['flagged']} of 10 flagged"] for way in rigid
    ]
    rows.append(["one blade, 2002", "Table 2", *_figures(np.array(TABLE_2)), ""])
    console.print(printed("Without errors of measurement; one blade taken for rigid; the paper", rows))
    results = list(finished(range(1, seeds + 1), processes, console, scheduler))
    console.print(printed(f"95th percentile (median) of {len(results)} laboratories", errors(results)))
    console.print(coverage(results))
    worst = {case: np.percentile([_size(result[case.name][COUNTS]) for result in results], 95, axis=0) for case in CASES}
    kept = all(met(case, _size(result[COUNTS])) for case, result in alone) and all(met(*one) for one in worst.items())
    sys.exit(0 if kept else 1)


if __name__ == "__main__":
    from benchmarks import identification_bars  # a worker finds its functions under their names

    identification_bars.main()
