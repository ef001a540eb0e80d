"""Pictures of every built-in article and set-up, and the sheet of them that the README shows.

    python examples/pictures.py [FOLDER] [SHEET]

Writes one picture an article into FOLDER (``out/pictures``) and the contact sheet to SHEET (``docs/pictures/articles.png``).
The sheet carries what it shows in figures too, so that a test sees when the articles have moved on.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from geometry import multibody
from geometry.article import Article
from geometry.articles import NAMES, SETUPS, built_in
from validation.output import inertia_json
from validation.pictures import contact_sheet, drawn_bodies, picture

ON_THE_SHEET = ("cuboid", "disc", "fmd", "clumod-1", "clumod-4", "fmd+disc+cuboid")


DEFAULTS = (Path("out/pictures"), Path("docs/pictures/articles.png"))


def main(folder: Path, sheet: Path, names: Sequence[str] = (*NAMES, *SETUPS)) -> None:
    """Draw the articles called `names` into `folder`, and those of them that the README shows on one `sheet`."""
    for name in names:
        article = built_in(name)
        picture(name, drawn_bodies(article), multibody.inertia(article), folder / f"{name}.png", note=article.note)
    shown = [name for name in ON_THE_SHEET if name in names]
    about = json.dumps({name: figures(built_in(name)) for name in shown})
    contact_sheet([folder / f"{name}.png" for name in shown], sheet, about)


def figures(article: Article) -> dict[str, Any]:
    """What a picture of `article` shows: its parts with their materials, and its inertia."""
    parts = [[part.name, part.material.name, part.counted] for part in article.parts]
    return {"parts": parts, "note": article.note, **inertia_json(multibody.inertia(article))}


if __name__ == "__main__":
    given = [Path(argument) for argument in sys.argv[1:]]
    folder, sheet = (*given, *DEFAULTS[len(given) :])
    main(folder, sheet)
