"""Where truths and answers of a draw are kept: ``out/blind/CODE/SEED``, truths and answers each in a folder of their own.

`CODE` is a hash of all code that figures come from, so that those of other code are never mixed. What writes tables and pages
is not in it, nor are the faces in `FACES`: they change nothing that is kept, as two contracts of import make sure.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from benchmarks.blind.names import Json
from geometry.atomic import write_text

FOLDER = Path("out/blind")

ROOMS = (
    "geometry",
    "fem",
    "identification",
    "validation",
    "benchmarks/blind/drawing",
    "benchmarks/blind/structures",
)

FACES = ("validation/report", "validation/app", "validation/cli")
"""What shows results and makes none: a diagnosis that is asked as a function does not pass through them."""

KEPT_AS = ("validation/report/diagnose.py",)
"""In a face, and covered all the same: it writes the diagnosis as the JSON that is kept."""

ALSO = ("sealing.py", "answering.py", "running.py", "names.py", "../cross_check_proof.py", "drawing/limits.json")
"""Beside this file: what draws, seals and asks, and every size that is planted."""


@cache
def present_code() -> str:
    """The hash of the code as it is; the program must run where the code lies."""
    here = Path(__file__).parent
    files = (*hashed(Path()), *(here / name for name in ALSO))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:12]


def hashed(root: Path) -> list[Path]:
    """The files of the rooms under `root` that figures come from, sorted."""
    faces = [root / face for face in FACES]
    every = (path for room in ROOMS for path in (root / room).rglob("*") if path.suffix in {".py", ".toml"})
    kept = [root / name for name in KEPT_AS]
    return sorted(path for path in every if path in kept or not any(path.is_relative_to(face) for face in faces))


@dataclass(frozen=True, kw_only=True)
class Kept:
    """The results of one draw.

    Attributes
    ----------
    seed : of the draw
    code : that made them
    folder : of all results
    what : of what kind, if it is none of Clumod's series
    """

    seed: int
    code: str
    folder: Path = FOLDER
    what: str = ""

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
        return self.folder / self.code / f"{self.what}{self.seed}"

    def _file(self, what: str, name: str) -> Path:
        return self._place / what / f"{name}.json"

    def _read(self, what: str, name: str) -> Json:
        found: Json = json.loads(self._file(what, name).read_text(encoding="utf-8"))
        return found
