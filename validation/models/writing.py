"""A `Model` as the text of its file, with comments; and a file's own text with an effect more or less, its comments kept.

What is read back from `text` is the same model, bit for bit where it came from a file.
"""

from __future__ import annotations

import os.path
from dataclasses import fields
from functools import partial
from math import degrees
from operator import add
from pathlib import Path

import numpy as np

from geometry import multibody, toml_file
from geometry.articles import built_in, changes_of
from geometry.inertia import Inertia, parallel_axis, six_from_tensor
from identification.chain.fmd import assumed_stiffness
from validation.identifying.known import FMD
from validation.models import laboratory
from validation.models.editing import with_effect, without_effect
from validation.models.effects import effect_text
from validation.models.laboratory import SCALES
from validation.models.model import Model, StructureTolerances
from validation.models.notation import Line, block, number, numbers, shortest, string

__all__ = ["text", "with_effect", "without_effect"]

TOLERANCE_NOTES = {
    "gain": "relative, load cells and accelerometers on cover plate and article",
    "table_gain": "relative, accelerometers below the FMD",
    "delay": "of every channel",
    "position": "of a pick-up along each axis",
    "angle": "of a pick-up about the two axes across its direction",
    "cell_stiffness": "relative, of each load cell along each axis",
    "crosstalk": "relative, of each resultant in the others of its kind",
}
STRUCTURE_NOTES = {
    "modulus": "of every part's moduli",
    "frequency": "of every mode's frequency, beside the moduli",
    "damping": "of every part's loss factor; of the logarithm of every mode's damping where damping_ratio gives it",
    "mode_damping": "of the logarithm of every mode's damping, beside the loss factors of the parts",
    "damping_law": "share of what parts lose that follows the velocity instead of the displacement",
    "participation": "of every mode's participation, as a share of its largest",
    "mode_coupling": "of the damping between two modes, as a share of the geometric mean of theirs",
}


def text(model: Model) -> str:
    """The text of the model file of `model`."""
    blocks = [_head(model), *_laboratory(model), *_tolerances(model), *_structure(model), _about_effects()]
    return "\n\n".join([*blocks, *(effect_text(one) for one in model.effects)]) + "\n"


def _head(model: Model) -> str:
    return block(
        "# A model file of massline: a laboratory, a structure, and the effects that were added so far.\n"
        "# Units are in the names; what has none is a share, or SI.\n"
        f"format = {toml_file.FORMAT}\n\n[model]",
        [
            ("title", string(model.title), ""),
            ("article", string(model.article), "the set-up, bottom to top; one model serves a whole series"),
        ],
    )


def _laboratory(model: Model) -> list[str]:
    stiffness = numbers(assumed_stiffness() if model.cell_stiffness is None else model.cell_stiffness)
    unknown = "# " if model.cell_stiffness is None else ""
    lines = [
        ("hardware", string(model.hardware), "FMD and sensors, as `campaign.hardware` calls them; empty: any"),
        ("gravity_m_s2", number(model.gravity), ""),
        (f"{unknown}cell_stiffness_N_m", stiffness, "one load cell along x, y, z; leave it out where it is not known"),
    ]
    return [block("[laboratory]", lines), block(_FMD, _fmd(model))]


_FMD = """\
# The FMD's moving part: its inertia as a tare or a drawing says, never assumed to be exact. `tolerance` is one standard deviation
# of every parameter, as a share. inertia = "drawing" takes that of the built-in reconstruction; or state your own figures.
[laboratory.fmd]"""


def _fmd(model: Model) -> list[Line]:
    known = _drawn(model) if model.fmd is None else _inertia(model.fmd)
    return [*known, ("tolerance", number(model.fmd_tolerance), "")]


def _drawn(model: Model) -> list[Line]:
    """The drawing asked for, and its figures as a comment to write one's own over."""
    drawn = multibody.inertia(built_in(FMD, changes_of(FMD, model.changes)))
    rounded = Inertia.from_cog(float(f"{drawn.mass:.4g}"), np.round(drawn.cog, 5), np.diag(np.round(drawn.moments_cog, 4)))
    return [("inertia", string(laboratory.DRAWING), ""), *((f"# {key}", value, note) for key, value, note in _inertia(rounded))]


def _inertia(inertia: Inertia) -> list[Line]:
    """Mass, CoG, moments and products, in digits that give the same ten parameters about F when they are read."""
    about_f = inertia.about((0.0, 0.0, 0.0))
    mass = about_f.mass
    cog = [shortest(first, lambda mm: mass * (mm / 1e3), 1e3 * first / mass) for first in map(float, about_f.first_moment)]
    steiner = six_from_tensor(parallel_axis(mass, [one / 1e3 for one in cog]))
    six = [
        shortest(target, partial(add, more), target - more)
        for target, more in zip(about_f.parameters[4:].tolist(), steiner.tolist(), strict=True)
    ]
    return [
        ("mass_kg", number(mass), ""),
        ("cog_mm", numbers(cog), "from F, the centre of the force-measuring plane"),
        ("moi_cog_kgm2", numbers(six[:3]), "xx, yy, zz about the CoG"),
        ("poi_cog_kgm2", numbers(six[3:]), "xy, xz, yz: entries of the tensor, -∫xy dm"),
    ]


def _tolerances(model: Model) -> list[str]:
    lines = [
        (key, number(shortest(size, partial(laboratory.si, name), _as_written(key, size))), TOLERANCE_NOTES[name])
        for name, (key, _) in SCALES.items()
        for size in [getattr(model.tolerances, name)]
    ]
    return [block("# What is not known of the measurement chain, one standard deviation each; 0 is exact.\n[tolerances]", lines)]


def _as_written(key: str, size: float) -> float:
    return {"position_mm": 1e3 * size, "angle_deg": degrees(size)}.get(key, size)


def _structure(model: Model) -> list[str]:
    ratio = model.damping_ratio
    lines = [
        ("kind", string(model.kind), "beam, rigid (does not give), or own: every article has its own model below"),
        ("modes", str(model.modes), "kept; what the others contribute is in the residual mass"),
        (
            "# damping_ratio" if ratio is None else "damping_ratio",
            number(0.003 if ratio is None else ratio),
            "of every mode; left out, the loss factors of the parts hold",
        ),
    ]
    own = [(string(article), string(_relative(path, model.source)), "") for article, path in model.own.items()]
    changes = [(string(key), number(value), "") for key, value in model.changes.items()]
    spread = [
        (one.name, number(getattr(model.structure, one.name)), STRUCTURE_NOTES[one.name]) for one in fields(StructureTolerances)
    ]
    return [
        block("[structure]", lines),
        *(
            [
                block(
                    "# Your own dimensions of built-in parts, as in their file in geometry/articles.\n[structure.dimensions]",
                    changes,
                )
            ]
            if changes
            else []
        ),
        *(
            [
                block(
                    "# Your own model by article: K and M, modal data or CAD, from the folder of this file.\n[structure.own]", own
                )
            ]
            if own
            else []
        ),
        block("# How well it is known beforehand, one standard deviation as a share.\n[structure.tolerances]", spread),
    ]


def _relative(path: str, source: str) -> str:
    return os.path.relpath(path, Path(source).parent)


def _about_effects() -> str:
    return (
        "# Effects that were added, in the order in which they act; `massline add` writes them, `massline undo` takes them out."
    )
