"""`Evaluation`: the four errors of a model on data, fitted and held out, and the fits behind them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from geometry.frames import Array
from validation.estimation.problem import Parameter
from validation.output import entry

NO_ERRORS: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Share:
    """An error in per cent of what the judged channels read, and where it comes from.

    Attributes
    ----------
    percent : over all data sets, runs and lines
    by_channel, by_run, by_data_set : the same by name; runs as ``data set/run``
    by_fold : of held-out data, by what was held out together
    """

    percent: float
    by_channel: Mapping[str, float] = field(default_factory=lambda: NO_ERRORS)
    by_run: Mapping[str, float] = field(default_factory=lambda: NO_ERRORS)
    by_data_set: Mapping[str, float] = entry("by_campaign", default_factory=lambda: NO_ERRORS)
    by_fold: Mapping[str, float] = entry("by_what_was_held_out", default_factory=lambda: NO_ERRORS)


@dataclass(frozen=True, eq=False, kw_only=True)
class Fit:
    """Where a fit ended.

    Attributes
    ----------
    parameters : (p,) that were free
    offsets : (p,)
    covariance : (p, p) of the offsets
    cost : half the sum of squares of whitened residuals, knowledge beforehand included
    chi2 : of the data alone
    degrees_of_freedom : real numbers left when inputs and free parameters without knowledge beforehand are taken out
    tolerance_z2 : sum of squares of offset / tolerance over the `TOLERANCES`
    tolerances : how many these are
    log_evidence : Laplace approximation [nats], up to a constant of the data
    converged : whether the iteration ended by itself
    """

    parameters: tuple[Parameter, ...]
    offsets: Array
    covariance: Array
    cost: float
    chi2: float
    degrees_of_freedom: int
    tolerance_z2: float
    tolerances: int
    log_evidence: float
    converged: bool

    @property
    def by_name(self) -> dict[str, float]:
        """Offsets by name."""
        return {one.name: float(x) for one, x in zip(self.parameters, self.offsets, strict=True)}

    @property
    def by_parameter(self) -> dict[str, Any]:
        """Every parameter by its name, as JSON has it."""
        sd = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return {
            one.name: {"value_si": one.value(float(x)), "offset": float(x), "sd": float(s), "kind": one.kind}
            for one, x, s in zip(self.parameters, self.offsets, sd, strict=True)
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class Evaluation:
    """The errors of one model.

    Attributes
    ----------
    nominal : the model as it stands, nothing fitted
    plain : tolerances of the measurement not fitted
    held_out : plain error on runs, blocks of lines and whatever was named that were not fitted; None where nothing was held out
    held_out_nominal : nominal error on the same
    plain_fit, fitted : the fits; surprise is `fitted.tolerance_z2` beside `fitted.tolerances`
    held_out_names : what was held out, in words
    held_out_configurations, held_out_configurations_nominal : the same on each configuration of a series in turn, of which not
        even the modes were fitted; None where nothing but one was tested, or something was named
    """

    nominal: Share
    plain: Share
    held_out: Share | None
    held_out_nominal: Share | None
    plain_fit: Fit
    fitted: Fit
    held_out_names: tuple[str, ...] = field(default=())
    held_out_configurations: Share | None = None
    held_out_configurations_nominal: Share | None = None
