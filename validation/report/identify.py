"""The answer of `massline identify`: its document, its pictures, and what a report says of a campaign by itself."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from geometry import cache
from geometry.dynamic_mass import MOTIONS, ComplexArray, DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Pose
from geometry.inertia import PARAMETERS, judge
from identification import campaign_file, free_body, request
from identification.campaign import Campaign
from identification.elastic.model import dynamic_mass
from identification.quality import NORMAL_95, impossible
from identification.response_functions import ResponseFunctions
from validation.identify import identify
from validation.identify.identify import DrawnBandStudy, IdentificationFindings, Reported, by_kind
from validation.identify.request import IdentifyOptions
from validation.model.setups import FMD, above_fmd, is_stack, stated, takes_fmd_off
from validation.output import NONE, inertia_json, print_answer, print_json, rounded, shown, to_json, wrote
from validation.reference.reference import ArticleOptions, file_name, reference
from validation.reference.statement import QUANTITIES, Statement
from validation.report import document as doc
from validation.report.charts import identification, spec
from validation.report.charts.spec import LEFT_OUT, MEASURED, QUOTIENT
from validation.report.charts.style import DynamicMassCurve, diagonal, full
from validation.report.parts import CampaignPart, Picture, Report, notes, paragraphs, section
from validation.report.reference import drawing_of, drawn, kept, tried

if TYPE_CHECKING:
    from validation.compare.compare import Comparison
    from validation.history.history import Body, HistoryPosition
    from validation.model.model import Model
    from validation.study import Study

# What is said of an identification: both results side by side, what each parameter rests on, elastic terms, what was left out.


ORIGINS = {"article": "the article's own origin", "F": "F, the centre of the force-measuring plane"}

WORTH = 0.1
"""Share of the variance from which a second input is named."""


@dataclass(frozen=True, eq=False, kw_only=True)
class IdentificationPage:
    """What a page says of the identification that was `found`, table by table."""

    found: IdentificationFindings

    def document(self) -> doc.Document:
        """All of it, in the order in which it is read."""
        found, (low, high) = self.found, self.found.result.identified.band
        doubts = doc.Table(
            rows=list(enumerate(found.doubts, start=1)),
            columns=(
                doc.Column("", lambda row: str(row[0])),
                doc.Column("the data contradict themselves: do not trust these figures", lambda row: row[1], words=True),
            ),
        )
        return doc.Document(
            title=f"{found.article}: identified from {len(found.request.campaign.runs)} runs, {low:g} to {high:g} Hz",
            blocks=(doubts, self.values(), self.verdicts(), self.elastic_terms(), self.single_axis()),
            notes=tuple(self.notes()),
        )

    def values(self) -> doc.Table:
        """Mass, CoG, moments and products of both ways with their 95 % intervals, and how far the second lies from the first."""

        def column(one: Reported) -> doc.Column:
            listed = zip(one.values, one.half_width, QUANTITIES, strict=True)
            cells = [doc.plus_minus(float(v) * q.per_si, float(h) * q.per_si) for v, h, q in listed]
            return doc.Column(one.identified.way, cells.__getitem__)

        columns = [
            doc.Column("± 95 %", lambda k: f"{QUANTITIES[k].label} [{QUANTITIES[k].unit}]"),
            *map(column, self.found.results),
        ]
        if len(self.found.results) > 1:
            plain, better = self.found.results[0], self.found.results[-1]
            moved, width = better.values - plain.values, plain.half_width

            def shift(k: int) -> str:
                """In the unit of the quantity, or in per cent where that says more."""
                quantity = QUANTITIES[k]
                if plain.values[k] != 0 and quantity.key.partition("_")[0] in ("mass", "moi"):
                    return f"{100 * moved[k] / abs(plain.values[k]):+.2f} %"
                finest = min(float(width[k]), float(better.half_width[k])) * quantity.per_si
                return f"{rounded(float(moved[k]) * quantity.per_si, finest)} {quantity.unit}"

            columns += [
                doc.Column("moved by", shift),
                doc.Column("half-widths", lambda k: f"{moved[k] / width[k]:+.2f}" if width[k] else NONE),
            ]
        return doc.Table(rows=range(10), columns=columns)

    def verdicts(self) -> doc.Table:
        """What is to be thought of every value, and what its uncertainty comes from."""

        def said(k: int) -> str:
            text = self.found.verdict.get(request.QUANTITIES[k], NONE)
            inputs = self.found.result.dominating(k) if "of the variance" in text else ()
            then = len(inputs) > 1 and inputs[1][1] > WORTH
            return f"{text}; then {inputs[1][0]} {100 * inputs[1][1]:.0f} %" if then else text

        return doc.Table(
            rows=range(10),
            columns=(
                doc.Column("", lambda k: QUANTITIES[k].label),
                doc.Column(f"verdict on the {self.found.result.identified.way} result", said, words=True),
            ),
        )

    def elastic_terms(self) -> doc.Table | None:
        """Frequency, damping, and the axes that each term shows on most, with its effective mass."""
        terms = self.found.result.identified.elastic
        if terms is None:
            return None
        order = np.argsort(terms.frequency)
        frequency = dict(zip(order, doc.aligned(tuple(f"{f:.3f}" for f in terms.frequency[order])), strict=True))

        def shows_on(r: int) -> str:
            mass = terms.participation[r] ** 2
            most = sorted(range(6), key=lambda k: -mass[k] * (1.0 if k < 3 else 4.0))[
                :2
            ]  # rotations as at a lever of half a metre
            return ", ".join(f"{MOTIONS[k]} {mass[k]:.3g} {'kg' if k < 3 else 'kg m²'}" for k in most)

        return doc.Table(
            rows=order.tolist(),
            columns=(
                doc.Column("elastic terms [Hz]", frequency.__getitem__),
                doc.Column("damping [%]", lambda r: 100 * terms.damping_ratio[r], ".3f"),
                doc.Column("effective mass about F", shows_on, words=True),
            ),
        )

    def single_axis(self) -> doc.Table | None:
        """What the quotient of the driven axis alone would have cost."""
        crossed = self.found.crossed
        if crossed is None:
            return None
        shares = {
            "other axes move": crossed.cross_motion,
            "off on the diagonal": crossed.diagonal,
            "off beside it, up to": crossed.column,
        }

        def column(head: str, of: Array) -> doc.Column:
            return doc.Column(head, lambda k: f"{100 * of[k]:.2g} %", aligned=False)

        columns = [doc.Column("Eq. 8a alone", lambda k: MOTIONS[k]), *(column(head, of) for head, of in shares.items())]
        return doc.Table(rows=range(6), columns=columns)

    def notes(self) -> Iterator[str]:
        """What must be known to read the tables, then what was left out, checked and warned of."""
        where = (
            ORIGINS[self.found.origin] if self.found.frame is None else f"your own frame, seen from {ORIGINS[self.found.origin]}"
        )
        yield f"CoG from {where}. Moments and products about the CoG; products are matrix entries, Θxy = -∫xy dm."
        asked, best = self.found.request, self.found.result
        tares = ", ".join(tare.campaign.article for tare in asked.tares)
        facts = dict.fromkeys(fact.source for fact in asked.facts)
        taken = f"tare {tares}" if tares else "the FMD as stated" if asked.fmd is not None else "no tare"
        if tares and not takes_fmd_off(asked):
            taken = f"tare {tares} on other hardware, which takes no FMD off: its moving part is in the result"
        elif not takes_fmd_off(asked):
            taken += ", so the FMD's moving part is in the result"
        method = asked.method if self.found.spectra is None else self.found.spectra.method
        made = "as the files hold them" if method == "spectra" else method
        yield f"Spectra: {made}; {taken}{'; data of ' + ', '.join(facts) if facts else ''}."
        for one in (one.identified for one in self.found.results):
            terms = 0 if one.elastic is None else len(one.elastic.frequency)
            misfit = "" if np.isnan(one.misfit) else f", chi² per degree of freedom {one.misfit:.3g}"
            surprise = f", sum z² of {one.tolerances} tolerances {one.surprise:.3g}" if one.surprise else ""
            stopped = "" if one.converged else "; it did not converge"
            by_spectra = "" if one.raw is None else f"; from raw spectra instead of H the mass is {one.raw[0]:.5g} kg"
            yield f"{one.way[0].upper()}{one.way[1:]}: {terms} elastic terms{misfit}{surprise}{stopped}{by_spectra}."
        if best.quality.bootstrap:  # whether the interval would be another one were lines not taken for independent
            ratios = [best.quality.bootstrap[name] for name in request.QUANTITIES]
            sizes = f"{min(ratios):.2f} to {max(ratios):.2f}"
            yield f"Block bootstrap of the lines: standard deviations {sizes} times those of the intervals."
        if self.found.lines is not None:
            lines, worst = self.found.lines, int(np.argmax(self.found.lines.condition))
            yield (
                f"Lines: {int(np.sum(lines.kept))} of {len(lines.frequency)} used; condition number at most "
                f"{lines.condition[worst]:.3g}, at {lines.frequency[worst]:g} Hz; the limit is {lines.limit:g}."
            )
            yield from (f"left out: {reason}." for reason in lines.reasons)
        yield from (f"check: {one.text}." for one in self.found.checks if not one.holds)
        if sound := [one.name for one in self.found.checks if one.holds]:
            yield f"Closed checks that hold: {', '.join(sound)}."
        # The accelerometers that nothing stands in for, or else the one whose absence moves the base motion most
        alone = [one for one in self.found.losses if one.lost] or sorted(
            self.found.losses, key=lambda one: -float(one.moved.max())
        )[:1]
        yield from (f"Losing a sensor: {one.text}." for one in alone)
        for name, times in best.identified.gained.items():
            k = int(np.argmax(times))
            yield f"Without {name} the interval of {PARAMETERS[k]} would be {times[k]:.3g} times as wide."
        yield from (f"warning: {words}." for words in self.found.warnings)

    def beside_the_drawing(self, reference: Statement | None) -> doc.Table:
        """Every result beside what is drawn."""

        def known(k: int) -> float | None:
            said = None if reference is None else reference.values[k]
            return None if said is None else said.value * QUANTITIES[k].per_si

        heads = ["quantity", "unit", *(["drawn"] if reference is not None else [])]
        rows: list[list[doc.Cell]] = [[q.label, q.unit] for q in QUANTITIES]
        if reference is not None:
            rows = [[*row, doc.number(known(k), ".6g")] for k, row in enumerate(rows)]
        for one in self.found.results:
            way = one.identified.way
            heads += [way, "± 95 %", *([f"{way} less drawn", "in intervals"] if reference is not None else [])]
            for k, row in enumerate(rows):
                value, half = (float(of[k]) * QUANTITIES[k].per_si for of in (one.values, one.half_width))
                there = known(k)
                apart = None if there is None else value - there
                many = None if apart is None or not half else apart / half
                row += [doc.toleranced(value, half), doc.toleranced(half, half)]
                row += [doc.toleranced(apart, half), doc.number(many, "+.2f")] if reference is not None else []
        where = "from the article's own origin" if self.found.origin == "article" else "from F"
        return doc.Table(
            caption=f"{self.found.article}: mass, CoG and inertia, {self.found.result.identified.way} counts, raw records",
            rows=rows,
            columns=[doc.Column(head, itemgetter(at), words=at < 2) for at, head in enumerate(heads)],
            note=f"CoG {where}; moments and products about the CoG, products as matrix entries. In intervals: 1 is its end.",
        )


# The pictures of `massline identify`: what each of them shows, from the findings.


PRODUCT = 1e3
"""Products are shown in g m²: as a share of a product that is almost zero their deviation says nothing."""

FINE = 1401
"""Lines of the fitted curve: narrow resonances stay round."""

SHARP = 0.05
"""Damping ratio above which a term is no resonance that could be pointed at, but bends the curve where the others leave it."""

POINT = "about F; loads of the table on the article"


def uncertainty_shares(results: Sequence[Reported]) -> list[identification.UncertaintyShares]:
    """Where the uncertainty of each of `results` comes from, beside its intervals."""
    return [
        identification.UncertaintyShares(
            way=one.identified.way,
            parameters=tuple(quantity.label for quantity in QUANTITIES),
            intervals=tuple(f"{half * q.per_si:.2g} {q.unit}" for half, q in zip(one.half_width, QUANTITIES, strict=True)),
            shares=one.quality.shares,
        )
        for one in results
    ]


@dataclass(frozen=True, eq=False, kw_only=True)
class IdentificationPictures:
    """All pictures that `found` has the evidence for."""

    found: IdentificationFindings

    @property
    def stack(self) -> str:
        """What was on the load cells: pictures of measurements are about all of it."""
        return self.found.request.campaign.article

    @property
    def alone(self) -> str:
        """What the result is about, where that is not all that was on the load cells."""
        article = self.found.article
        return f"{article} alone, FMD taken off" if article != self.stack else article

    def draw(self, folder: Path) -> tuple[Path, ...]:
        """Write them into `folder`, and say where they are."""
        found, made = self.found, []

        def to(name: str) -> Path:
            made.append(folder / f"{file_name(f'identify-{found.article}-{name}')}.png")
            return made[-1]

        if found.lines is not None:
            lines, spectra = found.lines, found.spectra
            drawn_lines = spec.SpectralLines(
                frequency=lines.frequency,
                condition=lines.condition,
                limit=lines.limit,
                left_out=lines.kept == 0,
                runs=() if spectra is None else spectra.runs,
                unexplained=np.zeros((0, len(lines.frequency))) if spectra is None else 1 - spectra.quality,
            )
            note = "Condition number of the base motions of all runs at a line, every axis divided by its nominal level."
            identification.draw_lines(f"{self.stack}: lines of the spectra", drawn_lines, to("lines"), note)
        if found.dynamic_mass is not None:
            curves = self.curves(found.dynamic_mass)
            # Why dots and line need not lie on each other
            corrected = ", channels uncorrected; line: sensors put right, which moves what is small."
            measured = f"Dots: Eqs. 9 to 11{'.' if found.result.identified.way == 'plain' else corrected}"
            note = f"Blocked, {POINT}. {measured} Dashed: rigid body identified."
            ticks = f"{note} Ticks: elastic terms [Hz]."
            diagonal(f"{self.stack}: dynamic mass", curves, to("dynamic-mass"), ticks)
            full(f"{self.stack}: dynamic mass, rows loads, columns base motions", curves, to("dynamic-mass-6x6"), note)
        if found.residuals is not None:
            note = (
                "What a pick-up reads beyond the motion that all of them agree on, and what redundant load cells contradict each "
                "other by, as a share of the readings of their kind at the line."
            )
            title = f"{self.stack}: what redundant channels disagree by"
            identification.draw_residuals(title, found.residuals, to("residuals"), note)
        if found.study is not None:
            for at, what in enumerate(found.study.maps):
                self._draw_stability(found.study, what, to(f"stability{'-rigid' if at else ''}"))
        if known := [one for one in found.results if one.quality.shares]:
            note = "What every input contributes to the variance of mass, CoG, and moments and products about the CoG."
            title = f"{self.alone}: where the uncertainty comes from"
            identification.draw_shares(title, uncertainty_shares(known), to("shares"), note)
        return tuple(made)

    def curves(self, H: DynamicMass) -> tuple[DynamicMassCurve, ...]:
        """The measured dynamic mass H about F, lines that were left out apart, and what was fitted to it."""
        found, best = self.found, self.found.result.identified
        rigid = best.inertia.mass_matrix if found.rigid is None else found.rigid
        terms, fine = best.elastic, np.linspace(H.frequency[0], H.frequency[-1], FINE)
        if terms is None:
            marked, carried = np.zeros(0), np.zeros((0, 6))
            fitted, count = np.tile(rigid + 0j, (FINE, 1, 1)), 0
        else:
            sharp = np.flatnonzero(terms.damping_ratio < SHARP)
            order = sharp[np.argsort(terms.frequency[sharp])]
            marked, carried = terms.frequency[order], terms.participation[order] ** 2
            fitted, count = dynamic_mass(rigid, terms, fine), len(terms.frequency)

        def curve(name: str, frequency: Array, matrix: ComplexArray, dots: str = "") -> DynamicMassCurve:
            mass = DynamicMass(frequency=frequency, matrix=matrix, reference_point=H.reference_point)
            return DynamicMassCurve(name=name, mass=mass, rigid=rigid, marked=marked, effective_mass=carried, dots=dots)

        kept = np.ones(len(H.frequency), dtype=bool) if found.lines is None else found.lines.kept > 0
        made = []
        if found.crossed is not None:
            made.append(curve("quotient of the driven axis, Eq. 8a", H.frequency, found.crossed.quotient, QUOTIENT))
        made.append(curve("measured, channels as they are", H.frequency[kept], H.matrix[kept], MEASURED))
        made.append(curve(f"{best.way}, {count} elastic terms", fine, fitted))
        if not kept.all():
            made.append(curve("left out", H.frequency[~kept], H.matrix[~kept], LEFT_OUT))
        return tuple(made)

    def _draw_stability(self, study: DrawnBandStudy, what: str, path: Path) -> None:
        counts, *_ = study.maps
        at = np.asarray(np.isfinite(study.maps[what]).any(axis=(0, 2)))  # without the stops of which nothing is known
        maps = [self.band_map(study, what, k) for k in range(len(QUANTITIES))]
        maps = [replace(one, deviation=one.deviation[:, at], half_width=one.half_width[:, at]) for one in maps]
        note = (
            f"Plain fits, Eqs. 9 to 11, with {what} over each band, less the plain fit with {counts} over the chosen band "
            "(square). Cross: apart by more than the 95 % interval of the difference. Grey: too few lines."
        )
        title = f"{self.alone}: stability over the band, plain fits with {what}"
        identification.draw_stability(title, maps, study.start, study.stop[at], study.chosen, path, note)

    def band_map(self, study: DrawnBandStudy, what: str, k: int) -> identification.BandMap:
        """How far quantity `k` of the fits `what` lies from that of the chosen band, over all bands."""
        chosen = self.found.result
        kind = "mm" if 1 <= k <= 3 else "g m²" if k >= 7 else "%"
        scale = {"mm": 1e3, "g m²": PRODUCT, "%": 100 / abs(chosen.values[k])}[kind]
        apart = study.maps[what][..., k] - study.reference[k]
        half = np.full(apart.shape, chosen.half_width[k])
        if what in study.half_widths:
            half = np.hypot(half, study.half_widths[what][..., k])
        # Deviation of the darkest colour at most: what lies beyond is wrong, by how much is no matter
        most = {"mm": 20.0, "g m²": 0.05 * PRODUCT * float(np.abs(chosen.values[4:7]).min()), "%": 5.0}[kind]
        label = QUANTITIES[k].label
        return identification.BandMap(label=label, unit=kind, deviation=scale * apart, half_width=scale * half, most=most)


# `massline identify` from options to output: read, identify, show.


RESULT = "identify.json"
"""The file of a result in its folder."""


def answer(asked: IdentifyOptions, frame: str | None, *, as_json: bool, folder: Path | None, keep: bool) -> None:
    """Identify what is `asked`, print it, and draw it into `folder` (None: nowhere); `keep` writes the JSON there, too.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : no body can have what comes out; raised when everything is printed.
    """
    found = identify.identified(asked, frame, quiet=as_json)
    page, file = IdentificationPage(found=found), folder / RESULT if keep and folder is not None else None
    print_answer(lambda: to_json(found), lambda: page.document().text(), as_json=as_json, file=file)
    if folder is not None:
        with shown(f"pictures of {found.article}", quiet=as_json):
            paths = IdentificationPictures(found=found).draw(folder)
        wrote(*paths)
    if impossible(found.result.quality):
        said = f"no body can have the {found.result.identified.way} result: {judge(found.result.inertia).text}"
        if found.request.modes == 0:
            raise CheckFailed(f"{said}. The article was taken for rigid: allow for elastic terms, --modes auto")
        raise CheckFailed(f"{said}. Look at the checks on the page, and drive the sweeps lower or at a higher level")


# What is known of a campaign by itself: the map of its sensors, and the inertia that is identified from it without any model.


KNOWN = ("cuboid", "disc")
"""Parts that are known well enough to tell the FMD by: a campaign of nothing else is the tare of the others."""


NOT_MOUNTED = (
    "the result is seen from F and the drawing from its own origin, and campaign.toml has no [mounting] that says how the "
    "article stands; state it, and both are compared"
)


def campaign_part(
    one: Campaign, series: Sequence[Campaign], model: "Model", band: tuple[float, float] | None, method: str
) -> CampaignPart:
    """What is known of the campaign `one` of a `series`; its tare is a campaign of the series whose article is known."""
    missing: list[str] = []
    tares = tuple(other.source for other in series if other is not one and is_tare(other) and not is_tare(one))
    asked = IdentifyOptions(campaign=one.source, tares=tares, band=band, spectra=method, study=False)
    typed = ["massline identify", one.source, *(word for tare in tares for word in ("--tare", tare))]
    typed += [] if band is None else ["--band", *(f"{end:g}" for end in band)]
    found: IdentificationFindings | None = None
    try:
        # The records at hand, which may be older than the folder is now, and what is read in it
        folders = (asked.campaign, *asked.tares)
        used = [each.recordings.items() for each in series if each.source in folders]
        runs = [[(name, one.digest, one.source, one.warnings) for name, one in each] for each in used]
        of = cache.content(Path(folder) / campaign_file.NAME for folder in folders), runs
        found = cache.answer(lambda: _without_records(identify.identified(asked, at_hand=series)), "identification", asked, of)
    except (BadInput, CheckFailed) as error:
        missing.append(f"No inertia was identified: {error}")
    return CampaignPart(
        campaign=one,
        sensors=sensor_map(one, missing),
        findings=found,
        reference=None if found is None else drawing_beside(found, model, missing),
        command=" ".join([*typed, "--spectra", method, "--no-study"]),
        missing=tuple(missing),
    )


def _without_records(found: IdentificationFindings) -> IdentificationFindings:
    """`found` as it is kept: its records are a hundred times as large as all that was made of them."""
    asked = found.request
    tares = tuple(replace(one, campaign=replace(one.campaign, recordings={})) for one in asked.tares)
    return replace(found, request=replace(asked, campaign=replace(asked.campaign, recordings={}), tares=tares))


def is_tare(one: Campaign) -> bool:
    """Whether nothing but known parts stand on the FMD."""
    parts = above_fmd(one.article).split("+")
    return bool(parts) and set(parts) <= set(KNOWN)


def sensor_map(one: Campaign, missing: list[str]) -> Picture | None:
    """The map of the sensors of `one`; None, with the reason among what is `missing`, where nothing can be rendered."""
    said = f"Sensors of {Path(one.source).name}, seen from F: accelerometers of table, cover plate and article, and load cells"
    of = one.table, one.article, one.title, one.mounting  # of whatever records, the same picture

    def made() -> Picture:
        from validation.report.scenes.setups import sensor_map as draw_sensors

        return cache.answer(lambda: drawn(lambda folder: draw_sensors(one, folder), ""), "sensors", *of)

    picture = tried(made, missing, "No map of the sensors: ")
    return None if picture is None else replace(picture, said=said)


def drawing_beside(found: IdentificationFindings, model: "Model", missing: list[str]) -> Statement | None:
    """Of what was identified, as it is drawn, in the frame of the result.

    None where no drawing is known, with an FMD that the model knows otherwise, and where nothing says how the article stands.
    """
    on_fmd = found.article.split("+")[0] == FMD
    if on_fmd and model.fmd is not None:
        return None
    source = drawing_of(found.article, model)
    if not source:
        return None
    frame = Pose()  # of the result, seen from the drawing's: that of a stack from the FMD up is F's
    if found.origin == "F" and not on_fmd:
        mount = stated(found.request.campaign)
        if mount is None:
            missing.append(f"Nothing is held against the drawing of {found.article}: {NOT_MOUNTED}")
            return None
        frame = mount.inverse
    changes = model.changes if is_stack(found.article) else {}
    options = ArticleOptions(changes=changes)
    drawn = tried(lambda: kept(lambda: reference(source, None, options, frame)[1], "drawn", source, (options, frame)), [])
    if drawn is None:
        return None
    # An article is what its drawing says within what the laboratory admits: density, bolts and holes that nobody drew
    share = NORMAL_95 * model.mounting.inertia
    values = list(drawn.values)
    for k in (0, *range(4, 7)):
        if (one := values[k]) is not None and share:
            values[k] = replace(one, tolerance=float(np.hypot(one.tolerance or 0.0, share * abs(one.value))))
    return replace(drawn, values=tuple(values))


# Identified inertia with the effects of the model: what its ladder says, or what a fit finds where no rung says it.
#
# Identification from raw records knows no effect: a load cell that reads too much makes an article too heavy there. With the
# effects of the model its fault is taken out.


Progress = Callable[[str, float], None]


def identified(
    study: "Study", comparison: "Comparison", at: "HistoryPosition | None", progress: Progress
) -> "tuple[tuple[Body, ...], str]":
    """Of the rung on which the model stands, where that stands on the same data; else of a fit. None of a model without effects
    that no rung has, and none where there is a reason, which is told.

    Parameters
    ----------
    comparison : of the `study`

    Raises
    ------
    OSError : a file cannot be read.
    """
    from validation.history.add import conditions_of
    from validation.history.verdict import body_of

    rung = None if at is None else at.rung
    if rung is not None and rung.errors is not None:
        same_held = rung.errors.held_out_names == comparison.evaluation.held_out_names
        if same_held and replace(rung.conditions, hold_out=()).same(replace(conditions_of(study), hold_out=())):
            return rung.bodies, ""
    if not study.model.effects:
        return (), ""
    try:
        body = body_of(study, comparison.evaluation.plain_fit, lambda share: progress("identifying", share))
    except (BadInput, CheckFailed) as error:
        return (), str(error)
    return ((body,), "") if body is not None else ((), "no article stood on the FMD")


# Identified inertia with intervals and verdicts beside its reference: with the effects of the model, then from raw records.


RAW = "Identified from the records as they were read: no effect of the model is taken out of them."


def html(report: Report, figures: doc.Figures) -> doc.Safe:
    """The section; empty where nobody identified anything."""
    parts = [_with_effects(one, report, figures) for one in report.identified]
    if report.not_identified:
        parts.append(notes([f"With the effects of the model no inertia was identified: {report.not_identified}"]))
    parts += [_from_records(one, figures) for one in report.campaigns if one.findings is not None or one.missing]
    return section("inertia", "Identified inertia", *parts) if parts else doc.Safe("")


def _quantities() -> list[doc.Column]:
    return [
        doc.Column("quantity", lambda k: QUANTITIES[k].label, words=True),
        doc.Column("unit", lambda k: QUANTITIES[k].unit, words=True),
    ]


def _with_effects(body: "Body", report: Report, figures: doc.Figures) -> doc.Safe:
    from validation.report.charts.history import identified_inertia

    effects = report.comparison.effects
    with_what = "with the effects of the model" if effects else "with the model, which has no effects"
    title = f"{body.article}, {with_what}"
    scale = np.array([quantity.per_si for quantity in QUANTITIES])
    value, half, model = (scale * one for one in (body.values, body.half_width, body.reference))
    table = doc.Table(
        caption=f"{title}: mass, CoG and inertia",
        rows=range(10),
        columns=(
            *_quantities(),
            doc.Column("identified", lambda k: doc.toleranced(value[k], half[k])),
            doc.Column("± 95 %", lambda k: doc.toleranced(half[k], half[k])),
            doc.Column("the model", lambda k: doc.toleranced(model[k], half[k])),
            doc.Column("less the model", lambda k: doc.toleranced(value[k] - model[k], half[k])),
            doc.Column("in intervals", lambda k: doc.number((value[k] - model[k]) / half[k] if half[k] else None, "+.2f")),
        ),
        note="CoG from the article's own origin; moments and products about it, as matrix entries. In intervals: 1 is its end.",
    )
    said = [
        f"Effects of the model: {', '.join(effects)}" if effects else "",
        "From all data that are fitted, ten parameters free beside what the plain fit frees",
        "The model: its own inertia with its effects",
        "" if body.converged else "The fit did not end by itself",
    ]
    figure = identified_inertia({"identified": body}, f"{title}: identified less the model, 95 % intervals")
    return doc.tag("div", doc.tag("h3", title), table.html(), figures.placed(figure), notes(said), class_="part")


def _from_records(one: CampaignPart, figures: doc.Figures) -> doc.Safe:
    from validation.history.history import Body
    from validation.report.charts.history import identified_inertia

    found, reference = one.findings, one.reference
    if found is None:
        return doc.joined(doc.tag("h3", f"From the raw records of {one.campaign.source}"), notes(one.missing))
    figure = None
    if reference is not None and reference.complete:
        known = np.array([0.0 if value is None else value.value for value in reference.values])
        bodies = {
            way.identified.way: Body(
                article=found.article, values=way.values, deviation=way.half_width / NORMAL_95, reference=known
            )
            for way in found.results
        }
        figure = figures.placed(identified_inertia(bodies, f"{found.article}: identified less drawn, 95 % intervals"))
    page, alike = IdentificationPage(found=found), set(found.verdict.values())
    if len(alike) == 1:
        verdicts = paragraphs([f"All ten values: {alike.pop()}."])
    else:
        caption = f"{found.article}: verdicts on the {found.result.identified.way} result"
        thought = doc.Column("what is to be thought of it", lambda k: found.verdict.get(request.QUANTITIES[k], NONE), words=True)
        verdicts = doc.Table(caption=caption, rows=range(10), columns=(_quantities()[0], thought)).html()
    return doc.tag(
        "div",
        doc.tag("h3", f"{found.article}, from the raw records of {one.campaign.source}"),
        paragraphs([RAW]),
        notes(found.doubts),
        page.beside_the_drawing(reference).html(),
        figure,
        verdicts,
        notes([*page.notes(), *one.missing, f"The same by itself: {one.command}" if one.command else ""]),
        class_="part",
    )


# `massline identify TEST.toml`: response functions of a free or softly hung body.

OF_BODY = (
    ("mass", "kg", 1.0),
    *((f"CoG {axis}", "mm", 1e3) for axis in "xyz"),
    *((f"{name} about the CoG", "kg m²", 1.0) for name in PARAMETERS[4:]),
)


def answer_of_test(path: str, band: tuple[float, float] | None, *, as_json: bool) -> None:
    """Print mass, CoG and inertia by response functions.

    Raises
    ------
    BadInput : the test cannot be used for it.
    CheckFailed : no body comes out.
    """
    from validation.study import tests_in

    found_tests = tests_in(Path(path)) or ()
    if len(found_tests) != 1:
        problem = f"it describes {len(found_tests) or 'a campaign and no'} tests, where one is needed"
        raise BadInput(path, "", problem, "Name the file of one test, or the folder of a campaign")
    data = found_tests[0]
    if not isinstance(data, ResponseFunctions):
        problem = "a table of modes says nothing of a mass: its shapes have no scale"
        raise BadInput(path, "kind", problem, "Name response functions, or a campaign")
    data = data if band is None else replace(data, band=band)
    with shown(f"{path}: mass lines and their joint fit", quiet=as_json):
        found = free_body.identify(data)
    joint, plain, sd = found.figures(), found.figures(found.mass_line), found.deviations
    rows = [
        (name, unit, factor * value, factor * NORMAL_95 * spread, factor * other)
        for (name, unit, factor), value, spread, other in zip(OF_BODY, joint, sd, plain, strict=True)
    ]
    if as_json:
        keys = ("quantity", "unit", "value", "half_width_95", "mass_line")
        about = {"test": path, "article": data.article, "band_hz": list(found.band), "mass_line_band_hz": list(found.straight)}
        figures = [dict(zip(keys, row, strict=True)) for row in rows]
        ends = joint[:, None] + NORMAL_95 * sd[:, None] * [-1, 1]
        body = {"origin": "coordinates of the test", "inertia": inertia_json(found.inertia), "interval95": by_kind(ends)}
        fit = {"poles_hz": found.poles, "misfit": found.misfit, "figures": figures, "gains": found.gains}
        print_json(to_json({**about, **body, **fit, "warnings": data.warnings}))
        return
    heads = ("", "unit", "joint fit", "95 %", "mass line alone")
    columns = tuple(doc.Column(head, itemgetter(k), words=k < 2) for k, head in enumerate(heads))
    cells = [(name, unit, f"{value:.5g}", f"±{half:.2g}", f"{other:.5g}") for name, unit, value, half, other in rows]
    notes = [
        f"Joint fit: {found.band[0]:.4g} to {found.band[1]:.4g} Hz, {len(found.poles)} elastic modes taken apart; mass line "
        f"alone: {found.straight[0]:.4g} to {found.straight[1]:.4g} Hz.",
        f"Misfit {found.misfit:.2f} of what noise and tolerances are expected to leave"
        + (": too much, and the intervals are widened by it." if found.misfit > free_body.SOUND else "."),
        "About the origin of the coordinates of the points, products as entries of the matrix.",
        *data.warnings,
    ]
    blocks = (doc.Table(caption="Mass, centre of gravity and inertia", columns=columns, rows=cells),)
    click.echo(doc.Document(title=f"{data.article} by {path}", blocks=blocks, notes=notes).text(), nl=False)
