"""A user's own effects: a folder of small files, each with a `FAMILY`, read without a trace in the folder.

What a user's code does wrong is said in words, with the line of the user's file that did it - when the file is read and whenever
its equation is asked.
"""

from __future__ import annotations

import sys
import tokenize
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import fields, is_dataclass, replace
from functools import wraps
from hashlib import sha256
from linecache import getline
from pathlib import Path
from traceback import extract_tb
from types import ModuleType
from typing import Any

from geometry.errors import BadInput
from validation.effects.family import Family


def files(directory: Path) -> tuple[Path, ...]:
    """The files of effects in `directory`, by name; what begins with an underscore is none.

    Raises
    ------
    BadInput : no such folder, or no file in it.
    """
    if not directory.is_dir():
        problem = "it is a file" if directory.exists() else "there is no such folder"
        raise BadInput(source=str(directory), field="--effects-from", problem=problem, remedy="Name a folder of effects")
    found = tuple(sorted(path.resolve() for path in directory.glob("*.py") if not path.name.startswith("_")))
    if not found:
        problem = "it holds no file of an effect, *.py"
        remedy = "Write one: docs/effects.md shows how, examples/effects holds two"
        raise BadInput(source=str(directory), field="--effects-from", problem=problem, remedy=remedy)
    return found


def family(path: Path) -> Family:
    """The `FAMILY` of the file at `path`, whose code runs once; its equation and plant answer in words when they fail.

    Raises
    ------
    BadInput : it is no Python, it fails, or it holds no `Family` of that name.
    """
    module = _executed(path)
    if not hasattr(module, "FAMILY"):
        raise BadInput(source=str(path), field="FAMILY", problem="is missing", remedy="Write FAMILY = Family(name=..., ...)")
    return of(module.FAMILY, str(path))


def of(value: object, file: str) -> Family:
    """`value`, which must be a family, with the functions of `file` guarded.

    Raises
    ------
    BadInput : it is something else.
    """
    if not isinstance(value, Family):
        problem = f"must be a validation.effects.family.Family, found {type(value).__name__}"
        raise BadInput(source=file, field="FAMILY", problem=problem, remedy="Write FAMILY = Family(name=..., ...)")
    change = value.change if value.change is None else guarded(value.change, file, "change")
    plant = value.plant if value.plant is None else _guarded_plant(value.plant, file)
    return replace(value, change=change, plant=plant)


def guarded(function: Callable[..., Any], file: str, what: str) -> Callable[..., Any]:
    """`function` of the user's `file`, whose errors become words; `what` is the field that holds it."""

    @wraps(function)
    def call(*arguments: Any) -> Any:
        try:
            return function(*arguments)
        except BadInput:
            raise
        except Exception as error:
            raise in_words(error, file, what) from None

    return call


def in_words(error: BaseException, file: str, what: str) -> BadInput:
    """`error` that code of `file` raised, with the line where it happened."""
    said = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    line = _line(error, file)
    number = f"line {line}, `{getline(file, line).strip()}`, " if line else ""
    return BadInput(source=file, field=what, problem=f"{number}raised {said}", remedy="Correct the file")


def _line(error: BaseException, file: str) -> int:
    if isinstance(error, SyntaxError) and error.filename == file:
        return error.lineno or 0
    return next((one.lineno or 0 for one in reversed(extract_tb(error.__traceback__)) if one.filename == file), 0)


def _guarded_plant(plant: Callable[[Any], Any], file: str) -> Callable[[Any], Any]:
    planted = guarded(plant, file, "plant")

    def call(named: Any) -> Any:
        effect = planted(named)
        if not is_dataclass(effect) or isinstance(effect, type):
            problem = f"must return an Effect of validation.virtual_test.hooks, found {type(effect).__name__}"
            raise BadInput(source=file, field="plant", problem=problem, remedy="Write plant=at(...) of validation.effects.plants")
        made = {one.name: getattr(effect, one.name) for one in fields(effect)}
        return replace(effect, **{name: guarded(one, file, "plant") for name, one in made.items() if callable(one)})

    return call


def _executed(path: Path) -> ModuleType:
    """The module at `path`. Compiled here, since an import would leave its cache in the folder."""
    file = str(path)
    name = f"massline_effect_{sha256(file.encode()).hexdigest()[:12]}"
    module = ModuleType(name)
    module.__file__ = file
    sys.modules[name] = module
    try:
        with tokenize.open(file) as source:
            code = compile(source.read(), file, "exec", dont_inherit=True)
        with redirect_stdout(sys.stderr):  # standard output belongs to the command
            exec(code, module.__dict__)
    except OSError:
        del sys.modules[name]
        raise
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise in_words(error, file, "") from None
    return module
