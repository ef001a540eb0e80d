"""What every test may ask for: the repository's root, the folder of real measured data, a renderer."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def root() -> Path:
    """The repository."""
    return ROOT


@pytest.fixture(scope="session")
def shared(root: Path) -> Path:
    """The project's shared folder, beside the repository."""
    return _present(root.parent / "shared", "the shared folder beside the repository")


@pytest.fixture(scope="session")
def data(root: Path) -> Path:
    """Real measured data: `MASSLINE_DATA`, or ``../shared/data``."""
    return _present(Path(os.environ.get("MASSLINE_DATA", root.parent / "shared" / "data")), "MASSLINE_DATA or ../shared/data")


@pytest.fixture(scope="session")
def renderer() -> None:
    """Off-screen rendering; a machine without OpenGL says so and skips."""
    from geometry.errors import CheckFailed
    from validation.pictures.window import off_screen

    try:
        with off_screen():
            pass
    except CheckFailed as error:
        pytest.skip(str(error))


def _present(folder: Path, what: str) -> Path:
    if not folder.is_dir():
        pytest.skip(f"{what} is absent; data/README.md of the shared folder says where its sets come from")
    return folder
