"""A model file to start from: an article as it is drawn, in an ordinary laboratory, with nothing added."""

from __future__ import annotations

from pathlib import Path

from geometry import toml_file
from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.tolerances import Tolerances
from geometry.user_article.description import DESCRIPTION
from validation.article_reference import is_file, is_stack
from validation.identifying.known import FMD, above_fmd
from validation.models import reading
from validation.models.model import Model


def draft(article: str, out: Path | None = None) -> Model:
    """The model to start from for `article`, which is to be written to the file `out`.

    `article` is a built-in stack on the FMD; a file with a model or a drawing of the user's own, which is put on the FMD; or a
    model file, which is written anew.

    Raises
    ------
    BadInput : no such article, one that does not stand on the FMD, a file that is neither.
    OSError : a file cannot be read.
    """
    if _is_model_file(article):
        return reading.read(article)
    if is_stack(article) or not _is_own(article):
        built_in(article)
        _require_on_fmd(article)
        return _ordinary(article, f"{above_fmd(article) or FMD} on the FMD" if article != FMD else "the FMD alone", out, {})
    path = _usable(article)
    name = path.parent.resolve().name if path.name == DESCRIPTION else path.stem
    return _ordinary(f"{FMD}+{name}", f"{name} on the FMD", out, {f"{FMD}+{name}": str(path)})


def _ordinary(article: str, title: str, out: Path | None, own: dict[str, str]) -> Model:
    fmd_tolerance = Tolerances().fmd_inertia
    return Model(source=str(out or "model.toml"), title=title, article=article, fmd_tolerance=fmd_tolerance, own=own)


def _is_model_file(name: str) -> bool:
    path = Path(name)
    if path.suffix.lower() not in (".toml", ".json") or not path.is_file():
        return False
    try:
        return "model" in toml_file.read(path)
    except BadInput:
        return path.name != DESCRIPTION  # `reading` says what is wrong with it


def _is_own(name: str) -> bool:
    from fem.users_model.reading import is_model

    return is_file(name) or is_model(name)


def _usable(name: str) -> Path:
    from fem.users_model.reading import is_model
    from geometry.user_article import require_file

    if is_model(name):
        if not Path(name).is_file():
            raise BadInput(source=name, problem="there is no such file", remedy="Check the path")
        return Path(name)
    return require_file(name)


def _require_on_fmd(article: str) -> None:
    if article.split("+")[0] != FMD:
        problem = "a model file describes what stands on the FMD, which must be the lowest of the stack"
        raise BadInput(source=f"article {article}", problem=problem, remedy=f"Name {FMD}+{article}")
