"""The comparison of the model as it stands: worked out once, kept in the desk, and read again after a reload."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.desk.desk import Desk

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Compared:
    """What `massline compare` finds, as a window keeps it.

    Attributes
    ----------
    summary : the object of `massline compare --json`: "errors" [{"name", "figure", "meaning", "verdict", "text"}], "worst",
        "absurd_tolerances", "classical", "warnings", "plain_error_percent" ...
    maps : one a campaign, with its `pairs` (measured and predicted 6 x 6 dynamic mass)
    modes : by campaign, as the plain fit has them
    offsets : where the plain fit ended, by name of the parameter
    """

    summary: Mapping[str, Any]
    maps: tuple[Map, ...]
    modes: tuple[tuple[NamedMode, ...], ...]
    offsets: Mapping[str, float]

    @property
    def campaigns(self) -> tuple[str, ...]:
        """Names of the data sets, in order."""
        return tuple(one.data_set for one in self.maps)

    def map(self, campaign: str) -> Map:
        """That of `campaign`.

        Raises
        ------
        KeyError : there is none of that name.
        """
        return self.maps[self._place(campaign)]

    def modes_of(self, campaign: str) -> tuple[NamedMode, ...]:
        """Those of the article of `campaign`; none of an FMD alone or of a rigid one."""
        return self.modes[self._place(campaign)]

    def _place(self, campaign: str) -> int:
        if campaign not in self.campaigns:
            raise KeyError(campaign)
        return self.campaigns.index(campaign)


def compared(of: Desk, progress: Progress | None = None) -> Compared:
    """The model of the desk held against its data, and kept; on a rung of the ladder without fitting anything anew.

    Takes from seconds to minutes: `validation.desk.jobs.start(desk, "compare")` does it in a worker.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : a fit that does not converge.
    """
    raise NotImplementedError


def comparison(of: Desk) -> Compared | None:
    """That of the model as it stands, if it was made; quick."""
    raise NotImplementedError
