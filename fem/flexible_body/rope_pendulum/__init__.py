"""The rope pendulum in exudyn: a rigid body on two or three ropes, let go and watched.

`Suspension` says how it hangs and starts, `swing` lets exudyn integrate it, `Swing` is what it did. Ropes may have mass and
stretch; the twist may be large, damped, and about a point that is not the CoG. Nothing here knows Eq. 5, which is held against
it elsewhere.
"""

from fem.flexible_body.rope_pendulum.simulation import STANDARD_GRAVITY, Swing, small_period, swing
from fem.flexible_body.rope_pendulum.suspension import Suspension, hung, on_three_ropes, on_two_ropes

__all__ = ["STANDARD_GRAVITY", "Suspension", "Swing", "hung", "on_three_ropes", "on_two_ropes", "small_period", "swing"]
