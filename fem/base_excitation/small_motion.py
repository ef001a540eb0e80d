"""Whether a run stays where the linear equations hold: "rotational amplitudes and velocities sufficiently small" (paper 2.1).

Eqs. 1 take the table's axes for those of the laboratory and velocities for nothing. With the rotation vector phi(t) of the table,
R its rotation, omega its angular velocity, r the arm from the reference point A to a particle, the exact acceleration is

    a = a_A + omega' x (R r) + omega x (omega x (R r)),

and load cells, which ride on the table, sense R^T of it. What the linear equations drop is of second order in the motion:

- turned axes: (R^T - 1) a_A and omega' x ((R - 1) r), at most |phi| times what is kept, and nothing where accelerometers and
  load cells turn with the table together;
- centripetal acceleration and the gyroscopic moment omega x (Theta omega): |omega|² beside |omega'|, which for a harmonic motion
  is |phi| again;
- phi'' - omega', which vanishes while one axis turns alone and is of the order |phi| |phi''| and |phi'|² otherwise.

One figure says how small all of it is beside what is kept, `left_out`: the larger of the largest angle and of the largest squared
rate over the largest angular acceleration. Where it shows depends on how the record is read. Products of two harmonics lie at
zero and at twice the driven frequency, so a reading at the driven frequency (a steady sine, a tracking filter) sees only terms of
third order, `left_out`². The transform of a whole sweep does not know when a line was driven: at the frequency f it also
holds what the sweep left over when it passed f / 2, which in a sweep of one axis is half the angle at f / 2. With the paper's
vertical rotation that is 0.5 % of the force just above 8 Hz, falling with 1 / f². A resonance of the article at f magnifies it.

Gravity is not among these terms: its tilt m g |phi| is of first order, and belongs to the linear equations that include it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.base_excitation.base_motion import BaseMotion

LIMIT = 0.02
"""Largest share of the load, in the time record of a rigid article, that the linear equations may leave out: 2 %, an angle of 1.1
degrees, twice what the paper's sweeps reach. At the driven frequency that is 0.04 %, in full-record spectra of a sweep 1 %.

Exudyn's own bodies and beams, on a table that really turns, stay below that share in every case tried, rigid and flexible, from
the paper's level to thirty times it (`examples/large_motion.py`)."""


@dataclass(frozen=True, kw_only=True)
class SmallMotion:
    """How large the rotations of a run are.

    Attributes
    ----------
    angle : [rad] largest rotation of the table
    rate : [rad/s] largest angular velocity
    turned : [1] share of a load that the turning of the axes moves to another axis: the angle itself
    centripetal : [1] largest squared rate over largest angular acceleration
    limit : `LIMIT`
    """

    angle: float
    rate: float
    turned: float
    centripetal: float
    limit: float = LIMIT

    @property
    def left_out(self) -> float:
        """[1] what the linear equations leave out, as a share of what they keep."""
        return max(self.turned, self.centripetal)

    @property
    def within(self) -> bool:
        """Whether that is small enough."""
        return self.left_out <= self.limit

    @property
    def text(self) -> str:
        """One sentence."""
        is_within = "within" if self.within else "beyond"
        return (
            f"The table turns by {np.degrees(self.angle):.2g}° at most, at up to {np.degrees(self.rate):.2g}°/s: the linear "
            f"equations leave out {self.left_out:.2%} of the load, {is_within} the limit of {self.limit:.2%}."
        )


def judge(motion: BaseMotion) -> SmallMotion:
    """What the rotations of `motion` are to the linear equations; see the head of this file for what they leave out."""
    angle, rate, acceleration = (
        float(np.linalg.norm(kind[:, 3:], axis=1).max()) for kind in (motion.displacement, motion.velocity, motion.acceleration)
    )
    return SmallMotion(angle=angle, rate=rate, turned=angle, centripetal=rate**2 / acceleration if acceleration else 0.0)
