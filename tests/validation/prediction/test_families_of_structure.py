"""The equations of the structure's families by themselves: closed forms, limits, scaling, and friction against Exudyn."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, rigid_transformation, rigid_transformation_6
from geometry.inertia import PARAMETERS, Inertia
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import BODY_STAGE, STRUCTURE_STAGE
from validation.effects.families.friction import ALWAYS_SLIPPING, describing_function
from validation.effects.stages import Matrices, MountedDynamicMass
from validation.prediction import dynamic_mass

LINES = np.array([4.0, 9.0, 13.0, 30.0])
SEAT = np.array([0.01, -0.02, 0.05])
PLACE = np.array([0.1, -0.05, 0.6])
BODY = Inertia.from_cog(40.0, [0.02, 0.01, 0.3], np.diag([3.0, 3.5, 1.2]))


def stiff() -> Matrices:
    """A body with two modes and one place."""
    mass = np.zeros((8, 8))
    mass[:6, :6], mass[6:, 6:] = BODY.about(np.zeros(3)).mass_matrix, np.eye(2)
    mass[:6, 6:] = [[3.0, 0.2], [0.1, 2.5], [0.3, 0.1], [-0.1, -1.0], [1.2, 0.1], [0.0, 0.2]]
    mass[6:, :6] = mass[:6, 6:].T
    own = np.diag((2 * np.pi * np.array([11.0, 14.0])) ** 2)
    K = np.pad(own, (6, 0))
    phi = np.hstack([rigid_transformation(PLACE), [[0.3, 0.02], [0.01, 0.25], [0.05, -0.03]]])
    return Matrices(
        base=6,
        mass=mass,
        stiffness=K,
        viscous=np.zeros((8, 8)),
        structural=0.01 * K,
        places={"tip": phi},
        parts={"mast": 0.6 * K, "blade": 0.3 * K, "blade-silicone": 0.1 * K},
        cog=BODY.cog,
    )


def mounted() -> MountedDynamicMass:
    return MountedDynamicMass(frequency=LINES, matrix=dynamic_mass.dynamic_mass(stiff(), LINES).matrix, seat=SEAT, cog=BODY.cog)


def equation(family: str) -> Callable[..., Any]:
    change = FAMILIES[family].change
    assert change is not None
    return change


def on_matrices(family: str, *targets: str, **values: float) -> ComplexArray:
    change = equation(family)
    return dynamic_mass.dynamic_mass(change(stiff(), targets, _keyed(values)), LINES).matrix


def on_body(family: str, *targets: str, stage: MountedDynamicMass | None = None, **values: float) -> ComplexArray:
    change = equation(family)
    matrix: ComplexArray = change(stage or mounted(), targets, _keyed(values)).matrix
    return matrix


def _keyed(values: dict[str, float]) -> dict[str, float]:
    return {"" if key == "size" else key: value for key, value in values.items()}


NOMINAL = mounted().matrix

NULL = {
    "point-mass": (("tip",), {"": 0.0}),
    "rigid-inertia": (("Ixy",), {"": 0.0}),
    "structural-damping": (("mast",), {"": 0.0}),
    "layer-damping": (("blade",), {"": 0.0}),
    "cable": (("tip",), {"": 0.0}),
    "absorber": (("tip",), {"m": 0.0, "f": 11.0, "zeta": 0.1}),
    "slosh": (("tip",), {"m": 0.0, "f": 11.0, "zeta": 0.1}),
    "joint-compliance": (("rotation",), {"": 0.0}),
    "appendage": (("x",), {"m": 0.0, "f": 11.0, "zeta": 0.1}),
    "orientation": (("z",), {"": 0.0}),
    "mounting-offset": (("y",), {"": 0.0}),
    "friction": (("flange", "x"), {"": 0.0, "mass": 2.0}),
}


@pytest.mark.parametrize("family", NULL)
def test_the_size_of_nothing_changes_nothing(family):
    targets, values = NULL[family]
    change = equation(family)
    if FAMILIES[family].stage == STRUCTURE_STAGE and not {"m"} & set(values):
        after = change(stiff(), targets, values)
        for name in ("mass", "stiffness", "viscous", "structural"):
            np.testing.assert_array_equal(getattr(after, name), getattr(stiff(), name))
    elif FAMILIES[family].stage == BODY_STAGE:
        np.testing.assert_allclose(change(mounted(), targets, values).matrix, NOMINAL, rtol=1e-13, atol=1e-13)
    else:  # a resonator of no mass has no equation of its own; one of next to no mass moves next to nothing
        H = on_matrices(family, *targets, **{**values, "m": 1e-9})
        np.testing.assert_allclose(H, NOMINAL, rtol=0, atol=1e-6 * np.abs(NOMINAL).max())


def test_a_mass_on_a_rigid_body_is_the_composed_body():
    rigid = Matrices(base=6, mass=BODY.about(np.zeros(3)).mass_matrix, **nothing(6), places={"tip": rigid_transformation(PLACE)})
    change = equation("point-mass")
    expected = BODY.about(np.zeros(3)) + Inertia.from_cog(0.7, PLACE, np.zeros((3, 3))).about(np.zeros(3))
    np.testing.assert_allclose(change(rigid, ("tip",), {"": 0.7}).mass, expected.mass_matrix, rtol=1e-12, atol=1e-12)


def nothing(size: int) -> dict[str, Array]:
    return dict.fromkeys(("stiffness", "viscous", "structural"), np.zeros((size, size)))


@pytest.mark.parametrize("parameter", PARAMETERS)
def test_rigid_inertia_is_the_article_with_that_parameter_about_its_centre_of_gravity(parameter):
    about = np.array(BODY.about(BODY.cog).parameters)
    about[PARAMETERS.index(parameter)] += 0.05
    expected = Inertia(parameters=about, reference_point=BODY.cog).about(np.zeros(3)).mass_matrix
    change = equation("rigid-inertia")
    np.testing.assert_allclose(change(stiff(), (parameter,), {"": 0.05}).mass[:6, :6], expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("family", ["absorber", "slosh", "appendage"])
def test_a_resonator_far_above_its_frequency_is_a_mass_and_far_below_nothing(family):
    of = on_body if family == "appendage" else on_matrices
    target = "x" if family == "appendage" else "tip"
    mass = 0.3
    loose = of(family, target, m=mass, f=1e-3, zeta=0.1)
    np.testing.assert_allclose(loose, NOMINAL, rtol=0, atol=1e-4 * np.abs(NOMINAL).max())
    stiffly = of(family, target, m=mass, f=1e4, zeta=0.1)
    np.testing.assert_allclose(stiffly, with_mass(family, mass), rtol=0, atol=1e-4 * np.abs(NOMINAL).max())


def with_mass(family: str, mass: float) -> ComplexArray:
    if family == "appendage":
        row = rigid_transformation(-SEAT)[0]
        return NOMINAL + mass * np.outer(row, row)
    axes = (0, 1, 2) if family == "absorber" else (0, 1)
    m = stiff()
    phi = m.places["tip"][list(axes)]
    return dynamic_mass.dynamic_mass(replace(m, mass=m.mass + mass * phi.T @ phi), LINES).matrix


def test_a_resonator_is_the_equation_of_the_catalogue():
    """Condensed from its own coordinate, an absorber adds that mass, complex and of every line, at the place."""
    m, f, zeta, of = 0.3, 12.0, 0.05, stiff()
    phi, found = of.places["tip"], on_matrices("absorber", "tip", m=m, f=f, zeta=zeta)
    own = 2 * np.pi * f
    for k, w in enumerate(2 * np.pi * LINES):
        spring = own**2 + 2j * zeta * own * w
        D = of.mass + m * spring / (spring - w**2) * phi.T @ phi - (of.stiffness + 1j * of.structural) / w**2
        expected = D[:6, :6] - D[:6, 6:] @ np.linalg.solve(D[6:, 6:], D[6:, :6])
        np.testing.assert_allclose(found[k], expected, rtol=1e-10, atol=1e-10)


def test_slosh_swings_sideways_only_and_a_cable_that_does_not_give_holds_its_place():
    rigid = Matrices(
        base=6, mass=BODY.about(np.zeros(3)).mass_matrix, **nothing(6), places={"tip": rigid_transformation(np.zeros(3))}
    )
    change = equation("slosh")
    H = dynamic_mass.dynamic_mass(change(rigid, ("tip",), {"m": 0.5, "f": 6.0, "zeta": 0.02}), LINES).matrix
    added = np.einsum("nii->ni", H - rigid.mass)
    np.testing.assert_allclose(added[:, 0], added[:, 1], rtol=1e-12)
    assert np.abs(added[:, 0]).min() > 1e-3
    np.testing.assert_allclose(added[:, 2:], 0, atol=1e-12)
    change = equation("cable")
    answered = dynamic_mass.dynamic_mass(change(stiff(), ("tip", "vertical"), {"": 1e12}), LINES)
    moved = np.einsum("k,knj->nj", stiff().places["tip"][2], answered.right)
    freely = np.einsum("k,knj->nj", stiff().places["tip"][2], dynamic_mass.dynamic_mass(stiff(), LINES).right)
    assert np.abs(moved).max() < 1e-4 * np.abs(freely).max()


def test_a_cable_on_a_rigid_body_is_its_stiffness_over_omega_squared():
    rigid = Matrices(base=6, mass=BODY.about(np.zeros(3)).mass_matrix, **nothing(6), places={"tip": rigid_transformation(PLACE)})
    change = equation("cable")
    H = dynamic_mass.dynamic_mass(change(rigid, ("tip", "lateral"), {"": 2000.0}), LINES).matrix
    rows = rigid_transformation(PLACE)[:2]
    expected = rigid.mass - 2000.0 * rows.T @ rows / (2 * np.pi * LINES[:, None, None]) ** 2
    np.testing.assert_allclose(H, expected, rtol=1e-12, atol=1e-12)


def test_a_joint_is_a_spring_between_two_bodies():
    """The same from matrices: the base of the body becomes coordinates of its own on springs."""
    c = np.array([1e-7, 1e-7, 0.0, 0.0, 0.0, 0.0])
    m = stiff()
    gives = [0, 1]
    T = np.vstack([np.eye(8), np.eye(8)[gives]]).T  # base, own, joint: the body's base moves with the base and the joint
    K = T.T @ m.stiffness @ T
    K[[8, 9], [8, 9]] += 1 / c[gives]
    sprung = Matrices(base=6, mass=T.T @ m.mass @ T, stiffness=K, viscous=np.zeros((10, 10)), structural=T.T @ m.structural @ T)
    expected = dynamic_mass.dynamic_mass(sprung, LINES).matrix
    np.testing.assert_allclose(on_body("joint-compliance", "lateral", size=1e-7), expected, rtol=1e-9, atol=1e-9)


def test_two_joints_in_series_give_the_sum_of_their_compliance_and_none_takes_energy():
    change = equation("joint-compliance")
    once = on_body("joint-compliance", "rotation", size=3e-6)
    twice = change(change(mounted(), ("rotation",), {"": 1e-6}), ("rotation",), {"": 2e-6}).matrix
    np.testing.assert_allclose(twice, once, rtol=1e-10, atol=1e-10)
    lossless = replace(mounted(), matrix=NOMINAL.real.astype(np.complex128))
    assert not np.any(on_body("joint-compliance", "torsion", stage=lossless, size=1e-5).imag)


def test_a_quarter_turn_swaps_the_axes_a_turned_article_is_its_turned_inertia_and_an_offset_another_seat():
    H = on_body("orientation", "z", size=np.pi / 2)
    np.testing.assert_allclose(H[:, 1, 1], NOMINAL[:, 0, 0], rtol=1e-12)
    np.testing.assert_allclose(H[:, 3, 3], NOMINAL[:, 4, 4], rtol=1e-12)
    stage = mounted()
    change = equation("orientation")
    for _ in range(4):
        stage = change(stage, ("z",), {"": np.pi / 2})
    np.testing.assert_allclose(stage.matrix, NOMINAL, rtol=1e-12, atol=1e-12)
    angle = 0.3
    c, s = np.cos(angle), np.sin(angle)
    rigid = replace(mounted(), matrix=np.broadcast_to(BODY.about(np.zeros(3)).mass_matrix.astype(np.complex128), (4, 6, 6)))
    expected = BODY.about(np.zeros(3)).rotated([[c, -s, 0], [s, c, 0], [0, 0, 1]]).mass_matrix
    np.testing.assert_allclose(on_body("orientation", "z", stage=rigid, size=angle)[0], expected, rtol=1e-12, atol=1e-12)
    moved = on_body("mounting-offset", "y", size=0.004)
    as_drawn, beside = (rigid_transformation_6(seat) for seat in (SEAT, np.add(SEAT, [0, 0.004, 0])))
    np.testing.assert_allclose(as_drawn.T @ moved @ as_drawn, beside.T @ NOMINAL @ beside, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("family", "part", "of"), [("structural-damping", "mast", "mast"), ("layer-damping", "blade", "blade-silicone")]
)
def test_a_loss_factor_is_an_imaginary_stiffness_of_its_part(family, part, of):
    change = equation(family)
    after = change(stiff(), (part,), {"": 0.03})
    np.testing.assert_allclose(after.structural - stiff().structural, 0.03 * stiff().parts[of], rtol=1e-9, atol=1e-9)


def test_effects_of_a_model_twice_as_large_scale_as_what_they_act_on_does():
    """Lengths x s: masses s³, compliances s^-1 and s^-3, frequencies 1 / s; the dynamic mass s³ with a length a rotation."""
    s, length = 2.0, np.repeat([1.0, 2.0], 3)
    scale = s**3 * np.outer(length, length)
    large = replace(mounted(), frequency=LINES / s, matrix=scale * NOMINAL, seat=s * SEAT)
    cases = [
        (("joint-compliance", "rotation"), {"size": 1e-6}, {"size": 1e-6 / s**3}),
        (("joint-compliance", "lateral"), {"size": 1e-8}, {"size": 1e-8 / s}),
        (("appendage", "y"), {"m": 0.1, "f": 12.0, "zeta": 0.02}, {"m": 0.1 * s**3, "f": 12.0 / s, "zeta": 0.02}),
        (("mounting-offset", "x"), {"size": 0.003}, {"size": 0.003 * s}),
        (("orientation", "z"), {"size": 0.1}, {"size": 0.1}),
    ]
    for (family, target), values, scaled in cases:
        small = on_body(family, target, **values)
        np.testing.assert_allclose(on_body(family, target, stage=large, **scaled), scale * small, rtol=1e-9, atol=1e-9)


def driven(acceleration: float, loose: str = "x", force: float = 3.0) -> ComplexArray:
    stage = replace(mounted(), amplitude=np.array([acceleration, 0, 0, 0, 0, 0]))
    return on_body("friction", "flange", loose, stage=stage, size=force, mass=2.0) - NOMINAL


def test_a_part_that_sticks_is_a_mass_and_one_that_slips_is_less_and_loses():
    stuck = np.diag([2.0, 2.0, 2.0, 0, 0, 0])
    for acceleration in (0.0, 1.0, 1.4999):
        np.testing.assert_allclose(driven(acceleration)[0], stuck, atol=1e-9)
    slipping = [driven(acceleration)[0, 0, 0] for acceleration in (1.6, 2.0, 2.5, 3.0, 6.0, 60.0)]
    assert np.all(np.diff([abs(one) for one in slipping]) < 0)
    assert all(one.imag < 0 < one.real < 2 for one in slipping)
    np.testing.assert_allclose(driven(60.0)[0, 1:, 1:], stuck[1:, 1:], atol=1e-9)


def test_it_slips_along_the_axis_that_is_loose_and_by_what_the_flange_does():
    assert driven(60.0, loose="y")[0, 1, 1] == 2.0  # the run does not move it along y
    turning = replace(mounted(), amplitude=np.array([0, 0, 0, 0, 30.0, 0]))
    H = on_body("friction", "flange", "x", stage=turning, size=3.0, mass=2.0) - NOMINAL
    np.testing.assert_allclose(H[0, 0, 0], 2.0 * describing_function(3.0 / (2.0 * 30.0 * SEAT[2])), rtol=1e-9)


@pytest.mark.parametrize("share", [0.98, 0.8, 0.6, ALWAYS_SLIPPING + 1e-3, 0.5, 0.2])
def test_harmonic_balance_is_the_first_harmonic_of_the_motion_in_time(share):
    """A part on a base with acceleration cos(t), carried along by at most `share`, integrated until it repeats itself."""
    per_period = 20_000
    step = 2 * np.pi / per_period
    t = step * np.arange(12 * per_period)
    speed = np.sin(t + step)
    own, force = 0.0, np.empty_like(t)
    for k in range(len(t)):
        needed = (speed[k] - own) / step
        force[k] = min(max(needed, -share), share)
        own += step * force[k]
    last = slice(-per_period, None)
    found = 2 * np.mean(force[last] * np.exp(-1j * t[last]))
    np.testing.assert_allclose(found, describing_function(share), rtol=0, atol=2e-3)


def test_the_two_ways_to_slip_meet():
    below, above = (describing_function(ALWAYS_SLIPPING * (1 + side * 1e-9)) for side in (-1, 1))
    np.testing.assert_allclose(below, above, atol=1e-6)
    np.testing.assert_allclose(describing_function(1 - 1e-12), 1.0, atol=1e-5)


def test_named_effects_carry_their_sizes():
    assert {size.key for size in Named(family="friction", targets=("flange", "x"), values={"": 3.0, "mass": 2.0}).sizes} == {
        "",
        "mass",
    }
