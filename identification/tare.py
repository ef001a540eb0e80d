"""The FMD from campaigns on known articles, with its covariance, to be carried into later results."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from identification.evidence import Known, Settings, TareSpectra

_DEFAULT = Settings()


def fmd(
    tares: Sequence[TareSpectra],
    settings: Settings = _DEFAULT,
    *,
    self_calibrated: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Known:
    """The FMD's ten parameters about F from `tares`, self-calibrated or by Eqs. 6 to 11, with their covariance.

    Raises
    ------
    BadInput : no tare, or tares of different hardware.
    """
    raise NotImplementedError  # pragma: no cover
