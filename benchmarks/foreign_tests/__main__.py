"""Structures whose truth is none of ours: meshes that CalculiX assembles and beams of another element code, tested and diagnosed.

    python -m benchmarks.foreign_tests OUT [--only WORD ...] [--table]

writes a folder a case into OUT, with the model as its owner would write it, a coarse mesh or a frame in a few lines, and the data
as a laboratory would hand them over (UFF 58 and 55, CSV); it diagnoses what has no answer yet, and prints a row a case. Nothing
of massline is asked for the data: the tested structure is finer, of other elements, its materials a little off, its losses by
mode, its pick-ups glued a little crooked and calibrated as well as certificates say.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from benchmarks.foreign_tests.laboratory import Bench, Fault, functions, table
from benchmarks.foreign_tests.structures import BENCHES

SOUND = 2
"""[count] of sound articles of each structure and kind of test."""


def cases() -> list[tuple[str, str, str, int]]:
    """Name, structure, fault or nothing, and seed of every case; functions of every fault, tables of those that a table shows."""
    found = []
    for at, (name, bench) in enumerate(BENCHES.items()):
        for kind in ("functions", "table"):
            found += [(f"{name}-{kind}-sound-{k + 1}", name, "", 1000 * at + k) for k in range(SOUND)]
            faults = [
                (k, fault) for k, fault in enumerate(bench().faults) if (kind, fault) != ("table", "delay")
            ]  # shapes are real
            found += [(f"{name}-{kind}-{fault}", name, fault, 1000 * at + 100 + k) for k, fault in faults]
    return found


def written(folder: Path, case: tuple[str, str, str, int]) -> None:
    """Model and data of a case."""
    name, structure, fault, seed = case
    bench, kind = BENCHES[structure](), name.split(f"{structure}-")[1].split("-")[0]
    folder.mkdir(parents=True)
    fine = bench.fine()
    at: dict[str, tuple[float, float, float]] = {}
    for place, p in bench.places.items():
        x, y, z = (float(f"{x:.6g}") for x in 1e3 * fine.points[fine.nearest(tuple(np.array(p) / 1e3))])
        at[place] = (x, y, z)
    bench = Bench(**{**vars(bench), "places": {name: tuple(np.array(p) / 1e3) for name, p in at.items()}})
    planted = bench.faults[fault] if fault else None
    test = (
        functions(folder, bench, planted, seed, csv=seed % 2 == 1) if kind == "functions" else table(folder, bench, planted, seed)
    )
    model = bench.described(folder, at)
    head = 'format = 1\nmodel = { title = "own", article = "own" }\n[tolerances]\nclass = "calibrated"\n'
    (folder / "own.toml").write_text(f"{head}{model}{test}")
    (folder / "truth.json").write_text(json.dumps({"planted": planted}))


TURNS = {"x": "alpha", "y": "beta", "z": "gamma"}


def verdict(fault: Fault | None, answer: Mapping[str, object]) -> str:
    """`quiet`, `named`, `class`, `beside` (more is named with it), `missed`, `wrong`, `unknown` or `refused`."""
    if "refused" in answer:
        return "refused"
    said, accepted = str(answer["verdict"]), [str(one["id"]) for one in answer["accepted"]]  # type: ignore[attr-defined]
    if not fault:
        return "quiet" if said == "nothing" else ("unknown" if not accepted else "wrong")
    if not accepted:
        return "missed" if said == "nothing" else "unknown"
    kind, target, _ = fault
    channel = [one.replace(":", "-") for one in target.split()]
    right = {
        "point-mass": [f"point-mass:{target}"],
        "modulus": [f"modulus:{target}"],
        "support": [f"support-stiffness:{target}"],
        "joint": [f"connection-compliance:{target.rpartition(':')[0]}:{TURNS.get(target[-1])}"],
        "gain": [f"accelerometer-gain:{channel[0]}"],
        "polarity": [f"polarity:{channel[0]}"],
        "unit": [f"unit:{channel[0]}"],
        "delay": [f"accelerometer-delay:{channel[0]}"],
        "turned": [f"accelerometer-misalignment:{':'.join(channel)}"],
        "beside": [f"accelerometer-position:{':'.join(channel)}"],
        "moved": [f"wrong-place:{':'.join(channel)}"],
        "direction": [f"wrong-direction:{':'.join(channel)}"],
        "swap": [":".join(["channel-swap", *channel]), ":".join(["channel-swap", *channel[::-1]])],
    }[kind]
    if accepted[0] in right and len(accepted) == 1:
        return "named"
    if any(one in right for one in accepted):
        return "beside"
    alike = [one for each in answer["accepted"] for one in each.get("same", [])]  # type: ignore[attr-defined]
    alike += [one for each in answer.get("class", []) for one in (each if isinstance(each, list) else [each])]  # type: ignore[attr-defined]
    return "class" if any(one in right for one in alike) else "wrong"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", nargs="*", default=[], help="words that the name of a case has one of")
    parser.add_argument("--again", action="store_true", help="answer again what has an answer")
    parser.add_argument("--table", action="store_true", help="nothing but the table of what is answered")
    asked = parser.parse_args()
    counts: dict[str, int] = {}
    for case in cases():
        name, _, fault, _ = case
        folder = asked.out / name
        if asked.only and not any(word in name for word in asked.only):
            continue
        if not folder.exists() and not asked.table:
            written(folder, case)
        answer = folder / "answer.json"
        if not asked.table and (asked.again or not answer.exists()):
            before = os.times()
            run = subprocess.run(
                [str(Path(sys.executable).with_name("massline")), "diagnose", "own.toml", "--json"],
                cwd=folder,
                capture_output=True,
                text=True,
                check=False,
            )
            spent = os.times().children_user + os.times().children_system - before.children_user - before.children_system
            text = run.stdout if run.stdout.startswith("{") else json.dumps({"refused": run.stderr[-1000:]})
            answer.write_text(json.dumps({**json.loads(text), "seconds": spent}))
        if not answer.exists():
            continue
        found, planted = json.loads(answer.read_text()), json.loads((folder / "truth.json").read_text())["planted"]
        said = verdict(planted, found)
        key = f"{'fault' if fault else 'sound'} {said}"
        counts[key] = counts.get(key, 0) + 1
        sys.stdout.write(f"{name:32} {said:8} {found.get('verdict', '')} {found.get('seconds', 0):5.0f} s {summary(found)}\n")
        sys.stdout.flush()
    sys.stdout.write(", ".join(f"{key} {n}" for key, n in sorted(counts.items())) + "\n")
    return 0


def summary(found: Mapping[str, object]) -> str:
    """What was named with its size, or why nothing was answered."""
    if "refused" in found:
        return str(found["refused"]).strip().replace("\n", " ")[-150:]
    named = [f"{one['id']} {one['value'] or 0:.3g}" for one in found["accepted"]]  # type: ignore[attr-defined]
    return "; ".join(named)


if __name__ == "__main__":
    sys.exit(main())
