"""Pictures need OpenGL: on a machine without it the tests of pictures say so and are skipped."""

import pytest

from geometry.errors import CheckFailed


@pytest.fixture(scope="session")
def renderer() -> None:
    """Off-screen rendering works here."""
    from validation.pictures.window import off_screen

    try:
        with off_screen():
            pass
    except CheckFailed as error:
        pytest.skip(str(error))
