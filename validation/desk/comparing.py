"""The comparison of the model as it stands: worked out once, kept in the desk, and read again after a reload."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from geometry.atomic import write_text, write_with
from geometry.sensors import resultants
from identification.campaign import Campaign
from validation.comparing import as_json as written
from validation.comparing.comparison import Comparison
from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.comparing.pairs import Pairs
from validation.desk.desk import Desk, digest
from validation.desk.held_against import comparison as of_rung
from validation.desk.held_against import ground, rung
from validation.desk.recorded import DAMAGE
from validation.ladders.climbing import read_text
from validation.output import json_text

Progress = Callable[[str, float], None]

ARM = 0.01
"""Share of the largest by which a channel must take part in a load to tell it."""

SUMMARY, MAPS = "compare.json", "maps.npz"

TEXTS = ("data_set", "configuration", "runs", "axes", "rows", "channels", "remarks")
ARRAYS = tuple(one.name for one in fields(Map) if one.name not in (*TEXTS, "pairs"))
OF_PAIRS = tuple(one.name for one in fields(Pairs) if one.name != "campaign")


@dataclass(frozen=True, eq=False, kw_only=True)
class Compared:
    """What `massline compare` finds, as a window keeps it.

    Attributes
    ----------
    summary : the object of `massline compare --json`: "errors" [{"name", "figure", "meaning", "verdict", "text"}], "worst",
        "absurd_tolerances", "classical", "warnings", "plain_error_percent" ...
    maps : one a campaign, with its `pairs` (measured and predicted 6 x 6 dynamic mass)
    modes : by campaign, as the plain fit has them
    offsets : where the plain fit ended, by name of the parameter
    loads : by campaign, by force channel the loads (0 to 5) that it tells
    """

    summary: Mapping[str, Any]
    maps: tuple[Map, ...]
    modes: tuple[tuple[NamedMode, ...], ...]
    offsets: Mapping[str, float]
    loads: tuple[Mapping[str, tuple[int, ...]], ...]

    @property
    def campaigns(self) -> tuple[str, ...]:
        """Names of the data sets, in order."""
        return tuple(one.data_set for one in self.maps)

    def map(self, campaign: str) -> Map:
        """That of `campaign`.

        Raises
        ------
        KeyError : there is none of that name.
        """
        return self.maps[self._place(campaign)]

    def modes_of(self, campaign: str) -> tuple[NamedMode, ...]:
        """Those of the article of `campaign`; none of an FMD alone or of a rigid one.

        Raises
        ------
        KeyError : there is no campaign of that name.
        """
        return self.modes[self._place(campaign)]

    def loads_of(self, campaign: str, channel: str) -> tuple[int, ...]:
        """Those that a `channel` tells: of a force channel its own, of an acceleration all six.

        Raises
        ------
        KeyError : there is no campaign of that name.
        """
        return self.loads[self._place(campaign)].get(channel) or tuple(range(6))

    def _place(self, campaign: str) -> int:
        if campaign not in self.campaigns:
            raise KeyError(campaign)
        return self.campaigns.index(campaign)


def compared(of: Desk, progress: Progress | None = None) -> Compared:
    """The model of the desk held against its data, and kept; on a rung of the ladder without fitting anything anew.

    Takes from seconds to minutes: `validation.desk.jobs.start(desk, "compare")` does it in a worker.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : a fit that does not converge.
    OSError : a file cannot be read or written.
    """
    tell = progress or (lambda what, share: None)
    text = read_text(of.model)
    ready = ground(of, tell)
    found = of_rung(ready, rung(of, ready, tell), tell)
    folder = of.folder / "found" / digest(text)
    _write(found, [_loads(one.tested.campaign) for one in ready.made], folder)
    return _read(folder)


def comparison(of: Desk) -> Compared | None:
    """That of the model as it stands, if it was made; quick."""
    try:
        return _read(of.found)
    except DAMAGE:
        return None


def _loads(campaign: Campaign) -> dict[str, list[int]]:
    """By force channel the loads about F that it tells, but for arms of less than a per cent of the longest."""
    told = [campaign.table.channels[k] for k in campaign.table.select(quantity=("force", "moment"))]
    share = np.abs(resultants(told, campaign.table.origin))
    share /= np.maximum(share.max(axis=1, keepdims=True, initial=0.0), np.finfo(np.float64).tiny)
    return {one.name: np.flatnonzero(share[:, k] > ARM).tolist() for k, one in enumerate(told)}


def _write(found: Comparison, loads: Sequence[Mapping[str, Sequence[int]]], folder: Path) -> None:
    """Arrays first: where the summary is, all is."""
    arrays = {f"{k}.{name}": getattr(one, name) for k, one in enumerate(found.maps) for name in ARRAYS}
    for k, one in enumerate(found.maps):
        arrays |= {} if one.pairs is None else {f"{k}.pairs.{name}": getattr(one.pairs, name) for name in OF_PAIRS}
    words = {
        "maps": [{name: getattr(one, name) for name in TEXTS} for one in found.maps],
        "modes": [[vars(mode) for mode in of] for of in found.modes],
        "offsets": found.evaluation.plain_fit.by_name,
        "loads": loads,
    }
    arrays["words"] = np.frombuffer(json.dumps(words).encode(), dtype=np.uint8)
    write_with(folder / MAPS, lambda temporary: np.savez(temporary, allow_pickle=False, **arrays))
    write_text(folder / SUMMARY, json_text(written.as_json(found)))


def _read(folder: Path) -> Compared:
    summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    with (folder / MAPS).open("rb") as opened, np.load(opened, allow_pickle=False) as held:
        words = json.loads(held["words"].tobytes())
        maps = tuple(_map(said, held, k) for k, said in enumerate(words["maps"]))
    modes = tuple(tuple(NamedMode(**_tuples(mode)) for mode in each) for each in words["modes"])
    loads = tuple(_tuples(one) for one in words["loads"])
    return Compared(summary=summary, maps=maps, modes=modes, offsets=words["offsets"], loads=loads)


def _map(said: dict[str, Any], held: Any, k: int) -> Map:
    pairs = None
    if f"{k}.pairs.{OF_PAIRS[0]}" in held:
        pairs = Pairs(campaign=said["data_set"], **{name: held[f"{k}.pairs.{name}"] for name in OF_PAIRS})
    return Map(**_tuples(said), **{name: held[f"{k}.{name}"] for name in ARRAYS}, pairs=pairs)


def _tuples(said: dict[str, Any]) -> dict[str, Any]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in said.items()}
