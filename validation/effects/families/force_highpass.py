from validation.effects.effect import FORCE, FORCES, Family, SizeSpec
from validation.effects.plants import at

FAMILY = Family(
    name="force-highpass",
    side=FORCES,
    what="first-order corner of a charge amplifier",
    targets=(FORCE,),
    sizes=(SizeSpec(unit="Hz", low=0.0, high=100.0, plausible=0.5),),
    example="force-highpass:fmd-x12=0.3",
    equation="y' = y / (1 - i f_c / f)",
    mistaken_for=("cable", "force-delay", "gravity"),
    confirmed_by="the time constant on the amplifier's switch; a quasi-static load that decays; the lowest lines of every sweep",
    reference="first-order high-pass of a charge amplifier, corner 1 / (2π R C) of its feedback",
    sentence="The charge amplifier of {target} lets slow forces fade: below a corner frequency it reads too little, too early. "
    "Only the low end of the band shows it, and there it looks like a spring or a damper to the ground.",
    plant=at("signals", "highpass"),
)
