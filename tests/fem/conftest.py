"""What tests of fem share: the user's bracket, in files and as arrays to be spoilt, a smooth motion, and an elastic block."""

import runpy
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csr_array, eye_array, kron

from fem import factorisers
from fem.base_excitation.patterns import BaseMotion
from fem.exudyn.linear import Linearised
from fem.modes import Reduced
from fem.structure import Structure, rigid_motion
from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array


@pytest.fixture(autouse=True)
def _optional_factoriser(request: pytest.FixtureRequest) -> None:
    """A test marked ``fast(name)`` needs the factoriser of that name."""
    marker = request.node.get_closest_marker("fast")
    if marker is not None and marker.args[0] not in factorisers.installed():
        pytest.skip(f"{marker.args[0]} is not installed: it comes with the extra `fast`")


@pytest.fixture(scope="session")
def own_model(root: Path) -> dict[str, Any]:
    """The names in ``examples/own_model.py``."""
    return runpy.run_path(str(root / "examples" / "own_model.py"))


@pytest.fixture(scope="session")
def condensed() -> Callable[[Reduced, Array], ComplexArray]:
    """``condensed(reduced, lines)``: the dynamic mass (n, 6, 6) at `lines` (n,) [Hz], modal coordinates condensed at each."""

    def matrix(reduced: Reduced, lines: Array) -> ComplexArray:
        H = np.empty((len(lines), 6, 6), dtype=np.complex128)
        for line, omega in enumerate(2 * np.pi * np.asarray(lines)):
            Z = reduced.stiffness + 1j * (omega * reduced.viscous + reduced.structural) - omega**2 * reduced.mass
            q = np.linalg.solve(Z[6:, 6:], omega**2 * reduced.mass[6:, :6])  # for a unit displacement of the base
            H[line] = reduced.mass[:6, :6] + reduced.mass[:6, 6:] @ q
        return H

    return matrix


@pytest.fixture(scope="session")
def bracket_files(own_model: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the bracket in every format."""
    folder = tmp_path_factory.mktemp("own-model")
    own_model["write"](folder)
    return folder


@pytest.fixture
def arrays(own_model: dict[str, Any]) -> dict[str, np.ndarray]:
    """The bracket's arrays, mm-t-N-s; a test may change them."""
    nodes, coordinates, K, M = own_model["bracket"]()
    dof = np.array([(node, component) for node in nodes for component in range(1, 7)])
    return {"stiffness": K.copy(), "mass": M.copy(), "dof": dof, "nodes": nodes, "coordinates": coordinates}


@pytest.fixture
def saved(own_model: dict[str, Any], tmp_path: Path) -> Callable[..., Path]:
    """``saved(arrays, description, ending)``: a file with the bracket's description unless another is given."""

    def save(arrays: dict[str, np.ndarray], description: str = own_model["DESCRIPTION"], ending: str = ".npz") -> Path:
        path = tmp_path / f"model{ending}"
        if ending == ".npz":
            np.savez(path, description=np.array(description), **arrays)
            return path
        import h5py

        with h5py.File(path, "w") as file:
            file.attrs["description"] = description
            for name, array in arrays.items():
                file[name] = array
        return path

    return save


@pytest.fixture(scope="session")
def driven() -> Callable[[Linearised, np.ndarray, float], np.ndarray]:
    """``driven(system, lossy, frequency)``: blocked dynamic mass (6, 6) straight from the matrices that exudyn linearises.

    The base's six coordinates u are prescribed, the others x and the joints' forces lambda follow from

        Z = K + i S - omega² M,    Z_xx x + J_x lambda = -Z_xu u,    J_x^T x = -J_u^T u,

    and the load of the table is F = Z_uu u + Z_ux x + J_u lambda; with u = -a / omega², H = F / a.
    """
    return _driven


def _driven(system: Linearised, lossy: np.ndarray, frequency: float) -> np.ndarray:
    J, omega = system.constraints, 2 * np.pi * frequency
    none = np.zeros((J.shape[1], J.shape[1]))
    Z = np.block([[system.stiffness + 1j * lossy - omega**2 * system.mass, J], [J.T, none]])  # base, others, joints
    others = np.linalg.solve(Z[6:, 6:], -Z[6:, :6])
    return (Z[:6, :6] + Z[:6, 6:] @ others) / -(omega**2)


@pytest.fixture(scope="session")
def smooth() -> Callable[..., BaseMotion]:
    """``smooth(amplitude, omega, ...)``: sines that rise smoothly, displacement and its derivatives in closed form."""

    def make(
        amplitude: Array,
        omega: Array,
        duration: float = 1.0,
        rate: float = 1024.0,
        point: Any = (0.0, 0.0, 0.0),
        rise: float = 0.3,
    ) -> BaseMotion:
        t = np.arange(round(rate * duration) + 1)[:, None] / rate
        s = (t / rise) ** 4
        envelope = [1 - np.exp(-s), 4 * t**3 / rise**4 * np.exp(-s), (12 * t**2 / rise**4 - 16 * t**6 / rise**8) * np.exp(-s)]
        A, w = np.asarray(amplitude), np.asarray(omega)
        sine = [A * np.sin(w * t), A * w * np.cos(w * t), -A * w**2 * np.sin(w * t)]
        return BaseMotion(
            sampling_rate=rate,
            displacement=sine[0] * envelope[0],
            velocity=sine[1] * envelope[0] + sine[0] * envelope[1],
            acceleration=sine[2] * envelope[0] + 2 * sine[1] * envelope[1] + sine[0] * envelope[2],
            driven=duration,
            reference_point=point,
        )

    return make


@pytest.fixture(scope="session")
def block() -> Callable[..., Structure]:
    """``block(nx, ny, nz)``: lattice of point masses 0.1 m apart, sprung to all 26 neighbours, the lowest layer held."""
    return cache(_block)


def _block(nx: int, ny: int, nz: int, stiffness: float = 1e6, mass: float = 0.1) -> Structure:
    places = np.stack(np.meshgrid(*(np.arange(n) for n in (nx, ny, nz)), indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(places)).reshape(nx, ny, nz)
    K = csr_array((3 * len(places), 3 * len(places)))
    for step in np.ndindex(3, 3, 3):
        d = np.array(step) - 1
        if tuple(d) <= (0, 0, 0):
            continue
        here = np.all((places + d >= 0) & (places + d < [nx, ny, nz]), axis=1)
        a = number.ravel()[here]
        b = number[tuple((places[here] + d).T)]
        rows = np.arange(len(a))
        lift = csr_array(
            (np.append(np.ones(len(a)), -np.ones(len(a))), (np.append(rows, rows), np.append(a, b))), (len(a), len(places))
        )
        along = csr_array(np.outer(d, d) / (d @ d) * stiffness)
        K = K + kron(lift.T @ lift, along)
    points = 0.1 * places
    dofs = np.arange(3 * len(places)).reshape(-1, 3)
    return Structure(
        stiffness=csr_array(K),
        mass=csr_array(mass * eye_array(3 * len(places))),
        rigid=rigid_motion(points).reshape(-1, 6, 6)[:, :3].reshape(-1, 6),
        held=dofs[places[:, 2] == 0].ravel(),
        points=points,
        translations=dofs,
    )
