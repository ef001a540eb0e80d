"""What an identification is told: spectra of the article, tares, an FMD known from before, classical facts, settings.

Every inertia here is about the reference point F of the campaigns, in their axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.inertia import PARAMETERS, Inertia
from geometry.tolerances import Tolerances
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
class Tare:
    """A campaign on an article that is known.

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
class Fact:
    """A classical result: a linear combination of the article's ten parameters about F that was measured some other way.

    Attributes
    ----------
    name : "weighing", "CoG z by crane" ...; results with the same name are reported together
    row : (10,) so that ``row @ parameters = value``, order of Eq. 4
    value, deviation : in the unit of the combination; the deviation is one standard deviation
    """

    name: str
    row: Array
    value: float
    deviation: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "row", frozen(self.row, (10,), "row"))
        if not 0 < self.deviation < np.inf:
            raise ValueError(f"`deviation` must be positive and finite, found {self.deviation}")

    @staticmethod
    def of_parameter(name: str, parameter: str, value: float, deviation: float) -> Fact:
        """A value of one of `PARAMETERS`."""
        return Fact(name=name, row=np.eye(10)[PARAMETERS.index(parameter)], value=value, deviation=deviation)


@dataclass(frozen=True, eq=False, kw_only=True)
class Settings:
    """How an identification is done.

    Attributes
    ----------
    tolerances : of the measurement chain, one standard deviation each
    stiffness : (4, 3) or (3,) [N/m] of the load cells along x, y, z; None where it is not known
    elastic : "auto" finds as many modes as the data shows, "rigid" takes the structure for rigid; a number asks for so many modes
    floor : model-error floor, relative to the level of a channel
    mixed_hardware : whether campaigns of other hardware may be combined, sharing neither chain nor FMD
    """

    tolerances: Tolerances = field(default_factory=Tolerances)
    stiffness: npt.ArrayLike | None = None
    elastic: str | int = "auto"
    floor: float = FLOOR
    mixed_hardware: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Evidence:
    """Everything that one identification may use.

    Attributes
    ----------
    article : spectra of the article on the FMD
    tares : campaigns on known articles, none at all where the result is to include the FMD or `fmd` is given
    fmd : the FMD from before (`identification.tare.fmd`, a model file); None where only the tares tell it
    facts : classical results on the article
    hardware : id of FMD and sensors of the article's campaign
    """

    article: Spectra
    tares: Sequence[Tare] = ()
    fmd: Known | None = None
    facts: Sequence[Fact] = ()
    hardware: str = ""
