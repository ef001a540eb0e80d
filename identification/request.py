"""`Request`: what an identification is asked for - the campaign, its tares, further knowledge, and how to go about it."""

from __future__ import annotations

from dataclasses import dataclass, field

from geometry.arrays import Array, frozen
from geometry.inertia import Inertia
from geometry.tolerances import Tolerances
from identification.campaign import Campaign

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
    quantity : "mass_kg", "cog_x_mm", ..., "moi_xx_cog_kgm2", ... as `identification.classical` names them
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
