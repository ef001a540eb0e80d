"""The whole set-up of one campaign - FMD and what stands on it - by the paper's equations: the plain result and every fit's start.

Base motion and resultants (Eqs. 2, 3, 6, 7), dynamic mass (Eqs. 9 to 11), then ten parameters: of a rigid body (Eqs. 1 and 4), or with
the modal terms of Eq. 8b.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.inertia import Inertia
from identification.base_motion import base_motion
from identification.dynamic_mass import Estimate, from_runs
from identification.elastic.terms import ElasticTerms
from identification.evidence import Settings
from identification.resultants import resultants
from identification.spectra.line_spectra import Spectra


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """What Eqs. 6 to 11 and 8b say of one campaign.

    Attributes
    ----------
    motion, load : (r, n, 6) of the reference point F
    estimate : dynamic mass and condition number
    ten : (10,) of everything above the force plane, about F
    terms : elastic terms; none at all for a rigid set-up
    """

    motion: ComplexArray
    load: ComplexArray
    estimate: Estimate
    ten: Array
    terms: ElasticTerms


def setup(spectra: Spectra, settings: Settings) -> Setup:
    """The set-up of `spectra`, rigid or with elastic terms as `settings.modes` asks."""
    motion, load = base_motion(spectra).values, resultants(spectra).values
    estimate = from_runs(load, motion, spectra.frequency, spectra.table.origin)
    return Setup(motion=motion, load=load, estimate=estimate, ten=_rigid(estimate), terms=ElasticTerms())


def _rigid(estimate: Estimate) -> Array:
    from identification.self_calibration.structure import ten_matrices

    H = np.median(estimate.dynamic_mass.matrix.real, axis=0)
    scale = np.sqrt(np.abs(np.diag(H)))
    X = (ten_matrices() / np.outer(scale, scale)).reshape(10, 36).T
    return np.asarray(np.linalg.lstsq(X, (H / np.outer(scale, scale)).ravel(), rcond=None)[0])


def inertia_of(ten: Array) -> Inertia:
    """The ten parameters as `Inertia` about F."""
    return Inertia(parameters=ten)
