"""``campaign.toml``: read to the letter, written and read again, and refused by name where it is wrong."""

import json
import re
from dataclasses import asdict, fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.sensors import GROUPS, SI, Channel, ChannelTable, Place
from identification import campaign_file
from identification.campaign import METHODS, UNITS, Campaign, Excitation, Instrument, Processing, Run
from identification.campaign_file import Problems, parse, text

CONTRACT = """
format = 1
[campaign]
title   = "Clumod, one blade"
article = "fmd+clumod-1"
hardware = "fmd-A/sensors-2002"
notes   = "free text"
date = 2026-03-31
place = "hall 2"
operator = "B. Tester"
serial_number = "0042"
[mounting]
origin = [0.0, 0.0, 0.0445]
rotation_deg = 90.0
[environment]
gravity = 9.81
[frame]
origin = [0.0, 0.0, 0.01]
length_unit = "m"
[processing]
method = "peak-reference-hold"
block_size = 8192
overlap = 0.9
frequency = { start = 4.0, stop = 32.0, step = 0.05 }
[[instrument]]
name = "cell"
serial_number = "4711"
calibrated = 2025-02-03
due = "2027-02-03"
channels = ["fmd-x12"]
[[instrument]]
name = "cell"
[[channel]]
name = "cover-1x"
quantity = "acceleration"
unit = "m/s^2"
group = "cover"
position = [0.150, 0.150, 0.030]
direction = [1.0, 0.0, 0.0]
reference = true
senses_gravity = false
noise_rms = 0.004
[[channel]]
name = "fmd-x12"
quantity = "force"
unit = "kN"
group = "fmd"
noise_rms = 0.002
cells = [
  { position = [ 0.120,  0.120, 0.0], direction = [1.0, 0.0, 0.0] },
  { position = [-0.120,  0.120, 0.0], direction = [1.0, 0.0, 0.0] },
]
[[run]]
name = "x"
file = "x.uff"
axis = "x"
excitation = { kind = "sine-sweep", start_hz = 4.0, stop_hz = 32.0, octaves_per_minute = 2.0, level = 2.5 }
[[run]]
name = "all"
file = "all.h5"
"""


def parsed(content: str) -> Campaign:
    """The campaign in `content`, or the first refusal."""
    problems = Problems()
    campaign = parse(toml_file.parse(content, "campaign.toml"), "campaign.toml", problems)
    if problems.found:
        raise problems.found[0]
    assert campaign is not None
    return campaign


def problems_of(content: str) -> list[BadInput]:
    problems = Problems()
    parse(toml_file.parse(content, "campaign.toml"), "campaign.toml", problems)
    return problems.found


def test_the_example_of_the_contract_says_what_it_says() -> None:
    campaign = parsed(CONTRACT)
    assert (campaign.title, campaign.article, campaign.hardware) == ("Clumod, one blade", "fmd+clumod-1", "fmd-A/sensors-2002")
    assert (campaign.date, campaign.place, campaign.operator) == ("2026-03-31", "hall 2", "B. Tester")
    cell, other = campaign.instruments  # two of one type
    assert (cell.serial_number, cell.calibrated, cell.due, cell.channels) == ("4711", "2025-02-03", "2027-02-03", ("fmd-x12",))
    assert (campaign.serial_number, other.name, other.calibrated) == ("0042", "cell", "")
    assert_allclose(campaign.mounting.apply([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0445], rtol=0, atol=1e-15)
    assert_allclose(campaign.table.origin, [0, 0, 0.01], rtol=0, atol=0)
    assert campaign.processing is not None
    assert asdict(campaign.processing) == asdict(Processing(method="peak-reference-hold"))
    cover, cells = campaign.table.channels
    assert (cover.reference, cover.senses_gravity, cover.noise_rms, cover.is_sum) == (True, False, 0.004, False)
    assert (cells.unit, len(cells.places), cells.senses_gravity) == ("kN", 2, False)
    assert_allclose(cells.noise_rms, 2.0, rtol=1e-15)  # 0.002 kN
    x, several = campaign.runs
    assert (x.axis, x.file, several.axis, several.excitation) == ("x", "x.uff", "", None)
    assert x.excitation.sweep_duration == 90.0  # three octaves at two a minute
    assert x.excitation.figure("level") == 2.5


def test_the_page_of_the_contract_itself_is_read(shared: Path) -> None:
    """The indented blocks of the contract, put together, are a campaign."""
    page = (shared / "campaign-format.md").read_text(encoding="utf-8")
    section = page.split("## campaign.toml")[1].split("\nCampaigns of one series")[0]
    campaign = parsed("\n".join(line.removeprefix("    ") for line in section.splitlines()))
    assert campaign.table.names == ("cover-1x", "fmd-x12")
    assert [run.name for run in campaign.runs] == ["x"]


def test_accelerometers_sense_gravity_unless_they_say_otherwise() -> None:
    campaign = parsed(CONTRACT.replace("senses_gravity = false\n", ""))
    assert campaign.table.channels[0].senses_gravity


@pytest.mark.parametrize(("unit", "size"), [("mm", 1e-3), ("in", 0.0254), ("m", 1.0)])
def test_lengths_are_metres_whatever_the_file_is_written_in(unit: str, size: float) -> None:
    campaign = parsed(CONTRACT.replace('length_unit = "m"', f'length_unit = "{unit}"'))
    whole = parsed(CONTRACT)
    for found, metres in zip(campaign.table.channels, whole.table.channels, strict=True):
        for place, plain in zip(found.places, metres.places, strict=True):
            assert_allclose(place.position, size * plain.position, rtol=1e-15)
    assert_allclose(campaign.table.origin, size * whole.table.origin, rtol=1e-15)
    assert_allclose(campaign.mounting.position[2], size * 0.0445, rtol=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "field", "words"),
    [
        ("format = 1", "format = 2", "format", "found 2"),
        ("format = 1\n", "", "format", "is missing"),
        ('title   = "Clumod, one blade"\n', "", "campaign.title", "is missing"),
        ('hardware = "', 'hardwear = "', "campaign.hardwear", "unknown key"),
        ("date = 2026-03-31", 'date = "31.3.2026"', "campaign.date", "must be a day"),
        ("calibrated = 2025-02-03", 'calibrated = "spring"', "instrument.cell.calibrated", "must be a day"),
        ('channels = ["fmd-x12"]', 'channels = ["fmd-x21"]', "instrument.cell.channels", "fmd-x12"),
        ('channels = ["fmd-x12"]', "channels = 3", "instrument.cell.channels", "a list of channels"),
        ("gravity = 9.81", "", "environment.gravity", "is missing"),
        ("gravity = 9.81", "gravity = true", "environment.gravity", "finite number"),
        ('length_unit = "m"', 'length_unit = "ell"', "frame.length_unit", "ell"),
        ("origin = [0.0, 0.0, 0.01]", "origin = [0.0, 0.01]", "frame.origin", "three finite numbers"),
        ("origin = [0.0, 0.0, 0.01]", "origin = [0.0, 0.0, nan]", "frame.origin", "three finite numbers"),
        ("block_size = 8192", "block_size = 0.5", "processing.block_size", "0.5"),
        ("overlap = 0.9", "overlap = 1.0", "processing.overlap", "1.0"),
        ("stop = 32.0, step = 0.05", "stop = 2.0, step = 0.05", "processing.frequency", "4 to 2"),
        ("peak-reference-hold", "peak-hold", "processing.method", "one of"),
        ('name = "cover-1x"', 'name = "fmd-x12"', "channel.fmd-x12", "2 have this name"),
        ('name = "cover-1x"', 'name = ""', "channel.1.name", "text"),
        ('name = "cover-1x"', 'name = "a/b"', "channel.a/b.name", "without /"),
        ('quantity = "acceleration"', 'quantity = "velocity"', "channel.cover-1x.quantity", "one of"),
        ('unit = "m/s^2"', 'unit = "N"', "channel.cover-1x.unit", "a unit of force"),
        ('unit = "m/s^2"', 'unit = "furlong"', "channel.cover-1x.unit", "furlong"),
        ('unit = "kN"', 'unit = "kn"', "channel.fmd-x12.unit", "Known are N, kN"),
        ('group = "cover"', 'group = "lid"', "channel.cover-1x.group", "one of"),
        ("direction = [1.0, 0.0, 0.0]\nreference", "direction = [2.0, 0.0, 0.0]\nreference", "cover-1x.direction", "unit vector"),
        ("direction = [1.0, 0.0, 0.0]\nreference", "reference", "cover-1x.direction", "is missing"),
        ("reference = true", "reference = 1", "cover-1x.reference", "true or false"),
        ("noise_rms = 0.004", "noise_rms = -1", "cover-1x.noise_rms", "-1"),
        ("noise_rms = 0.004", "noise = 0.004", "cover-1x.noise", "unknown key"),
        ("noise_rms = 0.002", "senses_gravity = true", "fmd-x12.senses_gravity", "accelerometers"),
        ("noise_rms = 0.002", "position = [0, 0, 0]", "fmd-x12.cells", "beside position"),
        ('file = "x.uff"', 'file = "x.txt"', "run.x.file", ".txt"),
        ('axis = "x"', 'axis = "yaw"', "run.x.axis", "one of"),
        ('name = "all"', 'name = "x"', "run.x", "2 have this name"),
        ('kind = "sine-sweep"', 'kind = "sine"', "run.x.excitation.kind", "sine-sweep"),
        ('kind = "sine-sweep"', "kind = [1]", "run.x.excitation.kind", "[1]"),
        ("level = 2.5", "levle = 2.5", "run.x.excitation.levle", "level"),
        ("level = 2.5", 'level = "2.5 m/s^2"', "run.x.excitation.level", "finite number"),
    ],
)
def test_what_is_wrong_is_named_with_what_was_found(old: str, new: str, field: str, words: str) -> None:
    assert old in CONTRACT
    found = problems_of(CONTRACT.replace(old, new, 1))
    assert found
    assert any(field in one.field and words in str(one) for one in found), [str(one) for one in found]


def test_an_axis_is_a_direction_as_in_every_other_test() -> None:
    """ "z", which all other files of tests take, "must be three finite numbers"; write it like [0.1, 0.0, 0.03]."""
    stated = "direction = [1.0, 0.0, 0.0]\nreference"
    assert not problems_of(CONTRACT.replace(stated, 'direction = "-x"\nreference', 1))
    (said,) = problems_of(CONTRACT.replace(stated, 'direction = "w"\nreference', 1))
    assert "[0, 0, 1]" in said.remedy


def test_all_that_is_wrong_is_said_at_once() -> None:
    spoilt = CONTRACT.replace("format = 1", "format = 7").replace("m/s^2", "N").replace('axis = "x"', 'axis = "w"')
    assert {one.field for one in problems_of(spoilt)} == {"format", "channel.cover-1x.unit", "run.x.axis"}


@pytest.mark.parametrize(
    "content", ["format = 1", "format = 1\nchannel = 3\nrun = [1]\ncampaign = 2\nenvironment = []", "format = 1\n[[campaign]]\n"]
)
def test_tables_of_another_shape_are_refused_in_words(content: str) -> None:
    assert problems_of(content)


def test_a_file_in_millimetres_that_says_metres_is_doubted() -> None:
    text = CONTRACT.replace("0.120", "120").replace("[0.150, 0.150, 0.030]", "[150.0, 150.0, 30.0]")
    with pytest.raises(BadInput, match=r"270 m apart.*mm"):
        parsed(text)
    smaller = CONTRACT.replace("0.120", "12").replace("[0.150, 0.150, 0.030]", "[15.0, 15.0, 3.0]")
    assert any("mm" in warning for warning in parsed(smaller).warnings)


words = st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=30)
names = st.text(st.characters(codec="ascii", categories=["L", "N", "P"], exclude_characters="/"), min_size=1, max_size=20)
numbers = st.floats(-1e3, 1e3)
lengths = st.floats(-25, 25)  # channels of one article are within 100 m
points = st.tuples(lengths, lengths, lengths).map(np.array)
places = st.builds(
    lambda position, turn: Place(position=position, direction=rotation_about("z", turn)[:, 0]), points, st.floats(-3, 3)
)


@st.composite
def channels(draw: st.DrawFn, name: str) -> Channel:
    quantity = draw(st.sampled_from(list(SI)))
    return Channel(
        name=name,
        quantity=quantity,
        group=draw(st.sampled_from(list(GROUPS))),
        places=tuple(draw(st.lists(places, min_size=1, max_size=3))),
        unit=draw(st.sampled_from(list(UNITS[quantity]))),
        reference=draw(st.booleans()),
        senses_gravity=draw(st.booleans()),
        noise_rms=draw(st.none() | st.floats(0, 1e3)),
    )


@st.composite
def campaigns(draw: st.DrawFn) -> Campaign:
    called = draw(st.lists(names.filter(lambda name: name not in (".", "..")), min_size=1, max_size=4, unique=True))
    run_names = draw(st.lists(words.filter(str.strip), min_size=1, max_size=3, unique=True))
    figures = {"start_hz": draw(st.floats(0, 1e3)), "level": draw(st.floats(0, 100))}
    excitation = st.none() | st.sampled_from(["sine-sweep", "random", "burst"]).map(
        lambda kind: Excitation(kind=kind, figures=figures)
    )
    grid = {"start": draw(st.floats(0, 10)), "stop": draw(st.floats(20, 100)), "step": draw(st.floats(0.01, 1))}
    pose = st.builds(lambda at, turn: Pose(position=at, rotation=rotation_about("z", turn)), points, st.floats(-3, 3))
    return Campaign(
        title=draw(words.filter(str.strip)),
        article="fmd+clumod-1",
        hardware=draw(words),
        notes=draw(words),
        place=draw(words),
        operator=draw(words),
        instruments=(Instrument(name="cell", serial_number=draw(words), due="2027-02-03", channels=(called[0],)),),
        table=ChannelTable(channels=tuple(draw(channels(name)) for name in called), origin=draw(points)),
        runs=tuple(
            Run(name=n, file="x.h5", axis=draw(st.sampled_from(["", "x", "gamma"])), excitation=draw(excitation))
            for n in run_names
        ),
        mounting=draw(st.none() | pose),
        gravity=draw(st.floats(0, 20)),
        processing=draw(
            st.none() | st.builds(Processing, method=st.just("full-record"), **{k: st.just(v) for k, v in grid.items()})
        ),
    )


def same(found: object, wanted: object) -> None:
    """Field by field; figures to what is left of dividing by a unit and multiplying again, of degrees and back."""
    assert type(found) is type(wanted)
    if is_dataclass(wanted):
        for one in fields(wanted):
            same(getattr(found, one.name), getattr(wanted, one.name))
    elif isinstance(wanted, tuple):
        assert len(found) == len(wanted)
        for pair in zip(found, wanted, strict=True):
            same(*pair)
    elif isinstance(wanted, float):
        assert_allclose(found, wanted, rtol=4e-16, atol=1e-300)
    elif isinstance(wanted, np.ndarray):
        assert_allclose(found, wanted, rtol=0, atol=1e-14)
    else:
        assert found == wanted


@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(campaigns())
def test_a_description_that_is_written_is_read_as_it_was(campaign: Campaign) -> None:
    found = parsed(text(campaign))
    told = ("title", "hardware", "notes", "processing", "gravity", "table", "mounting")
    for name in told:
        same(getattr(found, name), getattr(campaign, name))
    for run, other in zip(found.runs, campaign.runs, strict=True):
        same((run.name, run.axis), (other.name, other.axis))
        same(
            run.excitation and (run.excitation.kind, dict(run.excitation.figures)),
            other.excitation and (other.excitation.kind, dict(other.excitation.figures)),
        )


def test_a_mounting_that_the_format_cannot_say_is_refused() -> None:
    tilted = replace(parsed(CONTRACT), mounting=Pose(rotation=rotation_about("x", 0.1)))
    with pytest.raises(BadInput, match="rotation_deg about z only"):
        text(tilted)


def test_text_escapes_what_toml_does_not_allow() -> None:
    odd = replace(parsed(CONTRACT), title='a "b" \\ \x7f \x01 \n é')
    assert parsed(text(odd)).title == odd.title
    assert json.dumps(odd.title, ensure_ascii=False)[:5] in text(odd)


def test_every_key_of_the_file_is_on_the_page_for_users(root: Path) -> None:
    page = (root / "docs" / "campaigns.md").read_text(encoding="utf-8")
    kinds = {word for kind, figures in campaign_file.EXCITATIONS.items() for word in (kind, *figures)}
    tables = (*campaign_file.TOP, *campaign_file.CAMPAIGN, *campaign_file.RUN, *campaign_file.PROCESSING, *campaign_file.CHANNEL)
    tables += campaign_file.INSTRUMENT
    for key in (*tables, *kinds, *METHODS, *GROUPS, *SI):
        assert re.search(rf'`"?{re.escape(key)}"?`', page), key
