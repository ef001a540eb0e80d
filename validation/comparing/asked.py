"""What `massline compare` was asked, checked at the door."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from geometry.errors import BadInput
from identification.campaign import METHODS
from validation.comparing.gathered import Data, gathered
from validation.ladders.own_effects import reminded
from validation.models import reading
from validation.models.model import Model


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The options as typed.

    Attributes
    ----------
    model : path of the model file
    data : campaign folders and measurement files
    hold_out : names of runs, campaigns and files
    band : [Hz]; None for that of the campaigns
    method : of `METHODS`
    """

    model: str
    data: tuple[str, ...]
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    method: str = METHODS[0]


def ready(asked: Asked, progress: Callable[[str, float], None] | None = None) -> tuple[Model, Data]:
    """The model and the data, read.

    Raises
    ------
    BadInput : a band that is none, a model or data that cannot be used, or that do not belong together.
    OSError : a file cannot be read.
    """
    require_band(asked.band)
    with reminded(Path(asked.model)):
        model = reading.read(asked.model)
    return model, gathered(asked.data, model, progress)


def require_band(band: tuple[float, float] | None) -> None:
    """Refuse a band that ends before it begins."""
    if band is not None and not (0 < band[0] < band[1] and isfinite(band[1])):
        problem = f"two frequencies, the lower one first and above 0 Hz, are expected, found {band[0]:g} {band[1]:g}"
        raise BadInput(source="--band", problem=problem, remedy="Write for example --band 4 32")
