"""`storey-mass`: every storey is heavier than was thought, by the same mass. A user's own effect, for the three-storey frame."""

from dataclasses import replace

from validation.effects.effect import STRUCTURE, STRUCTURE_STAGE, Family, SizeSpec


def change(stage, targets, values):
    floors = [rows for name, rows in stage.places.items() if name.startswith("floor-")]
    return replace(stage, mass=stage.mass + values[""] * sum(rows.T @ rows for rows in floors)) if floors else stage


FAMILY = Family(
    name="storey-mass",
    side=STRUCTURE,
    what="the same mass on every storey",
    sizes=(SizeSpec(unit="kg", low=-5.0, high=50.0, plausible=1.0),),
    example="storey-mass=0.5",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="M' = M + m phi^T phi, summed over the floors",
    mistaken_for=("leg-clamp", "modulus:legs"),
    confirmed_by="weigh a storey; the mass line above all resonances",
    reference="Newton's second law",
    sentence="Every storey weighs more than was thought.",
)
