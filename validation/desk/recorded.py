"""The data of a desk ready for any model: spectra are made once and kept, so that a window is quickly there again.

``spectra.npz`` holds arrays and one JSON text, never a pickle, and the sizes and times of the files that it was made from; where
one of these has changed, or the file is damaged, spectra are made again.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from geometry.atomic import write_with
from identification import campaign_file
from validation.comparing.gathered import Data, gathered
from validation.desk.desk import Desk
from validation.engine.measured import Measured
from validation.models import reading
from validation.models.model import Model
from validation.prediction.amplitude import Drive
from validation.prediction.measured import names
from validation.prediction.series import SeriesPrediction, Tested, carried, predictions
from validation.prediction.set_up import standing

Progress = Callable[[str, float], None]

FORMAT = 2
DAMAGE = (OSError, EOFError, ValueError, KeyError, TypeError, BadZipFile, zlib.error)
"""What a file of arrays raises that is not there, not whole, or of another version."""

DRIVE = ("amplitude", "nominal", "sweep_rate", "block")


def model_of(of: Desk) -> Model:
    """The working copy, read.

    Raises
    ------
    BadInput, OSError : see `validation.models.reading.read`.
    """
    return reading.read(of.model)


def data_of(of: Desk, model: Model, progress: Progress | None = None) -> Data:
    """The data with their recordings.

    Raises
    ------
    BadInput, OSError : see `validation.comparing.gathered.gathered`.
    """
    return gathered(of.asked.data, model, progress)


def campaigns(of: Desk) -> dict[str, str]:
    """Folders of the campaigns by the names that the data sets have, in their order.

    Raises
    ------
    BadInput : one of them is no campaign any more.
    """
    folders = [path for path in of.asked.data if Path(path).is_dir()]
    return dict(zip(names([campaign_file.read_description(path) for path in folders]), folders, strict=True))


def made(of: Desk, model: Model, progress: Progress | None = None) -> tuple[SeriesPrediction, ...]:
    """A prediction of every campaign of the desk by `model`, from spectra that were kept where they still hold.

    Raises
    ------
    BadInput, OSError : see `data_of`.
    """
    tell = progress or (lambda what, share: None)
    with suppress(*DAMAGE):
        return _kept(of, model)
    data = data_of(of, model, tell)
    found = predictions(
        model,
        data.campaigns,
        band=of.asked.band,
        method=of.asked.method,
        progress=lambda share: tell("spectra", share),
    )
    keep(of, found)
    return found


def keep(of: Desk, found: Sequence[SeriesPrediction]) -> None:
    """Keep the spectra of `found` for the next time."""
    head = {"format": FORMAT, "asked": _stamp(of), "campaigns": [_head(one.tested) for one in found]}
    arrays = {f"{k}.{name}": value for k, one in enumerate(found) for name, value in _arrays(one.tested).items()}
    arrays["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    write_with(of.spectra, lambda temporary: np.savez(temporary, allow_pickle=False, **arrays))


def _kept(desk: Desk, model: Model) -> tuple[SeriesPrediction, ...]:
    """From the file; ValueError and the like where there is none that holds."""
    with desk.spectra.open("rb") as opened, np.load(opened, allow_pickle=False) as held:
        head = json.loads(held["head"].tobytes())
        if head["format"] != FORMAT or head["asked"] != _stamp(desk):
            raise ValueError("made from other data")
        parts = [
            {name: held[f"{k}.{name}"] for name in (*said["arrays"], *DRIVE, "per_rms")}
            for k, said in enumerate(head["campaigns"])
        ]
    tested = [_tested(model, said, arrays) for said, arrays in zip(head["campaigns"], parts, strict=True)]
    return tuple(SeriesPrediction(tested=one, effects=model.effects) for one in tested)


def _tested(model: Model, said: dict[str, Any], arrays: dict[str, Any]) -> Tested:
    campaign = campaign_file.read_description(said["source"])
    stands = standing(model, campaign)
    words: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in said["words"].items()}
    drives = zip(*(arrays[name] for name in DRIVE), strict=True)
    return Tested(
        model=model,
        campaign=replace(campaign, warnings=tuple(said["warnings"])),
        measured=Measured(**words, **{name: arrays[name] for name in said["arrays"]}),
        carried=carried(model, campaign, stands),
        drives=tuple(Drive(amplitude=a, nominal=n, sweep_rate=float(r), block=float(b)) for a, n, r, b in drives),
        per_rms=arrays["per_rms"],
        method=said["method"],
        remarks=tuple(said["remarks"]),
    )


def _head(of: Tested) -> dict[str, Any]:
    """What is no array; of the spectra every field that there is, whatever is added to them."""
    words, arrays = _told(of.measured)
    return {
        "source": of.campaign.source,
        "warnings": list(of.campaign.warnings),
        "method": of.method,
        "remarks": list(of.remarks),
        "words": words,
        "arrays": list(arrays),
    }


def _arrays(of: Tested) -> dict[str, Any]:
    drives = {name: np.array([getattr(one, name) for one in of.drives]) for name in DRIVE}
    return {**_told(of.measured)[1], **drives, "per_rms": of.per_rms}


def _told(measured: Measured) -> tuple[dict[str, Any], dict[str, Any]]:
    """Fields that JSON can hold, and arrays."""
    every = {one.name: getattr(measured, one.name) for one in fields(measured)}
    arrays = {name: value for name, value in every.items() if isinstance(value, np.ndarray)}
    return {name: value for name, value in every.items() if name not in arrays}, arrays


def _stamp(of: Desk) -> list[Any]:
    """What spectra depend on: the data by size and time of change, how they are made."""
    asked = of.asked
    files = [_files(Path(path)) for path in asked.data]
    return [list(asked.data), None if asked.band is None else list(asked.band), asked.method, files]


def _files(path: Path) -> list[list[Any]]:
    every = sorted(path.rglob("*")) if path.is_dir() else [path]
    seen = [(one, one.stat()) for one in every if one.is_file()]
    return [[one.name, found.st_size, found.st_mtime_ns] for one, found in seen]
