"""A user's own article behind its path: an FE model as its file has it, or a drawing, of which a solid model is made."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from fem.users_model.reading import UsersModel, is_model, load
from geometry.inertia import Inertia


@lru_cache(maxsize=8)
def users_model(path: str, stamp: int) -> UsersModel:
    """The model in the file `path`, or a solid one of the article that is drawn there; `stamp` tells a file from a newer one.

    Raises
    ------
    BadInput : whatever is wrong with it; a drawing whose bodies state no material in an ``article.toml``.
    """
    if is_model(path):
        return load(path)
    from fem.solid import model
    from geometry import user_article

    drawn = user_article.load(path, unit=None, material=None)
    return UsersModel(name=drawn.name, model=model.structure(drawn))


def inertia(path: str, stamp: int) -> Inertia:
    """Inertia about its own origin: of a drawing without meshing it for a solid model.

    Raises
    ------
    BadInput : see `users_model`.
    """
    if is_model(path):
        found = users_model(path, stamp).model
        return Inertia.from_mass_matrix(found.rigid_mass, found.reference_point).about(np.zeros(3))
    from geometry import user_article

    return next(iter(user_article.inertias(user_article.load(path, unit=None, material=None)).values())).about(np.zeros(3))


def stamp(path: str) -> int:
    """When the file `path`, or of a folder the newest file in it, was last written [ns]; 0 where there is none."""
    there = Path(path)
    files = [there] if there.is_file() else list(there.iterdir()) if path and there.is_dir() else []
    return max((one.stat().st_mtime_ns for one in files), default=0)
