"""`leg-clamp`: the ends of a storey's legs turn a little in their clamps. A user's own effect, for the three-storey frame.

A leg of length L, held at both ends, that shifts sideways by F/k = F L³ / (12 E I) bends its clamps by the moment F L / 2 each.
Clamps of compliance c [rad/(N m)] add the energy 2 (F L / 2)² c / 2, hence (Castigliano) the shift F c L² / 2; four legs share F.
"""

from dataclasses import replace

import numpy as np

from validation.effects.effect import PLACE, STRUCTURE, STRUCTURE_STAGE, Family, SizeSpec

LENGTH = 0.1533  # [m] of a leg


def change(stage, targets, values):
    floors = sorted(name for name in stage.places if name.startswith("floor-"))
    if not floors:
        return stage
    drift = np.diff([np.zeros(len(stage.mass)), *(stage.places[floor][0] for floor in floors)], axis=0)
    back = np.linalg.inv(drift)
    k = np.diag(back.T @ stage.parts["legs"] @ back)  # [N/m] of every storey as it is now
    softened = np.array([not targets or floor in targets for floor in floors])
    less = np.where(softened, 1 / (1 / k + values[""] * LENGTH**2 / 8) - k, 0.0)
    share = drift.T @ np.diag(less) @ drift
    return replace(stage, stiffness=stage.stiffness + share, parts={**stage.parts, "legs": stage.parts["legs"] + share})


FAMILY = Family(
    name="leg-clamp",
    side=STRUCTURE,
    what="compliance of each clamp of the legs below a floor",
    targets=(PLACE,),
    optional=True,
    sizes=(SizeSpec(unit="rad/(N m)", low=0.0, high=1.0, plausible=2e-3),),
    example="leg-clamp=0.001",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="1/k' = 1/k + c L² / 8 of a storey on four legs",
    mistaken_for=("modulus:legs", "storey-mass"),
    confirmed_by="clamp the ends harder and the frequencies rise; a leg that is weighed and bent alone has the modulus it had",
    reference="Castigliano; Timoshenko, Strength of Materials I, beams with elastically built-in ends",
    sentence="The ends of the legs below {target} are not held as firmly as was drawn.",
)
