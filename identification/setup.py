"""The whole set-up of one campaign - FMD and what stands on it - by the paper's equations: the plain way, the start of fits.

Base motion and resultants (Eqs. 2, 3, 6, 7), dynamic mass (Eqs. 9 to 11), then ten parameters and the modal terms of Eq. 8b.
"""

from __future__ import annotations

from dataclasses import dataclass

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.base_motion import base_motion
from identification.dynamic_mass import Estimate, from_runs
from identification.elastic.fit import Fitted, fit
from identification.elastic.terms import ElasticTerms
from identification.evidence import Settings
from identification.resultants import resultants
from identification.spectra.line_spectra import Spectra

CHAIN_ERROR = 0.02
"""Error of a plain dynamic mass by gains, angles and positions, as a share of its level: a pole must lower more than that."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """What Eqs. 6 to 11 and 8b say of one campaign.

    Attributes
    ----------
    motion, load : (r, n, 6) of the reference point F
    estimate : dynamic mass and condition number
    fitted : ten parameters and elastic terms
    """

    motion: ComplexArray
    load: ComplexArray
    estimate: Estimate
    fitted: Fitted

    @property
    def ten(self) -> Array:
        """(10,) of everything above the force plane, about F."""
        return self.fitted.parameters

    @property
    def terms(self) -> ElasticTerms:
        """Elastic terms; none at all for a rigid set-up."""
        return self.fitted.terms


def setup(spectra: Spectra, settings: Settings) -> Setup:
    """The set-up of `spectra`, rigid or with elastic terms as `settings.modes` asks.

    Raises
    ------
    BadInput : channels or runs that do not tell six motions and six loads.
    """
    motion, load = base_motion(spectra, gravity=settings.gravity).values, resultants(spectra).values
    estimate = from_runs(load, motion, spectra.frequency, spectra.table.origin)
    fitted = fit(estimate.dynamic_mass, modes=settings.modes, floor=CHAIN_ERROR)
    return Setup(motion=motion, load=load, estimate=estimate, fitted=fitted)
