"""`massline laboratory`: what was learnt, from how many, how sure, and what would sharpen it."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import click
import numpy as np

from geometry.atomic import write_text
from geometry.errors import BadInput
from geometry.toml_file import one_of, string
from identification import campaign_file
from validation.effects.practical_units import written_as
from validation.identify.laboratory import LaboratoryFindings, laboratory
from validation.model import model_file
from validation.model.learnt import ANEW, Offset
from validation.model.model import require_pair
from validation.model.tolerance_classes import AS_DELIVERED, METROLOGY, NAMES, ROWS
from validation.output import print_answer, require_file, stages, to_json
from validation.report import document as doc
from validation.study import read_data

NARROW = 0.8
"""Share of what was admitted above which next to nothing was learnt of a family."""


def answer(campaigns: Sequence[str], path: str | None, tolerance_class: str | None, out: Path | None, *, as_json: bool) -> None:
    """Learn from `campaigns`, print what, and write the file `out`.

    Raises
    ------
    BadInput : campaigns, a model or a class that cannot be used, a file that could not be written.
    CheckFailed : a fit does not converge.
    """
    if out is not None:
        require_file(out, "--out")
    if tolerance_class is not None:
        one_of(tolerance_class, tuple(name for name in NAMES if name != METROLOGY), source="--class", where="")
    described = [campaign_file.read_description(folder) for folder in campaigns]
    if path is None:
        about = f"format = 1\n[model]\narticle = {string(described[0].article)}\n[laboratory]\n"
        about += f"gravity_m_s2 = {described[0].gravity!r}\n[tolerances]\nclass = {string(tolerance_class or AS_DELIVERED)}\n"
        model = model_file.of_text(about, "the drawings")
    else:
        if tolerance_class is not None:
            problem = f"{path} says of which class the laboratory is"
            raise BadInput("--class", "", problem, "Write `class` in its [tolerances], and leave this out")
        model = model_file.read(path)
    require_pair(model, described)
    with stages("learning", quiet=as_json) as told:
        found = laboratory(model, read_data(campaigns, model).campaigns, told)
    if out is not None:
        write_text(out, found.learnt.text)
    whole = {"campaigns": list(campaigns), **to_json(found)}
    print_answer(lambda: whole, document(found).text, as_json=as_json)
    if out is not None and not as_json:
        click.echo(f"massline: wrote {out}. In [laboratory] of a model file: learnt = {string(str(out))}.", err=True)


def document(found: LaboratoryFindings) -> doc.Document:
    """All of it, in the order in which it is read."""
    of = found.learnt
    families: dict[str, list[Offset]] = {}
    for name, one in of.offsets.items():
        families.setdefault(name.partition(":")[0], []).append(one)

    def share(row: tuple[str, list[Offset]]) -> float:
        return 100 * float(np.median([one.deviation / one.before for one in row[1]]))

    def farthest(row: tuple[str, list[Offset]]) -> float:
        return max(abs(one.offset) / one.before for one in row[1])

    rows = {row.key: row for row in ROWS}

    def figures(key: str) -> tuple[tuple[str, ...], str]:
        one = of.spreads[key]
        unit = "m" if key.endswith("_mm") else "rad"
        return written_as(unit, (one.deviation, one.low, one.high, one.before), signed=False)

    hardware = doc.Table(
        caption="What is of the hardware",
        rows=sorted(families.items(), key=share),
        columns=(
            doc.Column("hardware", lambda row: row[0], words=True),
            doc.Column("parameters", lambda row: f"{len(row[1])}"),
            doc.Column("left of what was admitted [%]", share, ".0f"),
            doc.Column("farthest [sd admitted]", farthest, ".1f"),
        ),
    )
    mountings = doc.Table(
        caption="What is new with every mounting",
        rows=list(of.spreads),
        columns=(
            doc.Column("mounting", lambda key: rows[key].what.partition(",")[0], words=True),
            doc.Column("scatter (sd)", lambda key: figures(key)[0][0]),
            doc.Column("90 % interval", lambda key: "{1} to {2}".format(*figures(key)[0])),
            doc.Column("of its class", lambda key: figures(key)[0][3]),
            doc.Column("unit", lambda key: figures(key)[1], words=True),
            doc.Column("from", lambda key: f"{of.spreads[key].count}"),
        ),
    )
    proof = doc.Table(
        caption="What was learnt from the others, held against each",
        rows=found.held_out,
        columns=(
            doc.Column("used only for checking", lambda one: one.campaign, words=True),
            doc.Column("chi²", lambda one: one.misfit, ".3f"),
            doc.Column("of a sound laboratory below", lambda one: one.limit, ".3f"),
            doc.Column("prior penalty", lambda one: one.price, ".2f"),
            doc.Column("so", lambda one: "quiet" if one.quiet else "not quiet", words=True),
        ),
    )

    def notes() -> Iterator[str]:
        if found.widened > 1:
            yield f"All deviations of the hardware are widened by {found.widened:.2f}, the root of their mean prior penalty."
        if not found.held_out:
            yield "One campaign alone proves nothing: mount it again, and name both."
        shares: dict[str, list[float]] = {}
        for name, one in found.learnt.offsets.items():
            shares.setdefault(name.partition(":")[0], []).append(one.deviation / one.before)
        dull = [family for family, of in shares.items() if np.median(of) > NARROW]
        if dull:
            yield f"Little was learnt of {', '.join(dull)}: another known body would, or the same turned by 90 degrees."
        missing = [row.key for row in ANEW if row.key not in found.learnt.spreads]
        if missing:
            yield f"Nothing was learnt of {', '.join(missing)}: these data tell them no better than their class."
        yield "What drifts from run to run is not told apart: it counts as noise, or as of the mounting."

    quiet = sum(one.quiet for one in found.held_out)
    opening = [
        f"Learnt of {of.hardware or 'a nameless hardware'} from {len(of.campaigns)} campaigns, at first {of.tolerance_class}.",
        *([f"{quiet} of {len(found.held_out)} campaigns are quiet by what the others taught."] if found.held_out else []),
        *([] if found.stands.null else [f"But all of them together are not sound: {found.stands.text}."]),
    ]
    return doc.Document(
        title="What the laboratory knows of itself", opening=opening, blocks=(hardware, mountings, proof), notes=list(notes())
    )
