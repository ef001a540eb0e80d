"""What an identification is told: spectra of the article, tares, an FMD known from before, classical facts, settings.

Every inertia here is about the reference point F of the campaigns, in their axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from geometry.arrays import Array, frozen
from geometry.inertia import Inertia
from geometry.tolerances import Tolerances
from identification.base_motion import STANDARD_GRAVITY
from identification.request import CONDITION_LIMIT, Fact, Request, Tare
from identification.spectra.line_spectra import Spectra

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
    def nothing() -> Known:
        """No body at all, exactly: what stands on a bare FMD."""
        return Known(inertia=Inertia(parameters=np.zeros(10)), covariance=np.zeros((10, 10)))

    @staticmethod
    def within(inertia: Inertia, relative: float = KNOWN_RELATIVE) -> Known:
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
    fmd : what is known of the FMD from before (`identification.tare.fmd`, a model file); None where only the tares tell it
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


def evidence_of(request: Request, article: Spectra, tares: Sequence[Spectra], fmd: Known | None = None) -> Evidence:
    """The evidence of `request`, whose campaigns have the spectra `article` and, in their order, `tares`.

    A nominal FMD of the request is taken to be known within the tolerance of an FMD; `fmd` goes before it.
    """
    nominal = None if request.fmd is None else Known.within(request.fmd, request.tolerances.fmd_inertia)
    return Evidence(
        article=article,
        tares=tuple(_tare(asked, read) for asked, read in zip(request.tares, tares, strict=True)),
        fmd=fmd or nominal,
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


def _tare(asked: Tare, read: Spectra) -> TareSpectra:
    known = Known.nothing() if asked.known is None else Known.within(asked.known, asked.relative_sd)
    name = asked.campaign.title or asked.campaign.source
    return TareSpectra(spectra=read, known=known, hardware=asked.campaign.hardware, name=name)
