"""Reduced bodies answer as the structure they come from, and refuse what does not belong to it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem import dynamic_mass, reduction
from fem.base_excitation import rig
from fem.base_excitation.rig import FlexibleBody
from fem.beam import articles
from fem.damping import Damping
from fem.modes import Modes, fixed_base
from fem.structure import Structure, rigid_motion
from geometry.errors import BadInput
from geometry.frames import rigid_transformation_6
from geometry.inertia import Inertia

LINES = np.linspace(4.0, 32.0, 281)
RATIO = Damping(ratio=0.003)


@pytest.fixture(scope="module")
def four() -> Structure:
    return articles.structure("clumod-4")


@pytest.fixture(scope="module")
def modes(four: Structure) -> Modes:
    return fixed_base(four, 30, damping=RATIO)


def error(H: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """At every line, the largest difference as a share of the largest entry, axes scaled by the root of their inertia."""
    scale = np.sqrt(np.abs(truth[0].diagonal()))
    scale = np.outer(scale, scale)
    return (np.abs(H - truth) / scale).max(axis=(1, 2)) / (np.abs(truth) / scale).max(axis=(1, 2))


def dynamic_mass_of(made: FlexibleBody, lines: np.ndarray = LINES) -> np.ndarray:
    return reduction.dynamic_mass(made.reduced, lines).matrix


def viscous_alone(modes: Modes) -> Modes:
    """`modes` as they answer in time."""
    _, C = rig.viscous(modes)
    return replace(modes, viscous=C, structural=np.zeros_like(C), condensed=None)


@pytest.mark.parametrize("name", ["clumod-1", "clumod-4"])
def test_a_reduced_body_has_the_dynamic_mass_of_its_modes_and_residual(name: str) -> None:
    structure = articles.structure(name)
    modes = fixed_base(structure, 30, damping=RATIO)
    H = dynamic_mass_of(rig.flexible(name, structure, modes))
    # Modes and R leave out what grows with the fourth power of the frequency; 30 modes of clumod-4 go to 78 Hz.
    assert error(H, dynamic_mass.modal(modes, LINES).matrix).max() < 2e-4


def test_static_coordinates_beat_the_residual_against_the_direct_solution(four: Structure, modes: Modes) -> None:
    truth = dynamic_mass.direct(four, LINES, RATIO, modes=modes).matrix
    mine = error(dynamic_mass_of(rig.flexible("c", four, modes)), truth).max()
    assert mine < error(dynamic_mass.modal(modes, LINES).matrix, truth).max() / 3
    assert mine < 2e-5


def test_what_is_left_out_grows_with_the_sixth_power_of_the_frequency(four: Structure) -> None:
    lines = np.array([8.0, 16.0])
    few = fixed_base(four, 11, damping=Damping())
    truth = dynamic_mass.direct(four, lines, Damping()).matrix
    left = np.abs(dynamic_mass_of(rig.flexible("c", four, few), lines) - truth).max(axis=(1, 2))
    assert_allclose(np.log2(left[1] / left[0]), 6.0, atol=0.4)  # the next mode, at 38 Hz, is not infinitely far


def test_structural_damping_made_viscous_costs_what_is_said(four: Structure) -> None:
    lossy = fixed_base(four, 30)
    truth = dynamic_mass.direct(four, LINES).matrix
    assert error(dynamic_mass_of(rig.flexible("c", four, lossy)), truth).max() < 0.01
    # Without the condensation of the truncated modes it is twice as much.
    assert error(dynamic_mass.modal(viscous_alone(replace(lossy, condensed=None)), LINES).matrix, truth).max() > 0.015


def test_modal_data_alone_answer_as_modes_with_their_residual(modes: Modes) -> None:
    made = rig.of_modal_data("own", modes)
    assert_allclose(error(dynamic_mass_of(made), dynamic_mass.modal(modes, LINES).matrix), 0, atol=2e-4)
    low = np.array([0.5, 1.0])  # where R is all that the carriers are
    assert error(dynamic_mass_of(made, low), dynamic_mass.modal(modes, low).matrix).max() < 1e-9
    assert np.linalg.eigvalsh(made.reduced.mass).min() > 0
    assert np.sqrt(made.reduced.stiffness.diagonal()[36:].min()) / (2 * np.pi) > 2 * modes.frequency[-1]


def test_modal_data_about_another_point_is_moved_to_the_origin(modes: Modes) -> None:
    T = rigid_transformation_6([0.1, -0.2, 0.3]).T
    elsewhere = replace(
        modes,
        participation=np.linalg.solve(T, modes.participation),
        rigid_mass=np.linalg.solve(T, np.linalg.solve(T, modes.rigid_mass).T),
        residual=np.linalg.solve(T, np.linalg.solve(T, modes.residual).T),
        reference_point=[0.1, -0.2, 0.3],
    )
    here, there = (dynamic_mass_of(rig.of_modal_data("own", m)) for m in (modes, elsewhere))
    assert_allclose(there, here, atol=1e-8 * np.abs(here).max())  # the carriers' directions depend on the units


def test_a_body_without_residual_needs_no_carriers(four: Structure, modes: Modes) -> None:
    bare = replace(modes, residual=np.zeros((6, 6)))
    assert rig.of_modal_data("own", bare).reduced.mass.shape == (36, 36)


def test_modes_that_move_more_mass_than_there_is_are_refused(modes: Modes) -> None:
    with pytest.raises(BadInput, match=r"`participation`: its modes must not move more mass"):
        rig.of_modal_data("own", replace(modes, participation=3 * modes.participation))


def test_a_rigid_body_is_its_mass_matrix_everywhere() -> None:
    inertia = Inertia.from_cog(3.0, [0.1, 0.2, 0.3], np.diag([0.4, 0.5, 0.6]))
    made = rig.rigid("block", inertia, {"top": [0.0, 0.0, 0.5]})
    H = dynamic_mass_of(made)
    assert_allclose(H, np.broadcast_to(inertia.mass_matrix, H.shape), rtol=1e-14)
    assert_allclose(made.places["top"] @ [0, 0, 0, 0, 1.0, 0], [0.5, 0, 0])  # rotation about y carries the top along x


def test_an_inertia_that_no_body_has_is_refused() -> None:
    with pytest.raises(BadInput, match="body block"):
        rig.rigid("block", Inertia.from_cog(-3.0, [0.0, 0.0, 0.0], np.diag([0.4, 0.5, 0.6])))


def test_places_move_with_the_base_and_with_the_shapes(four: Structure, modes: Modes) -> None:
    made = rig.flexible("c", four, modes, places={"flange": [0.1, 0.0, 0.0], "top": [0.0, 0.0, 1.6]})
    assert_allclose(made.places["flange"][:, 6:], 0.0)
    assert_allclose(made.places["flange"][:, 5], [0.0, 0.1, 0.0], atol=1e-15)
    top = int(np.argmax(four.points[:, 2]))
    assert_allclose(made.places["top"][:, 6:36], modes.shapes[four.translations[top]])
    assert_allclose(made.places["top"][:, :6], four.rigid[four.translations[top]])


def test_a_place_off_the_structure_is_refused(four: Structure, modes: Modes) -> None:
    with pytest.raises(BadInput, match=r"`places.nowhere`.*nearest is .* mm away"):
        rig.flexible("c", four, modes, places={"nowhere": [0.0, 0.0, 3.0]})


def test_modes_without_shapes_are_refused(four: Structure, modes: Modes) -> None:
    with pytest.raises(BadInput, match="`modes`: shapes on all 402"):
        rig.flexible("c", four, replace(modes, shapes=np.zeros((0, 30))))


def test_a_solid_about_another_point_is_reduced_about_the_articles_origin(block: Callable[..., Structure]) -> None:
    """A column of point masses and springs, whose base is not where its reference point is."""
    column, point = block(2, 2, 4), np.array([0.3, -0.2, 0.1])
    points = column.points
    elsewhere = replace(column, reference_point=point, rigid=translations(points, point))
    modes = fixed_base(elsewhere, 4, damping=Damping())
    made = rig.flexible("column", elsewhere, modes, places={"corner": points[-1]})
    lines = np.array([0.0, 0.2, 0.4]) * modes.frequency[0]
    expected = dynamic_mass.direct(elsewhere, lines, Damping()).about(np.zeros(3)).matrix
    # Four of 36 modes and six static answers leave out what grows with the sixth power.
    assert_allclose(dynamic_mass_of(made, lines), expected, atol=1e-6 * np.abs(expected).max())
    assert_allclose(made.reduced.basis[:, :6], translations(points, np.zeros(3)), atol=1e-15)
    assert_allclose(made.places["corner"], made.reduced.basis[-3:], atol=1e-15)


def translations(points: np.ndarray, reference_point: np.ndarray) -> np.ndarray:
    return rigid_motion(points, reference_point).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)
