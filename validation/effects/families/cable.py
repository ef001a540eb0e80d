"""`cable`: what ties the article to the laboratory."""

from dataclasses import replace

from validation.effects.effect import CABLE, PLACE, STRUCTURE, STRUCTURE_STAGE, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import ALONG, Matrices


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``K += k phi^T phi``; unlike the article's own stiffness it resists the base too."""
    phi = stage.places[targets[0]][list(ALONG["".join(targets[1:])])]
    return replace(stage, stiffness=stage.stiffness + values[""] * phi.T @ phi)


FAMILY = Family(
    name="cable",
    side=STRUCTURE,
    what="a spring from a place to the ground",
    targets=(PLACE, CABLE),
    optional=True,
    sizes=(SizeSpec(unit="N/m", low=1e-3, high=1e9, plausible=5e3),),
    example="cable:mast-top:lateral=1000",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="K += k φᵀφ, K_nb = k φᵀΓ, K_bb = k ΓᵀΓ (in H with -1/ω²)",
    mistaken_for=("gravity", "force-highpass", "modulus"),
    confirmed_by="a run without it; it grows towards low frequency as 1/ω², as no stiffness inside the article does",
    reference="D. J. Ewins, Modal Testing, 2000, chapter 3 (support of the test piece)",
    sentence="A cable or hose ties {target} to the laboratory and carries part of the load past the load cells.",
    plant=at("rig", "cable"),
)
