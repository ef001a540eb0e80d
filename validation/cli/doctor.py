"""`massline doctor`: what of massline's libraries and helpers is there, and what is not, each with what it is for."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import click
from click import command

from geometry.errors import EXTRAS
from validation.cli import options, shadowed

NEEDED_FOR = {
    "cad": "STEP files, drawings of the built-in articles, the exact route",
    "fem": "solid models, Nastran's matrices, rope pendulums in exudyn",
    "gpl": "meshes of drawings by gmsh, .msh and .med files; under the GPL",
    "pictures": "pictures and moving modes (--view, report)",
    "app": "the workbench in the browser",
    "fleet": "many diagnoses at a time, by several processes or machines",
}
"""What a command that lacks the extra cannot do."""

CORE = ("numpy", "scipy", "pin", "trimesh", "libigl", "h5py", "manifold3d", "matplotlib", "plotly")
"""Libraries of the core whose version says most."""


@command("doctor")
@options.JSON
def doctor_command(as_json: bool) -> None:
    """What is installed here: Python, libraries by extra, browser, factorisers, the measured data of others.

    Exit code 1 when something of the core is missing; an extra that is not there is said, and is no fault.
    """
    from fem.factorisers import installed
    from geometry.errors import BadInput, CheckFailed
    from validation.output import print_json
    from validation.report.page import browser_path

    def of(name: str) -> str | None:
        try:
            return version(name)
        except PackageNotFoundError:
            return None

    core = {name: of(name) for name in CORE}
    extras = {name: [one for one in modules if find_spec(one) is None] for name, modules in EXTRAS.items()}
    try:
        browser: str | None = browser_path()
    except BadInput:
        browser = None
    data = os.environ.get("MASSLINE_DATA")
    if as_json:
        print_json(
            {
                "massline": version("massline"),
                "python": platform.python_version(),
                "core": core,
                "missing_of_extras": extras,
                "browser": browser,
                "factorisers": installed(),
                "data": data,
                "shadowed": shadowed(),
            }
        )
    else:
        lines = [f"massline {version('massline')}, Python {platform.python_version()}, {platform.platform()}"]
        lines.append("core          " + ", ".join(f"{name} {found or 'MISSING'}" for name, found in core.items()))
        for name, missing in extras.items():
            said = "there" if not missing else f"not there ({', '.join(missing)}): pip install 'massline[{name}]'"
            lines.append(f"{name:<13} {said}; for {NEEDED_FOR[name]}")
        lines.append(f"browser       {browser or 'none: a report as PDF needs one (MASSLINE_BROWSER)'}")
        lines.append(f"factorisers   {', '.join(installed())}")
        there = data is not None and Path(data).is_dir()
        lines.append(f"data          {data if there else 'not there: MASSLINE_DATA names the folder of measured data'}")
        click.echo("\n".join(lines))
    if absent := [name for name, found in core.items() if found is None]:
        raise CheckFailed(f"the core lacks {', '.join(absent)}: install massline again")
