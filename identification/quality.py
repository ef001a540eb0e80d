"""The quality indicator that the paper says is missing: intervals, what dominates them, and a verdict in words.

Mass, CoG and moments about the CoG are a smooth map of the ten parameters of Eq. 4; their covariance follows linearised (GUM,
JCGM 100:2008, 5.2.2), input by input. An interval is judged against the size of the body: the mass for the mass, the radius of
gyration for the CoG, moments of inertia for moments and products.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from geometry.frames import Array, Pose, freeze
from geometry.inertia import PARAMETERS, Inertia, judge
from identification.request import QUANTITIES, Identified, jacobian, quantities, scale

NORMAL_90 = 1.6448536269514722
"""Half the width of a 90 % interval, in standard deviations."""

NORMAL_95 = 1.959963984540054
"""Half the width of a 95 % interval, in standard deviations."""

TRUSTED = 0.05
"""Half a 95 % interval, as a share of the size of the body, up to which a figure is worth having."""

ELASTICITY = "elasticity"

AGREE = 1.5
"""Times the interval up to which the block bootstrap agrees with it."""

WRONG = 10.0
"""Chi² per degree of freedom from which the model does not hold: errors three times as large as anybody would have them."""

TO_ADD: Mapping[str, str] = {
    "noise": "drive at a higher level, or sweep more slowly",
    ELASTICITY: "begin the sweeps lower, go on beyond the next mode, or allow for more modes",
    "tare": "know the tare's article better: weigh it, measure its moments, or add a second known article",
    "force-gain": "weigh the article, or add a tare whose mass is near the article's",
    "force-delay": "calibrate the delays of force and acceleration channels against each other",
    "accelerometer-gain": "calibrate the accelerometers on the cover plate against each other, or add a tare",
    "accelerometer-delay": "calibrate the delays of force and acceleration channels against each other",
    "accelerometer-position": "measure where the pick-ups on the cover plate sit, or set them farther apart",
    "accelerometer-misalignment": "align the pick-ups on the cover plate, or turn one and measure again",
    "cell-stiffness": "record the cells singly instead of in sums, or add a tare with its load off centre",
    "fmd-compliance": "state the stiffness of the load cells, or leave the table's accelerometers out",
    "force-crosstalk": "add a tare with its load off centre",
}
"""What to add where an input dominates."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Quality:
    """A result as one reads it, in the frame that was asked for.

    Attributes
    ----------
    inertia : about the frame's origin, in its axes
    values : (10,) order of `QUANTITIES`: mass [kg], CoG [m], moments xx yy zz and products xy xz yz about the CoG [kg m²]
    covariance : (10, 10) of these
    intervals : (10, 2) low and high end of the 95 % interval of each
    shares : by input its share (10,) of the variance of `values`
    verdict : by PARAMETER about F and by name in `QUANTITIES`, in words
    bootstrap : by the same names, standard deviation of the block bootstrap as a share of that of `covariance`; empty without one
    """

    inertia: Inertia
    values: Array
    covariance: Array
    intervals: Array
    shares: Mapping[str, Array]
    verdict: Mapping[str, str]
    bootstrap: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        freeze(self, values=(10,), covariance=(10, 10), intervals=(10, 2))

    @property
    def mass(self) -> float:
        """[kg]."""
        return float(self.values[0])

    @property
    def cog(self) -> Array:
        """(3,) [m], from the frame's origin."""
        return self.values[1:4]

    @property
    def moments(self) -> Array:
        """(3,) [kg m²] xx, yy, zz about the CoG."""
        return self.values[4:7]

    @property
    def products(self) -> Array:
        """(3,) [kg m²] xy, xz, yz about the CoG, as matrix entries."""
        return self.values[7:]


def quality(identified: Identified, frame: Pose | None = None) -> Quality:
    """Mass, CoG and moments of inertia about the CoG, with their 95 % intervals and verdicts.

    Parameters
    ----------
    frame : pose of the article's own frame, seen from F, to report in; F's own by default
    """
    carried = _carrying(frame or Pose())
    ten = carried @ identified.inertia.parameters
    values = quantities(ten)
    J = jacobian(ten) @ carried
    covariance = J @ identified.covariance @ J.T
    half = NORMAL_95 * np.sqrt(np.maximum(np.diag(covariance), 0.0))
    variance = {name: np.maximum(np.einsum("ij,jk,ik->i", J, part, J), 0.0) for name, part in identified.parts.items()}
    whole = np.maximum(np.sum(list(variance.values()), axis=0), np.finfo(np.float64).tiny) if variance else np.ones(10)
    shares = {name: one / whole for name, one in variance.items()}
    about_f = (identified.shares, NORMAL_95 * np.sqrt(np.diag(identified.covariance)) / scale(identified.inertia))
    reported = (shares, half / sizes(Inertia(parameters=ten)))
    judged = [(PARAMETERS, *about_f), (QUANTITIES, *reported)]
    wider = {**_wider(identified, np.eye(10), PARAMETERS), **_wider(identified, J, QUANTITIES)}
    return Quality(
        inertia=Inertia(parameters=ten),
        values=values,
        covariance=covariance,
        intervals=np.stack([values - half, values + half], axis=1),
        shares=shares,
        verdict={
            name: verdict(float(width[k]), share, k, identified, wider.get(name, 1.0))
            for names, share, width in judged
            for k, name in enumerate(names)
        },
        bootstrap=wider,
    )


def impossible(of: Quality) -> bool:
    """Whether no body within the 95 % intervals can have the result: no positive mass, or one moment beyond the others."""
    body = judge(of.inertia)
    if body.physical or of.mass <= 0:
        return not body.physical
    _, axes = np.linalg.eigh(of.inertia.tensor_cog)
    x, y, z = axes[:, -1]
    slope = np.array([*(1 - 2 * axes[:, -1] ** 2), -4 * x * y, -4 * x * z, -4 * y * z])  # of the smallest margin
    half = NORMAL_95 * np.sqrt(max(float(slope @ of.covariance[4:, 4:] @ slope), 0.0))
    return bool(body.margin[0] + half < 0)


def half_widths(inertia: Inertia, covariance: Array, frame: Pose) -> Array:
    """(10,) half 95 % intervals, in `frame`, of `QUANTITIES` of `inertia` about F with the `covariance` (10, 10) there."""
    carried = _carrying(frame)
    J = jacobian(carried @ inertia.parameters) @ carried
    return np.asarray(NORMAL_95 * np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", J, covariance, J), 0.0)))


def sizes(body: Inertia) -> Array:
    """(10,) against which intervals of `quantities` are judged: mass, radius of gyration, moments and their geometric means."""
    moments = np.abs(body.moments_cog)
    xx, yy, zz = moments
    reach = np.sqrt(moments.max() / abs(body.mass))
    products = np.sqrt([xx * yy, xx * zz, yy * zz])
    return np.array([abs(body.mass), reach, reach, reach, xx, yy, zz, *products])


def verdict(width: float, shares: Mapping[str, Array], k: int, identified: Identified, wider: float = 1.0) -> str:
    """In words what to think of quantity `k`, whose half interval is `width` of the size of the body.

    `wider` is the standard deviation of the block bootstrap as a share of that of the interval.
    """
    if wider > AGREE:
        told = verdict(wider * width, shares, k, identified)
        return f"{told}; that is the block bootstrap, {wider:.2g} times the printed interval: lines do not err independently"
    most = max(shares, key=lambda name: float(shares[name][k])) if shares else ""
    percent = f"±{100 * width:.2g} % of the size of the body"
    from_it = f", mostly from {most} ({100 * shares[most][k]:.0f} % of the variance)" if most else ""
    if identified.resonance is not None:
        advice = "fit elastic terms (--modes auto), or begin the sweeps far below it"
        taken = f"taken for rigid below a resonance at {identified.resonance:.4g} Hz"
        return f"dominated by elasticity: {percent}{from_it}; {taken}: {advice}"
    if most == ELASTICITY and (width > TRUSTED or identified.elastic is None):
        rigid = "no rigid body moves like this: fit elastic terms (--modes auto), or begin the sweeps far below the first mode"
        return f"dominated by elasticity: {percent}{from_it}; {rigid if identified.elastic is None else TO_ADD[ELASTICITY]}"
    if not identified.converged:
        return "not identifiable from this data: the fit did not converge; see the checks below"
    if identified.misfit > WRONG:
        wrong = f"chi² per degree of freedom is {identified.misfit:.3g}, so something is wrong that the model does not hold"
        return f"not identifiable from this data: {wrong}; see the checks below"
    if width > TRUSTED:
        return f"not identifiable from this data: {percent}{from_it}; {TO_ADD.get(most, 'add a classical measurement of it')}"
    return f"trustworthy: {percent}{from_it}"


def _carrying(frame: Pose) -> Array:
    """(10, 10) that takes the ten parameters about F to `frame`: they are linear in each other."""
    return np.stack([Inertia(parameters=row).placed(frame.inverse).parameters for row in np.eye(10)], axis=1)


def _wider(identified: Identified, J: Array, names: Sequence[str]) -> dict[str, float]:
    if identified.resampled is None:
        return {}
    own, drawn = (np.einsum("ij,jk,ik->i", J, C, J) for C in (identified.covariance, identified.resampled))
    ratio = np.sqrt(np.maximum(drawn, 0.0) / np.maximum(own, np.finfo(np.float64).tiny))
    return dict(zip(names, ratio.tolist(), strict=True))
