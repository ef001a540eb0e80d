"""An article of exudyn's own bodies and beams on a base that really moves and turns, however far.

None of massline's matrices takes part: from `fem.beam.plan` exudyn takes places, sections and rigid bodies (`native`) and makes
its own equations of them, geometrically exact. It is the truth against which the linear equations of base excitation are judged
(`cost`) and a second way, of another fidelity, to the response of a virtual test.
"""

from fem.flexible_body.large_motion.conditions import Conditions
from fem.flexible_body.large_motion.response import respond, respond_of_plan

__all__ = ["Conditions", "respond", "respond_of_plan"]
