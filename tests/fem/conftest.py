"""What the tests of users' models share: the bracket of the example, in its files and as arrays that can be spoilt."""

import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest


@pytest.fixture(scope="session")
def own_model(root: Path) -> dict[str, Any]:
    """The names in ``examples/own_model.py``."""
    return runpy.run_path(str(root / "examples" / "own_model.py"))


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
