"""A dynamic mass as a file: comma-separated for a spreadsheet, ``.npz`` for numpy; no pickle, whole or not at all."""

from __future__ import annotations

import csv
from io import StringIO
from pathlib import Path

import numpy as np

from geometry.atomic import write_text, write_with
from geometry.dynamic_mass import MOTIONS, DynamicMass
from validation import output

ENDINGS = (".csv", ".npz")


def require_ending(path: Path) -> None:
    """Refuse a `path` that names no format, as `validation.output.require_ending`."""
    output.require_ending(path, ENDINGS, "a dynamic mass", "out/H.csv")


def write(path: Path, H: DynamicMass, article: str) -> None:
    """Write `H`: frequency [Hz], then real and imaginary part of all 36 entries, row by row."""
    require_ending(path)
    if path.suffix.lower() == ".csv":
        write_text(path, comma_separated(H, article))
    else:
        write_with(path, lambda temporary: _npz(temporary, H, article))


def comma_separated(H: DynamicMass, article: str) -> str:
    """`H` as lines of text; those that begin with # say of what and about which point."""
    about = ", ".join(f"{1e3 * x:g}" for x in H.reference_point)
    text = StringIO()
    text.write(f"# dynamic mass of {article} about ({about}) mm, blocked, loads of the table on the article\n")
    text.write("# units: kg between translations, kg m mixed, kg m2 between rotations\n")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(
        ["frequency_hz", *(f"{part}_{row}_{column}" for row in MOTIONS for column in MOTIONS for part in ("re", "im"))]
    )
    for f, matrix in zip(H.frequency, H.matrix, strict=True):
        flat = matrix.ravel()
        table.writerow([repr(float(f)), *(repr(float(v)) for v in np.column_stack([flat.real, flat.imag]).ravel())])
    return text.getvalue()


def _npz(path: Path, H: DynamicMass, article: str) -> None:
    np.savez_compressed(
        path,
        frequency_hz=H.frequency,
        matrix=H.matrix,
        reference_point_m=H.reference_point,
        order=np.array(MOTIONS),
        article=np.array(article),
    )
