"""`dashpot`: a viscous damper from a place of the article to the ground, such as a hose. One file, whole."""

from dataclasses import replace

import numpy as np

from fem.base_excitation.rig import Strut
from validation.effects.effect import STRUCTURE, STRUCTURE_STAGE, Family, SizeSpec
from validation.effects.plants import at


def change(matrices, targets, values):
    phi = matrices.places[targets[0]]  # (3, k): how the place moves along x, y, z with every coordinate
    return replace(matrices, viscous=matrices.viscous + values[""] * phi.T @ phi)


def strut(named):
    damper = Strut(place=named.target, to="ground", damping=np.full(3, named.value))
    return lambda rig: replace(rig, struts=(*rig.struts, damper))


FAMILY = Family(
    name="dashpot",
    side=STRUCTURE,
    what="a viscous damper from a place to the ground",
    targets=("place",),
    sizes=(SizeSpec(unit="N s/m", low=0.0, high=1e5, plausible=50.0),),
    example="dashpot:mast-top=30",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="C += c φᵀφ, base motions among the coordinates",
    mistaken_for=("structural-damping", "cable"),
    confirmed_by="the run without the hose",
    reference="linear viscous damper; Meirovitch, Fundamentals of Vibrations, section 2.1",
    sentence="Something at {target} holds back in proportion to speed, and is fixed to the ground.",
    plant=at("rig", strut),
)
