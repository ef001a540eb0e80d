"""`absorber`: something that swings at a place of the article."""

from validation.effects.effect import PLACE, STRUCTURE, STRUCTURE_STAGE, Family, Values, resonator
from validation.effects.plants import at
from validation.effects.stages import ALONG, Matrices, with_resonators


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """Three alike, one along each axis: a mass on springs that gives as much every way."""
    return with_resonators(stage, targets[0], ALONG[""], values)


FAMILY = Family(
    name="absorber",
    side=STRUCTURE,
    what="a resonator at a place of the article",
    targets=(PLACE,),
    sizes=resonator(1000.0),
    example="absorber:mast-top=m:0.05,f:21,zeta:0.01",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="H_kk += m (ω_a² + 2iζω_aω) / (ω_a² - ω² + 2iζω_aω) at the place, along x, y and z",
    mistaken_for=("appendage", "slosh", "point-mass"),
    confirmed_by="hold it still by hand or with wax: its frequency is gone; a sensor on it",
    reference="J. P. Den Hartog, Mechanical Vibrations, 1956, section 3.2; H. Frahm, US patent 989958, 1911",
    sentence="Something small swings at {target}: it splits or dents the resonances near its own frequency.",
    plant=at("rig", "absorber"),
)
