"""Condensation of small matrices that were drawn: identities, and every derivative against differences."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.frames import Array
from validation.effects.stages import Matrices
from validation.prediction import dynamic_mass
from validation.prediction.nuisances import FIELDS, Tangent, full, of_arrays, plus

LINES = np.array([3.0, 9.0, 11.0, 40.0])
SIZE = 11

DIFFERENCE = 1e-7
"""Relative agreement with central differences of steps of 1e-5: their rounding."""


def drawn(base: int = 6) -> Matrices:
    generator = np.random.default_rng(5)

    def definite(scale: float) -> Array:
        A = generator.standard_normal((SIZE, SIZE))
        return scale * (A @ A.T + np.eye(SIZE))

    mass, K, C, S = definite(1.0), definite(4e3), definite(1.0), definite(10.0)
    for matrix in (K, C, S):
        matrix[:base] = matrix[:, :base] = 0.0
    return Matrices(
        base=base, mass=mass, stiffness=K, viscous=C, structural=S, places={"tip": generator.standard_normal((3, SIZE))}
    )


def changes(generator: np.random.Generator, at: Array) -> Tangent:
    fields = {}
    for name in FIELDS:
        change = np.zeros((SIZE, SIZE))
        block = generator.standard_normal((len(at), len(at)))
        change[np.ix_(at, at)] = block + block.T
        fields[name] = change
    return of_arrays(SIZE, **fields)


def moved(m: Matrices, change: Tangent, step: float) -> Matrices:
    return replace(m, **{name: getattr(m, name) + step * full(change, name, SIZE) for name in FIELDS})


@pytest.mark.parametrize("at", [[7, 9], [0, 8], list(range(SIZE))], ids=["own", "base", "all"])
def test_derivatives_of_the_dynamic_mass_are_its_differences(at: list[int]) -> None:
    m, change = drawn(), changes(np.random.default_rng(1), np.array(at))
    found = dynamic_mass.transfer_tangents(dynamic_mass.dynamic_mass(m, LINES), {"one": change})["one"]
    above, below = (dynamic_mass.dynamic_mass(moved(m, change, step), LINES).matrix for step in (1e-5, -1e-5))
    np.testing.assert_allclose(found, (above - below) / 2e-5, rtol=0, atol=DIFFERENCE * np.abs(found).max())


@pytest.mark.parametrize("at", [[2, 9], list(range(SIZE))], ids=["few", "all"])
def test_derivatives_of_an_accelerance_are_its_differences(at: list[int]) -> None:
    m, change = drawn(base=0), changes(np.random.default_rng(2), np.array(at))
    responses, drive = m.places["tip"], m.places["tip"][2]
    found = dynamic_mass.transfer_tangents(dynamic_mass.accelerance(m, LINES, responses, drive), {"one": change})["one"]
    assert found.shape == (len(LINES), 3, 1)
    above, below = (dynamic_mass.accelerance(moved(m, change, step), LINES, responses, drive).matrix for step in (1e-5, -1e-5))
    np.testing.assert_allclose(found, (above - below) / 2e-5, rtol=0, atol=DIFFERENCE * np.abs(found).max())


def test_the_dynamic_mass_is_symmetric_and_solves_the_equations_of_motion() -> None:
    m = drawn()
    answered = dynamic_mass.dynamic_mass(m, LINES)
    np.testing.assert_allclose(answered.matrix, answered.matrix.transpose(0, 2, 1), rtol=1e-10, atol=1e-10)
    for k, w in enumerate(2 * np.pi * LINES):
        x = -answered.right[:, k] / w**2  # displacements for unit accelerations of the base
        loads = (m.stiffness + 1j * (w * m.viscous + m.structural) - w**2 * m.mass) @ x
        np.testing.assert_allclose(loads[:6], answered.matrix[k], rtol=0, atol=1e-9 * np.abs(answered.matrix).max())
        np.testing.assert_allclose(loads[6:], 0, atol=1e-9 * np.abs(answered.matrix).max())


def test_an_accelerance_is_reciprocal() -> None:
    m = drawn(base=0)
    one, other = (dynamic_mass.along(m, "tip", axis) for axis in ([1.0, 0, 0], [0, 0, 1.0]))
    there, back = (dynamic_mass.accelerance(m, LINES, a, b).matrix for a, b in ((one, other), (other, one)))
    np.testing.assert_allclose(there, back, rtol=1e-9)


def test_one_mass_on_one_spring_is_the_textbook() -> None:
    m, k, eta, omega = 2.0, 800.0, 0.05, 2 * np.pi * LINES
    one = Matrices(base=0, mass=[[m]], stiffness=[[k]], viscous=[[0.0]], structural=[[eta * k]], places={})
    found = dynamic_mass.accelerance(one, LINES, [1.0], [1.0]).matrix[:, 0, 0]
    np.testing.assert_allclose(found, -(omega**2) / (k * (1 + 1j * eta) - m * omega**2), rtol=1e-12)


def test_a_row_and_column_that_cross_are_the_matrix_that_they_are() -> None:
    m, generator, r = drawn(base=0), np.random.default_rng(6), 4
    cross = np.zeros((SIZE, SIZE))
    cross[r] = generator.standard_normal(SIZE)
    cross[:, r] = cross[r]
    answered = dynamic_mass.accelerance(m, LINES, m.places["tip"][:2], m.places["tip"][2])
    changes = {"whole": of_arrays(SIZE, stiffness=cross), "crossing": of_arrays(SIZE, crossing=r, stiffness=cross)}
    found = dynamic_mass.transfer_tangents(answered, changes)
    np.testing.assert_allclose(found["crossing"], found["whole"], rtol=1e-10, atol=1e-12 * np.abs(found["whole"]).max())


def test_tangents_add_on_the_coordinates_of_both() -> None:
    generator = np.random.default_rng(3)
    one, other = changes(generator, np.array([1, 2])), changes(generator, np.array([2, 8]))
    both = plus(one, other, SIZE)
    assert list(both.at) == [1, 2, 8]
    for name in FIELDS:
        np.testing.assert_allclose(full(both, name, SIZE), full(one, name, SIZE) + full(other, name, SIZE))
