"""What `massline dynamic-mass` was asked, and what it answers: the dynamic mass of an article by one model or by several."""

from __future__ import annotations

from dataclasses import dataclass

import click
import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from validation.flexible import dynamic_mass_table as table
from validation.flexible.bodies import another_body
from validation.flexible.dynamic_mass import Apart, apart, beyond_the_modes, dynamic_mass, lines, reference_point
from validation.flexible.model import Asked, Flexible, flexible, require_model, require_used


@dataclass(frozen=True, kw_only=True)
class Question:
    """Article, models (the first is the one asked for, the others stand beside it), band and step [Hz], reference point."""

    article: str
    models: tuple[str, ...]
    band: tuple[float, float]
    step: float
    about: str
    asked: Asked


@dataclass(frozen=True, eq=False, kw_only=True)
class Curves:
    """The answer: a dynamic mass for each model, all on the same lines about the same point.

    Attributes
    ----------
    about : name of the reference point
    rigid : (6, 6) rigid mass matrix about it, of the first model
    apart : how far each further model is from the first
    """

    article: str
    about: str
    models: tuple[Flexible, ...]
    masses: tuple[DynamicMass, ...]
    rigid: Array
    apart: tuple[tuple[Apart, ...], ...]
    warnings: tuple[str, ...]


def curves(question: Question, *, quiet: bool = False) -> Curves:
    """Answer `question`.

    Raises
    ------
    BadInput : something in it cannot be; everything that can be checked is, before anything is computed.
    """
    from validation.progress import shown

    names = [
        require_model(question.article, m, option) for m, option in zip(question.models, ("--model", "--against"), strict=False)
    ]
    require_used(question.article, names, question.asked)
    frequency = lines(question.band, question.step)
    about, point = reference_point(question.about, question.article)
    models, masses = [], []
    for name, model in zip(names, question.models, strict=True):
        with shown(f"dynamic mass of {question.article}, {name} model", quiet=quiet):
            models.append(flexible(question.article, model, question.asked))
            masses.append(dynamic_mass(models[-1], frequency, point))
    resonances = np.concatenate([m.modes.frequency for m in models])
    rigid = DynamicMass(
        frequency=np.zeros(1),
        matrix=models[0].modes.rigid_mass[None].astype(complex),
        reference_point=models[0].modes.reference_point,
    )
    rigid_mass = np.asarray(rigid.about(point).matrix[0].real)
    said = [beyond_the_modes(m, question.band[1], question.asked) for m in models]
    return Curves(
        article=question.article,
        about=about,
        models=tuple(models),
        masses=tuple(masses),
        rigid=rigid_mass,
        apart=tuple(apart(masses[0], other, resonances, rigid_mass) for other in masses[1:]),
        warnings=tuple(dict.fromkeys(filter(None, said))),
    )


def report(found: Curves, *, as_json: bool) -> None:
    """Print `found` as tables, or as the JSON object of the output contract."""
    from validation.output import print_json
    from validation.tables.text import page

    first = found.models[0]
    if as_json:
        other = (found.models[1].model, found.apart[0]) if found.apart else None
        print_json(table.as_json(first, found.masses[0], np.diag(found.rigid), found.about, other))
        return
    H, rigid = found.masses[0], np.diag(found.rigid)
    peaks = table.peaks_grid(table.peaks(H, rigid))
    grids = [table.lines_grid(H, rigid), *([peaks] if peaks else [])]
    grids += [table.apart_grid(one, first.model, m.model) for one, m in zip(found.apart, found.models[1:], strict=True)]
    click.echo(page(f"{found.article}: dynamic mass, {first.model} model", grids, _notes(found)), nl=False)


def _notes(found: Curves) -> tuple[str, ...]:
    first, H = found.models[0], found.masses[0]
    point = ", ".join(f"{1e3 * x + 0.0:g}" for x in H.reference_point)
    name = {"article": "the article's origin", "F": "F, the centre of the force-measuring plane"}.get(found.about, "the point")
    compared = (table.apart_text(one, first.model, m.model) for one, m in zip(found.apart, found.models[1:], strict=True))
    kept = f"{len(first.modes.frequency)} modes and the residual mass of the others"
    return (
        *filter(None, (another_body(first, other) for other in found.models[1:])),
        f"Blocked: all six base motions are prescribed. About {name}, ({point}) mm in the article's frame; {kept}.",
        f"{len(H.frequency)} lines, {H.frequency[0]:g} to {H.frequency[-1]:g} Hz; a peak between two lines is higher than shown.",
        *compared,
        *first.notes,
    )
