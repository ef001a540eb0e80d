"""Up, down and aside on a ladder: which rung a model file stands on, keeping one, and going to another.

A model file and its ladder are two files, and no system writes two at once. So the ladder does not say where the model stands:
the text of the model does. It stands on the rung with that very text, and only among rungs of the same text the ladder's own word
counts. Wherever an interruption falls, both agree: a rung is in the ladder before the model file shows it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from platform import python_version

from geometry.atomic import write_with
from geometry.errors import BadInput
from validation.ladders import file
from validation.ladders.locking import locked
from validation.ladders.nouns import EDITED, START, Ladder, Rung

PROGRAMS = ("massline", "numpy", "scipy")
"""Whose versions stand in a rung."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Standing:
    """A model file and its ladder.

    Attributes
    ----------
    path : the model file
    text : what it holds
    ladder : beside it; without rungs where there is none yet
    rung : on which it stands; None before there is one, and where the file was edited by hand since
    """

    path: Path
    text: str
    ladder: Ladder
    rung: Rung | None

    @property
    def edited(self) -> bool:
        """Whether somebody changed the file since its last rung."""
        return self.rung is None and bool(self.ladder.rungs)

    @property
    def below(self) -> Rung | None:
        """The rung on which it stands, or from which it was edited."""
        if self.rung is not None or self.ladder.current is None:
            return self.rung
        return self.ladder.rung(self.ladder.current)


def standing(path: Path) -> Standing:
    """Where the model file `path` stands.

    Raises
    ------
    BadInput : there is no such file, it is no text, or its ladder cannot be read (see `validation.ladders.file.read`).
    OSError : one of them cannot be read.
    """
    text, beside = read_text(path), file.beside(path)
    ladder = file.read(beside) if beside.exists() else Ladder()
    return Standing(path=path, text=text, ladder=ladder, rung=ladder.of_text(text))


def read_text(path: Path) -> str:
    """What the file `path` holds, ends of lines as they are.

    Raises
    ------
    BadInput : no such file, a folder, or not UTF-8.
    """
    remedy = "Name a model file; `massline model ARTICLE` writes one to start from"
    if not path.is_file():
        problem = "this is a folder" if path.is_dir() else "there is no such file"
        raise BadInput(source=str(path), problem=problem, remedy=remedy)
    try:
        return path.read_bytes().decode("utf-8")
    except UnicodeDecodeError:
        raise BadInput(source=str(path), problem="it is not text in UTF-8", remedy=remedy) from None


def next_rung(at: Standing) -> Rung:
    """The rung, still without figures, that the model of `at` is as it stands: the first, or one that was edited by hand."""
    below = at.below
    if at.rung is not None and at.rung.errors is None:
        return at.rung
    parent = None if below is None else below.number
    return Rung(number=len(at.ladder.rungs), parent=parent, cause=EDITED if at.edited else START, model=at.text)


def kept(at: Standing, rung: Rung) -> Standing:
    """`at` with `rung` on its ladder, written at once, and standing on it where it is the model as it is; no other file changes.

    A rung that waits for its figures gets them, and one that is there already is not made twice. Whatever other rungs were made
    meanwhile stay, and `rung` is numbered after them.

    Raises
    ------
    BadInput, OSError : see `standing`; the ladder cannot be written.
    """
    with locked(at.path):
        return _kept(at, rung)[0]


def _kept(at: Standing, rung: Rung) -> tuple[Standing, int]:
    """As `kept`, the ladder being ours alone, and the number of the rung."""
    now = standing(at.path).ladder
    one = _numbered(now, stamped(rung))
    rungs = [*now.rungs]
    rungs[one.number : one.number + 1] = [one]
    here = one.model == at.text
    ladder = Ladder(rungs=tuple(rungs), current=one.number if here or now.current is None else now.current)
    file.write(file.beside(at.path), ladder, at.path.name)
    return replace(at, ladder=ladder, rung=one if here else at.rung), one.number


def _numbered(now: Ladder, rung: Rung) -> Rung:
    """`rung` in the place that waits for it, or as it is there already, or behind all others."""
    if rung.number < len(now.rungs) and _is_waiting(now.rung(rung.number), rung):
        return rung
    there = next((one for one in now.rungs if _is_same(one, rung)), None)
    return there or replace(rung, number=len(now.rungs))


def _is_same(there: Rung, rung: Rung) -> bool:
    """Whether another process made the very rung: the same step to the same model, on the same data, by the same programs."""
    step = ("parent", "cause", "effect", "model", "versions", "verdict")
    return (
        rung.stands_on(there.conditions)
        and there.errors is not None
        and all(getattr(there, name) == getattr(rung, name) for name in step)
    )


def _is_waiting(there: Rung, rung: Rung) -> bool:
    return there.errors is None and there.model == rung.model and there.parent == rung.parent


def stamped(rung: Rung) -> Rung:
    """`rung` with the time and the versions of the programs, where it has none."""
    if rung.when:
        return rung
    versions = {"python": python_version(), **{name: version(name) for name in PROGRAMS}}
    return replace(rung, when=datetime.now(UTC).isoformat(timespec="seconds"), versions=versions)


def climbed(at: Standing, rung: Rung) -> Standing:
    """`at` on the new `rung`: on its ladder first, then in its model file.

    A model file that somebody edited since `at` was read is left alone; the rung is kept all the same, to go to.

    Raises
    ------
    BadInput, OSError : see `kept`.
    """
    with locked(at.path):
        there, number = _kept(at, rung)
        untouched = read_text(at.path) == at.text
        return _gone_to(there, number) if untouched else standing(at.path)


def gone_to(at: Standing, number: int) -> Standing:
    """`at` on the rung with `number`, its model file byte by byte; a text that was on no rung becomes one first.

    Raises
    ------
    BadInput : there is no such rung, or no ladder.
    OSError : a file cannot be written.
    """
    with locked(at.path):
        return _gone_to(at, number)


def _gone_to(at: Standing, number: int) -> Standing:
    """As `gone_to`, the ladder being ours alone; rungs that others made since `at` was read stay."""
    _require_rungs(at)
    at = replace(at, ladder=standing(at.path).ladder)
    if not 0 <= number < len(at.ladder.rungs):
        numbers = f"0 to {len(at.ladder.rungs) - 1}" if len(at.ladder.rungs) > 1 else "0"
        raise BadInput(source=str(file.beside(at.path)), problem=f"there is no rung {number}", remedy=f"It has {numbers}")
    if at.edited:
        at, _ = _kept(at, next_rung(at))
    ladder = replace(at.ladder, current=number)
    file.write(file.beside(at.path), ladder, at.path.name)
    rung = ladder.rung(number)
    if rung.model != at.text:
        _write_model(at.path, rung.model)
    return replace(at, ladder=ladder, text=rung.model, rung=rung)


def undone(at: Standing) -> Standing:
    """`at` on the parent of its rung; one that was edited by hand, on the rung that it was edited from.

    Raises
    ------
    BadInput : there is no ladder, or nothing below.
    OSError : a file cannot be written.
    """
    _require_rungs(at)
    if at.rung is None:
        return gone_to(at, at.below.number if at.below is not None else 0)
    if at.rung.parent is None:
        problem = f"it stands on rung {at.rung.number}, the first; there is nothing to undo"
        raise BadInput(source=str(at.path), problem=problem, remedy="`massline ladder MODEL --go RUNG` goes to any other")
    return gone_to(at, at.rung.parent)


def _require_rungs(at: Standing) -> None:
    if not at.ladder.rungs:
        problem = f"it has no ladder: there is no {file.beside(at.path).name} beside it"
        raise BadInput(source=str(at.path), problem=problem, remedy="`massline add MODEL EFFECT DATA ...` makes one")


def _write_model(path: Path, text: str) -> None:
    write_with(path, lambda temporary: temporary.write_bytes(text.encode("utf-8")))
