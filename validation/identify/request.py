"""From the options of `massline identify` to a `Request`: every one checked before the first signal is read."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path

import numpy as np

from geometry.errors import BadInput
from geometry.frames import Array, Pose
from geometry.inertia import Inertia
from geometry.sensors import Tolerances
from geometry.toml_file import nearest, quantity
from identification import campaign_file
from identification.campaign import METHODS, Campaign, Processing
from identification.elastic.study import NARROWEST
from identification.quality import NORMAL_95
from identification.request import CONDITION_LIMIT, Fact, Request, Tare
from validation.classical import files, pendulum, weigh
from validation.classical.files import Fields, Reduction, read
from validation.model.setups import above_fmd, known, stated
from validation.study import require_band

# Weighing, CoG and pendulum results as data of an identification, the combined approach of the paper's conclusions.
#
# A result is reduced as `massline weigh`, `cog` and `pendulum` do it and carried into the frame of the campaign. Its tolerance
# is taken for the half-width of a 95 % interval, as everywhere in massline; results of one file count as independent.


REDUCED: dict[str, Callable[[Fields], Reduction]] = {
    "weighing": weigh.reduce,
    "crane-cog": weigh.reduce_cog,
    "pendulum": pendulum.reduce,
    "results": files.reduce,
}
"""What reduces a file of each kind."""

ALONG = 1e-9
"""How far an axis of the article may lie off one of the campaign's and still be it."""


def facts(files: Iterable[str], campaign: Campaign, *, tared: bool) -> tuple[tuple[Fact, ...], tuple[str, ...]]:
    """What the measurement `files` say about the article of `campaign`, in its frame, the CoG from F; and what was assumed.

    `tared` says whether a tare takes the FMD off: what was measured must be what is identified.

    Raises
    ------
    BadInput : a file that cannot be used, is about another article, or says nothing that can be carried into that frame.
    """
    found: list[Fact] = []
    words: list[str] = []
    for name in files:
        file = read(name, tuple(REDUCED))
        reduction = REDUCED[file.text("kind")](file)
        # Refuse a result about another body than the `article` identified; say what is assumed about it
        article = above_fmd(campaign.article) if tared else campaign.article
        about_words = [f"{name}: its tolerances are assumed, and so is its weight in the result"] if reduction.assumed else []
        if not reduction.article:
            about: list[str] = [*about_words, f"{name}: it does not say which article it is about; {article} is taken"]
        elif reduction.article == article:
            about = about_words
        else:
            problem = f"it is about {reduction.article}, what is identified from {campaign.source} is {article}"
            remedy = (
                "A tare takes the FMD off: --tare CAMPAIGN" if article == f"fmd+{reduction.article}" else "Leave the file out"
            )
            raise BadInput(name, "article.name", problem, remedy)
        words += about
        found += [fact for key, value in reduction.results.items() for fact in _facts(key, value, name, campaign)]
    return tuple(found), tuple(words)


def _facts(key: str, value: object, name: str, campaign: Campaign) -> list[Fact]:
    """One result, SI in the frame of the article, as a fact in that of the campaign; none of a quantity that is no inertia."""
    size, sd = float(value.nominal_value), float(value.std_dev) / NORMAL_95  # type: ignore[attr-defined]
    if key == "mass":
        return [Fact(quantity="mass_kg", value=size, sd=sd, source=name)]
    if key.startswith("cog_"):
        pose = stated(campaign)
        if pose is None:
            problem = f"is missing, and {name} states the CoG from the article's own origin"
            remedy = "State where that origin is mounted, [mounting] with origin"
            raise BadInput(f"{campaign.source}/campaign.toml", "mounting", problem, remedy)
        axis, sign = _axis("xyz".index(key[-1]), pose, name, key)
        origin = float(pose.position[axis])
        return [Fact(quantity=f"cog_{'xyz'[axis]}_mm", value=sign * size + origin, sd=sd, source=name)]
    if key.startswith("I"):
        pose = campaign.mounting or Pose()
        pair = [_axis("xyz".index(letter), pose, name, key) for letter in key[1:]]
        letters = "".join(sorted("xyz"[axis] for axis, _ in pair))
        kind = "moi" if letters[0] == letters[1] else "poi"
        return [Fact(quantity=f"{kind}_{letters}_cog_kgm2", value=pair[0][1] * pair[1][1] * size, sd=sd, source=name)]
    return []


def _axis(k: int, pose: Pose, name: str, key: str) -> tuple[int, float]:
    """Along which axis of the campaign, and with which sign, axis `k` of the article lies."""
    along: Array = pose.rotation[:, k]
    axis = int(np.argmax(np.abs(along)))
    if abs(along[axis]) < 1 - ALONG:
        problem = f"axis {'xyz'[k]} of the article lies askew in the campaign, along {np.round(along, 4).tolist()}"
        raise BadInput(name, key, problem, "Use results about the turning axis, or a mounting turned by a multiple of 90 deg")
    return axis, float(np.sign(along[axis]))


MOST_MODES = 40
"""More elastic terms than that no band of six sweeps can tell apart."""

FEWEST = 5
"""Lines that a band must hold."""

DIMENSIONS = {"delay": "time", "position": "length", "angle": "angle"}
"""Of a tolerance; every other is a ratio."""

KNOWN = "0.03 %"
"""Standard deviation of an article that was weighed and measured with care, as a share of its parameters."""


@dataclass(frozen=True, kw_only=True)
class IdentifyOptions:
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

    def checked(self) -> tuple[int | None, Tolerances, float]:
        """Number of modes, None where the data choose; tolerances of the laboratory; share to which known articles are known.

        Raises
        ------
        BadInput : an option that cannot be, whatever the data.
        """
        text = self.modes
        if text == "auto":
            modes: int | None = None
        else:
            if not text.isdecimal() or int(text) > MOST_MODES:
                modes_problem = f"auto or a whole number from 0 to {MOST_MODES} is expected, found {text!r}"
                raise BadInput("--modes", "", modes_problem, "0 takes the article for rigid; auto lets the data choose")
            modes = int(text)
        tolerances = tolerances_of(self.tolerances)
        if self.cell_stiffness is not None and not all(isfinite(k) and k > 0 for k in self.cell_stiffness):
            problem = f"three stiffnesses above 0 N/m are expected, found {' '.join(f'{k:g}' for k in self.cell_stiffness)}"
            raise BadInput("--cell-stiffness", "", problem, "One load cell along x, y and z, in N/m")
        if not (isfinite(self.condition_limit) and self.condition_limit > 1):
            problem = f"a condition number is above 1, found {self.condition_limit:g}"
            raise BadInput("--condition-limit", "", problem, f"The default is {CONDITION_LIMIT:g}")
        share = float(quantity(self.known_tolerance, "ratio", source="--known-tolerance", field="").nominal_value)
        if not 0 < share < 1:
            problem = f"a share above 0 and below 1 is expected, found {self.known_tolerance}"
            raise BadInput("--known-tolerance", "", problem, f'Write for example "{KNOWN}"')
        band = self.band
        require_band(band)
        if band is not None and self.study and band[1] < NARROWEST * band[0]:
            problem = f"{band[0]:g} to {band[1]:g} Hz is too narrow for the band study, which needs {NARROWEST:g} times its start"
            raise BadInput("--band", "", problem, "Choose a wider band, or leave the study out with --no-study")
        return modes, tolerances, share

    def band_within(self, campaign: Campaign) -> list[str]:
        """Refuse a band that no run drives; say which part of it is not driven."""
        band = self.band
        driven = [of for run in campaign.runs if run.excitation is not None and (of := run.excitation.band) is not None]
        if band is None or len(driven) < len(campaign.runs):
            return []
        low, high = max(of[0] for of in driven), min(of[1] for of in driven)
        if band[1] <= low or band[0] >= high:
            problem = f"{band[0]:g} to {band[1]:g} Hz is not driven: all runs of {campaign.source} drive {low:g} to {high:g} Hz"
            raise BadInput("--band", "", problem, "Choose a band within")
        if band[0] < low or band[1] > high:
            return [f"--band {band[0]:g} {band[1]:g}: the runs of {campaign.source} drive {low:g} to {high:g} Hz only"]
        return []

    def fmd_inertia(self) -> Inertia | None:
        """The FMD's moving part as a result file states it, in its own frame, which is that of F."""
        if self.fmd is None:
            return None
        from validation.reference.reference import read_result

        said = read_result(self.fmd, article="fmd").statement
        try:
            return said.inertia
        except ValueError as error:
            raise BadInput(self.fmd, "inertia", str(error), "State mass, CoG and moments of the FMD") from None


@dataclass(frozen=True, eq=False, kw_only=True)
class PreparedRequest:
    """A request and what was assumed on the way to it, sentences without their full stop."""

    request: Request
    warnings: tuple[str, ...] = field(default=())


def ready(
    asked: IdentifyOptions, progress: Callable[[str, float], None] | None = None, at_hand: Sequence[Campaign] = ()
) -> PreparedRequest:
    """The request that `asked` comes to, campaigns read but for those `at_hand`.

    `progress` hears which campaign is read and the share of it.

    Raises
    ------
    BadInput : an option, a campaign, a known article or a classical result that cannot be used.
    OSError : a file cannot be read.
    """
    modes, tolerances, share = asked.checked()
    band = asked.band
    # The known article of every tare; empty for the one that the tare's campaign says
    if asked.known and not asked.tares:
        raise BadInput("--known", "", f"{asked.known[0]} is known, but there is no tare", "Name its campaign, --tare CAMPAIGN")
    if not asked.known:
        names: tuple[str, ...] = ("",) * len(asked.tares)
    else:
        if len(asked.known) != len(asked.tares):
            problem = f"one known article for each of {len(asked.tares)} tares is needed, found {len(asked.known)}"
            raise BadInput("--known", "", problem, "Repeat it in the order of --tare, or leave it out")
        names = asked.known
    described = campaign_file.read_description(asked.campaign)
    below = [campaign_file.read_description(folder) for folder in asked.tares]
    words: list[str] = []
    for tare in () if asked.any_hardware else below:
        if tare.hardware and described.hardware and tare.hardware != described.hardware:
            problem = f"is {tare.hardware}, that of {described.source} is {described.hardware}: another FMD, other sensors"
            remedy = "Such a tare says nothing about this FMD; --any-hardware combines the two all the same, and says so"
            where = f"{tare.source}/{campaign_file.NAME}"
            raise BadInput(where, "campaign.hardware", problem, remedy)
    for tare, name in zip(below, names, strict=True):
        if Path(tare.source).resolve() == Path(described.source).resolve():
            raise BadInput("--tare", "", f"{tare.source} is the campaign itself", "Name the campaign of the known article")
        words += known(name or above_fmd(tare.article) or "fmd", tare, _source(name, tare))[1]
    data, said = facts(asked.classical, described, tared=bool(below) or asked.fmd is not None)
    words += [*said, *asked.band_within(described)]
    there_already = {one.source: one for one in at_hand if one.recordings}
    campaign = there_already.get(asked.campaign) or _read(asked.campaign, progress)
    if band is not None and campaign.recordings:
        there, grid = next(iter(campaign.recordings.values())).frequency, campaign.processing or Processing()
        lines = np.arange(band[0], band[1], grid.step) if there is None else there[(there >= band[0]) & (there <= band[1])]
        if len(lines) < FEWEST:
            problem = f"{band[0]:g} to {band[1]:g} Hz holds only {len(lines)} of the lines of {campaign.source}"
            raise BadInput("--band", "", problem, f"Choose a band of {FEWEST} lines or more")
    tares = []
    for folder, name in zip(asked.tares, names, strict=True):
        tare = there_already.get(folder) or _read(folder, progress)
        inertia, _ = known(name or above_fmd(tare.article) or "fmd", tare, _source(name, tare))
        tares.append(Tare(campaign=tare, known=inertia, relative_sd=share))
    request = Request(
        campaign=campaign,
        tares=tuple(tares),
        facts=data,
        band=band,
        method=asked.spectra,
        modes=modes,
        condition_limit=asked.condition_limit,
        tolerances=tolerances,
        fmd=asked.fmd_inertia(),
        cell_stiffness=None if asked.cell_stiffness is None else np.array(asked.cell_stiffness),
        any_hardware=asked.any_hardware,
        robust=asked.robust,
        study=asked.study,
    )
    return PreparedRequest(request=request, warnings=tuple(words))


def _read(folder: str, progress: Callable[[str, float], None] | None) -> Campaign:
    return campaign_file.read(folder, progress=None if progress is None else lambda share: progress(folder, share))


def _source(name: str, tare: Campaign) -> str:
    """Who named the known article: the option, or the campaign itself."""
    return "--known" if name else f"{tare.source}/{campaign_file.NAME}: campaign.article"


def tolerances_of(settings: Sequence[str]) -> Tolerances:
    """The ordinary tolerances with those of `settings`, ``KEY=VALUE``, in their place."""
    known_keys = tuple(Tolerances.__dataclass_fields__)
    changed: dict[str, float] = {}
    for text in settings:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or key not in known_keys:
            problem = f"KEY=VALUE with a tolerance's name is expected, found {text!r}"
            raise BadInput("--tolerance", "", problem, f"{nearest(key, known_keys)}Known are {', '.join(known_keys)}")
        dimension = DIMENSIONS.get(key, "ratio")
        changed[key] = float(quantity(value, dimension, source="--tolerance", field=key).nominal_value)
    return Tolerances(**changed)
