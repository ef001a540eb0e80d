"""From the options of `massline identify` to a `Request`: every one checked before the first signal is read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import repeat
from math import isfinite
from pathlib import Path

import numpy as np

from geometry.errors import BadInput
from geometry.inertia import Inertia
from geometry.keys import nearest
from geometry.quantities import quantity
from geometry.tolerances import Tolerances
from identification import campaign_file
from identification.campaign import METHODS, Campaign, Processing
from identification.elastic.study import NARROWEST
from identification.request import CONDITION_LIMIT, Request, Tare
from validation.identifying import classical
from validation.identifying.known import above_fmd, known

MOST_MODES = 40
"""More elastic terms than that no band of six sweeps can tell apart."""

FEWEST = 5
"""Lines that a band must hold."""

DIMENSIONS = {"delay": "time", "position": "length", "angle": "angle"}
"""Of a tolerance; every other is a ratio."""

Progress = Callable[[str], Callable[[float], None]]


KNOWN = "0.03 %"
"""Standard deviation of an article that was weighed and measured with care, as a share of its parameters."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The options as typed.

    Attributes
    ----------
    campaign, tares, known, classical : folders, articles, files
    band : [Hz]; None for that of the campaign
    spectra : of `METHODS`
    known_tolerance : standard deviation of the known articles' parameters, a share
    modes : "auto" or a number
    condition_limit, tolerances, cell_stiffness, fmd : see `identification.request.Request`
    """

    campaign: str
    tares: tuple[str, ...] = ()
    known: tuple[str, ...] = ()
    known_tolerance: str = KNOWN
    classical: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    spectra: str = METHODS[0]
    modes: str = "auto"
    condition_limit: float = CONDITION_LIMIT
    tolerances: tuple[str, ...] = ()
    cell_stiffness: tuple[float, float, float] | None = None
    fmd: str | None = None
    any_hardware: bool = False
    robust: bool = False
    study: bool = True


@dataclass(frozen=True, eq=False, kw_only=True)
class Ready:
    """A request and what was assumed on the way to it, sentences without their full stop."""

    request: Request
    warnings: tuple[str, ...] = field(default=())


def ready(asked: Asked, progress: Callable[[str, float], None] | None = None) -> Ready:
    """The request that `asked` comes to, campaigns read.

    `progress` hears which campaign is read and the share of it.

    Raises
    ------
    BadInput : an option, a campaign, a known article or a classical result that cannot be used.
    OSError : a file cannot be read.
    """
    modes, tolerances, stiffness = _modes(asked.modes), tolerances_of(asked.tolerances), _stiffness(asked.cell_stiffness)
    _require_limit(asked.condition_limit)
    share = _share(asked.known_tolerance)
    _require_band(asked.band, study=asked.study)
    names = _known_names(asked)
    described = campaign_file.read_description(asked.campaign)
    below = [campaign_file.read_description(folder) for folder in asked.tares]
    words: list[str] = []
    if not asked.any_hardware:
        _require_same_hardware(described, below)
    for tare, name in zip(below, names, strict=True):
        _require_other(tare, described)
        words += known(name or above_fmd(tare.article) or "fmd", tare, _source(name, tare))[1]
    data, said = classical.facts(asked.classical, described, tared=bool(below) or asked.fmd is not None)
    words += [*said, *_band_within(asked.band, described)]
    campaign = _read(asked.campaign, progress)
    _require_lines(asked.band, campaign)
    tares = [_tare(folder, name, share, progress) for folder, name in zip(asked.tares, names, strict=True)]
    request = Request(
        campaign=campaign,
        tares=tuple(tares),
        facts=data,
        band=asked.band,
        method=asked.spectra,
        modes=modes,
        condition_limit=asked.condition_limit,
        tolerances=tolerances,
        fmd=None if asked.fmd is None else _fmd(asked.fmd),
        cell_stiffness=stiffness,
        any_hardware=asked.any_hardware,
        robust=asked.robust,
        study=asked.study,
    )
    return Ready(request=request, warnings=tuple(words))


def _read(folder: str, progress: Callable[[str, float], None] | None) -> Campaign:
    return campaign_file.read(folder, progress=None if progress is None else lambda share: progress(folder, share))


def _tare(folder: str, name: str, share: float, progress: Callable[[str, float], None] | None) -> Tare:
    campaign = _read(folder, progress)
    inertia, _ = known(name or above_fmd(campaign.article) or "fmd", campaign, _source(name, campaign))
    return Tare(campaign=campaign, known=inertia, relative_sd=share)


def _share(text: str) -> float:
    """The share behind ``--known-tolerance``.

    Raises
    ------
    BadInput : no number, or one that is not between 0 and 1, both left out.
    """
    share = float(quantity(text, "ratio", source="--known-tolerance", field="").nominal_value)
    if not 0 < share < 1:
        problem = f"a share above 0 and below 1 is expected, found {text}"
        raise BadInput(source="--known-tolerance", problem=problem, remedy=f'Write for example "{KNOWN}"')
    return share


def _source(name: str, tare: Campaign) -> str:
    """Who named the known article: the option, or the campaign itself."""
    return "--known" if name else f"{tare.source}/{campaign_file.NAME}: campaign.article"


def _known_names(asked: Asked) -> Sequence[str]:
    """The known article of every tare; empty for the one that the tare's campaign says."""
    if asked.known and not asked.tares:
        problem = f"{asked.known[0]} is known, but there is no tare"
        raise BadInput(source="--known", problem=problem, remedy="Name its campaign, --tare CAMPAIGN")
    if not asked.known:
        return list(repeat("", len(asked.tares)))
    if len(asked.known) != len(asked.tares):
        problem = f"one known article for each of {len(asked.tares)} tares is needed, found {len(asked.known)}"
        raise BadInput(source="--known", problem=problem, remedy="Repeat it in the order of --tare, or leave it out")
    return asked.known


def _modes(text: str) -> int | None:
    if text == "auto":
        return None
    if not text.isdecimal() or int(text) > MOST_MODES:
        problem = f"auto or a whole number from 0 to {MOST_MODES} is expected, found {text!r}"
        raise BadInput(source="--modes", problem=problem, remedy="0 takes the article for rigid; auto lets the data choose")
    return int(text)


def _require_limit(limit: float) -> None:
    if not (isfinite(limit) and limit > 1):
        raise BadInput(
            source="--condition-limit",
            problem=f"a condition number is above 1, found {limit:g}",
            remedy=f"The default is {CONDITION_LIMIT:g}",
        )


def _require_band(band: tuple[float, float] | None, *, study: bool) -> None:
    if band is not None and not (0 < band[0] < band[1] and isfinite(band[1])):
        problem = f"two frequencies, the lower one first and above 0 Hz, are expected, found {band[0]:g} {band[1]:g}"
        raise BadInput(source="--band", problem=problem, remedy="Write for example --band 4 32")
    if band is not None and study and band[1] < NARROWEST * band[0]:
        problem = f"{band[0]:g} to {band[1]:g} Hz is too narrow for the band study, which needs {NARROWEST:g} times its start"
        raise BadInput(source="--band", problem=problem, remedy="Choose a wider band, or leave the study out with --no-study")


def _stiffness(values: tuple[float, float, float] | None) -> np.ndarray | None:
    if values is None:
        return None
    if not all(isfinite(k) and k > 0 for k in values):
        problem = f"three stiffnesses above 0 N/m are expected, found {' '.join(f'{k:g}' for k in values)}"
        raise BadInput(source="--cell-stiffness", problem=problem, remedy="One load cell along x, y and z, in N/m")
    return np.array(values)


def tolerances_of(settings: Sequence[str]) -> Tolerances:
    """The ordinary tolerances with those of `settings`, ``KEY=VALUE``, in their place."""
    known_keys = tuple(Tolerances.__dataclass_fields__)
    changed: dict[str, float] = {}
    for text in settings:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or key not in known_keys:
            raise BadInput(
                source="--tolerance",
                problem=f"KEY=VALUE with a tolerance's name is expected, found {text!r}",
                remedy=f"{nearest(key, known_keys)}Known are {', '.join(known_keys)}",
            )
        dimension = DIMENSIONS.get(key, "ratio")
        changed[key] = float(quantity(value, dimension, source="--tolerance", field=key).nominal_value)
    return Tolerances(**changed)


def _require_other(tare: Campaign, campaign: Campaign) -> None:
    if Path(tare.source).resolve() == Path(campaign.source).resolve():
        raise BadInput(
            source="--tare", problem=f"{tare.source} is the campaign itself", remedy="Name the campaign of the known article"
        )


def _require_same_hardware(campaign: Campaign, tares: Sequence[Campaign]) -> None:
    for tare in tares:
        if tare.hardware and campaign.hardware and tare.hardware != campaign.hardware:
            raise BadInput(
                source=f"{tare.source}/{campaign_file.NAME}",
                field="campaign.hardware",
                problem=f"is {tare.hardware}, that of {campaign.source} is {campaign.hardware}: another FMD, other sensors",
                remedy="Such a tare says nothing about this FMD; --any-hardware combines the two all the same, and says so",
            )


def _band_within(band: tuple[float, float] | None, campaign: Campaign) -> list[str]:
    """Refuse a band that no run drives; say which part of it is not driven."""
    driven = [of for run in campaign.runs if run.excitation is not None and (of := run.excitation.band) is not None]
    if band is None or len(driven) < len(campaign.runs):
        return []
    low, high = max(of[0] for of in driven), min(of[1] for of in driven)
    if band[1] <= low or band[0] >= high:
        problem = f"{band[0]:g} to {band[1]:g} Hz is not driven: all runs of {campaign.source} drive {low:g} to {high:g} Hz"
        raise BadInput(source="--band", problem=problem, remedy="Choose a band within")
    if band[0] < low or band[1] > high:
        return [f"--band {band[0]:g} {band[1]:g}: the runs of {campaign.source} drive {low:g} to {high:g} Hz only"]
    return []


def _require_lines(band: tuple[float, float] | None, campaign: Campaign) -> None:
    """Refuse a band that holds too few lines to tell anything."""
    if band is None or not campaign.recordings:
        return
    there, grid = next(iter(campaign.recordings.values())).frequency, campaign.processing or Processing()
    lines = np.arange(band[0], band[1], grid.step) if there is None else there[(there >= band[0]) & (there <= band[1])]
    if len(lines) < FEWEST:
        raise BadInput(
            source="--band",
            problem=f"{band[0]:g} to {band[1]:g} Hz holds only {len(lines)} of the lines of {campaign.source}",
            remedy=f"Choose a band of {FEWEST} lines or more",
        )


def _fmd(name: str) -> Inertia:
    """The FMD's moving part as a result file states it, in its own frame, which is that of F."""
    from validation.result_file import read

    said = read(name, article="fmd").statement
    try:
        return said.inertia
    except ValueError as error:
        remedy = "State mass, CoG and moments of the FMD"
        raise BadInput(source=name, field="inertia", problem=str(error), remedy=remedy) from None
