from validation.effects.effect import FORCES, Family, SizeSpec
from validation.effects.plants import at

FAMILY = Family(
    name="fmd-compliance",
    side=FORCES,
    what="factor on the compliance of all load cells",
    targets=("direction of the FMD",),
    sizes=(SizeSpec(unit="1", low=1e-3, high=1e3, null=1.0, plausible=2.0, logarithmic=True),),
    example="fmd-compliance:lateral=3",
    tolerance=0.3,
    equation="table reads G (u - ω² K⁻¹ H u), K⁻¹ times the factor along the direction",
    mistaken_for=("accelerometer-gain", "joint-compliance", "cell-stiffness"),
    confirmed_by="accelerometers on the table against those on the cover plate, over frequency: the difference grows with ω²",
    reference="springs in series: a cover plate on K moves by K⁻¹ F against the table",
    sentence="The load cells give more or less in {target} direction than their data sheet says, so that table and cover plate "
    "do not move alike. Only the pick-ups on the table can be misled by it.",
    plant=at("chain", "compliance"),
)
