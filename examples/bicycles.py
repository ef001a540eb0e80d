"""Four bicycles on pendulums: measured periods reduced to the published inertias, with massline's general functions.

Wheels (F, R), fork (H) and frame (B) of each bicycle were hung from a torsion rod and swung as compound pendulums; the rod was
calibrated with a solid steel bar (P). The data are the measurements and published results of BicycleParameters
(github.com/moorepants/BicycleParameters, data/bicycles, commit e061bc9, BSD-2); massline holds no copy.

The published frame has x forwards, z *down*, its origin at the rear wheel's contact point. A body hung from the rod in
orientation i, turned by alpha_i from the horizontal, has the rod's axis along ``(cos β, 0, -sin β)`` with β = lam - alpha (lam is
the tilt of the steer axis from the vertical). The plumb line through the rod runs along the same direction, at the measured
distance a_i from the wheel's axle, and through the CoG: ``x sin β + z cos β = -a`` from the axle.

    python examples/bicycles.py --data ../shared/data
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

import click
from numpy import pi
from rich.table import Table
from uncertainties import UFloat, nominal_value, umath

from geometry.errors import BadInput
from geometry.toml_file import tagged
from validation.classical.pendulum import (
    compound_pendulum,
    rod_inertia,
    tensor_from_axes,
    torsion_pendulum,
    torsion_stiffness,
)
from validation.output import print_pages
from validation.reference.statement import add_figures

BICYCLES = ("Browser", "Fisher", "Pista", "Yellow")
HANGINGS = ("1", "2", "3")
HEADINGS = ("computed", "tolerance", "published", "tolerance", "deviation\n/ tolerance")

PLANAR = ("xx", "zz", "xz")
"""What pendulums about axes in the plane of symmetry xz see of the tensor."""

PARALLEL = 1e-3
"""Sine of the angle between two plumb lines below which their intersection says nothing."""

Quantities = dict[str, UFloat]


def read(file: Path) -> Quantities:
    """The lines ``name = value`` or ``name = value+/-tolerance`` of a file of the set; lengths m, periods s, angles deg."""
    pairs = (line.split("=") for line in file.read_text(encoding="utf-8").splitlines() if "=" in line)
    return {name.strip(): _value(name.strip(), text) for name, text in pairs}


def reduce(measured: Quantities) -> Quantities:
    """All published quantities from the measured ones."""
    m = dict(measured)
    bar = rod_inertia(mass=m["mP"], length=m["lP"], diameter=m["dP"])
    m["k"] = torsion_stiffness(known_inertia=bar, period=m["TtP1"])
    m["lam"] = pi / 180 * (90 - m["gamma"])
    return _geometry(m) | _wheel(m, "F") | _wheel(m, "R") | _frame_or_fork(m, "B") | _frame_or_fork(m, "H")


def _value(name: str, text: str) -> UFloat:
    value, _, tolerance = text.partition("+/-")
    return tagged(float(value), float(tolerance or 0), name)


def _roll_out(m: Quantities, wheel: str) -> UFloat:
    return m[f"d{wheel}"] / (2 * pi * m[f"n{wheel}"])


def _geometry(m: Quantities) -> Quantities:
    rF, lam = _roll_out(m, "F"), m["lam"]
    trail = (rF * umath.sin(lam) - m["f"]) / umath.cos(lam)
    given = {name: m[name] for name in ("g", "w", "lam", "mB", "mF", "mH", "mR")}
    return given | {"rF": rF, "rR": _roll_out(m, "R"), "c": trail}


def _wheel(m: Quantities, wheel: str) -> Quantities:
    """A wheel is round: one torsional period about a diameter and one compound period about an axis parallel to its axle."""
    swing = {"mass": m[f"m{wheel}"], "gravity": m["g"], "arm": m[f"l{wheel}"], "period": m[f"Tc{wheel}1"]}
    across = torsion_pendulum(stiffness=m["k"], period=m[f"Tt{wheel}1"])
    return {f"I{wheel}xx": across, f"I{wheel}yy": compound_pendulum(**swing)}


def meeting_point(normals: Sequence[tuple[UFloat, UFloat]], offsets: Sequence[UFloat]) -> tuple[UFloat, UFloat]:
    """Where plumb lines ``n · p = offset`` of a plane meet: the mean of all their pairwise intersections.

    Parameters
    ----------
    normals : (n, 2), unit normals of the lines, numbers or quantities
    offsets : (n,) [m], signed distances of the lines from the origin of the plane

    Three lines with reading errors form a triangle; its corners are averaged. That is what the published bicycle data use; a
    least-squares fit to the lines gives another point, a few millimetres away when the lines are poorly crossed.

    Raises
    ------
    BadInput : fewer than two lines, or two of them nearly parallel.
    """
    lines = list(zip(normals, offsets, strict=True))
    if len(lines) < 2:
        problem = f"at least two plumb lines must cross, found {len(lines)}"
        raise BadInput("plumb lines", "orientations", problem, "Hang the body in another orientation too")
    corners = []
    for (n, c), (m, d) in combinations(lines, 2):
        determinant = n[0] * m[1] - n[1] * m[0]
        if abs(nominal_value(determinant)) < PARALLEL:
            problem = "two plumb lines are parallel within 0.06 deg"
            remedy = "Hang the body in a clearly different orientation"
            raise BadInput("plumb lines", "orientations", problem, remedy)
        corners.append(((c * m[1] - d * n[1]) / determinant, (n[0] * d - m[0] * c) / determinant))
    x, z = (sum(corner[i] for corner in corners) / len(corners) for i in (0, 1))
    return x, z


def _frame_or_fork(m: Quantities, body: str) -> Quantities:
    """Frame and fork have a plane of symmetry: three hanging orientations in it, and a swing about the axle across it."""
    betas = [m["lam"] - pi / 180 * m[f"alpha{body}{i}"] for i in HANGINGS]
    x, z = meeting_point([(umath.sin(b), umath.cos(b)) for b in betas], [-m[f"a{body}{i}"] for i in HANGINGS])
    moments = [torsion_pendulum(stiffness=m["k"], period=m[f"Tt{body}{i}"]) for i in HANGINGS]
    tensor = tensor_from_axes([(umath.cos(b), 0.0, -umath.sin(b)) for b in betas], moments, PLANAR)
    arm = umath.sqrt(x**2 + z**2)
    tensor["yy"] = compound_pendulum(mass=m[f"m{body}"], gravity=m["g"], arm=arm, period=m[f"Tc{body}1"])
    axle_x, axle_z = (m["w"], -_roll_out(m, "F")) if body == "H" else (0.0, -_roll_out(m, "R"))
    return {f"x{body}": x + axle_x, f"z{body}": z + axle_z} | {f"I{body}{entry}": value for entry, value in tensor.items()}


def comparison(folder: Path, bicycle: str) -> list[tuple[str, UFloat, UFloat]]:
    """Name, computed and published value of every published quantity of one bicycle; `folder` holds the set."""
    computed = reduce(read(folder / f"{bicycle}Measured.txt"))
    published = read(folder / f"{bicycle}Benchmark.txt")
    return [(name, computed[name], published[name]) for name in sorted(published)]


def _table(folder: Path, bicycle: str) -> Table:
    table = Table(title=f"{bicycle}: computed beside published (kg, m, rad, kg m²)", title_justify="left")
    lines = [(name, *_figures(ours, theirs)) for name, ours, theirs in comparison(folder, bicycle)]
    names, *figures = zip(*lines, strict=True)
    table.add_column("quantity", no_wrap=True, min_width=max(map(len, ("quantity", *names))))
    for heading, column in zip(HEADINGS, figures, strict=True):
        add_figures(table, heading, column)
    for line in lines:
        table.add_row(*line)
    return table


def _figures(ours: UFloat, theirs: UFloat) -> tuple[str, ...]:
    figures = (ours.nominal_value, ours.std_dev, theirs.nominal_value, theirs.std_dev)
    deviation = abs(ours.nominal_value - theirs.nominal_value) / theirs.std_dev
    return (*(f"{figure:.6g}" for figure in figures), f"{deviation:.1e}")


@click.command()
@click.option(
    "--data", "folder", envvar="MASSLINE_DATA", default="../shared/data", type=click.Path(path_type=Path), show_default=True
)
def main(folder: Path) -> None:
    """Print computed beside published inertias of the four bicycles in FOLDER/bicycle_pendulum."""
    if not (folder / "bicycle_pendulum").is_dir():
        raise click.UsageError(f"{folder}/bicycle_pendulum is absent; give the data folder with --data or MASSLINE_DATA")
    print_pages(_table(folder / "bicycle_pendulum", bicycle) for bicycle in BICYCLES)


if __name__ == "__main__":
    main()
