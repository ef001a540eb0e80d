"""Any article as curved ten-node tetrahedra, made by gmsh.

Every part is drawn by OCC, handed over as BREP in millimetres and fragmented with the others, so that bodies in contact share
the nodes of the common face and no joint has to be invented. The first-order mesh is made first; its edges are then bent onto
the true surfaces, since straight ones lose mass at every circle. What cannot be meshed is tried again with smaller elements
before it is refused.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from fem.solid import packed
from fem.solid.bodies import Body
from fem.solid.mesh import SolidMesh
from fem.solid.mesher import FAULT, JOB, MESH, Unmeshable
from fem.solid.sizing import Sizing
from geometry.errors import BadInput, CheckFailed

FINER = (1.0, 1.4, 2.0)
"""Fineness of the attempts, relative to the one asked for; a mesh that fails or is inverted is often only too coarse."""

TIME_LIMIT = 1800.0
"""Seconds after which gmsh is taken to hang."""


def tetrahedra(bodies: Sequence[Body], sizes: Sizing | None = None) -> SolidMesh:
    """Curved tetrahedra of `bodies`, conforming where they touch; the same input gives the same mesh.

    Raises
    ------
    BadInput : bodies that share volume, or more degrees of freedom than `sizes` allows.
    CheckFailed : no valid mesh after several attempts; the message says which body, or how many elements are inverted and where,
        or how much of which body is missing.
    """
    sizes = sizes or Sizing()
    with tempfile.TemporaryDirectory() as folder:
        for index, body in enumerate(bodies):
            body.write(Path(folder, f"{index}.brep"))
        failures: list[str] = []
        for finer in FINER:
            try:
                return _attempt(Path(folder), bodies, replace(sizes, fineness=sizes.fineness * finer))
            except Unmeshable as failure:
                failures.append(str(failure))
            except BadInput as refusal:
                if failures and refusal.field == "size":
                    break  # too fine to be afforded: what made it finer is what the user must hear
                raise
    raise CheckFailed(
        f"no valid mesh after {len(failures)} attempt(s): {failures[-1]}. Give a smaller element size, or simplify the body "
        "there in the CAD",
        failures=tuple(failures),
    )


def _attempt(folder: Path, bodies: Sequence[Body], sizes: Sizing) -> SolidMesh:
    """One run of `fem.solid.mesher`; its answer, or its fault raised here."""
    job = {"bodies": [body.name for body in bodies], "sizing": asdict(sizes)}
    (folder / JOB).write_text(json.dumps(job), encoding="utf-8")
    for left in (MESH, FAULT):
        (folder / left).unlink(missing_ok=True)
    words = _run(folder)
    if (folder / FAULT).is_file():
        raise _fault(json.loads((folder / FAULT).read_text(encoding="utf-8")))
    if words:
        raise Unmeshable(words)
    with np.load(folder / MESH, allow_pickle=False) as arrays:
        return packed.unpack_mesh(arrays)


def _run(folder: Path) -> str:
    """How the process ended, in words; nothing when it ended well. An interruption here ends it too."""
    command = [sys.executable, "-P", "-m", "fem.solid.mesher", str(folder)]
    path = os.pathsep.join(entry or os.getcwd() for entry in sys.path)
    try:
        run = subprocess.run(
            command, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, timeout=TIME_LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return f"gmsh has not finished after {TIME_LIMIT / 60:g} minutes"
    last = [line for line in run.stderr.splitlines() if line.strip()][-1:]
    return f"gmsh broke down ({''.join(last).strip() or run.returncode})" if run.returncode else ""


def _fault(said: dict[str, str]) -> Exception:
    return Unmeshable(said["unmeshable"]) if "unmeshable" in said else BadInput(**said)
