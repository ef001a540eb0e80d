"""Write one model in every format that massline reads: a steel bracket in millimetres, tonnes, newtons and seconds.

Run it as ``python examples/own_model.py [FOLDER]``; ``docs/own-model.md`` works with what it leaves in the folder
(``out/own-model`` when none is given). The matrices come from `fem.beam.frame` here; yours come from your own program.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from fem.beam.elements import Section
from fem.beam.frame import Frame, Member, Plan, assemble
from fem.modes import fixed_base
from fem.structure import Structure
from fem.user_model import reading

E, G, RHO = 210_000.0, 80_800.0, 7.85e-9
"""Young's and shear modulus [N/mm²] and density [t/mm³] of steel."""

DESCRIPTION = """\
format = 1

[fe_model]
name = "bracket"
kind = "matrices"
units = "mm-t-N-s"
reference_point = ["0 mm", "0 mm", "0 mm"]
interface = [101]

[stated]
mass = "2.51 +/- 0.02 kg"
"""


def bracket() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Node numbers (n,), coordinates (n, 3) [mm], K and M (6 n, 6 n): a column of 40 x 20 mm, 300 high, and an arm of 100."""
    coordinates, frame = assembled(STEEL, STEEL)
    return np.arange(101, 111), coordinates, sum(frame.stiffness.values(), np.zeros((60, 60))), frame.mass


def parts() -> dict[str, np.ndarray]:
    """K and M of the column and of the arm, as arrays `stiffness/column`, `mass/arm` ..., which add up to the bracket's."""
    massless = replace(STEEL, mass=0.0, rotary_y=0.0, rotary_z=0.0)
    arrays = {f"stiffness/{name}": share for name, share in assembled(STEEL, STEEL)[1].stiffness.items()}
    return arrays | {
        "mass/column": assembled(STEEL, massless)[1].mass,
        "mass/arm": assembled(massless, STEEL)[1].mass,
    }


def assembled(column: Section, arm: Section) -> tuple[np.ndarray, Frame]:
    """Coordinates (n, 3) [mm] of the nodes, and the frame of both beams."""
    upright = [[0.0, 0.0, z] for z in np.linspace(0, 300, 7)]
    level = [[x, 0.0, 300.0] for x in np.linspace(0, 100, 4)[1:]]
    coordinates = np.array(upright + level)
    members = (
        Member(nodes=tuple(range(7)), section=column, z_axis=np.array([1.0, 0.0, 0.0]), part="column"),
        Member(nodes=(6, 7, 8, 9), section=arm, z_axis=np.array([0.0, 0.0, 1.0]), part="arm"),
    )
    return coordinates, assemble(Plan(nodes=coordinates, carriers=tuple(range(10)), members=members))


def section(width: float, height: float) -> Section:
    """A solid rectangle [mm]; `height` along the section's z axis."""
    area, about_y, about_z = width * height, width * height**3 / 12, height * width**3 / 12
    return Section(
        axial=E * area,
        torsion=G * width * height**3 / 3 * (1 - 0.63 * height / width),
        bending_y=E * about_y,
        bending_z=E * about_z,
        mass=RHO * area,
        rotary_y=RHO * about_y,
        rotary_z=RHO * about_z,
    )


STEEL = section(40.0, 20.0)


def write(folder: Path) -> None:
    """Write the bracket's files into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    nodes, coordinates, K, M = bracket()
    dof = np.array([(node, component) for node in nodes for component in range(1, 7)])
    arrays = {"stiffness": K, "mass": M, "dof": dof, "nodes": nodes, "coordinates": coordinates}
    write_numpy(folder, arrays)
    named = {name: arrays[name] for name in ("dof", "nodes", "coordinates")}
    np.savez_compressed(folder / "bracket-parts.npz", **named, **parts())
    write_nastran(folder, arrays)
    structure = reading.read(folder / "bracket.h5")
    if isinstance(structure, Structure):
        reading.write(fixed_base(structure, 12), folder / "bracket-modes.h5", "bracket")


def write_numpy(folder: Path, arrays: dict[str, np.ndarray]) -> None:
    """HDF5 and npz carry their description themselves."""
    import h5py

    with h5py.File(folder / "bracket.h5", "w") as file:
        file.attrs["description"] = DESCRIPTION
        for name, array in arrays.items():
            file[name] = array
    np.savez_compressed(folder / "bracket.npz", description=np.array(DESCRIPTION), **arrays)


def write_nastran(folder: Path, arrays: dict[str, np.ndarray]) -> None:
    """Files as Nastran leaves them: matrices in OUTPUT4 and in punched DMIG, grid points in bulk data, the rest in TOML."""
    import pandas as pd
    from pyyeti import nastran
    from pyyeti.nastran import op4

    nastran.wtgrids(str(folder / "bracket.bdf"), arrays["nodes"], xyz=arrays["coordinates"])
    op4.write(str(folder / "bracket.op4"), {"kaa": arrays["stiffness"], "maa": arrays["mass"]})
    shares = {f"{name[0]}{name.partition('/')[2]}": share for name, share in parts().items()}  # scolumn, sarm, mcolumn, marm
    op4.write(str(folder / "bracket-parts.op4"), shares)
    index = pd.MultiIndex.from_arrays(arrays["dof"].T)
    punched = {name: pd.DataFrame(arrays[key], index=index, columns=index) for name, key in (("k", "stiffness"), ("m", "mass"))}
    nastran.wtdmig(str(folder / "bracket.pch"), punched)
    names = 'grids = "bracket.bdf"\nmatrices = { stiffness = "k", mass = "m" }\n'
    for name, more in (("bracket-op4", 'file = "bracket.op4"\n'), ("bracket-pch", f'file = "bracket.pch"\n{names}')):
        text = DESCRIPTION.replace("interface", f"{more}interface")
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/own-model"))
