"""What a chart shows, said once: `static` draws it with matplotlib into a file, `interactive` with plotly on a page.

A specification holds data, words and roles. Sizes, fonts and the colour of a role are the renderers' own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array

INK, FAINT, PAPER = "#1d2330", "#6b7280", "#ffffff"
"""Of letters, of what stands back, and of the page."""

MEASURED, PREDICTED, FURTHER, ASIDE, LEFT_OUT = "measured", "predicted", "further", "aside", "left out"
QUOTIENT = "quotient of the driven axis"
BEFORE, AFTER = "before", "with what was found"
NOT_JUDGED = ""
STANDINGS = ACCEPTED, ALIKE, LESS, TOO_MUCH_LEFT = "accepted", "cannot be told from it", "adds too little", "leaves too much"
"""Where a cause stands."""

COLOURS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        MEASURED: ("#f28a1c", "#d9661f"),
        PREDICTED: ("#2456c4", "#3b7ddd"),
        FURTHER: ("#1f8a4c", "#1f9d61"),
        ASIDE: ("#9aa0a6", "#8791a1"),
        LEFT_OUT: ("#c3c8d0", "#8791a1"),
        QUOTIENT: ("#b9a5dd", "#9a6fd0"),
        "held out": ("#d9541e", "#d9661f"),
        "prior penalty": ("#8e6fc0", "#9a6fd0"),
        "limit": ("#c8283c", "#c2334d"),
        NOT_JUDGED: ("#7c8798", "#8791a1"),
        "good": ("#2456c4", "#3b7ddd"),
        "doubtful": ("#f39b2c", "#e0952b"),
        "failed": ("#b8415f", "#c2476b"),
        BEFORE: ("#b4bcc8", "#8791a1"),
        AFTER: ("#2456c4", "#3b7ddd"),
        ACCEPTED: ("#2456c4", "#3b7ddd"),
        ALIKE: ("#f39b2c", "#e0952b"),
        LESS: ("#b4bcc8", "#97a1b0"),
        TOO_MUCH_LEFT: ("#b8415f", "#c2476b"),
    }
)
"""Of a role: in print, and in a middle tone that is read on a light and on a dark page.

Blue against orange and red-purple are told apart by everybody, and the standings differ in lightness, too.
"""

VERDICTS = (NOT_JUDGED, "good", "doubtful", "failed")

CURVES = ("#2456c4", "#d9541e", "#1f8a4c", "#8e6fc0", "#c9a227")
"""In print, of curves or bars that have no role, first to fifth."""

LINEAR, LOG, EVIDENCE = "linear", "log", "evidence"
"""Scales of an axis; that of evidence is linear to `LINEAR_NATS` and logarithmic beyond."""

LINEAR_NATS = 10.0

BOUNDS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0)
"""Sigmas at which the colour of a map changes."""

CHANCE = 4.0
"""Sigmas that chance does not reach: up to it the colour stays pale."""

PALE = {False: ("#ffffff", "#f3f5f8", "#e3e9f0", "#ccd8e4"), True: ("#1c222b", "#2a3442", "#3a4757", "#4b5a6d")}
STRONG = {
    False: ("#f7d13d", "#f39b2c", "#dd6a3c", "#b8415f", "#7b2a76", "#3d1559"),
    True: ("#9a50bd", "#c2529a", "#e0616c", "#ef8f45", "#f8ba47", "#fdee90"),
}
"""Below and above `CHANCE`, by whether the page is dark: on paper darker where worse, on a dark page lighter where worse.

There everything above has three times the luminance of the page."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Bars:
    """Lying bars of one kind in a panel.

    Attributes
    ----------
    name : in the legend
    rows : on which each lies
    values, words : how long each is, and what stands behind it
    roles : of `COLOURS`, of each, or one for all
    about : what each is, for a pointer over it
    """

    name: str
    rows: tuple[str, ...]
    values: tuple[float, ...]
    words: tuple[str, ...]
    roles: tuple[str, ...] | str
    about: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class BarPanel:
    """A panel of lying bars, from top to bottom.

    Attributes
    ----------
    label : of the axis, with its unit
    rows : names; a click tells one of them
    limit : where a dashed line stands; None without one
    asked : what each row has to bring; empty where nothing is asked for
    least : how far the axis reaches at least
    """

    label: str
    rows: tuple[str, ...]
    bars: tuple[Bars, ...]
    scale: str = LINEAR
    limit: float | None = None
    asked: tuple[float, ...] = ()
    least: float = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class BarChart:
    """Panels of bars.

    Attributes
    ----------
    title, note : above and below
    legend : roles by their words
    limit : the words of the dashed lines; empty where they have none in the legend
    on_page : what a page says in other words than a file, which has more room
    """

    title: str
    panels: tuple[BarPanel, ...]
    legend: Mapping[str, str]
    limit: str = ""
    note: str = ""
    on_page: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class HeatMap:
    """Rows over frequency, each cell coloured.

    Attributes
    ----------
    title : what it is of
    frequency : (n,) [Hz]; of a table of modes their numbers
    rows : (m,) names, from top to bottom; a click tells one of them
    values : (n, m), sigmas if nothing else is said; NaN where nothing checks a row
    modes : name and eigenfrequency [Hz] of those to be marked
    rules : numbers of rows above which a line separates blocks
    finer : likewise, where a file has room for more
    along : what stands on the axis below
    """

    title: str
    frequency: Array
    rows: tuple[str, ...]
    values: Array
    modes: Sequence[tuple[str, float]] = ()
    rules: tuple[int, ...] = ()
    finer: tuple[int, ...] = ()
    along: str = "frequency [Hz]"

    @property
    def shown_modes(self) -> tuple[tuple[str, float], ...]:
        """Within the band."""
        return tuple(one for one in self.modes if self.frequency[0] <= one[1] <= self.frequency[-1])


def signed_log(nats: Array) -> Array:
    """Where `nats` stand on an axis of evidence: as they are to `LINEAR_NATS`, a decade as long as that beyond."""
    beyond = LINEAR_NATS * (1 + np.log10(np.maximum(np.abs(nats), LINEAR_NATS) / LINEAR_NATS))
    return np.asarray(np.where(np.abs(nats) <= LINEAR_NATS, nats, np.sign(nats) * beyond))


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A complex quantity over frequency.

    Attributes
    ----------
    name : in the legend
    frequency : (n,) [Hz]
    values : (n,)
    role : of `COLOURS`; empty for one that takes its colour in turn
    dots : whether it is drawn line by line, as what was measured is
    expected : (n,) standard deviation of its magnitude, for a band on a page; None for none
    """

    name: str
    frequency: Array
    values: ComplexArray
    role: str = ""
    dots: bool = False
    expected: Array | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class EntryPanel:
    """One entry of a matrix over frequency: magnitude above phase.

    Attributes
    ----------
    unit : of the magnitude
    curves : none of an entry that is nothing
    rigid : magnitude of the rigid body; None where it is not drawn
    modes : name and eigenfrequency [Hz] of those to be marked
    """

    unit: str
    curves: tuple[Curve, ...]
    rigid: float | None = None
    modes: Sequence[tuple[str, float]] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class SpectralLines:
    """The lines of the spectra, and how well their base motions tell the columns of a dynamic mass.

    Attributes
    ----------
    frequency : (n,) [Hz]
    condition : (n,) scaled condition number of the base motions
    limit : above which a line is left out
    left_out : (n,) bool
    runs : names
    unexplained : (r, n) share of what the channels read that no rigid base motion and no resultant load explains
    """

    frequency: Array
    condition: Array
    limit: float
    left_out: np.ndarray
    runs: tuple[str, ...] = ()
    unexplained: Array = field(default_factory=lambda: np.zeros((0, 0)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Intervals:
    """Several quantities with their 95 % intervals, each beside its reference.

    Attributes
    ----------
    name : of the body, or of the rung on which it was identified
    values, half_width, reference : (q,) in the unit of each quantity
    deviation, reach : (q,) values less reference, and half-widths, in the unit of their group
    """

    name: str
    values: Array
    half_width: Array
    reference: Array
    deviation: Array
    reach: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class IntervalChart:
    """The same quantities of some bodies: a file shows values, a page their distances from the reference.

    Attributes
    ----------
    quantities : label and unit of each
    groups : what shares a unit on a page, by heading the numbers of quantities
    """

    title: str
    quantities: tuple[tuple[str, str], ...]
    groups: Mapping[str, tuple[int, ...]]
    bodies: tuple[Intervals, ...]
    note: str = ""
