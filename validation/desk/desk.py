"""`Desk`: the folder in which one window works, and what it was asked. It survives a reload and a crash.

    desk.json            what was asked, and the face's own view of it
    work/model.toml      working copy of the model, with its ladder beside it
    given/               files that a browser handed over
    found/<model>/       comparison and diagnosis of a model, by the digest of its text
    spectra.npz          spectra of the data, made once
    job.json             what a worker does or did last

The user's own files are read and never changed; `validation.desk.saving` writes where the user says.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from geometry.atomic import write_text
from geometry.errors import BadInput
from identification.campaign import METHODS
from validation.comparing.asked import require_band
from validation.desk import moving
from validation.effects import catalogue
from validation.ladders.climbing import read_text
from validation.output import json_text

FORMAT = 1
STATE, VIEW = "desk.json", "view.json"
LARGEST_VIEW = 1_000_000
"""Characters of what a face may keep."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What a window was opened with.

    Attributes
    ----------
    model : path of the user's model file, absolute
    data : campaign folders and measurement files, absolute; names of shipped measurements as they are
    hold_out : runs, campaigns and files that are predicted and never fitted; empty for each run in turn
    band : (low, high) [Hz]; None for what all runs drive
    method : of `identification.campaign.METHODS`
    effects_from : folders of the user's own effects, absolute
    title : what the window shows above everything; not to be trusted as HTML
    """

    model: str
    data: tuple[str, ...]
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    method: str = METHODS[0]
    effects_from: tuple[str, ...] = ()
    title: str = ""


@dataclass(frozen=True, kw_only=True)
class Desk:
    """A folder with a model and data that are worked on.

    Attributes
    ----------
    folder : absolute
    asked : what it was begun with
    """

    folder: Path
    asked: Asked

    @property
    def model(self) -> Path:
        """The working copy of the model file."""
        return self.folder / "work" / "model.toml"

    @property
    def found(self) -> Path:
        """Folder of what was computed for the model as it stands now.

        Raises
        ------
        BadInput : the working copy is gone.
        """
        return self.folder / "found" / digest(read_text(self.model))

    @property
    def spectra(self) -> Path:
        """The file of the spectra."""
        return self.folder / "spectra.npz"

    @property
    def job(self) -> Path:
        """The file of the worker."""
        return self.folder / "job.json"


def digest(text: str) -> str:
    """By which what was computed for a model text is found again."""
    return sha256(text.encode()).hexdigest()[:16]


def begun(
    folder: str | Path,
    model: str | Path,
    data: Sequence[str | Path],
    *,
    hold_out: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    method: str = METHODS[0],
    effects_from: Sequence[str | Path] = (),
    title: str = "",
) -> Desk:
    """A desk in the new or empty `folder`, with a working copy of `model` and of the ladder beside it.

    Data are not read here; `validation.desk.faults.faults` says what is wrong with them.

    Raises
    ------
    BadInput : `folder` holds something already, a model or ladder that cannot be read, a band that is none.
    OSError : the folder cannot be written.
    """
    where = Path(folder).resolve()
    if where.exists() and (not where.is_dir() or any(one.name != "given" for one in where.iterdir())):
        raise BadInput(source=str(folder), problem="it is there already and not empty", remedy="Name a new folder for the desk")
    require_band(band)
    _require_method(method)
    asked = Asked(
        model=str(Path(model).resolve()),
        data=tuple(_absolute(path) for path in data),
        hold_out=tuple(_absolute(name) if _is_among(name, data) else name for name in hold_out),
        band=None if band is None else (float(band[0]), float(band[1])),
        method=method,
        effects_from=tuple(str(Path(one).resolve()) for one in effects_from),
        title=title,
    )
    made = Desk(folder=where, asked=asked)
    _load_effects(asked)
    moving.copied(Path(asked.model), made.model)
    write_text(where / STATE, json_text({"format": FORMAT, "kind": "massline desk", **_as_json(asked)}))
    return made


def opened(folder: str | Path) -> Desk:
    """The desk in `folder`, as it was left.

    Raises
    ------
    BadInput : there is none, or another program's, or it is damaged.
    OSError : it cannot be read.
    """
    where = Path(folder).resolve()
    state = _read(where / STATE)
    if state.get("kind") != "massline desk" or state.get("format") != FORMAT:
        raise _damaged(where, "its desk.json is none of this program's")
    try:
        asked = _asked(state)
    except (KeyError, TypeError, ValueError) as error:
        raise _damaged(where, f"its desk.json lacks or misstates {error}") from None
    _load_effects(asked)
    read_text(where / "work" / "model.toml")
    return Desk(folder=where, asked=asked)


def is_desk(folder: str | Path) -> bool:
    """Whether a desk was begun there."""
    return (Path(folder) / STATE).is_file()


def view(of: Desk) -> dict[str, Any]:
    """What the face kept: the entry shown, the effect chosen and the like; empty where nothing was, or where it is damaged."""
    try:
        return _read(of.folder / VIEW)
    except BadInput:
        return {}


def keep_view(of: Desk, kept: dict[str, Any]) -> None:
    """Keep `kept` (JSON values) for the next reload.

    Raises
    ------
    ValueError : it is no JSON, or more than a view can be.
    OSError : it cannot be written.
    """
    text = json_text(kept)
    if len(text) > LARGEST_VIEW:
        raise ValueError(f"`kept` must be a view, at most {LARGEST_VIEW} characters, found {len(text)}")
    write_text(of.folder / VIEW, text)


def _absolute(path: str | Path) -> str:
    """Of what is there; names of shipped measurements stay names."""
    return str(Path(path).resolve()) if Path(path).exists() else str(path)


def _is_among(name: str, data: Sequence[str | Path]) -> bool:
    """Whether `name` is a path of the `data`, not that of a run beside which some file of that name happens to lie."""
    return Path(name).exists() and Path(name).resolve() in {Path(one).resolve() for one in data}


def _load_effects(asked: Asked) -> None:
    for folder in asked.effects_from:
        catalogue.load(folder)


def _require_method(method: str) -> None:
    if method not in METHODS:
        raise BadInput(source="method", problem=f"no method is called {method!r}", remedy=f"Known are {', '.join(METHODS)}")


def _as_json(asked: Asked) -> dict[str, Any]:
    return {
        "model": asked.model,
        "data": list(asked.data),
        "hold_out": list(asked.hold_out),
        "band_hz": None if asked.band is None else list(asked.band),
        "method": asked.method,
        "effects_from": list(asked.effects_from),
        "title": asked.title,
    }


def _asked(state: dict[str, Any]) -> Asked:
    band = state["band_hz"]
    return Asked(
        model=str(state["model"]),
        data=tuple(map(str, state["data"])),
        hold_out=tuple(map(str, state["hold_out"])),
        band=None if band is None else (float(band[0]), float(band[1])),
        method=str(state["method"]),
        effects_from=tuple(map(str, state["effects_from"])),
        title=str(state["title"]),
    )


def _read(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise BadInput(
            source=str(path.parent), problem="there is no desk here", remedy="Begin one with a model and data"
        ) from None
    except (ValueError, RecursionError):
        raise _damaged(path.parent, f"its {path.name} cannot be read") from None
    if not isinstance(found, dict):
        raise _damaged(path.parent, f"its {path.name} holds no object")
    return found


def _damaged(folder: Path, problem: str) -> BadInput:
    return BadInput(source=str(folder), problem=problem, remedy="Begin a new desk; the user's own files were never changed")
