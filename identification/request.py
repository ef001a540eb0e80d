"""`Request`: what an identification is asked for - the campaign, its tares, further knowledge, and how to go about it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from geometry.errors import BadInput
from geometry.frames import Array, frozen
from geometry.inertia import Inertia, six_from_tensor
from geometry.sensors import Tolerances
from geometry.toml_file import nearest
from identification.base_motion import STANDARD_GRAVITY
from identification.campaign import Campaign
from identification.elastic.model import ElasticTerms
from identification.spectra.line_spectra import Spectra

CONDITION_LIMIT = 100.0
"""Scaled condition number above which a line is left out: so many times larger may errors of spectra reach the dynamic mass."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Tare:
    """A campaign whose article is known, from which the FMD's moving part is learnt.

    Attributes
    ----------
    campaign : on the same hardware
    known : inertia about F of what stands on the FMD; None for an FMD with nothing on it
    relative_sd : standard deviation of the known ten parameters, as a share [1]
    """

    campaign: Campaign
    known: Inertia | None = None
    relative_sd: float = 3e-4


@dataclass(frozen=True, eq=False, kw_only=True)
class Fact:
    """Something that another measurement says about the article: ``coefficients . parameters = value``, or an equation in
    mass, CoG and inertia about the CoG that is made linear where it is used.

    Attributes
    ----------
    quantity : "mass_kg", "cog_x_mm", ..., "moi_xx_cog_kgm2", ... as `identification.request` names them
    value, sd : SI, in the frame of the campaign, the CoG from F
    source : the file it comes from
    """

    quantity: str
    value: float
    sd: float
    source: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Request:
    """What is asked.

    Attributes
    ----------
    campaign : of the article
    tares : none leaves the FMD in the result
    facts : of weighing, CoG and pendulum
    band : (low, high) [Hz]; None for that of the campaign
    method : of spectra, "full-record" or "peak-reference-hold"
    modes : number of elastic modes; None lets the data choose, 0 takes the article for rigid
    condition_limit : scaled condition number above which a line is left out
    tolerances : of the laboratory
    fmd : nominal inertia of the FMD's moving part about F; None when nothing is known
    cell_stiffness : (3,) [N/m] of one load cell along x, y, z; None when it is not known
    any_hardware : whether campaigns of another hardware are combined all the same
    robust : whether the plain fit limits what single lines may say
    study : whether the band study is made
    """

    campaign: Campaign
    tares: tuple[Tare, ...] = ()
    facts: tuple[Fact, ...] = ()
    band: tuple[float, float] | None = None
    method: str = "full-record"
    modes: int | None = None
    condition_limit: float = CONDITION_LIMIT
    tolerances: Tolerances = field(default_factory=Tolerances)
    fmd: Inertia | None = None
    cell_stiffness: Array | None = None
    any_hardware: bool = False
    robust: bool = False
    study: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "tares", tuple(self.tares))
        object.__setattr__(self, "facts", tuple(self.facts))
        if self.cell_stiffness is not None:
            object.__setattr__(self, "cell_stiffness", frozen(self.cell_stiffness, (3,), "cell_stiffness"))


# Weighing, CoG and pendulum as data: what they say about the ten parameters of the article, linearised where the iteration is.
#
# A fact is a value of mass, CoG (from F) or inertia about the CoG, with its standard deviation. All but the mass are nonlinear
# in the parameters of Eq. 4; residual and derivative are evaluated at every step.

QUANTITIES = (
    "mass_kg",
    *("cog_x_mm", "cog_y_mm", "cog_z_mm"),
    *("moi_xx_cog_kgm2", "moi_yy_cog_kgm2", "moi_zz_cog_kgm2"),
    *("poi_xy_cog_kgm2", "poi_xz_cog_kgm2", "poi_yz_cog_kgm2"),
)
"""What a fact can be about, in the order of `quantities`. Values are SI throughout: the names are those of the files."""


def quantities(parameters: Array) -> Array:
    """(10,) mass [kg], CoG from the reference point [m], moments and products about the CoG [kg m²] of ten `parameters`."""
    body = Inertia(parameters=parameters)
    return np.concatenate([[body.mass], body.cog, six_from_tensor(body.tensor_cog)])


def jacobian(parameters: Array) -> Array:
    """(10, 10) derivative of `quantities`, in closed form: I_cog = I_F - (|h|² 1 - h h^T) / m with the first moment h."""
    m, h = float(parameters[0]), np.asarray(parameters[1:4])
    J = np.zeros((10, 10))
    J[0, 0] = 1.0
    J[1:4, 0], J[1:4, 1:4] = -h / m**2, np.eye(3) / m
    J[4:, 4:] = np.eye(6)
    J[4:, 0] = six_from_tensor(h @ h * np.eye(3) - np.outer(h, h)) / m**2
    for k, e in enumerate(np.eye(3)):
        change = 2 * h[k] * np.eye(3) - np.outer(e, h) - np.outer(h, e)
        J[4:, 1 + k] = -six_from_tensor(change) / m
    return J


def require_known(facts: Sequence[Fact]) -> None:
    """Refuse facts about something else.

    Raises
    ------
    BadInput : a quantity that is none of `QUANTITIES`, or a standard deviation that is not above zero.
    """
    for fact in facts:
        if fact.quantity not in QUANTITIES:
            remedy = f"{nearest(fact.quantity, QUANTITIES)}Known are {', '.join(QUANTITIES)}"
            raise BadInput(fact.source or "facts", fact.quantity, "no such quantity", remedy)
        if not 0 < fact.sd < np.inf:
            problem = f"its standard deviation must be positive and finite, found {fact.sd}"
            raise BadInput(fact.source or "facts", fact.quantity, problem, "State its tolerance")


def equations(facts: Sequence[Fact], parameters: Array) -> tuple[Array, Array]:
    """Whitened residuals (p,) of `facts` at ten `parameters`, and their derivatives (p, 10)."""
    at = [QUANTITIES.index(fact.quantity) for fact in facts]
    sd = np.array([fact.sd for fact in facts])
    left = quantities(parameters)[at] - np.array([fact.value for fact in facts])
    return left / sd, jacobian(parameters)[at] / sd[:, None]


def name(fact: Fact) -> str:
    """What a fact is called among the inputs."""
    return f"{fact.quantity} of {fact.source}" if fact.source else fact.quantity


# What an identification is told: spectra of the article, tares, an FMD known from before, classical facts, settings.
#
# Every inertia here is about the reference point F of the campaigns, in their axes.

KNOWN_RELATIVE = 3e-4
"""Standard deviation, relative, of the ten parameters of an article that was drawn, weighed and measured with care."""

FLOOR = 0.0015
"""Standard deviation of what the model itself does not hold, relative to the level of a channel (catalogue of effects)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Known:
    """Ten parameters that are known, and how well.

    Attributes
    ----------
    inertia : about F
    covariance : (10, 10) of the parameters of Eq. 4 about F
    """

    inertia: Inertia
    covariance: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "covariance", frozen(self.covariance, (10, 10), "covariance"))

    @staticmethod
    def nothing() -> "Known":
        """No body at all, exactly: what stands on a bare FMD."""
        return Known(inertia=Inertia(parameters=np.zeros(10)), covariance=np.zeros((10, 10)))

    @staticmethod
    def within(inertia: Inertia, relative: float = KNOWN_RELATIVE) -> "Known":
        """`inertia` about its reference point F, every parameter known to `relative` of its scale, independently.

        The scale of a first moment is the mass times the largest radius of gyration about F; that of a tensor entry the geometric
        mean of the two moments of its axes, so that a product of zero has a tolerance, too.
        """
        return Known(inertia=inertia, covariance=np.diag(np.square(relative * scale(inertia))))


def scale(inertia: Inertia) -> Array:
    """(10,) sizes of the ten parameters of a body about its reference point, none of them zero where the body has mass."""
    m, moments = abs(inertia.mass), np.abs(np.diag(inertia.tensor))
    xx, yy, zz = moments
    reach = np.sqrt(m * moments.max())
    return np.array([m, reach, reach, reach, xx, yy, zz, np.sqrt(xx * yy), np.sqrt(xx * zz), np.sqrt(yy * zz)])


@dataclass(frozen=True, eq=False, kw_only=True)
class TareSpectra:
    """What a campaign on a known article read.

    Attributes
    ----------
    spectra : of the campaign
    known : what stood on the FMD - disc and Cuboid, say; `Known.nothing()` for a bare FMD
    hardware : id of FMD and sensors, empty when it was not stated
    name : for messages
    """

    spectra: Spectra
    known: Known
    hardware: str = ""
    name: str = "tare"


@dataclass(frozen=True, eq=False, kw_only=True)
class Evidence:
    """Everything that one identification may use.

    Attributes
    ----------
    article : spectra of the article on the FMD
    tares : campaigns on known articles, none at all where the result is to include the FMD or `fmd` is given
    fmd : what is known of the FMD from before (`identification.identify.fmd`, a model file); None where only the tares tell it
    facts : classical results on the article
    hardware : id of FMD and sensors of the article's campaign
    """

    article: Spectra
    tares: tuple[TareSpectra, ...] = ()
    fmd: Known | None = None
    facts: tuple[Fact, ...] = ()
    hardware: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "tares", tuple(self.tares))
        object.__setattr__(self, "facts", tuple(self.facts))


@dataclass(frozen=True, eq=False, kw_only=True)
class Settings:
    """How an identification is done.

    Attributes
    ----------
    tolerances : of the measurement chain, one standard deviation each
    stiffness : (3,) [N/m] of one load cell along x, y, z; None where it is not known
    gravity : [m/s²]
    modes : number of elastic modes; None lets the data choose, 0 takes every structure for rigid
    floor : model-error floor, relative to the level of a channel
    any_hardware : whether campaigns of other hardware are combined all the same, sharing neither chain nor FMD
    condition_limit : scaled condition number above which the plain way leaves a line out
    robust : whether the plain way limits what single entries of H may say
    """

    tolerances: Tolerances = field(default_factory=Tolerances)
    stiffness: Array | None = None
    gravity: float = STANDARD_GRAVITY
    modes: int | None = None
    floor: float = FLOOR
    any_hardware: bool = False
    condition_limit: float = CONDITION_LIMIT
    robust: bool = False


def evidence_of(request: Request, article: Spectra, tares: Sequence[Spectra]) -> Evidence:
    """The evidence of `request`, whose campaigns have the spectra `article` and, in their order, `tares`.

    A nominal FMD of the request is taken to be known within the tolerance of an FMD.
    """
    below = []
    for tare, read in zip(request.tares, tares, strict=True):
        known = Known.nothing() if tare.known is None else Known.within(tare.known, tare.relative_sd)
        name = tare.campaign.title or tare.campaign.source
        below.append(TareSpectra(spectra=read, known=known, hardware=tare.campaign.hardware, name=name))
    return Evidence(
        article=article,
        tares=tuple(below),
        fmd=None if request.fmd is None else Known.within(request.fmd, request.tolerances.fmd_inertia),
        facts=request.facts,
        hardware=request.campaign.hardware,
    )


def settings_of(request: Request) -> Settings:
    """How `request` wants it done."""
    return Settings(
        tolerances=request.tolerances,
        stiffness=request.cell_stiffness,
        gravity=request.campaign.gravity,
        modes=request.modes,
        any_hardware=request.any_hardware,
        condition_limit=request.condition_limit,
        robust=request.robust,
    )


# `Identified`: ten inertia parameters with their covariance, and where their uncertainty comes from.


@dataclass(frozen=True, eq=False, kw_only=True)
class Identified:
    """One result of one way of identification.

    Attributes
    ----------
    way : "plain" (Eqs. 6 to 11, then Eqs. 1 and 4) or "self-calibrated"
    inertia : about the reference point of the campaign, F
    covariance : (10, 10) of the parameters of Eq. 4 about the same point, every tolerance in it
    band : (low, high) [Hz]
    elastic : auxiliary terms; None when the structure was taken for rigid
    shares : by the name of an input (noise, "force-gain", "accelerometer-position", "tare", "elasticity", ...) its share of the
        variance of each of the ten, (10,); they add up to 1
    misfit : chi² for each degree of freedom; nan where noise is not known
    surprise : sum z² of the tolerances that were estimated; 0 for the plain way
    tolerances : how many these are
    converged : whether the iteration ended by itself
    resonance : [Hz] the lowest one in sight of a structure that was taken for rigid all the same; None otherwise
    parts : by input its part (10, 10) of the covariance; they add up to it
    gained : by the name of a classical result, how many times wider each interval would be without it, (10,)
    resampled : (10, 10) covariance by the block bootstrap, which does not take lines for independent; None where not made
    raw : (10,) about F from the raw spectra instead of H, of the plain way; None otherwise
    warnings : sentences
    """

    way: str
    inertia: Inertia
    covariance: Array
    band: tuple[float, float]
    elastic: ElasticTerms | None = None
    shares: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    misfit: float = float("nan")
    surprise: float = 0.0
    tolerances: int = 0
    converged: bool = True
    resonance: float | None = None
    parts: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    gained: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    resampled: Array | None = None
    raw: Array | None = None
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "covariance", frozen(self.covariance, (10, 10), "covariance"))
        for field_name, shape in {"shares": (10,), "parts": (10, 10), "gained": (10,)}.items():
            given = getattr(self, field_name).items()
            kept = {name: frozen(np.asarray(one), shape, f"{field_name}.{name}") for name, one in given}
            object.__setattr__(self, field_name, MappingProxyType(kept))


def counts(ways: Sequence[Identified]) -> int:
    """Which of the results of one article, the paper's own way first, is the one that counts.

    The last one, unless it did not converge, or blamed the sensors for the elasticity of a structure that was taken for rigid.
    """
    sound = [k for k, one in enumerate(ways) if one.converged and one.resonance is None]
    return max(sound, default=0)


# Which campaigns share FMD and sensors, and so their errors.

WITHOUT_TARE = "no tare and no known FMD: the result includes the moving part of the FMD"


def hardware_groups(evidence: Evidence, settings: Settings) -> tuple[list[int], tuple[str, ...]]:
    """The group of every tare - 0 is the article's own - and what must be said about it.

    A campaign that states no hardware is taken to share the article's, and a warning says so.

    Raises
    ------
    BadInput : a tare of other hardware than the article, without `settings.any_hardware`.
    """
    known, found, warnings = [evidence.hardware], [], []
    for tare in evidence.tares:
        if not tare.hardware or not evidence.hardware:
            if tare.hardware != evidence.hardware:
                warnings.append(
                    f"{tare.name}: hardware is not stated on both sides; FMD and sensors are taken to be the article's"
                )
            found.append(0)
            continue
        if tare.hardware not in known:
            known.append(tare.hardware)
        found.append(known.index(tare.hardware))
        if found[-1]:
            if not settings.any_hardware:
                problem = f"must be that of the article's campaign, {evidence.hardware!r}, found {tare.hardware!r}"
                remedy = "Give a tare of the same hardware, or ask for the combination explicitly"
                raise BadInput(tare.name, "campaign.hardware", f"{problem}: another FMD, other sensors", remedy)
            warnings.append(
                f"{tare.name}: its hardware {tare.hardware!r} is not the article's {evidence.hardware!r}; they share "
                "neither sensor errors nor FMD, and the tare says nothing about the article"
            )
    return found, tuple(warnings)
