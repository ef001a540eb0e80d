"""The pictures of `massline dynamic-mass --plot`."""

from __future__ import annotations

from pathlib import Path

from geometry.dynamic_mass import DynamicMass
from validation.article_reference import file_name
from validation.flexible.curves import Curves
from validation.pictures.curves import Curve, diagonal, full


def draw(found: Curves, folder: Path) -> tuple[Path, ...]:
    """Write the diagonal and the full 6x6 grid of `found` into `folder`, and say where they are."""
    drawn = [
        Curve(name=f"{model.model} model", mass=mass, rigid=found.rigid, modes=model.modes)
        for model, mass in zip(found.models, found.masses, strict=True)
    ]
    stem = file_name(f"dynamic-mass-{found.article}-{'-'.join(model.model for model in found.models)}")
    paths = folder / f"{stem}.png", folder / f"{stem}-6x6.png"
    note = note_on(found.masses[0], found.about)
    diagonal(f"{found.article}: dynamic mass, diagonal", drawn, paths[0], note)
    full(f"{found.article}: dynamic mass, rows loads, columns base motions", drawn, paths[1], note.removesuffix(TICKS))
    return paths


TICKS = " Ticks on the upper edge: eigenfrequencies [Hz]."
"""Said where there are such ticks: the full grid has none."""


def note_on(H: DynamicMass, about: str, frame: str = "in the article's frame") -> str:
    """What must be known to read a picture of `H`."""
    point = ", ".join(f"{1e3 * x + 0.0:g}" for x in H.reference_point)
    name = {"article": "the article's origin", "F": "F"}.get(about, "the point")
    return (
        f"Blocked: all six base motions prescribed; loads of the table on the article, about {name}, ({point}) mm {frame}. "
        f"Dashed: the rigid body.{TICKS}"
    )
