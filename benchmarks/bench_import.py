"""What a fresh process pays before it does anything: the package, the help, and each heavy library behind its door."""

import subprocess
import sys
from collections.abc import Callable

from benchmarks.ratios import measure, show

STATEMENTS = {
    "bare python": "pass",
    "import numpy": "import numpy",
    "import geometry.inertia": "import geometry.inertia",
    "massline --help": "from validation.cli.main import run; run(['--help'])",
    "import trimesh": "import trimesh",
    "import pinocchio": "import pinocchio",
    "import exudyn": "import exudyn",
    "import pyvista": "import pyvista",
    "import cadquery": "import cadquery",
}


def in_a_fresh_process(statement: str) -> Callable[[], object]:
    """A callable that runs `statement` in a new interpreter and waits for its end."""
    return lambda: subprocess.run([sys.executable, "-c", statement], check=True, capture_output=True)


if __name__ == "__main__":
    callables = {name: in_a_fresh_process(statement) for name, statement in STATEMENTS.items()}
    show("Fresh processes", measure(callables, rounds=3), base="bare python")
