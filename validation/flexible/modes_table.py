"""The table of `massline modes`: frequencies, damping, what moves, effective masses and their sum; and its JSON."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from geometry.arrays import Array
from validation.flexible.effective_mass import movable
from validation.flexible.model import OWN, Flexible
from validation.flexible.words import Described, described
from validation.published.modes import Claim, claims
from validation.rows import NONE
from validation.tables.grid import Grid, aligned, number

AXES = ("x", "y", "z", "α", "β", "γ")
UNITS = ("kg", "kg", "kg", "kg m²", "kg m²", "kg m²")

NOTHING = 1e-6
"""Share of the rigid mass below which an effective mass is printed as 0."""

DECIMALS = 3


def grid(model: Flexible) -> Grid:
    """One line a mode, and below them the sum, what the base carries, and the rigid mass."""
    modes = model.modes
    rigid = np.diag(modes.rigid_mass)
    lines = [
        (str(r), f"{f:.3f}", f"{100 * zeta:.2f}", *_masses(mass, rigid), what.text)
        for r, (f, zeta, mass, what) in enumerate(
            zip(modes.frequency, modes.damping_ratio, modes.effective_mass, words(model), strict=True), start=1
        )
    ]
    header = ("mode", "f [Hz]", "ζ [%]", *(f"{axis} [{unit}]" for axis, unit in zip(AXES, UNITS, strict=True)), "what moves")
    columns = list(zip(*lines, *_sums(model, rigid), strict=True))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:9]), columns[9], strict=True)), words=True)


def words(model: Flexible) -> tuple[Described, ...]:
    """Every mode of `model` in words; empty ones for modal data without a structure."""
    if model.structure is None:
        return tuple(Described(moving={}, strained={}, text="") for _ in model.modes.frequency)
    # The parts of a user's own model are shares of its stiffness, which only its reader has given names.
    structure = replace(model.structure, part_stiffness={}, loss_factors={}) if model.model == OWN else model.structure
    return described(structure, model.modes, model.article_of_primitives)


def _sums(model: Flexible, rigid: Array) -> list[tuple[str, ...]]:
    """The sum over the modes, its share of what all modes can carry, and the base's own part, which is in none."""
    total = model.modes.effective_mass.sum(axis=0)
    sums = [("Σ", "", "", *_masses(total, rigid), f"sum of {len(model.modes.frequency)} modes")]
    if model.structure is not None:
        can = movable(model.structure)
        share = tuple(f"{100 * part / whole:.1f} %" if whole > 0 else NONE for part, whole in zip(total, can, strict=True))
        sums.append(("", "", "", *share, "of what all modes together carry"))
        sums.append(("base", "", "", *_masses(rigid - can, rigid), "carried by the base itself, in no mode"))
    return [*sums, ("rigid", "", "", *_masses(rigid, rigid), "the whole article")]


def _masses(masses: Array, rigid: Array) -> tuple[str, ...]:
    return tuple(number(m, DECIMALS) if abs(m) > NOTHING * whole else "0" for m, whole in zip(masses, rigid, strict=True))


def notes(model: Flexible) -> tuple[str, ...]:
    """What must be known to read the table."""
    about = ", ".join(f"{1e3 * x:g}" for x in model.modes.reference_point)
    where = "the article's origin" if not model.modes.reference_point.any() else f"({about}) mm"
    return (
        f"Base held. Effective masses about {where}: [kg] along x, y, z, [kg m²] about them (α, β, γ).",
        *((_WHAT_MOVES,) if any(what.text for what in words(model)) else ()),
        *model.notes,
    )


_WHAT_MOVES = "What moves: parts with their share of the kinetic energy and the axis along which most of it goes."


def published(model: Flexible) -> Grid | None:
    """The paper's sentences beside what `model` has; None where it prints none."""
    said = claims(model.article, model.modes.frequency)
    if not said:
        return None
    return Grid(
        header=("in print", f"{model.model} model", "holds"),
        lines=tuple((claim.says, claim.found, _verdict(claim)) for claim in said),
        words=True,
    )


def _verdict(claim: Claim) -> str:
    return {True: "yes", False: "NO", None: "too few modes to tell"}[claim.holds]


def as_json(model: Flexible) -> dict[str, Any]:
    """The object of the output contract, effective masses [kg, kg m²] about the reference point."""
    modes = model.modes
    base = {} if model.structure is None else {"effective_mass_of_all_modes": movable(model.structure).tolist()}
    return {
        "article": model.article,
        "model": model.model,
        "frequency_hz": modes.frequency.tolist(),
        "damping_ratio": modes.damping_ratio.tolist(),
        "effective_mass": modes.effective_mass.tolist(),
        "effective_mass_unit": list(UNITS),
        "reference_point_mm": (1e3 * modes.reference_point).tolist(),
        "rigid_mass": np.diag(modes.rigid_mass).tolist(),
        **base,
        "what_moves": [{"text": what.text, "kinetic_energy_share": what.moving} for what in words(model)],
        "published": [{"says": c.says, "found": c.found, "holds": c.holds} for c in claims(model.article, modes.frequency)],
        "notes": list(model.notes),
    }
