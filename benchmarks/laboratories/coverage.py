"""How often the 90 % interval of a size holds what was planted, where the right name is given.

``python -m benchmarks.laboratories.coverage --seed 80 --count 96 --out out/coverage.jsonl`` draws laboratories of any bench and
plants a resonator or a soft joint, a size that is not chosen by what could be named; the model is fitted with that effect, from
everywhere as a baseline is, and the interval is the one that a diagnosis would print. Lines are kept; ``--score`` counts.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import numpy as np

from benchmarks.blind.score.rates import rate
from benchmarks.laboratories.__main__ import analyst
from benchmarks.laboratories.shaking import Bench, Faults, series
from geometry.errors import CheckFailed
from validation.diagnose.candidate_fits import goodness_of_fit, recentred
from validation.diagnose.diagnose import as_cause
from validation.diagnose.diagnosis import Candidate
from validation.effects.catalogue import FAMILIES, Named
from validation.estimation.fit import fit
from validation.estimation.problem import FITTED
from validation.model import model_file
from validation.model.model import Added
from validation.study import Data, Study

ASKED = (
    ("absorber:mast-top", "fmd+clumod-1"),
    ("slosh:top", "fmd+disc+cuboid"),
    ("appendage:x", "fmd+clumod-1"),
    ("joint-compliance:rotation", "fmd+clumod-1"),
    ("absorber:hub-2", "fmd+clumod-1"),
    ("slosh:mast-top", "fmd+clumod-1"),
    ("appendage:z", "fmd+disc+cuboid"),
    ("joint-compliance:lateral", "fmd+clumod-1"),
    ("absorber:top", "fmd+disc+cuboid"),
    ("slosh:lower-1+", "fmd+clumod-1"),
    ("joint-compliance:rotation", "fmd+disc+cuboid"),
    ("joint-compliance:lateral", "fmd+disc+cuboid"),
)
"""In turn: what is planted, and what is tested."""

SHEETS = ("calibrated", "as-delivered")

COMPLIANCE = {"joint-compliance:rotation": (-6.5, -5.5), "joint-compliance:lateral": (-8.3, -7.0)}
"""[log10 of rad/(N m), m/N] that are drawn."""

MASS, BAND, DAMPING = (-1.5, -0.3), (5.5, 22.0), (0.01, 0.05)
"""[log10 of kg, Hz, 1] that are drawn of a resonator."""


def fitted(seed: int, number: int) -> dict[str, Any]:
    """Case `number` of the draw `seed`: truths and intervals by key of the size, or why there is none."""
    generator = np.random.default_rng([seed, number])
    id, article = ASKED[number % len(ASKED)]
    sheet = SHEETS[number // len(ASKED) % len(SHEETS)]
    laboratory, bench = int(generator.integers(1, 10**9)), Bench.drawn(generator)
    if id in COMPLIANCE:
        sizes: tuple[float, ...] = (float(10 ** generator.uniform(*COMPLIANCE[id])),)
    else:
        sizes = (float(10 ** generator.uniform(*MASS)), float(generator.uniform(*BAND)), float(generator.uniform(*DAMPING)))
    campaigns = series(laboratory, (article,), sheet, Faults(sizes={id: sizes}), bench)
    study = Study.of(model_file.of_text(analyst(sheet, article, bench), "drawn.toml"), Data(campaigns=campaigns))
    family, _, target = id.partition(":")
    targets = tuple(target.split(":"))
    keys = [one.key for one in FAMILIES[family].sizes_at(targets)]
    added = Added(named=Named(family=family, targets=targets, values=dict(zip(keys, sizes, strict=True))))
    line = {"number": number, "id": id, "article": article, "sheet": sheet, "planted": dict(zip(keys, sizes, strict=True))}
    try:
        problem = study.problem((added,))
        at = recentred(study, Candidate(effects=(added,), fit=fit(problem, FITTED), problem=problem))
    except CheckFailed as error:
        return line | {"refused": str(error)}
    told = as_cause(at.effects[-1], at, 0.0, goodness_of_fit(at.fit, at.problem))
    return line | {"told": {one.key: [one.value, one.low, one.high] for one in told.sizes}}


def scored(lines: list[dict[str, Any]]) -> Iterator[tuple[str, str]]:
    """By family, and by size of a resonator, how many intervals hold the truth."""
    held: dict[str, list[bool]] = {}
    for one in lines:
        family = one["id"].partition(":")[0]
        for key, (_, low, high) in one.get("told", {}).items():
            inside = low <= one["planted"][key] <= high
            for of in ("all", family, *([f"{key} of resonators"] if key else [])):
                held.setdefault(of, []).append(inside)
    yield from ((of, str(rate(each))) for of, each in sorted(held.items()))
    yield "refused", str(rate("refused" in one for one in lines))


@click.command()
@click.option("--seed", default=80, show_default=True)
@click.option("--count", default=96, show_default=True)
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/coverage.jsonl"), show_default=True)
@click.option("--score", is_flag=True, help="Count what is kept in --out.")
def main(seed: int, count: int, out: Path, score: bool) -> None:
    """Fit what is planted under its right name, and count intervals."""
    kept = [json.loads(one) for one in out.read_text().splitlines()] if out.exists() else []
    if score:
        for what, share in scored(kept):
            click.echo(f"{what:25s} {share}")
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    for number in range(len(kept), count):
        line = fitted(seed, number)
        with out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        click.echo(f"{number:3d} {line['sheet'][:4]} {line['id']} {line['planted']}: {line.get('told') or line['refused']}")


if __name__ == "__main__":
    main()
