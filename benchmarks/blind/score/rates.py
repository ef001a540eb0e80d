"""`Rate`: so many of so many, with the exact interval of Clopper and Pearson (Biometrika 26 (1934), 404)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

SURE = 0.95
"""Probability that an interval holds the true share."""


@dataclass(frozen=True, kw_only=True)
class Rate:
    """`hits` of `count`."""

    hits: int
    count: int

    @property
    def share(self) -> float:
        """0 to 1; NaN of nothing."""
        return self.hits / self.count if self.count else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """In which the true share lies, `SURE` at least; all of 0 to 1 where nothing was counted."""
        from scipy.stats import beta

        tail, k, n = (1 - SURE) / 2, self.hits, self.count
        low = float(beta.ppf(tail, k, n - k + 1)) if k else 0.0
        high = float(beta.ppf(1 - tail, k + 1, n - k)) if k < n else 1.0
        return low, high

    def __str__(self) -> str:
        if not self.count:
            return "none yet"
        low, high = self.interval
        return f"{self.hits} of {self.count}, {100 * self.share:.1f} % ({100 * low:.1f} to {100 * high:.1f})"


def rate(hits: Iterable[bool]) -> Rate:
    """How many of `hits` are true."""
    found = list(hits)
    return Rate(hits=sum(found), count=len(found))
