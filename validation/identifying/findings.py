"""`Findings`: all that `massline identify` shows, whichever way it is shown - on paper, as JSON, in pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from geometry.frames import Pose
from identification.closed_checks import Finding
from identification.cross_motion import CrossMotion
from identification.identified import counts
from identification.losing_a_sensor import Loss
from identification.request import Request
from identification.spectra.line_spectra import Spectra
from validation.identifying.reported import Reported
from validation.pictures.identification import DrawnResiduals


@dataclass(frozen=True, eq=False, kw_only=True)
class Lines:
    """The lines of the spectra and what became of them.

    Attributes
    ----------
    frequency : (n,) [Hz]
    condition : (n,) scaled condition number of the base motions [1]
    limit : above which a line is left out
    kept : (n,) 1 for a line that is used, 0 for one that is not
    reasons : why lines were left out, sentences
    """

    frequency: Array
    condition: Array
    limit: float
    kept: Array
    reasons: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Study:
    """The band study: results of Eqs. 9 to 11 over start and stop frequency.

    Attributes
    ----------
    start, stop : (a,), (b,) [Hz]
    maps : by what was fitted ("5 elastic terms", "rigid"), the one that counts first: (a, b, 10) as a statement has them, in the
        frame of the result; NaN where a band is too short
    chosen : (start, stop) [Hz]
    half_widths : by the same names (a, b, 10), of the 95 % intervals of each from noise and model error; empty when not known
    """

    start: Array
    stop: Array
    maps: Mapping[str, Array]
    chosen: tuple[float, float]
    half_widths: Mapping[str, Array] = field(default_factory=dict)

    @property
    def reference(self) -> Array:
        """(10,) of the map that counts in the chosen band."""
        at = (np.argmin(np.abs(self.start - self.chosen[0])), np.argmin(np.abs(self.stop - self.chosen[1])))
        return np.asarray(next(iter(self.maps.values()))[at])


@dataclass(frozen=True, eq=False, kw_only=True)
class Findings:
    """An identification to be shown.

    Attributes
    ----------
    article : what the result is about: the stack, without the FMD when a tare took it off
    origin : "article" or "F", from where the CoG is given; with the user's own frame it is that frame's origin that counts
    frame : the user's own frame, seen from the article's or from F; None without one
    request : what was asked
    results : plain, then self-calibrated when there is one; `identification.identified.counts` says which is the result
    rigid : (6, 6) mass matrix about F of all that the load cells carry, FMD included
    lines, dynamic_mass, crossed, spectra, residuals, study : evidence; None where it does not exist
    checks : findings of the closed checks
    losses : what the base motion would be without each of its accelerometers
    verdict : by PARAMETER about F and by name in `identification.classical.QUANTITIES`, in words
    doubts : what says that the figures are not to be trusted, the gravest first; sentences without their full stop
    warnings : sentences without their full stop
    """

    article: str
    origin: str
    request: Request
    results: tuple[Reported, ...]
    verdict: Mapping[str, str] = field(default_factory=dict)
    frame: Pose | None = None
    rigid: Array | None = None
    lines: Lines | None = None
    dynamic_mass: DynamicMass | None = None
    spectra: Spectra | None = None
    crossed: CrossMotion | None = None
    residuals: DrawnResiduals | None = None
    study: Study | None = None
    checks: tuple[Finding, ...] = ()
    losses: tuple[Loss, ...] = ()
    doubts: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def result(self) -> Reported:
        """The one that counts."""
        return self.results[counts([one.identified for one in self.results])]
