"""Notebooks run without a kernel: ``python -m tools.notebooks FILE.ipynb ...`` keeps what their cells show in the file.

A cell shows what it prints, and its last expression as a notebook would: by ``_repr_html_``, or as text.
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from geometry.atomic import write_text

Shown = list[dict[str, Any]]
"""Outputs of a cell, as the format of notebooks has them."""


def read(path: Path) -> dict[str, Any]:
    """The notebook in the file `path`."""
    notebook: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return notebook


def ran(path: Path, folder: Path) -> dict[str, Any]:
    """The notebook in the file `path` as it is after all of its cells ran in order, in the `folder` with a copy of `examples`."""
    notebook, names = read(path), {"__name__": "__main__"}
    shutil.copytree(path.parents[1], folder / "examples", dirs_exist_ok=True)
    with contextlib.chdir(folder):
        for count, cell in enumerate((one for one in notebook["cells"] if one["cell_type"] == "code"), start=1):
            cell["outputs"], cell["execution_count"] = (
                _outputs("".join(cell["source"]), f"{path.name}:{count}", names, count),
                count,
            )
    return notebook


def _outputs(source: str, of: str, names: dict[str, Any], count: int) -> Shown:
    tree, last, printed = ast.parse(source), None, io.StringIO()
    if tree.body and isinstance(tree.body[-1], ast.Expr):
        last = ast.Expression(tree.body.pop().value)  # type: ignore[attr-defined]
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
        exec(compile(tree, of, "exec"), names)
        value = None if last is None else eval(compile(last, of, "eval"), names)
    shown: Shown = []
    if printed.getvalue():
        shown.append({"output_type": "stream", "name": "stdout", "text": printed.getvalue().splitlines(keepends=True)})
    if value is not None:
        data = {"text/plain": str(value).splitlines(keepends=True)}
        if hasattr(value, "_repr_html_"):
            data = {"text/html": value._repr_html_().splitlines(keepends=True)} | data
        shown.append({"output_type": "execute_result", "execution_count": count, "metadata": {}, "data": data})
    return shown


def page(path: Path) -> str:
    """The notebook in the file `path` as a page of the site, with what its cells show."""
    made = []
    for cell in read(path)["cells"]:
        text = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            made.append(text)
            continue
        made.append(f"```python\n{text}\n```")
        for one in cell["outputs"]:
            data = one.get("data", {"text/plain": one.get("text", [])})
            html = "".join(data.get("text/html", []))
            made.append(f"```{{raw}} html\n{html}\n```" if html else f"```text\n{''.join(data['text/plain'])}\n```")
    return "\n\n".join(made) + "\n"


if __name__ == "__main__":
    for name in sys.argv[1:]:
        there = Path(name).resolve()
        with tempfile.TemporaryDirectory() as work:
            os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
            write_text(there, json.dumps(ran(there, Path(work)), indent=1, ensure_ascii=False) + "\n")
        sys.stderr.write(f"massline: ran {name}\n")
