"""docs/model-file.md: its files can be read, its program runs, its facts are those of the data. All pages run their commands."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path

import numpy as np

from geometry.sensors import Tolerances
from validation.correct import CORRECTIONS
from validation.model import model_file
from validation.model.model import KINDS, StructureTolerances

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "model-file.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "example_series.toml"


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def test_the_example_says_what_nominal_json_says(data: Path) -> None:
    known, model = json.loads((data / "example_series" / "nominal.json").read_text()), model_file.read(EXAMPLE)
    np.testing.assert_allclose(model.fmd.mass_matrix, known["fmd"]["mass_matrix_about_F"], rtol=1e-6, atol=1e-9)  # 7 digits
    assert model.cell_stiffness is not None
    np.testing.assert_allclose(model.cell_stiffness, [known["cell_stiffness_N_per_m"][axis] for axis in "xyz"])
    assert model.damping_ratio == known["damping_ratio_expected"]
    assert f"within {100 * model.fmd_tolerance:.0f} %" in known["note"]


def test_the_example_belongs_to_the_campaigns_of_the_data(data: Path) -> None:
    from identification.campaign_file import read_description
    from validation.model.model import require_pair

    campaigns = [read_description(data / "example_series" / name) for name in ("fmd+disc+cuboid", "fmd+clumod-1")]
    require_pair(model_file.read(EXAMPLE), campaigns)


def test_every_key_is_on_the_page() -> None:
    names = [one.name for one in fields(StructureTolerances)] + [key for key, _ in model_file.SCALES.values()]
    tables = (
        *model_file.MODEL,
        *model_file.STRUCTURE,
        *model_file.LABORATORY,
        *model_file.FMD,
        *KINDS,
        "id",
        "value",
        "sd",
        "fixed",
    )
    for key in (*names, *tables):
        assert re.search(rf"[`.]{key}[`\]= ]", PAGE), key
    assert {one.name for one in fields(Tolerances)} == {*model_file.SCALES, "fmd_inertia"}


def test_every_correction_is_on_the_page() -> None:
    for family in CORRECTIONS:
        assert f"`{family}`" in PAGE, family
