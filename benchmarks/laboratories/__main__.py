"""How many sound laboratories are said to be sound, and what is found in others.

``python -m benchmarks.laboratories --count 8 --sheet calibrated --class calibrated`` asks nulls of one series on one bench;
``python -m benchmarks.laboratories --draw 1 --count 60 --out out/laboratories.jsonl`` draws benches, series and faults, a null
before each of them, and goes on where it was interrupted; ``--score out/laboratories.jsonl`` counts.
"""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import Any

import click
import numpy as np

from benchmarks.blind.score.rates import rate
from benchmarks.laboratories.cases import KINDS, SERIES, Case, draw
from benchmarks.laboratories.shaking import SOUND, Bench, Faults, drawn, series, truth
from geometry.errors import BadInput, CheckFailed
from validation.diagnose.diagnose import diagnosed
from validation.model import model_file
from validation.study import Data, Study

Json = dict[str, Any]

ARTICLES = SERIES[0]

MODEL = """
format = 1
model = {{ title = "drawn", article = "{article}" }}
laboratory = {{ cell_stiffness_N_m = {stiffness}, fmd = {{ inertia = "drawing", tolerance = 0.04 }} }}
{tolerances}
structure = {{ kind = "beam" }}
"""


def analyst(name: str, article: str = ARTICLES[-1], bench: Bench | None = None) -> str:
    """The model file of an analyst who states the class `name`; none states nothing."""
    said = f'tolerances = {{ class = "{name}" }}' if name else ""
    return MODEL.format(article=article, stiffness=list((bench or Bench()).stiffness), tolerances=said)


def asked(case: Case, faults: Faults) -> tuple[Json, Mapping[str, float]]:
    """What is said of a case with `faults`, and the smallest sizes that would have been named."""
    made = series(case.laboratory, case.articles, case.sheet, faults, case.bench)
    model = model_file.of_text(analyst(case.sheet, case.articles[-1], case.bench), "drawn.toml")
    line: Json = {"number": case.number, "kind": case.kind, "laboratory": case.laboratory, "sheet": case.sheet}
    line |= {"articles": list(case.articles), "bench": asdict(case.bench)}
    line |= {
        "planted": truth(case.laboratory, case.sheet, faults, tuple(drawn(made[-1]).parts)),
        "multiples": dict(case.multiples),
    }
    begun, smallest = time.process_time(), {}
    try:
        found = diagnosed(Study.of(model, Data(campaigns=made)))
        line |= {"verdict": found.verdict, "text": found.text, "class": list(found.equivalence_class)}
        line["named"] = {one.id: {size.key: [size.value, size.low, size.high] for size in one.sizes} for one in found.accepted}
        line["same"] = {one.id: list(one.same) for one in found.accepted}
        line["ranking"] = [[one.id, one.evidence] for one in found.ranking[:4]]
        line["goodness"] = [[one.misfit, one.price] for one in found.steps]
        line["limit"] = found.settings.get("misfit_limit")
        smallest = {one.id: one.size for one in found.detectable}
    except (BadInput, CheckFailed) as error:  # a refusal is an answer that counts
        line |= {"verdict": "refused", "text": str(error), "named": {}, "class": []}
    return line | {"seconds": time.process_time() - begun}, smallest


def answers(
    seed: int, first: int, count: int, out: Path, kinds: Sequence[str] = KINDS, times: float | None = None
) -> Iterator[Json]:
    """Of the cases of a draw, kept in `out` as they are found: a null, and the same laboratory with what is planted.

    Of faults only those of `kinds` are answered, at so many `times` what the null promises where that is given.
    """
    kept = [json.loads(one) for one in out.read_text().splitlines()] if out.exists() else []
    done = {(one["number"], one["kind"]): one for one in kept}
    for case in islice(draw(seed), first, first + count):
        if times is not None and case.kind in ("single", "pair"):
            case = replace(case, multiples=dict.fromkeys(case.multiples, times))
        for kind in ("null", case.kind):
            if (case.number, kind) in done or kind not in ("null", *kinds):
                continue
            faults: Faults | None = SOUND
            if kind != "null":
                faults = case.faults(done[case.number, "null"].get("smallest", {}))
            if faults is None:
                continue
            line, smallest = asked(case, faults)
            line |= {"kind": kind} | (
                {"smallest": {id: smallest[id] for id in case.multiples if id in smallest}} if kind == "null" else {}
            )
            done[case.number, kind] = line
            out.parent.mkdir(parents=True, exist_ok=True)
            with out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")
            yield line


def told(line: Json) -> str:
    """One answer in a line."""
    planted = ", ".join(f"{id} {size[0]:.4g}" for id, size in line["planted"].items()) or "sound"
    named = ", ".join(f"{id} {next(iter(sizes.values()), [0])[0]:.4g}" for id, sizes in line["named"].items())
    where = f"{line['number']:3d} {line['sheet'][:4]} {'+'.join(one[4:] for one in line['articles'])}"
    return f"{where} | {planted} | {line['verdict']}: {named} {line['text'][:150]} ({line['seconds']:.0f} s)"


def hit(line: Json) -> dict[str, bool]:
    """Whether what was planted is first, or tied to the last digit with it, all of it named, in the class, and whether something
    else is claimed."""
    planted, named, alike = set(line["planted"]), list(line["named"]), set(line["class"])
    same, ranking = line.get("same", {}), line.get("ranking", [])
    near = {id for id, nats in ranking if nats > ranking[0][1] - 1.0}
    return {
        "first": bool(named) and named[0] in planted,
        "first or not more than 1 nat behind": bool(named) and bool(planted & {named[0], *same.get(named[0], ()), *near}),
        "first or one name with it": bool(named) and bool(planted & {named[0], *same.get(named[0], ())}),
        "all": planted <= set(named),
        "class": planted <= {*named, *alike},
        "wrong": bool(set(named) - planted) and not planted <= alike,
    }


KIND_OF_SIZE = dict.fromkeys(("absorber", "slosh", "appendage"), "resonators") | {"joint-compliance": "joints"}
"""Of which families intervals are counted by themselves."""


def scored(lines: Sequence[Json]) -> list[tuple[str, str]]:
    """Rows of the table: what, and how many of how many with the exact interval of 95 %."""
    by = {kind: [one for one in lines if one["kind"] == kind] for kind in ("null", "single", "pair", "unknown")}
    nulls, singles = by["null"], by["single"]
    rows = [("nulls quiet", rate(one["verdict"] == "nothing" for one in nulls))]
    for sheet in ("calibrated", "as-delivered"):
        of = [one for one in nulls if one["sheet"] == sheet]
        rows.append((f"nulls of {sheet} quiet", rate(one["verdict"] == "nothing" for one in of)))
        for articles in sorted({tuple(one["articles"]) for one in of}):
            which = " beside ".join(one.removeprefix("fmd+") for one in articles)
            rows.append((f"- of {which}", rate(one["verdict"] == "nothing" for one in of if tuple(one["articles"]) == articles)))
    rows.append(("refused, of all", rate(one["verdict"] == "refused" for one in lines)))
    for times in sorted({times for one in singles for times in one["multiples"].values()}):
        of = [one for one in singles if times in one["multiples"].values()]
        rows += [
            (f"singles at {times:g} times: {what}", rate(hit(one)[what] for one in of))
            for what in ("first", "first or one name with it", "first or not more than 1 nat behind", "class", "wrong")
        ]
        rows.append((f"singles at {times:g} times: said to be sound", rate(one["verdict"] == "nothing" for one in of)))
    rows += [
        ("pairs, both named", rate(hit(one)["all"] for one in by["pair"])),
        ("pairs, both in the class", rate(hit(one)["class"] for one in by["pair"])),
    ]
    rows += [("unknown physics called unknown", rate(one["verdict"] == "unknown" for one in by["unknown"]))]
    rows += [("unknown physics given a name", rate(bool(one["named"]) for one in by["unknown"]))]
    off, inside = [], dict[str, list[bool]]()
    for one in (*singles, *by["pair"]):
        for id in set(one["planted"]) & set(one["named"]):
            kind = KIND_OF_SIZE.get(id.partition(":")[0], "others")
            for true, (value, low, high) in zip(one["planted"][id], one["named"][id].values(), strict=False):
                off.append(abs(value - true) / max(abs(true - float(id.startswith("fmd-compliance"))), 1e-12))
                inside.setdefault(kind, []).append(low <= true <= high)
    rows.append(("sizes in their 90 % interval", rate(each for of in inside.values() for each in of)))
    rows += [(f"- of {kind}", rate(of)) for kind, of in sorted(inside.items())]
    return [(what, str(of)) for what, of in rows] + [
        ("sizes, median error", f"{100 * float(np.median(off)):.1f} %" if off else "none yet")
    ]


@click.command()
@click.option("--count", default=8, show_default=True, help="Laboratories, or cases of a draw.")
@click.option("--first", default=1, show_default=True, help="Number of the first.")
@click.option("--sheet", default="calibrated", show_default=True, help="Class that they are drawn from.")
@click.option("--class", "stated", default="", help="Class that the analyst states; none by default.")
@click.option("--article", "articles", multiple=True, default=ARTICLES, show_default=True, help="Of the series.")
@click.option("--draw", "seed", type=int, default=None, help="Seed of a draw of benches, series, sheets and faults.")
@click.option(
    "--out", type=click.Path(path_type=Path), default=Path("out/laboratories.jsonl"), show_default=True, help="Answers of a draw."
)
@click.option("--nulls", is_flag=True, help="Of a draw the nulls alone; faults go on from there.")
@click.option("--times", type=float, default=None, help="What the null promises, in place of 2 and 5 times that.")
@click.option("--score", is_flag=True, help="Count what is kept in --out.")
def main(
    count: int,
    first: int,
    sheet: str,
    stated: str,
    articles: tuple[str, ...],
    seed: int | None,
    out: Path,
    nulls: bool,
    times: float | None,
    score: bool,
) -> None:
    """Draw laboratories, diagnose them, and count verdicts."""
    if score:
        for what, share in scored([json.loads(one) for one in out.read_text().splitlines()]):
            click.echo(f"{what:45s} {share}")
        return
    if seed is not None:
        for line in answers(seed, first, count, out, () if nulls else KINDS, times):
            click.echo(told(line))
        return
    model, verdicts = model_file.of_text(analyst(stated, articles[-1]), "drawn.toml"), []
    for number in range(first, first + count):
        begun = time.process_time()
        try:
            found = diagnosed(Study.of(model, Data(campaigns=series(number, articles, sheet))))
            verdict, text = found.verdict, found.text
        except (BadInput, CheckFailed) as error:
            verdict, text = "refused", str(error)
        verdicts.append(verdict)
        click.echo(f"{sheet} {number:3d} {verdict}: {text[:160]} ({time.process_time() - begun:.0f} s)")
    click.echo(", ".join(f"{n} {verdict}" for verdict, n in Counter(verdicts).items()))


if __name__ == "__main__":
    main()
