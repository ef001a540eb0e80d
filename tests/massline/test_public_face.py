"""From two paths to a named effect in five lines of Python, with the names of one package."""

import shutil
from pathlib import Path

import pytest

import massline


@pytest.fixture(scope="module")
def folder(gain: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small series with a fault, to be worked on."""
    return shutil.copytree(gain, tmp_path_factory.mktemp("face") / "gain")


def test_five_lines_lead_from_two_paths_to_a_named_effect_and_the_error_falls(folder: Path) -> None:
    study = massline.Study.open(folder / "model.toml", [folder / "gain"], hold_out=["z"])
    found = massline.diagnose(study, only=["force-gain", "point-mass"])
    assert "force-gain:fmd-z2" in str(found)
    study = massline.add(study, found.accepted[0])
    figure = study.history.plot()

    assert [one.named.id for one in found.accepted] == ["force-gain:fmd-z2"]
    assert "data:image/png;base64," in found._repr_html_()
    assert len(figure.data) > 0
    before, after = study.history.ladder.rungs
    assert before.errors is not None
    assert after.errors is not None
    assert after.errors.plain < 0.5 * before.errors.plain
    assert [one.named.id for one in study.model.effects] == ["force-gain:fmd-z2"]
    assert "force-gain:fmd-z2" in str(study.history)
    assert massline.undo(study).model.effects == ()


def test_every_name_that_is_handed_on_is_there() -> None:
    assert [name for name in massline.__all__ if not hasattr(massline, name)] == []
