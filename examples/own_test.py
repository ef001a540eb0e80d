"""Make the test of a structure of your own as a laboratory would hand it over, with a fault that its model does not know.

``python examples/own_test.py FILE.csv`` writes response functions of three floors, from the closed form of a chain of masses,
whose second storey is 20 % softer than drawn. ``python examples/own_test.py MODEL.toml PART PLACE:AXIS ... TEST.toml`` writes a
table of the first five modes of a model, one part of which is 20 % softer. ``docs/your-own-structure.md`` uses both.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

SOFTER = 0.2


def functions(path: Path) -> None:
    """Accelerances (m/s²)/N of floors 1 to 3, driven at floor 1: 5 kg a floor on four legs 25 x 3 x 150 mm of aluminium."""
    rng, frequency = np.random.default_rng(20), np.arange(3.0, 40.0, 0.1)
    leg = 4 * 12 * 70e9 * (0.025 * 0.003**3 / 12) / 0.15**3
    k1, k2, k3 = leg * np.array([1.0, 1.0 - SOFTER, 1.0])
    K, M = np.array([[k1 + k2, -k2, 0], [-k2, k2 + k3, -k3], [0, -k3, k3]]), 5.0 * np.eye(3)
    lines = ["frequency,floor-1 re,floor-1 im,floor-2 re,floor-2 im,floor-3 re,floor-3 im"]
    for f in frequency:
        omega = 2 * np.pi * f
        H = -(omega**2) * np.linalg.inv(K * (1 + 0.02j) - omega**2 * M)[:, 0]
        H = H * (1 + 0.004 * (rng.standard_normal(3) + 1j * rng.standard_normal(3)))
        lines.append(",".join(f"{x:.8g}" for x in [f, *H.view(np.float64)]))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def modes(model: str, part: str, sensors: list[str], path: Path) -> None:
    """Frequencies, known to 0.1 %, and shapes at the `sensors` of the `model` with a softer `part`."""
    import tomllib

    from scipy.sparse.linalg import eigsh

    from fem.user_model import reading

    article = tomllib.loads(Path(model).read_text(encoding="utf-8"))["model"]["article"]
    structure, rng = reading.read(model), np.random.default_rng(1)
    free = np.setdiff1d(np.arange(structure.mass.shape[0]), structure.held)
    K = (structure.stiffness - SOFTER * structure.part_stiffness[part]).tocsc()[free][:, free]
    squares, shapes = eigsh(K, k=5, M=structure.mass.tocsc()[free][:, free], sigma=0.0)
    order = np.argsort(squares)
    along = [(*sensor.split(":"),) for sensor in sensors]
    rows = np.array([structure.places[place].toarray()["xyz".index(axis)][free] for place, axis in along])
    hertz = np.sqrt(squares[order]) / (2 * np.pi) * (1 + 0.001 * rng.standard_normal(5))
    seen = [[float(f"{x:.4g}") for x in rows @ shapes[:, k]] for k in order]
    table = ["format = 1", 'kind = "modal-table"', f'article = "{article}"', f"sensors = {sensors}"]
    table += [f"frequencies = {[f'{f:.2f} +/- {f / 1000:.2f} Hz' for f in hertz]}", f"shapes = {seen}", "shapes_deviation = 0.01"]
    path.write_text("\n".join(table) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        functions(Path(sys.argv[1]))
    else:
        modes(sys.argv[1], sys.argv[2], sys.argv[3:-1], Path(sys.argv[-1]))
