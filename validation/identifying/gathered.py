"""From the driver's `Identification` to `Findings`: results in the frame of the article, evidence as it is drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from geometry.arrays import Array
from geometry.consistency import judge
from geometry.frames import Pose
from geometry.inertia import Inertia, six_from_tensor
from identification import closed_checks, losing_a_sensor, trust
from identification.closed_checks import Finding
from identification.elastic.model import dynamic_mass
from identification.elastic.study import BandStudy
from identification.identified import Identified, counts
from identification.identify import Identification
from identification.spectra.line_spectra import Spectra
from validation.identifying import band
from validation.identifying.asked import Ready
from validation.identifying.findings import Findings, Lines
from validation.identifying.known import above_fmd, stated, takes_fmd_off
from validation.identifying.reported import Reported, reported
from validation.pictures.identification import DrawnResiduals

SMALLEST = np.finfo(np.float64).tiny


def gathered(made: Ready, found: Identification, frame: Pose | None = None, study: BandStudy | None = None) -> Findings:
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
    checked = _checks(found)
    chosen = next(one for one in results if one.identified is best)
    said = [*made.warnings, *found.warnings, *(text for one in both for text in one.warnings), *_said(chosen, both)]
    against = (*trust.contradictions(checked), *_of_tares(found))
    failed = trust.failures(best)
    return Findings(
        article=above_fmd(request.campaign.article) if off else request.campaign.article,
        origin="F" if mount is None else "article",
        frame=frame,
        request=request,
        results=results,
        verdict=trust.judged(_verdict(chosen, study, rigid=request.modes == 0), against, failed),
        doubts=(*against, *failed),
        study=None if study is None else band.maps(found, study, pose),
        checks=checked,
        losses=losing_a_sensor.without_each(found.article, gravity=request.campaign.gravity),
        rigid=rigid(found, best),
        lines=_lines(found),
        dynamic_mass=found.estimate.dynamic_mass,
        crossed=found.crossed,
        spectra=found.article,
        residuals=residuals(found),
        warnings=tuple(dict.fromkeys(text.rstrip(".") for text in said)),
    )


def _said(chosen: Reported, both: Sequence[Identified]) -> Iterator[str]:
    """Why the better way is not the result, and what a body cannot quite have."""
    last = both[-1]
    if chosen.identified is not last:
        why = "blames the sensors for what is elastic" if last.converged else "did not converge"
        yield f"the {chosen.identified.way} result is the one that counts: the {last.way} one {why}"
    body = judge(chosen.inertia)
    if not body.physical:
        yield f"within their intervals only can a body have these moments: {body.text}"


def _verdict(one: Reported, study: BandStudy | None, *, rigid: bool) -> Mapping[str, str]:
    told = one.quality.verdict
    return told if study is None else band.verdicts(told, study, rigid=rigid)


def _checks(found: Identification) -> tuple[Finding, ...]:
    request = found.request
    return closed_checks.checks(found.estimate.dynamic_mass, found.article, request.tolerances, gravity=request.campaign.gravity)


def _of_tares(found: Identification) -> Iterator[str]:
    """What contradicts itself in the tares, each with the tare's name."""
    request = found.request
    for tare, read in zip(request.tares, found.tares, strict=True):
        checks = closed_checks.of_spectra(read, request.tolerances, gravity=tare.campaign.gravity)
        yield from (f"{text}, in the tare {tare.campaign.article}" for text in trust.contradictions(checks))


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


def residuals(found: Identification) -> DrawnResiduals:
    """What pick-ups and load cells contradict each other by, as a share of the readings of their kind at each line."""
    motion, load, article = found.motion, found.load, found.article
    back = load.parity @ load.combinations
    parts = [(motion.channels, motion.residual), (load.channels, back)]
    shares = [np.abs(values) / _level(article, names) for names, values in parts]
    return DrawnResiduals(
        frequency=article.frequency,
        runs=article.runs,
        channels=(*motion.channels, *load.channels),
        share=np.concatenate(shares, axis=2),
    )


def _level(article: Spectra, names: tuple[str, ...]) -> Array:
    """(r, n, 1) rms of the readings of the channels `names`."""
    chosen = [article.table.names.index(name) for name in names]
    level = np.sqrt(np.mean(np.abs(article.values[:, :, chosen]) ** 2, axis=2, keepdims=True))
    return np.asarray(np.maximum(level, SMALLEST))


def _lines(found: Identification) -> Lines:
    return Lines(
        frequency=found.estimate.dynamic_mass.frequency,
        condition=found.estimate.condition,
        limit=found.request.condition_limit,
        kept=np.asarray(found.exclusions.kept, dtype=np.float64),
        reasons=found.exclusions.reasons,
    )
