"""Processes of their own that need not import the libraries: this one has, and forks for whoever asks.

    python apart.py

A line of JSON on standard input is a program (`program`), its `arguments`, folder (`cwd`), environment (`env`) and standard
`input`; the line that is answered holds how it ended (`code`, as `subprocess` says it) and what it printed (`out`, `err`).
Modules are as they were imported, nothing of massline has run yet, and whatever a program does to them ends with it.
"""

import atexit
import gc
import json
import os
import sys
import tempfile
import traceback
from typing import Any

LIBRARIES = (
    "massline",
    "cadquery",
    "h5py",
    "igl",
    "manifold3d",
    "matplotlib.pyplot",
    "pinocchio",
    "plotly.graph_objects",
    "trimesh",
)


def main() -> None:
    gc.disable()
    for name in LIBRARIES:
        __import__(name)
    gc.freeze()
    gc.enable()
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as answers:
        os.dup2(2, 1)
        for line in sys.stdin:
            answers.write(json.dumps(answered(json.loads(line))) + "\n")
            answers.flush()


def answered(asked: dict[str, Any]) -> dict[str, Any]:
    """By a fork, how it ended and what it printed."""
    with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        given.write(asked["input"].encode())
        given.flush()
        child = os.fork()
        if not child:
            code = 70
            try:
                for number, file in enumerate((given, out, err)):
                    os.lseek(file.fileno(), 0, os.SEEK_SET)
                    os.dup2(file.fileno(), number)
                code = ended(asked)
            finally:
                os._exit(code)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = {}
        for name, file in (("out", out), ("err", err)):
            file.seek(0)
            texts[name] = file.read().decode()
    return {"code": code, **texts}


def ended(asked: dict[str, Any]) -> int:
    """Run the program, and end as Python ends: exit code, what is left to be done, what is left to be written."""
    os.environ.clear()
    os.environ.update(asked["env"])
    os.chdir(asked["cwd"])
    sys.stdin = os.fdopen(0, encoding="utf-8", closefd=False)
    sys.argv = ["-c", *asked["arguments"]]
    code = 0
    try:
        exec(compile(asked["program"], "<string>", "exec"), {"__name__": "__main__"})
    except SystemExit as left:
        code = left.code if isinstance(left.code, int) else int(left.code is not None)
        if isinstance(left.code, str):
            sys.stderr.write(left.code + "\n")
    except BaseException:
        traceback.print_exc()
        code = 1
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    return code


if __name__ == "__main__":
    main()
