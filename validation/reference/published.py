"""What is in print about the built-in articles: the paper's tables as data, every digit kept, with their own deviations."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from geometry.frames import Array, Pose
from validation.reference import statement
from validation.reference.statement import Statement


@dataclass(frozen=True, eq=False, kw_only=True)
class Published:
    """What is in print about one article, in the article's own frame.

    Attributes
    ----------
    source : the table it comes from
    statements : by column: "published", "measured", "identified"; only what is printed
    deviation_of : the column whose deviations are printed; empty when none are
    printed_deviation : mass, CoG x, y, z, moments xx, yy, zz, as printed with their unit
    footnotes : what must be known to read the table
    """

    source: str = ""
    statements: Mapping[str, Statement] = field(default_factory=dict)
    deviation_of: str = ""
    printed_deviation: tuple[str, ...] = ()
    footnotes: tuple[str, ...] = ()


RESULTS = ("clumod-1-table2",)
"""Identified results in print; each is a result file that `massline validate` takes by this name."""


def published(article: str) -> Published:
    """What is in print about the built-in `article`; empty for one about which nothing is."""
    table = _in_print("tables").get(article)
    if table is None:
        return Published()
    statements = {}
    for column in ("published", "measured"):
        if column in table:
            # One column of a table, from the file of ``kind = "results"`` that holds its values
            name, results = table[column]["file"], _in_print(table[column]["file"])
            values = (statement.stated(results[key]["value"], dimension, name, key) for key, dimension in _RESULT_KEYS)
            statements[column] = Statement(
                name=table[column]["name"],
                values=(*values, None, None, None),
                source=table["source"],
                tolerance_note=table[column]["tolerance"],
            )
    if "identified" in table:
        statements["identified"] = statement.read(result_table(table["identified"]), table["identified"], Pose())
    deviation = table["printed_deviation"]
    return Published(
        source=table["source"],
        statements=statements,
        deviation_of=deviation["of"],
        printed_deviation=(deviation["mass"], *deviation["cog"], *deviation["moments"]),
        footnotes=tuple(table["footnotes"]),
    )


def result_table(name: str) -> dict[str, Any]:
    """The result file in print called `name`, one of `RESULTS`."""
    return dict(_in_print(name))


_RESULT_KEYS = (
    ("mass", "mass"),
    *((f"cog_{axis}", "length") for axis in "xyz"),
    *((axes, "moment of inertia") for axes in ("Ixx", "Iyy", "Izz")),
)
"""Keys of a results file in the order of a statement."""


@cache
def _in_print(name: str) -> dict[str, Any]:
    return tomllib.loads(files("validation.reference").joinpath("in_print", f"{name}.toml").read_text(encoding="utf-8"))


# What the paper prints about the eigenfrequencies of an article, and whether a model's are so.


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One sentence of the paper.

    Attributes
    ----------
    says : the sentence
    found : what the model has instead, in the same words
    holds : whether it is so within the rounding of the print; None where too few modes were computed to tell
    """

    says: str
    found: str
    holds: bool | None


def claims(article: str, frequency: Array) -> tuple[Claim, ...]:
    """Every sentence about the eigenfrequencies of `article`, held against `frequency` (n,) [Hz]; empty where there is none."""
    made = []
    for entry in _in_print("modes").get(article, ()):
        holds: bool | None = None
        if "count" in entry:
            low, high = entry["between_hz"]
            count = int(np.sum((frequency >= low) & (frequency <= high)))
            found = f"{count} modes"
            if len(frequency) > 0 and frequency[-1] > high:
                holds = count == entry["count"]
        elif len(frequency) < entry["mode"]:
            found = f"{len(frequency)} modes computed"
        else:
            at = float(frequency[entry["mode"] - 1])
            found = f"mode {entry['mode']} at {at:.2f} Hz"
            holds = at >= entry["above_hz"] if "above_hz" in entry else abs(at - entry["hz"]) <= entry["half_hz"]
        made.append(Claim(says=entry["says"], found=found, holds=holds))
    return tuple(made)
