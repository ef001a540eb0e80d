from validation.classical.pendulum import plane_amplitude_factor, rope_amplitude_factor
from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec, Values
from validation.effects.stages import PendulumSwing


def change(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """The swing is so wide; of ropes the exact period, of a body on a pivot that of the plane pendulum."""
    if not swing.ropes:
        return swing.times(plane_amplitude_factor(values[""]))
    square = swing.square
    epsilon, kappa = square / swing.stated("length") ** 2, swing.stated("mass") * square / swing.stated("inertia")
    return swing.times(rope_amplitude_factor(values[""], epsilon, kappa))


FAMILY = Family(
    name="pendulum-amplitude",
    side=PENDULUM,
    what="the peak angle of a pendulum's swing, which Eq. 5 takes for small",
    sizes=(SizeSpec(unit="rad", low=0.0, high=2.5, plausible=0.2),),
    example="pendulum-amplitude=0.2",
    stage=PERIOD_STAGE,
    change=change,
    equation="T = T₀ 2 K(sin(A/2)) / π for long ropes or a pivot; ropes of length l: T₀ (1 + A² (1/16 - 3/16 e + k e / "
    "4)), e = s²/l², k = m s² / I",
    mistaken_for=("pendulum-damping", "rope-mass", "rope-elasticity", "air-inertia", "off-centre-suspension"),
    confirmed_by="two amplitudes of one pendulum: the period falls with the square of the amplitude as it decays",
    reference="energy of a body on ropes over a quarter swing (validation.classical.pendulum); Landau and Lifshitz, "
    "Mechanics, § 11",
    sentence="The pendulum swings so wide that its period is longer than that of small swings: 0.07 % at 0.1 rad, and the "
    "inertia is twice that too large.",
)
