"""The command `massline`, in a module of its own: a foreign package `validation` that stands before ours is told in words."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path


def main() -> None:
    """Run the command line, or say which `validation` hides it; `validation.cli` looks for the other three names.

    Small matrices are many, and threads that wait for each other cost more than they save: there is one, unless the user asks
    for more.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read once, by NumPy as it is imported
    spec, own = find_spec("validation"), Path(__file__).resolve().parent / "validation"
    where = Path(spec.origin).resolve() if spec is not None and spec.origin is not None else None
    if where is None or where.parent != own:
        said = where or (list(spec.submodule_search_locations or ()) if spec is not None else "nowhere")
        sys.stderr.write(
            f"massline: another package bears a name of massline's and stands before it: validation is {said}. "
            "Move or rename it, take its folder off PYTHONPATH, or start massline in an environment of its own.\n"
        )
        raise SystemExit(2)
    from validation.cli.main import main as run

    run()
