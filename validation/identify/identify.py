"""`massline identify`: a request answered, and all that is shown of the answer: results, intervals, verdicts, evidence."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from geometry.dynamic_mass import DynamicMass
from geometry.errors import CheckFailed
from geometry.frames import Array, Pose
from geometry.inertia import PARAMETERS, Inertia, judge, six_from_tensor
from identification import base_motion, consistency
from identification.base_motion import Loss
from identification.campaign import Campaign
from identification.consistency import Finding
from identification.dynamic_mass import CrossMotion
from identification.elastic.fit import fit
from identification.elastic.model import dynamic_mass
from identification.elastic.study import LIMIT, NARROWEST, BandStudy, study
from identification.identify import Identification, contradictions, failures, identify, judged
from identification.plain import CHAIN_ERROR
from identification.quality import Quality, half_widths, quality
from identification.request import QUANTITIES, Identified, Request, counts
from identification.spectra.line_spectra import Spectra
from validation.identify.request import IdentifyOptions, PreparedRequest, ready
from validation.model.setups import above_fmd, stated, takes_fmd_off
from validation.output import derived, entry, inertia_json, share_done, stages, unwritten
from validation.reference.statement import Stated, Statement, about_cog, read_frame


def identified(
    asked: IdentifyOptions, frame: str | None = None, *, quiet: bool = True, at_hand: Sequence[Campaign] = ()
) -> "IdentificationFindings":
    """The findings that `asked` leads to, reported in `frame`, the user's own seen from the article's.

    Campaigns `at_hand` are not read again.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : an estimate that does not settle, or without positive mass.
    """
    pose = None if frame is None else read_frame(frame)
    with stages("reading", quiet=quiet) as told:
        made = ready(asked, told, at_hand)
    with share_done(f"identifying {made.request.campaign.article}", quiet=quiet) as share:
        found = identify(made.request, share)
    if not made.request.study:
        return gathered(made, found, pose)
    with share_done("band study", quiet=quiet) as share:
        of = studied(found, share)
    return gathered(made, found, pose, of)


# `Reported`: one way's result as it is printed: mass, CoG and the tensor about the CoG in a frame, with their intervals.


NOTHING = 1e-3
"""A share of the variance below which an input is not worth a word."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Reported:
    """A result and what is to be thought of it.

    Attributes
    ----------
    identified : about F
    quality : in the frame in which it is reported
    """

    identified: Identified = unwritten()
    quality: Quality = unwritten()

    @property
    @derived("")
    def figures(self) -> dict[str, object]:
        """The result by its keys in JSON."""
        found, elastic = self.identified, self.identified.elastic
        return {
            "inertia": inertia_json(self.inertia),
            "interval95": by_kind(self.quality.intervals),
            "about_f": {
                "parameters": _named(found.inertia.parameters),
                "covariance": found.covariance,
                "reference_point_m": found.inertia.reference_point,
            },
            "from_raw_spectra_about_f": None if found.raw is None else _named(found.raw),
            "shares_about_f": {name: _named(share) for name, share in found.shares.items()},
            "shares": {name: dict(zip(QUANTITIES, share, strict=True)) for name, share in self.quality.shares.items()},
            "narrowed_by": {name: _named(times) for name, times in found.gained.items()},
            "bootstrap_sd_about_f": None if found.resampled is None else np.sqrt(np.diag(found.resampled)),
            "bootstrap_over_parametric_sd": dict(self.quality.bootstrap) or None,
            "modes": 0 if elastic is None else len(elastic.frequency),
            "elastic": None
            if elastic is None
            else {
                "frequency_hz": elastic.frequency,
                "damping_ratio": elastic.damping_ratio,
                "damping_rad_s": elastic.damping,
                "participation": elastic.participation,
                "residual": elastic.residual,
            },
            "chi2_per_dof": found.misfit,
            "tolerance_z2": found.surprise,
            "tolerances": found.tolerances,
            "converged": found.converged,
            "warnings": found.warnings,
        }

    @property
    def inertia(self) -> Inertia:
        """In the axes and about the origin of the frame."""
        return self.quality.inertia

    @property
    def values(self) -> Array:
        """(10,) mass [kg], CoG [m] from the frame's origin, moments and products [kg m²] about the CoG."""
        return self.quality.values

    @property
    def half_width(self) -> Array:
        """(10,) distance to the farther end of each 95 % interval."""
        low, high = self.quality.intervals.T
        return np.asarray(np.maximum(high - self.values, self.values - low))

    def statement(self) -> Statement:
        """The result as a column of a reference table."""
        values = tuple(Stated(value=float(v), tolerance=float(t)) for v, t in zip(self.values, self.half_width, strict=True))
        return Statement(name=self.identified.way, values=values, source="massline identify", tolerance_note="95 % intervals")

    def dominating(self, k: int) -> tuple[tuple[str, float], ...]:
        """Inputs by their share of the variance of value `k`, the largest first; none where nothing is known."""
        shares = [(name, float(share[k])) for name, share in self.quality.shares.items()]
        return tuple(sorted((one for one in shares if one[1] > NOTHING), key=lambda one: -one[1]))


def by_kind(values: Array) -> dict[str, Array]:
    """`values` (10, ...) of a statement by their keys in JSON, lengths in millimetres."""
    return {"mass_kg": values[0], "cog_mm": 1e3 * values[1:4], "moi_cog_kgm2": values[4:7], "poi_cog_kgm2": values[7:]}


def _named(parameters: Array) -> dict[str, float]:
    return dict(zip(PARAMETERS, parameters.tolist(), strict=True))


def reported(identified: Identified, frame: Pose) -> Reported:
    """`identified` seen from `frame`, whose pose is seen from F, along the axes of the campaign.

    Raises
    ------
    CheckFailed : the mass is not positive, so that there is no CoG.
    """
    if identified.inertia.mass <= 0:
        raise CheckFailed(
            f"the {identified.way} result has a mass of {identified.inertia.mass:.6g} kg: is the polarity of the load cells "
            "inverted, or more taken off than was mounted? `massline check` shows what the channels read",
            mass=identified.inertia.mass,
        )
    return Reported(identified=identified, quality=quality(identified, frame))


# `Findings`: all that `massline identify` shows, whichever way it is shown - on paper, as JSON, in pictures.


@dataclass(frozen=True, eq=False, kw_only=True)
class UsedLines:
    """The lines of the spectra and what became of them.

    Attributes
    ----------
    frequency : (n,) [Hz]
    condition : (n,) scaled condition number of the base motions [1]
    limit : above which a line is left out
    kept : (n,) 1 for a line that is used, 0 for one that is not
    reasons : why lines were left out, sentences
    """

    frequency: Array = entry("frequency_hz", unit="Hz")
    condition: Array
    limit: float = entry("condition_limit")
    kept: Array = entry("used", write=lambda kept: [bool(one) for one in kept])
    reasons: tuple[str, ...] = entry("left_out", default=())


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnBandStudy:
    """The band study: results of Eqs. 9 to 11 over start and stop frequency.

    Attributes
    ----------
    start, stop : (a,), (b,) [Hz]
    maps : by what was fitted ("5 elastic terms", "rigid"), the one that counts first: (a, b, 10) as a statement has them, in the
        frame of the result; NaN where a band is too short
    chosen : (start, stop) [Hz]
    half_widths : by the same names (a, b, 10), of the 95 % intervals of each from noise and model error; empty when not known
    """

    start: Array = entry("start_hz", unit="Hz")
    stop: Array = entry("stop_hz", unit="Hz")
    maps: Mapping[str, Array] = unwritten()
    chosen: tuple[float, float] = unwritten()
    half_widths: Mapping[str, Array] = unwritten(default_factory=dict)

    @property
    @derived("maps")
    def maps_by_kind(self) -> dict[str, dict[str, Array]]:
        """(a, b) or (a, b, 3) of every kind of quantity, by what was fitted."""
        kinds = {what: by_kind(np.moveaxis(values, -1, 0)) for what, values in self.maps.items()}
        return {
            what: {key: np.moveaxis(of, 0, -1) if of.ndim > 2 else of for key, of in found.items()}
            for what, found in kinds.items()
        }

    @property
    def reference(self) -> Array:
        """(10,) of the map that counts in the chosen band."""
        at = (np.argmin(np.abs(self.start - self.chosen[0])), np.argmin(np.abs(self.stop - self.chosen[1])))
        return np.asarray(next(iter(self.maps.values()))[at])


@dataclass(frozen=True, eq=False, kw_only=True)
class IdentificationFindings:
    """An identification to be shown.

    Attributes
    ----------
    article : what the result is about: the stack, without the FMD when a tare took it off
    origin : "article" or "F", from where the CoG is given; with the user's own frame it is that frame's origin that counts
    frame : the user's own frame, seen from the article's or from F; None without one
    request : what was asked
    results : plain, then self-calibrated when there is one; `identification.request.counts` says which is the result
    rigid : (6, 6) mass matrix about F of all that the load cells carry, FMD included
    lines, dynamic_mass, crossed, spectra, residuals, study : evidence; None where it does not exist
    checks : findings of the closed checks
    losses : what the base motion would be without each of its accelerometers
    verdict : by PARAMETER about F and by name in `identification.request.QUANTITIES`, in words
    doubts : what says that the figures are not to be trusted, the gravest first; sentences without their full stop
    warnings : sentences without their full stop
    """

    article: str
    origin: str
    request: Request = unwritten()
    results: tuple[Reported, ...] = unwritten()
    verdict: Mapping[str, str] = entry(write=lambda told: {name: told.get(name, "") for name in PARAMETERS}, default_factory=dict)
    doubts: tuple[str, ...] = ()
    warnings: tuple[str, ...] = unwritten(default=())
    checks: tuple[Finding, ...] = unwritten(default=())
    losses: tuple[Loss, ...] = unwritten(default=())
    crossed: CrossMotion | None = entry("cross_motion", write=lambda one: () if one is None else one.text, default=None)
    lines: UsedLines | None = None
    study: DrawnBandStudy | None = None
    frame: Pose | None = unwritten(default=None)
    rigid: Array | None = unwritten(default=None)
    dynamic_mass: DynamicMass | None = unwritten(default=None)
    spectra: Spectra | None = unwritten(default=None)
    residuals: "DrawnResiduals | None" = unwritten(default=None)

    @property
    def result(self) -> Reported:
        """The one that counts."""
        return self.results[counts([one.identified for one in self.results])]

    @property
    @derived("", before="verdict")
    def figures(self) -> dict[str, object]:
        """Band, inertia and its intervals of the result that counts."""
        best = self.result
        inertia, interval = inertia_json(best.inertia), by_kind(best.quality.intervals)
        return {"frequency_band_hz": best.identified.band, "inertia": inertia, "interval95": interval}

    @property
    @derived("", before="cross_motion")
    def ways(self) -> dict[str, object]:
        """Warnings, which result counts, each by its way, closed checks, and what the base motion is without a sensor."""
        checks = [
            {
                "name": one.name,
                "holds": one.holds,
                "tolerances": one.value,
                "text": one.text,
                "suspects": [
                    {"effects": [name for mistake in of.mistakes for name in mistake.identifiers], "text": of.text}
                    for of in one.suspects
                ],
            }
            for one in self.checks
        ]
        losses = [
            {
                "channel": one.channel,
                "lost": one.lost,
                "moved": one.moved.max(axis=0),
                "noise_times": None if one.lost else one.amplification,
                "text": one.text,
            }
            for one in self.losses
        ]
        warnings, counts = [*self.doubts, *self.warnings], self.result.identified.way
        ways = {one.identified.way.replace("-", "_"): one for one in self.results}
        return {"warnings": warnings, "result": counts, **ways, "checks": checks, "losing_a_sensor": losses}

    @property
    @derived("frame")
    def stated_frame(self) -> dict[str, object] | None:
        """The user's own frame as a result file states one, so that the result can be read again."""
        if self.frame is None:
            return None
        origin = " ".join(f"{x:.15g}" for x in self.frame.position) + " m"
        return {"origin": origin, "rotation": self.frame.rotation}

    @property
    @derived("settings")
    def settings(self) -> dict[str, object]:
        """What was asked, and by which versions of the libraries it was answered."""
        from importlib.metadata import version

        asked = self.request

        def campaign(of: Campaign) -> dict[str, object]:
            return {"campaign": of.source, "campaign_article": of.article, "hardware": of.hardware}

        def stated_inertia(of: Inertia | None) -> dict[str, object] | None:
            return None if of is None else inertia_json(of)

        return {
            **campaign(asked.campaign),
            "tares": [
                {**campaign(one.campaign), "known": stated_inertia(one.known), "known_relative_sd": one.relative_sd}
                for one in asked.tares
            ],
            "facts": [
                {"quantity": one.quantity, "value_si": one.value, "sd_si": one.sd, "source": one.source} for one in asked.facts
            ],
            "band_hz": asked.band,
            "spectra": asked.method,
            "modes": "auto" if asked.modes is None else asked.modes,
            "condition_limit": asked.condition_limit,
            "any_hardware": asked.any_hardware,
            "robust": asked.robust,
            "study": asked.study,
            "tolerances_si": asdict(asked.tolerances),
            "fmd": stated_inertia(asked.fmd),
            "cell_stiffness_n_m": asked.cell_stiffness,
            "versions": {name: version(name) for name in LIBRARIES},
        }


LIBRARIES = ("massline", "numpy", "scipy", "pin")
"""Whose versions stand in the settings."""


# The band study of an identification: does the result know where its band begins and ends?


RIGID = "no elastic terms"

FITTED = 0.3
"""Share of the work that is done with the fit of the whole band."""


def studied(found: Identification, progress: Callable[[float], None]) -> BandStudy | None:
    """Every band and number of poles, on the lines that are used; with as many poles as were asked for, or as the data want.

    None where the lines that a rigid body was left with are too few to vary the band.
    """
    H = found.estimate.dynamic_mass
    kept = np.asarray(found.exclusions.kept, dtype=bool)
    used = DynamicMass(frequency=H.frequency[kept], matrix=H.matrix[kept], reference_point=H.reference_point)
    if found.request.band is None and used.frequency[-1] < NARROWEST * used.frequency[0]:
        return None
    whole = fit(used, modes=found.request.modes or None, floor=CHAIN_ERROR, progress=lambda share: progress(FITTED * share))
    return study(used, fitted=whole, floor=CHAIN_ERROR, progress=lambda share: progress(FITTED + (1 - FITTED) * share))


def maps(found: Identification, of: BandStudy, frame: Pose) -> DrawnBandStudy:
    """The study as it is drawn: of the article in `frame`, seen from F, the FMD taken off as the plain way did."""
    parameters, rigid = of.map(), found.request.modes == 0
    whole = parameters[0, -1, 0] if rigid else of.fitted.parameters
    fmd = whole - found.plain.inertia.parameters
    drawn = {RIGID: _reported(parameters[:, :, 0] - fmd, frame)}
    spread = of.map("covariance")
    known = {RIGID: _half_widths(parameters[:, :, 0] - fmd, spread[:, :, 0], frame)}
    counts = [] if rigid else sorted(filter(None, of.counts), key=lambda count: abs(count - of.fitted.modes))
    for count in counts[:1]:
        elastic = parameters[:, :, of.counts.index(count)]
        what = f"{count} elastic terms"
        drawn = {what: _reported(elastic - fmd, frame), **drawn}
        known = {what: _half_widths(elastic - fmd, spread[:, :, of.counts.index(count)], frame), **known}
    return DrawnBandStudy(start=of.starts, stop=of.stops, maps=drawn, half_widths=known, chosen=of.fitted.band)


def _reported(parameters: Array, frame: Pose) -> Array:
    """(a, b, 10) as a statement has them; NaN where there is no fit, or none with a positive mass."""
    values = np.full(parameters.shape, np.nan)
    for at in np.argwhere(parameters[..., 0] > 0):
        values[tuple(at)] = about_cog(Inertia(parameters=parameters[tuple(at)]).placed(frame.inverse))
    return values


def _half_widths(parameters: Array, covariance: Array, frame: Pose) -> Array:
    """(a, b, 10) of the 95 % intervals of `_reported`, from noise and model error alone; NaN where there is no result."""
    values = np.full(parameters.shape, np.nan)
    for at in np.argwhere(parameters[..., 0] > 0):
        here = parameters[tuple(at)]
        values[tuple(at)] = half_widths(Inertia(parameters=here), covariance[tuple(at)], frame)
    return values


def verdicts(told: Mapping[str, str], of: BandStudy, *, rigid: bool) -> dict[str, str]:
    """The verdicts `told` of a result; where fits of the plain way over narrower bands lead elsewhere, they say so."""
    shares = of.spread(rigid=rigid) / of.scale
    moved = {name: float(share) for names in (PARAMETERS, QUANTITIES) for name, share in zip(names, shares, strict=True)}
    why = "plain fits over narrower bands and with other numbers of terms move it by"
    return {
        name: f"{said}; {why} {100 * moved[name]:.2g} % of that size" if moved[name] > LIMIT else said
        for name, said in told.items()
    }


# From the driver's `Identification` to `Findings`: results in the frame of the article, evidence as it is drawn.


SMALLEST = np.finfo(np.float64).tiny


def gathered(
    made: PreparedRequest, found: Identification, frame: Pose | None = None, study: BandStudy | None = None
) -> IdentificationFindings:
    """What `found` shows, in the user's own `frame`, seen from the article's.

    Raises
    ------
    CheckFailed : a result without positive mass.
    """
    request = made.request
    off = takes_fmd_off(request)
    mount = stated(request.campaign) if off else None
    pose = (mount or Pose()) @ (frame or Pose())
    both = tuple(one for one in (found.plain, found.self_calibrated) if one is not None)
    best = both[counts(both)]
    results = tuple(reported(one, pose) for one in both if one is best or one.inertia.mass > 0)
    checks_request = found.request
    checked = consistency.checks(
        found.estimate.dynamic_mass, found.article, checks_request.tolerances, gravity=checks_request.campaign.gravity
    )
    chosen = next(one for one in results if one.identified is best)
    said = [*made.warnings, *found.warnings, *(text for one in both for text in one.warnings)]
    # Why the better way is not the result, and what a body cannot quite have
    last, body = both[-1], judge(chosen.inertia)
    if best is not last:
        why = "blames the sensors for what is elastic" if last.converged else "did not converge"
        said.append(f"the {best.way} result is the one that counts: the {last.way} one {why}")
    if not body.physical:
        said.append(f"within their intervals only can a body have these moments: {body.text}")
    against = [*contradictions(checked)]
    for tare, spectra in zip(found.request.tares, found.tares, strict=True):
        of_tare = consistency.of_spectra(spectra, found.request.tolerances, gravity=tare.campaign.gravity)
        against += [f"{text}, in the tare {tare.campaign.article}" for text in contradictions(of_tare)]
    failed, told = failures(best), chosen.quality.verdict
    if study is not None:
        told = verdicts(told, study, rigid=request.modes == 0)
    return IdentificationFindings(
        article=above_fmd(request.campaign.article) if off else request.campaign.article,
        origin="F" if mount is None else "article",
        frame=frame,
        request=request,
        results=results,
        verdict=judged(told, tuple(against), failed),
        doubts=(*against, *failed),
        study=None if study is None else maps(found, study, pose),
        checks=checked,
        losses=base_motion.without_each(found.article, gravity=request.campaign.gravity),
        rigid=rigid(found, best),
        lines=UsedLines(
            frequency=found.estimate.dynamic_mass.frequency,
            condition=found.estimate.condition,
            limit=found.request.condition_limit,
            kept=np.asarray(found.exclusions.kept, dtype=np.float64),
            reasons=found.exclusions.reasons,
        ),
        dynamic_mass=found.estimate.dynamic_mass,
        crossed=found.crossed,
        spectra=found.article,
        residuals=residuals(found),
        warnings=tuple(dict.fromkeys(text.rstrip(".") for text in said)),
    )


def rigid(found: Identification, one: Identified) -> Array:
    """Mass matrix (6, 6) about F of all that the load cells carry, FMD included: what is measured less elastic terms of `one`.

    The median of all lines that are used, brought to the form of Eq. 1.
    """
    H = found.estimate.dynamic_mass
    kept = np.asarray(found.exclusions.kept, dtype=bool)
    elastic = 0.0 if one.elastic is None else dynamic_mass(np.zeros((6, 6)), one.elastic, H.frequency)
    left = np.median((H.matrix - elastic)[kept].real, axis=0)
    mass, S = np.trace(left[:3, :3]) / 3, (left[3:, :3] - left[:3, 3:]) / 2
    first = (S - S.T)[[2, 0, 1], [1, 2, 0]] / 2
    tensor = (left[3:, 3:] + left[3:, 3:].T) / 2
    return Inertia(parameters=np.concatenate([[mass], first, six_from_tensor(tensor)])).mass_matrix


def residuals(found: Identification) -> "DrawnResiduals":
    """What pick-ups and load cells contradict each other by, as a share of the readings of their kind at each line."""
    motion, load, article = found.motion, found.load, found.article
    back = load.parity @ load.combinations
    parts = [(motion.channels, motion.residual), (load.channels, back)]
    shares = []
    for names, values in parts:
        chosen = [article.table.names.index(name) for name in names]
        level = np.sqrt(np.mean(np.abs(article.values[:, :, chosen]) ** 2, axis=2, keepdims=True))  # (r, n, 1) rms of their kind
        shares.append(np.abs(values) / np.maximum(level, SMALLEST))
    return DrawnResiduals(
        frequency=article.frequency,
        runs=article.runs,
        channels=(*motion.channels, *load.channels),
        share=np.concatenate(shares, axis=2),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnResiduals:
    """What redundant channels disagree by.

    Attributes
    ----------
    frequency : (n,) [Hz]
    runs, channels : names
    share : (r, n, c) residual over the level of the channel's kind in that run
    """

    frequency: Array
    runs: tuple[str, ...]
    channels: tuple[str, ...]
    share: Array
