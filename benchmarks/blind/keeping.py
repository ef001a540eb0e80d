"""Where truths and answers of a draw are kept: ``out/blind/CODE/SEED``, truths and answers each in a folder of their own.

`CODE` is a hash of all code that figures come from, so that those of other code are never mixed in. What writes tables and pages
is not in it: it changes nothing that is kept.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from benchmarks.blind.names import Json
from benchmarks.identification_bars import code
from geometry.atomic import write_text

FOLDER = Path("out/blind")

ROOMS = (
    "geometry",
    "fem",
    "identification",
    "validation",
    "benchmarks/blind/drawing",
)

ALSO = ("sealing.py", "answering.py", "running.py", "names.py", "../cross_check_proof.py", "drawing/limits.json")
"""Beside this file: what draws, seals and asks, and every size that is planted."""


@cache
def present_code() -> str:
    """The hash of the code as it is; the program must run where the code lies."""
    here = Path(__file__).parent
    also = b"".join((here / name).read_bytes() for name in ALSO)
    return hashlib.sha256(code(ROOMS).encode() + also).hexdigest()[:12]


@dataclass(frozen=True, kw_only=True)
class Kept:
    """The results of one draw.

    Attributes
    ----------
    seed : of the draw
    code : that made them
    folder : of all results
    """

    seed: int
    code: str
    folder: Path = FOLDER

    def keep_truth(self, name: str, truth: Json) -> None:
        """Of the case `name`."""
        write_text(self._file("truths", name), json.dumps(truth))

    def keep_answer(self, name: str, answer: Json) -> None:
        """Of the case `name`, which is finished then."""
        write_text(self._file("answers", name), json.dumps(answer))

    def finished(self, name: str) -> bool:
        """Whether there is an answer."""
        return self._file("answers", name).exists()

    def pairs(self) -> list[tuple[Json, Json]]:
        """Truth and answer of all that are finished, in the order of their names."""
        return [self.pair(path.stem) for path in sorted((self._place / "answers").glob("*.json"))]

    def pair(self, name: str) -> tuple[Json, Json]:
        """Truth and answer of the case `name`, which is finished."""
        return self._read("truths", name), self._read("answers", name)

    @property
    def _place(self) -> Path:
        return self.folder / self.code / f"{self.seed}"

    def _file(self, what: str, name: str) -> Path:
        return self._place / what / f"{name}.json"

    def _read(self, what: str, name: str) -> Json:
        found: Json = json.loads(self._file(what, name).read_text(encoding="utf-8"))
        return found
