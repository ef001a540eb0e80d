"""What an estimate is worth when tolerances were not fitted but are there: consider covariance.

Parameters i are estimated with the tolerances t at zero, by the normal equations N = J^T W J of data, knowledge beforehand of i
included. To first order the estimate answers to a tolerance by

    G = d x_i / d t = -N_ii^-1 N_it ,        C = N_ii^-1 + G S_t G^T ,    S_t = diag(tolerance²)

so that its covariance C is what noise and knowledge beforehand leave, and what tolerances that nobody fitted add (Schmidt 1966;
Tapley, Schutz and Born, Statistical Orbit Determination, 2004, 6.3). Without any tolerance, C would be N_ii^-1.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from identification.self_calibration.solve import inverse
from validation.engine.cost import cost_of
from validation.engine.evaluation import Fit
from validation.engine.fit import floor_of
from validation.engine.parameter import FITTED
from validation.engine.problem import Problem


def of_fit(problem: Problem, found: Fit, kinds: Sequence[str]) -> tuple[tuple[str, ...], Array]:
    """Names (i,) of the parameters of `kinds` that the fit `found` of `problem` estimated, and their covariance (i, i)."""
    free = problem.free(FITTED)
    cost = cost_of(problem, free, floor_of(kinds))
    at = {one.name: 0.0 for one in free if one.kind not in kinds} | found.by_name
    whole, _, _ = cost.total(cost.at(at))
    estimated = np.array([one.kind in kinds for one in free])
    names = tuple(one.name for one in free if one.kind in kinds)
    return names, covariance(whole.matrix, estimated, np.array([one.tolerance for one in free]))


def covariance(normal: Array, estimated: npt.NDArray[np.bool_], tolerance: Array) -> Array:
    """(i, i) covariance of the parameters that were `estimated`, in their order.

    Parameters
    ----------
    normal : (k, k) normal equations of data and of what is known beforehand of the estimated ones
    estimated : (k,) which of them were; the others stood at zero
    tolerance : (k,) standard deviation of those that were not
    """
    of_noise = inverse(normal[np.ix_(estimated, estimated)])
    answered = of_noise @ normal[np.ix_(estimated, ~estimated)] * tolerance[~estimated]
    return np.asarray(of_noise + answered @ answered.T)
