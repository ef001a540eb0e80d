"""The answer of `massline pretest`: expected intervals, what dominates them, the price of every channel, rigid places."""

from collections.abc import Iterator
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path

import numpy as np

from geometry.frames import Array
from validation.flexible.model import Flexible
from validation.identify.pretest import PretestFindings, PretestOptions, Rigidity, coarse_lines, findings, largest_share
from validation.output import NONE, print_answer, require_folder, rounded, share_done, shown, to_json, wrote
from validation.reference.reference import file_name
from validation.reference.statement import QUANTITIES
from validation.report.charts.identification import DrawnPretest, draw_pretest, draw_rigid, draw_shares
from validation.report.document import Column, Document, Table
from validation.report.flexible import moved_bodies
from validation.report.identify import uncertainty_shares
from validation.report.scenes.motion import MovingBody

SHOWN_INPUTS = 2

NOTHING = 1e-5
"""Elastic shares below it are not worth their digits."""

HUGE = 10.0
"""Elastic shares above it are a resonance; how high it is hangs on damping."""

KINDS = {"mass": slice(0, 1), "CoG": slice(1, 4), "MoI": slice(4, 7)}
"""Mass, CoG, moments: products are left to the JSON."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PretestPage:
    """What is said and drawn of the pretest that was `found`, table by table."""

    found: PretestFindings

    def document(self) -> Document:
        """All of it, in the order in which it is read."""
        blocks = (self.intervals(), self.dominated_by(), self.losses(), self.places())
        return Document(title=self.title, blocks=blocks, notes=tuple(self.notes()))

    @property
    def title(self) -> str:
        """Article, number of runs, band."""
        plan = self.found.question.plan
        low, high = plan.band
        return f"Pretest of {plan.article}: {len(self.found.spectra.runs)} runs ({plan.pattern}), {low:g} to {high:g} Hz"

    def intervals(self) -> Table:
        """Half-widths of the expected 95 % intervals: plain, self-calibrated, and that without a tare."""

        def value(k: int) -> str:
            kind = slice(0, 1) if k == 0 else slice(1, 4) if k < 4 else slice(4, 10)
            values, per_si = self.found.best.values, QUANTITIES[k].per_si
            there = abs(values[k]) > 1e-6 * float(np.abs(values[kind]).max())  # of the largest of its kind; else rounding
            return rounded(values[k] * per_si if there else 0.0, self.found.best.half_width[k] * per_si)

        def column(head: str, half: Array) -> Column:
            def cell(k: int) -> str:
                """In the unit of the quantity, and in per cent where that says more."""
                own, size = f"{half[k] * QUANTITIES[k].per_si:.2g}", abs(self.found.best.values[k])
                relative = QUANTITIES[k].key.partition("_")[0] in ("mass", "moi") and size > 0
                return f"{own} ({100 * half[k] / size:.2g} %)" if relative else own

            return Column(head, cell)

        columns = [
            Column("expected ± 95 %", lambda k: f"{QUANTITIES[k].label} [{QUANTITIES[k].unit}]"),
            Column("value", value),
            column("plain", self.found.plain.half_width),
            column("self-calibrated", self.found.best.half_width),
        ]
        columns += [] if self.found.untared is None else [column("and without tare", self.found.untared)]
        return Table(rows=range(10), columns=columns)

    def dominated_by(self) -> Table:
        """What dominates the uncertainty of every value, by both ways."""
        said = [
            [
                ", ".join(f"{what} {100 * share:.0f} %" for what, share in one.dominating(k)[:SHOWN_INPUTS]) or NONE
                for one in (self.found.plain, self.found.best)
            ]
            for k in range(10)
        ]
        width = max(len(plain) for plain, _ in said)
        return Table(
            rows=range(10),
            columns=(
                Column("dominated by", lambda k: QUANTITIES[k].label),
                Column(f"{'plain':<{width}}", lambda k: f"{said[k][0]:<{width}}", aligned=False),
                Column("self-calibrated", lambda k: said[k][1], words=True),
            ),
        )

    def losses(self) -> Table:
        """By how much intervals grow when a channel is lost, and what the plain way loses."""
        best = np.where(self.found.best.half_width > 0, self.found.best.half_width, 1.0)
        rows = [
            (name, *(f"{(half / best)[kind].max():.2f}" for kind in KINDS.values()), self.found.lost[name] or NONE)
            for name, half in self.found.without.items()
        ]
        heads = ("without", *(f"{what} ×" for what in KINDS), "the plain way has then")
        columns = [Column(head, itemgetter(k), words=k > len(KINDS), aligned=False) for k, head in enumerate(heads)]
        return Table(rows=rows, columns=columns)

    def places(self) -> Table:
        """Rigid and elastic places."""

        def up_to(one: Rigidity) -> str:
            return "the whole band" if one.within == 1 else "nowhere" if one.up_to is None else f"{one.up_to:.2f} Hz"

        def share(value: float) -> str:
            if 0 < value < NOTHING:
                return f"< {100 * NOTHING:g} %"
            return "resonance" if value > HUGE else f"{100 * value:.2g} %"

        return Table(
            rows=self.found.places,
            columns=(
                Column("pick-up at", lambda one: one.name),
                Column("m above F", lambda one: one.position[2], ".3f"),
                Column(f"at {float(self.found.spectra.frequency[0]):g} Hz", lambda one: share(one.at_start)),
                Column("at most", lambda one: share(one.largest)),
                Column(f"below {100 * self.found.question.rigid:g} % up to", up_to, aligned=False),
                Column(
                    "largest in", lambda one: NONE if one.largest == 0 else f"{one.axis} at {one.frequency:.2f} Hz", words=True
                ),
            ),
        )

    def notes(self) -> Iterator[str]:
        """What must be known to read the tables."""
        found, question, condition = self.found, self.found.question, self.found.condition
        worst = int(np.argmax(condition))
        yield (
            f"Condition number of the base motions: median {np.median(condition):.3g}, at most {condition[worst]:.3g} at "
            f"{found.spectra.frequency[worst]:g} Hz; {int(np.sum(found.left_out))} of {len(condition)} lines above the limit "
            f"of {question.condition_limit:g}."
        )
        fmd = "" if question.above else " The FMD alone: its moving part is what is asked for."
        tared = f"tare {question.tare.article}" if question.tare else "no tare, the FMD known within its tolerance"
        yield f"Expected from the model and the planned chain, {tared}; CoG from the article's own origin.{fmd}"
        yield "Linearised at the drawn article with exact channels: what the model does not hold is in no interval."
        if self.found.places:
            limit = f"below {100 * self.found.question.rigid:g} %"
            if self.found.rigid_height is None:
                height = f"All of the article's axis stays {limit}."
            else:
                height = f"Its axis stays {limit} up to {self.found.rigid_height:.3f} m above F."
            yield (
                "Elastic motion: of a place relative to the base, over what a rigid article would do there; the largest of six "
                f"axes. {height} The cover plate counts as rigid."
            )
        yield from (f"warning: {words}." for words in self.found.warnings)

    def draw(self, folder: Path) -> tuple[Path, ...]:
        """Write every picture of `found` into `folder`, and say where they are.

        Raises
        ------
        CheckFailed : nothing can be rendered on this machine.
        """
        stem = file_name(f"pretest-{self.found.question.plan.article}")
        paths = [folder / f"{stem}.png", folder / f"{stem}-shares.png"]
        cases = {"plain": self.found.plain.half_width, "self-calibrated": self.found.best.half_width}
        cases |= {} if self.found.untared is None else {"self-calibrated, no tare": self.found.untared}
        best = self.found.best.half_width
        drawn = DrawnPretest(
            frequency=self.found.spectra.frequency,
            condition=self.found.condition,
            limit=self.found.question.condition_limit,
            quantities=tuple(f"{one.label} [{one.unit}]" for one in QUANTITIES[:7]),
            intervals={name: half[:7] * np.array([one.per_si for one in QUANTITIES[:7]]) for name, half in cases.items()},
            growth={name: (half / np.where(best > 0, best, 1.0))[:7] for name, half in self.found.without.items()},
        )
        draw_pretest(self.title, drawn, paths[0], NOTE)
        shares = uncertainty_shares((self.found.plain, self.found.best))
        draw_shares(f"{self.title}: where the uncertainty comes from", shares, paths[1], NOTE)
        if self.found.model is not None and self.found.model.drawn is not None:
            paths.append(folder / f"{stem}-places.png")
            note = "Elastic motion, the largest of six axes, over that of a rigid article at the same place."
            heading = f"{self.found.question.above}: where a pick-up moves with the base"
            draw_rigid(heading, self._surfaces(self.found.model), self.found.question.rigid, paths[2], note)
        return tuple(paths)

    def _surfaces(self, model: Flexible) -> dict[str, tuple[MovingBody, ...]]:
        """The surface of the article by caption; the length of a vertex's displacement is its elastic share."""
        lines = coarse_lines(self.found.spectra.frequency, model.modes)
        start: list[MovingBody] = []
        most: list[MovingBody] = []
        for body, edges, moved in moved_bodies(model, model.modes.shapes):
            shares = largest_share(moved, body.vertices + self.found.seat, model.modes, self.found.seat, lines)
            for sheet, size in zip((start, most), shares, strict=True):
                motion = size[:, None] * [1.0, 0.0, 0.0]
                sheet.append(
                    MovingBody(name=body.name, vertices=body.vertices, faces=body.faces, edges=edges, displacement=motion)
                )
        low, high = float(lines[0]), float(lines[-1])
        return {f"at {low:g} Hz": tuple(start), f"at most, {low:g} to {high:g} Hz": tuple(most)}


# The pictures of `massline pretest`: condition and expected intervals, shares of the variance, rigid places.


NOTE = "Expected before any measurement, linearised at the drawn article; see docs/pretest.md."


# `massline pretest` from options to output.


RESULT = "pretest.json"


def answer(question: PretestOptions, *, as_json: bool, plot: bool, out: Path | None) -> None:
    """Find out what is asked, print it, and draw it into `out`, or into ``out/`` where only `plot` is asked for.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : nothing can be rendered on this machine.
    """
    if out is not None:
        require_folder(out, "--out")
    with share_done(f"pretest of {question.plan.article}", quiet=as_json) as told:
        found = findings(question, told)
    page, file = PretestPage(found=found), None if out is None else out / RESULT
    print_answer(lambda: to_json(found), lambda: page.document().text(), as_json=as_json, file=file)
    if plot or out is not None:
        with shown(f"pictures of {question.plan.article}", quiet=as_json):
            paths = page.draw(out or Path("out"))
        wrote(*paths)
