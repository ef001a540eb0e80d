"""The run of `massline model`."""

from __future__ import annotations

from pathlib import Path

import click

from geometry.atomic import write_text
from geometry.errors import BadInput
from validation.models import reading, writing
from validation.models.drafting import draft
from validation.output import require_ending, require_file


def model(article: str, out: Path | None, *, force: bool) -> None:
    """Print the model file for `article`, or write it to `out`.

    Raises
    ------
    BadInput : see `draft`; `out` is there already and not to be replaced, or cannot be written.
    OSError : a file cannot be read or written.
    """
    if out is not None:
        _require_free(out, force=force)
    text = writing.text(draft(article, out))
    reading.of_text(text, str(out or "model.toml"))
    if out is None:
        click.echo(text, nl=False)
        return
    write_text(out, text)
    click.echo(f"massline: wrote {out}.", err=True)


def _require_free(out: Path, *, force: bool) -> None:
    require_ending(out, (".toml",), "a model file", "model.toml")
    if out.exists() and not force:
        problem = "it is there already, perhaps with changes of your own"
        raise BadInput(source=str(out), field="--out", problem=problem, remedy="Name another file, or replace it with --force")
    require_file(out, "--out")
