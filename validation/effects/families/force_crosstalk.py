from geometry.sensors import Tolerances
from validation.effects.effect import FORCES, RATIO, Family
from validation.effects.plants import at

FAMILY = Family(
    name="force-crosstalk",
    side=FORCES,
    what="a resultant shows in the channels along another axis; zx is x seen in z",
    targets=("pair of axes",),
    sizes=RATIO,
    example="force-crosstalk:zx=0.02",
    tolerance=Tolerances().crosstalk,
    equation="F' = X F, X = I + κ E_ij",
    mistaken_for=("force-plane-offset", "orientation", "accelerometer-misalignment"),
    confirmed_by="a calibration load along one axis alone, at the centre and off it",
    reference="cross-talk matrix of a three-component load cell, as its calibration sheet states it",
    sentence="Of the pair {target}, a share of the force along the second axis shows in the channels along the first: the cells' "
    "crystals or the plates are not square to each other.",
    plant=at("chain", "crosstalk"),
)
