"""Pages, notebooks and docstrings as a site: ``make docs``, or ``python -m tools.site [FOLDER]``, to be opened from disk.

Sphinx builds it, with search, from a copy of the pages in its own words; every warning is an error, and nothing is fetched.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

from geometry.atomic import write_text
from tools import notebooks
from tools.pages import FIRST, ROOT, pages

OUT = Path("out/site")
OVERVIEW = "overview.md"
"""What README.md becomes."""

NOTEBOOKS = Path("examples/notebooks")

ROOMS = ("massline", "geometry", "fem", "identification", "validation")
"""Packages whose docstrings are the reference."""


def build(folder: Path, root: Path = ROOT, *, reference: bool = True) -> None:
    """Write the site into `folder`, which is emptied before.

    Parameters
    ----------
    reference : with a page for every module

    Raises
    ------
    SystemExit : Sphinx finds a link that leads nowhere, a block or an equation that it cannot set.
    """
    shutil.rmtree(folder, ignore_errors=True)
    with tempfile.TemporaryDirectory() as copy:
        stage(Path(copy), root, reference=reference)
        options = ["-q", "-W", "--keep-going", "-b", "html", "-c", str(root / "docs"), "-d", f"{copy}/.read"]
        code = os.pathsep.join(path for path in sys.path if path)  # what is imported here is documented there
        sphinx = [sys.executable, "-P", "-m", "sphinx", *options, copy, str(folder)]
        if subprocess.run(sphinx, env={**os.environ, "PYTHONPATH": code}, check=False).returncode:
            raise SystemExit("massline: the site is not built: see above.")


def stage(copy: Path, root: Path, *, reference: bool) -> None:
    """Write the sources of the site into the folder `copy`."""
    names = {page.resolve(): OVERVIEW if page == root / "README.md" else page.name for page in pages(root)}
    shown = sorted((root / NOTEBOOKS).glob("*.ipynb"))
    names |= {one.resolve(): f"notebook-{one.stem}.md" for one in shown}
    modules = list(_modules(root)) if reference else []
    for page in pages(root):
        text = _links(_blocks(page.read_text(encoding="utf-8")), page, names, modules)
        if page.name == FIRST:
            text += _contents(page, names, modules)
        write_text(copy / names[page.resolve()], text)
    for one in shown:
        write_text(copy / names[one.resolve()], _links(_blocks(notebooks.page(one)), one, names, modules))
    shutil.copytree(root / "docs" / "pictures", copy / "pictures")
    for name in modules:
        title = f"{name}\n{'=' * len(name)}"
        write_text(copy / "reference" / f"{name}.rst", f"{title}\n\n.. automodule:: {name}\n   :members:\n")


def _modules(root: Path) -> Iterable[str]:
    for room in ROOMS:
        for path in sorted((root / room).rglob("*.py")):
            name = ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
            if not any(part.startswith("_") for part in name.split(".")):
                yield name


def _blocks(text: str) -> str:
    """Fences as MyST has them: an equation is a directive, a file has its name above it."""
    text = re.sub(r"^```math$", "```{math}", text, flags=re.MULTILINE)
    text = re.sub(r"^```output$", "```text", text, flags=re.MULTILINE)
    return re.sub(r"^```(toml|python|text) \+?(\S+)$", r"```{code-block} \1\n:caption: \2\n", text, flags=re.MULTILINE)


def _links(text: str, page: Path, names: dict[Path, str], modules: list[str]) -> str:
    """Links between pages by their names on the site; those to code lead to its reference, those to other files are words."""

    def lead(found: re.Match[str]) -> str:
        words, target = found[1], found[2]
        path, mark, name = target.partition("#")
        if re.match(r"[a-z]+:", target) or not path:
            return found[0]
        file = (page.parent / path).resolve()
        if file in names:
            return f"[{words}]({names[file]}{mark}{name})"
        if found[0].startswith("!"):
            return f"![{words}](pictures/{file.name})"
        code = words.strip("`")
        if path.endswith(".py") and any(code == one or code.startswith(f"{one}.") for one in modules):
            return f"{{py:obj}}`{code}`"
        return words

    return re.sub(r"(?<!\\)!?\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^)\s]+)\)", lead, text)


def _contents(index: Path, names: dict[Path, str], modules: list[str]) -> str:
    """The list of all pages that stands beside each of them: headings and entries of the index, in their order."""
    made: list[str] = []
    for line in index.read_text(encoding="utf-8").splitlines():
        heading, entry = re.match(r"## (.+)", line), re.match(r"- \[([^\]]+)\]\(([^)]+)\)", line)
        if heading:
            made += ["```", "", "```{toctree}", ":hidden:", f":caption: {heading[1]}", ""]
        elif entry:
            made.append(f"{entry[1]} <{names[(index.parent / entry[2]).resolve()]}>")
    if modules:
        made += ["```", "", "```{toctree}", ":hidden:", ":caption: Reference", "", *(f"reference/{name}" for name in modules)]
    return "\n".join(["", *made[1:], "```", ""])


if __name__ == "__main__":
    built = Path(sys.argv[1]) if len(sys.argv) > 1 else OUT
    with contextlib.suppress(KeyboardInterrupt):
        build(built)
        sys.stderr.write(f"massline: wrote the site; begin at {built / Path(FIRST).stem}.html\n")
