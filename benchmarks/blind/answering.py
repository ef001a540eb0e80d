"""The diagnosis of one folder, in a process of its own: ``python -m benchmarks.blind.answering FOLDER``.

It is handed the folder and nothing else, and writes `ANSWER` into it. A diagnosis that refuses is an answer, too; so is one that
breaks down, with what was left of it.
"""

from __future__ import annotations

import json
import sys
import time
import traceback
from pathlib import Path

from benchmarks.blind.names import ANSWER, MODEL, SETTINGS, Json
from geometry.atomic import write_text
from geometry.errors import BadInput, CheckFailed
from validation.study import Study

PARAMETERS = "parameters"
"""Of fits: hundreds of figures that no score asks for."""


def answered(folder: Path) -> Json:
    """What the diagnosis says of `folder`, how long it took, and how long reading took; refusals and breakdowns in words."""
    try:
        return _answered(folder)
    except (BadInput, CheckFailed) as error:
        return {"refused": f"{type(error).__name__}: {error}"}
    except Exception:
        return {"broken": traceback.format_exc()}


def _answered(folder: Path) -> Json:
    from validation.diagnose.diagnose import diagnosed
    from validation.output import to_json

    asked: Json = json.loads((folder / SETTINGS).read_text(encoding="utf-8"))
    began = time.process_time()
    ready = Study.open(folder / MODEL, [folder / name for name in asked["data"]], hold_out=tuple(asked["hold_out"]))
    read = time.process_time()
    found = diagnosed(ready, leave_out=tuple(asked["leave_out"]))
    return {
        **without(to_json(found), PARAMETERS),
        "seconds": {"reading": read - began, "diagnosis": time.process_time() - read},
    }


def without(content: Json, key: str) -> Json:
    """`content` without `key`, wherever it stands."""
    kept = {name: value for name, value in content.items() if name != key}
    return {name: without(value, key) if isinstance(value, dict) else value for name, value in kept.items()}


def main(folder: str) -> int:
    """Write the answer into `folder`."""
    write_text(Path(folder) / ANSWER, json.dumps(answered(Path(folder))))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
