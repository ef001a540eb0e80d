"""Whatever stands in a model file, a user reads a model or a sentence; and an edit changes one effect or refuses."""

import copy
from collections.abc import Iterator
from contextlib import suppress
from math import inf, nan
from typing import Any

import numpy as np
import pytest

from geometry import toml_file
from geometry.errors import BadInput
from validation.effects.catalogue import parse
from validation.model import model_file
from validation.model.model import Added, Model

WHOLE = """\
format = 1
[model]
title = "all of it"
article = "fmd+clumod-1"
[laboratory]
hardware = "A"
gravity_m_s2 = 9.81
cell_stiffness_N_m = [1e8, 1e8, 4e8]
[laboratory.fmd]
mass_kg = 18.0
cog_mm = [0.0, 0.0, 24.0]
moi_cog_kgm2 = [0.25, 0.25, 0.49]
poi_cog_kgm2 = [0.0, 0.0, 0.0]
tolerance = 0.05
[tolerances]
gain = 0.003
delay_s = 20e-6
position_mm = 0.5
angle_deg = 0.3
[structure]
kind = "beam"
modes = 20
damping_ratio = 0.003
[structure.dimensions]
"clumod.mast.outer_diameter_mm" = 60.0
[structure.tolerances]
modulus = 0.025

# the first
[[effect]]
id = "force-gain:fmd-z2"
value = 0.08   # as fitted
sd = 0.01

# the second
[[effect]]
id = "appendage:z"
value = { m = 0.05, f = 21.0, zeta = 0.01 }
sd = { m = 0.01 }
fixed = true
"""

STRANGE = [True, -1, 0, 10**30, nan, inf, "", "nonsense", [], [[1.0] * 3] * 3, {}, {"a": 1}, [{}]]


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if path:
        yield path
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from leaves(inner, (*path, key))


def read_or_refused(table: dict[str, Any]) -> Model | BadInput:
    try:
        return model_file.of_table(table, "lab.toml")
    except BadInput as error:
        return error


@pytest.mark.parametrize("path", [*leaves(toml_file.parse(WHOLE, "whole"))], ids=lambda path: ".".join(map(str, path)))
def test_a_strange_value_is_a_model_or_a_refusal_that_names_the_file(path):
    whole = toml_file.parse(WHOLE, "whole")
    for strange in STRANGE:
        table = copy.deepcopy(whole)
        inner: Any = table
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = strange
        read = read_or_refused(table)
        if isinstance(read, BadInput):
            assert (read.source, bool(read.field)) == ("lab.toml", True), (path, strange, read)
        else:
            assert model_file.text(model_file.of_text(model_file.text(read), "lab.toml")) == model_file.text(read), (
                path,
                strange,
            )


@pytest.mark.parametrize("path", [*leaves(toml_file.parse(WHOLE, "whole"))], ids=lambda path: ".".join(map(str, path)))
def test_a_key_that_is_left_out_or_misspelt_is_a_model_or_a_refusal(path):
    if isinstance(path[-1], int):
        return
    for name in ("", f"{path[-1]}x"):
        table = toml_file.parse(WHOLE, "whole")
        inner: Any = table
        for key in path[:-1]:
            inner = inner[key]
        value = inner.pop(path[-1])
        if name:
            inner[name] = value
            with pytest.raises(BadInput) as refused:
                model_file.of_table(table, "lab.toml")
            assert refused.value.source == "lab.toml"
        else:
            with suppress(BadInput):
                model_file.of_table(table, "lab.toml")


def rearranged(generator: np.random.Generator) -> str:
    """The effects of `WHOLE` with a line missing, twice, empty, a comment, indented, or in the place of another."""
    head, first, rest = WHOLE.partition("# the first")
    small = head.partition("[structure.dimensions]")[0]
    lines = (first + rest).split("\n")
    for a, b in generator.integers(0, len(lines), (2, 2)):
        a %= len(lines)
        b %= len(lines)
        match generator.integers(0, 6):
            case 0:
                del lines[a]
            case 1:
                lines.insert(b, lines[a])
            case 2:
                lines.insert(a, "")
            case 3:
                lines.insert(a, "# a thought")
            case 4:
                lines[a] = f"   {lines[a]}  # indented"
            case _:
                lines[a], lines[b] = lines[b], lines[a]
    return small + "\n".join(lines)


def test_an_edit_of_a_rearranged_file_changes_one_effect_or_refuses():
    generator, edited = np.random.default_rng(2026), 0
    new = Added(named=parse("force-gain:fmd-z2=0.5"), deviation={"": 0.25})
    for _ in range(80):
        text = rearranged(generator)
        try:
            before = model_file.of_text(text, "lab.toml")
        except BadInput:
            continue
        with suppress(BadInput):
            after = model_file.of_text(model_file.with_effect(text, new), "lab.toml")
            ids = [one.named.id for one in before.effects]
            assert [one.named.id for one in after.effects] == (ids if new.named.id in ids else [*ids, new.named.id])
            assert (after.article, after.tolerances, after.modes) == (before.article, before.tolerances, before.modes)
            edited += 1
    assert edited > 20
