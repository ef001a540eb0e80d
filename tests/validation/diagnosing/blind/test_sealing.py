"""What a diagnosis is handed holds neither seed nor truth, and its process knows no draw."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.blind.drawing.case import CUBOID, SINGLE, Case, Planted
from benchmarks.blind.names import MODEL, SETTINGS, Json
from benchmarks.blind.sealing import known, sealed
from identification import campaign_file
from validation.model import model_file
from validation.virtual_test.plan import RIGID

FAST: dict[str, Any] = {"octaves_per_minute": 120.0, "quiet": 0.2, "model": RIGID, "simulation_rate": 2000.0}

CASE = Case(
    name="singles-042",
    kind=SINGLE,
    laboratory=918273645,
    articles=(CUBOID,),
    planted=(Planted(text="force-gain:fmd-z2=0.075", multiple=5.0, told=5.0),),
    leave_out=("polarity",),
    hold_out=(f"{CUBOID}/y",),
    null="nulls-007",
)

Sealed = tuple[Path, Json]


@pytest.fixture(scope="module")
def handed(tmp_path_factory: pytest.TempPathFactory) -> Sealed:
    folder = tmp_path_factory.mktemp("scratch") / "series"
    return folder, sealed(CASE, folder, driven=FAST)


def test_no_file_of_the_folder_holds_seed_truth_name_or_kind(handed: Sealed) -> None:
    folder, truth = handed
    drawn = truth["planted"][0]["sizes"][""]
    secrets = [b"918273645", b"force-gain", b"singles", b"nulls", repr(drawn).encode(), b"truth", b"seed"]
    files = [path for path in folder.rglob("*") if path.is_file()]
    assert len(files) == 1 + 6 + 2
    for path in files:
        content = path.read_bytes()
        assert not [one for one in secrets if one in content or one.decode() in str(path.relative_to(folder))], path


def test_the_search_finds_a_seed_where_there_is_one(handed: Sealed) -> None:
    folder, _ = handed
    assert b"polarity" in (folder / SETTINGS).read_bytes()  # what is left out must be said, and is found


def test_the_settings_say_what_there_is_what_to_hold_out_and_what_to_do_without(handed: Sealed) -> None:
    settings = json.loads((handed[0] / SETTINGS).read_text())
    assert settings == {"data": [CUBOID], "hold_out": [f"{CUBOID}/y"], "leave_out": ["polarity"]}


def test_the_model_that_is_handed_over_is_what_the_laboratory_knows(handed: Sealed) -> None:
    found, expected = model_file.read(handed[0] / MODEL), known()
    assert (found.article, found.effects, found.tolerances) == (expected.article, (), expected.tolerances)
    np.testing.assert_array_equal(found.cell_stiffness, expected.cell_stiffness)


def test_the_true_size_is_what_was_planted_on_top_of_what_the_laboratory_has(handed: Sealed, tmp_path: Path) -> None:
    stated = handed[1]["planted"][0]
    plain = sealed(replace(CASE, planted=(Planted(text="force-gain:fmd-z2=0"),)), tmp_path / "series", driven=FAST)
    drawn = plain["planted"][0]["sizes"][""]
    assert drawn != 0
    assert stated["id"] == "force-gain:fmd-z2"
    assert stated["sizes"][""] == pytest.approx((1 + drawn) * 1.075 - 1)


def test_the_campaign_that_is_handed_over_has_the_effect_in_it(handed: Sealed, tmp_path: Path) -> None:
    sealed(replace(CASE, planted=()), tmp_path / "series", driven=FAST)
    with_it, without = (campaign_file.read(folder / CUBOID).recordings["z"] for folder in (handed[0], tmp_path / "series"))
    k = with_it.names.index("fmd-z2")
    level = np.sqrt(np.mean(with_it.values**2, axis=0))
    moved = np.sqrt(np.mean((with_it.values - without.values) ** 2, axis=0)) / level
    assert moved[k] == pytest.approx(0.075 / 1.075, rel=0.02)  # noise and hum, which are the same in both, are not multiplied
    assert np.all(np.delete(moved, k) < 1e-9)


def test_the_process_that_answers_knows_no_draw_and_no_virtual_test(root: Path) -> None:
    script = "import sys, benchmarks.blind.answering; print(*sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], cwd=root, capture_output=True, text=True, check=True)
    loaded = done.stdout.split()
    assert "benchmarks.blind.names" in loaded
    assert not [
        name
        for name in loaded
        if name.startswith(("benchmarks.blind.drawing", "benchmarks.blind.sealing", "validation.virtual_test"))
    ]
