"""The command line: one function a command, heavy imports inside it."""

import sys
from importlib.util import find_spec
from pathlib import Path

PACKAGES = ("geometry", "fem", "identification", "validation")
"""The names at the top level that are massline's."""


def shadowed() -> dict[str, str]:
    """Where packages lie that stand before massline's own of the same name on Python's path, by name."""
    own = Path(__file__).resolve().parents[2]
    found = {name: find_spec(name) for name in PACKAGES}
    where = {name: Path(spec.origin).resolve() if spec and spec.origin else Path("nowhere") for name, spec in found.items()}
    return {name: str(path) for name, path in where.items() if own not in path.parents}


if _others := shadowed():  # said before anything of them is imported: what follows would be an error that nobody understands
    _listed = "; ".join(f"{name} is {path}" for name, path in _others.items())
    sys.stderr.write(
        f"massline: another package bears a name of massline's and stands before it: {_listed}. Move or rename it, "
        "take its folder off PYTHONPATH, or start massline in an environment of its own.\n"
    )
    raise SystemExit(2)
