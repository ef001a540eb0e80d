"""Exudyn at work: quiet, and in words when it fails.

Exudyn says most of what is wrong by raising errors of its own, SciPy's functions inside it raise theirs, and a solution may come
back as NaN without a word. All three leave here as `CheckFailed`, with what exudyn said and the version that said it.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.flexible_body.inertia import quiet
from fem.flexible_body.interruption import is_interruption
from geometry.arrays import Array
from geometry.errors import BadInput, CheckFailed


def exudyn_version() -> str:
    """Version of the installed exudyn, without importing it."""
    return version("exudyn")


@contextmanager
def running(task: str) -> Iterator[Any]:
    """The exudyn module, held back from standard output, while it does `task`.

    Raises
    ------
    CheckFailed : exudyn, or what it calls, failed; with what it said.
    KeyboardInterrupt : Ctrl-C, of which exudyn made an error of its own.
    """
    try:
        with quiet() as exudyn, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # SciPy tells exudyn's authors about storage formats
            yield exudyn
    except (BadInput, CheckFailed):
        raise
    except Exception as error:
        if is_interruption(error):
            raise KeyboardInterrupt from None
        said = " ".join(str(error).split("[Python file")[0].split()) or type(error).__name__
        raise failed(task, said) from error


def finite(value: npt.ArrayLike, task: str) -> Array:
    """`value` as an array.

    Raises
    ------
    CheckFailed : NaN or infinity in it, which is how exudyn says that a solver went wrong.
    """
    array = np.array(value, dtype=np.float64)
    if not np.all(np.isfinite(array)):
        raise failed(task, "its result holds NaN or infinity")
    return array


def failed(task: str, said: str) -> CheckFailed:
    """The failure of `task`, with what exudyn said."""
    return CheckFailed(f"exudyn {exudyn_version()} failed when it should {task}: {said}", task=task, said=said)
