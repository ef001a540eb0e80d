"""Pictures of every built-in article and set-up, and the sheet of them that the README shows.

    python examples/pictures.py [FOLDER] [SHEET]

Writes one picture an article into FOLDER (``out/pictures``) and the contact sheet to SHEET (``docs/pictures/articles.png``).
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from geometry import multibody
from geometry.articles import NAMES, SETUPS, built_in
from validation.pictures import contact_sheet, drawn_bodies, picture

ON_THE_SHEET = ("cuboid", "disc", "fmd", "clumod-1", "clumod-4", "fmd+disc+cuboid")


DEFAULTS = (Path("out/pictures"), Path("docs/pictures/articles.png"))


def main(folder: Path, sheet: Path, names: Sequence[str] = (*NAMES, *SETUPS)) -> None:
    """Draw the articles called `names` into `folder`, and those of them that the README shows on one `sheet`."""
    for name in names:
        article = built_in(name)
        picture(name, drawn_bodies(article), multibody.inertia(article), folder / f"{name}.png", note=article.note)
    contact_sheet([folder / f"{name}.png" for name in ON_THE_SHEET if name in names], sheet)


if __name__ == "__main__":
    given = [Path(argument) for argument in sys.argv[1:]]
    folder, sheet = (*given, *DEFAULTS[len(given) :])
    main(folder, sheet)
