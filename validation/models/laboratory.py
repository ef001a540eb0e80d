"""The tables [laboratory] and [tolerances] of a model file: gravity, the FMD, its cells, and what is not known of the chain."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

import numpy as np

from geometry.arrays import Array
from geometry.consistency import judge
from geometry.inertia import Inertia, tensor_from_six
from geometry.tolerances import Tolerances
from validation.measurement_file import Fields
from validation.models.numbers import number, three

LABORATORY = ("hardware", "gravity_m_s2", "fmd", "cell_stiffness_N_m")
INERTIA = ("mass_kg", "cog_mm", "moi_cog_kgm2", "poi_cog_kgm2")
DRAWING = "drawing"
FMD = ("inertia", "tolerance", *INERTIA)

SCALES = {
    "gain": ("gain", 1.0),
    "table_gain": ("table_gain", 1.0),
    "delay": ("delay_s", 0.01),
    "position": ("position_mm", 100.0),
    "angle": ("angle_deg", 30.0),
    "cell_stiffness": ("cell_stiffness", 5.0),
    "crosstalk": ("crosstalk", 1.0),
}
"""Fields of `Tolerances`, how the file calls them, and beyond what a unit was mistaken."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Laboratory:
    """What [laboratory] says; see `Model`."""

    hardware: str
    gravity: float
    fmd: Inertia | None
    fmd_tolerance: float
    cell_stiffness: Array | None


def read(table: Fields) -> Laboratory:
    """[laboratory].

    Raises
    ------
    BadInput : an unknown key, a wrong type or size, an inertia that no body has.
    """
    table.only(LABORATORY)
    fmd = table.inner("fmd").only(FMD)
    stiff = "cell_stiffness_N_m" in table.table
    return Laboratory(
        hardware=table.text("hardware"),
        gravity=number(table, "gravity_m_s2", low=0.0, high=30.0) if "gravity_m_s2" in table.table else 9.81,
        fmd=_inertia(fmd),
        fmd_tolerance=number(fmd, "tolerance", low=0.0, high=1.0) if "tolerance" in fmd.table else 0.05,
        cell_stiffness=np.array(three(table, "cell_stiffness_N_m", low=1.0, high=1e15)) if stiff else None,
    )


def tolerances(table: Fields, fmd: float) -> Tolerances:
    """[tolerances], with the share `fmd` by which the FMD's inertia is known.

    Raises
    ------
    BadInput : an unknown key, a wrong type or size.
    """
    names = {key: name for name, (key, _) in SCALES.items()}
    table.only(names)
    given = {
        name: si(name, number(table, key, low=0.0, high=SCALES[name][1])) for key, name in names.items() if key in table.table
    }
    return Tolerances(**given, fmd_inertia=fmd)


def si(name: str, written: float) -> float:
    """The tolerance `name` in SI of the number `written` in the file."""
    return {"position_mm": written / 1e3, "angle_deg": radians(written)}.get(SCALES[name][0], written)


def fmd_of(mass: float, cog_mm: list[float], moi: list[float], poi: list[float]) -> Inertia:
    """The inertia about F of the four figures in the file."""
    return Inertia.from_cog(mass, [one / 1e3 for one in cog_mm], tensor_from_six([*moi, *poi]))


def _inertia(table: Fields) -> Inertia | None:
    stated = [key for key in INERTIA if key in table.table]
    if "inertia" in table.table:
        table.choice("inertia", (DRAWING,))
        if stated:
            problem = f"the drawing is asked for, and {stated[0]} is stated"
            raise table.refused("inertia", problem, "Keep one of them")
    if not stated:
        return None
    found = fmd_of(
        number(table, "mass_kg", low=0.0, high=1e6, above=True),
        three(table, "cog_mm", low=-1e5, high=1e5),
        three(table, "moi_cog_kgm2", low=0.0, high=1e9),
        three(table, "poi_cog_kgm2", low=-1e9, high=1e9) if "poi_cog_kgm2" in table.table else [0.0, 0.0, 0.0],
    )
    verdict = judge(found)
    if not verdict.physical:
        raise table.refused(
            "moi_cog_kgm2", f"no body has this inertia: {verdict.text}", "Give moments and products about the CoG"
        )
    return found
