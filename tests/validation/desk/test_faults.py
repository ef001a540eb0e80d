"""All that is wrong is told at once, beside the file and the field that has it."""

import shutil
from pathlib import Path

from geometry.errors import BadInput
from validation.app.opening import Fault, Series, faults, of_error


def test_a_sound_series_has_no_grave_fault(block: Series) -> None:
    heard: list[str] = []
    found = faults(block.model, block.data, progress=lambda what, share: heard.append(what))
    assert not any(one.grave for one in found)
    assert any("fmd+cuboid" in what for what in heard)


def test_no_fault_hides_the_next(tmp_path: Path, block: Series) -> None:
    model = tmp_path / "model.toml"
    model.write_text(Path(block.model).read_text().replace("[tolerances]", "[tolerances]\nsurplus = 1"))
    shutil.copytree(block.data[0], tmp_path / "one")
    described = tmp_path / "one" / "campaign.toml"
    text = described.read_text().replace('unit = "N"', 'unit = "cubits"', 1)
    described.write_text(text.replace('file = "x.h5"', 'file = "../x.h5"'))
    (tmp_path / "weighing.toml").write_text('format = 1\nkind = "weighing"\n')
    found = faults(str(model), [str(tmp_path / "one"), str(tmp_path / "weighing.toml"), str(tmp_path / "nowhere")])
    assert all(one.grave and one.problem and one.remedy for one in found if one.grave)
    said = {(Path(one.file).name, one.field) for one in found}
    assert ("model.toml", "tolerances.surplus") in said
    assert any(file == "campaign.toml" and "unit" in field for file, field in said)
    assert any("x" in field and file == "campaign.toml" for file, field in said)
    assert any(file == "weighing.toml" for file, _ in said)
    assert any(file == "nowhere" for file, _ in said)


def test_what_does_not_belong_together_is_a_fault(tmp_path: Path, block: Series) -> None:
    model = tmp_path / "model.toml"
    model.write_text(Path(block.model).read_text().replace('article = "fmd+cuboid"', 'article = "fmd+clumod-1"'))
    (fault,) = [one for one in faults(str(model), block.data) if one.grave]
    assert fault.field == "model.article"


def test_a_refusal_reads_the_same_as_a_fault() -> None:
    error = BadInput(source="a.toml", field="x", problem="is wrong", remedy="Mend it")
    assert of_error(error).text == str(error).rstrip(".")
    assert Fault(file="a", field="", problem="odd", grave=False).text == "a: odd"
