"""The public face of the joint estimator."""

from __future__ import annotations

from collections.abc import Callable

from identification.evidence import Evidence, Settings
from identification.identified import Identified

_DEFAULT = Settings()


def calibrated(
    evidence: Evidence, settings: Settings = _DEFAULT, *, progress: Callable[[float], None] | None = None
) -> Identified:
    """The article's ten parameters about F with every tolerance of the measurement chain estimated beside them.

    Without a tare and without a known FMD the result includes the FMD, and a warning says so.

    Parameters
    ----------
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : tare and article of different `hardware` without `settings.mixed_hardware`; a channel table that differs.
    CheckFailed : the iteration does not converge.
    """
    raise NotImplementedError  # pragma: no cover
