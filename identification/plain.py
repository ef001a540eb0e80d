"""The paper's way, whole: base motion, resultants, dynamic mass (Eqs. 6 to 11), ten parameters, tare taken off.

Its interval is honest, too: noise *and* every tolerance of the measurement chain are propagated through the same estimator.
"""

from __future__ import annotations

from collections.abc import Callable

from identification.evidence import Evidence, Settings
from identification.identified import Identified

_DEFAULT = Settings()


def plain(evidence: Evidence, settings: Settings = _DEFAULT, *, progress: Callable[[float], None] | None = None) -> Identified:
    """The article's ten parameters about F by Eqs. 6 to 11 and the modal terms of Eq. 8b, minus the FMD of the tares.

    Raises
    ------
    BadInput : as `identification.self_calibration.calibrated`.
    """
    raise NotImplementedError  # pragma: no cover
