"""`support-stiffness`: a spring to the ground is not as stiff as assumed. Opened: its factor leaves its tolerance."""

from validation.effects.effect import OPENED, STRUCTURE, SUPPORT, Family, SizeSpec

FAMILY = Family(
    name="support-stiffness",
    side=STRUCTURE,
    what="factor on the stiffness of a support",
    targets=(SUPPORT,),
    sizes=(SizeSpec(unit="1", low=1e-3, high=1e3, null=1.0, plausible=1.0, logarithmic=True),),
    example="support-stiffness:bearing=0.3",
    stage=OPENED,
    tolerance=0.1,
    equation="K += (s - 1) K_support",
    mistaken_for=("modulus", "cable", "connection-compliance"),
    confirmed_by="displacement transducers across the bearing; the modes in which the support moves most, by which it is told "
    "from its neighbour",
    reference="J. E. Mottershead and M. I. Friswell, J. Sound and Vibration 167 (1993), 347 (updating of boundary conditions)",
    sentence="The ground gives more (below 1) or less at {target} than the model says, by this factor.",
)
