"""A model and campaigns that do not belong together say so, by the name of the file and of the field."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from geometry.errors import BadInput
from geometry.sensors import Channel, ChannelTable, Place
from identification.campaign import Campaign
from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary
from validation.model.model import Added, Model, require_pair, require_target, vocabulary
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import Plan
from validation.virtual_test.shaker import middles_of_cells

ANY = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)


TABLE = mavis(middles_of_cells(Plan(article="fmd+clumod-1")), {}).table


def campaign(article: str = "fmd+clumod-1", **changes: Any) -> Campaign:
    said = {"title": "", "table": TABLE, "runs": (), "hardware": "A", "source": article.replace("+", "-"), "gravity": 9.81}
    return Campaign(article=article, **{**said, **changes})


def model(*effects: str, **changes: Any) -> Model:
    added = tuple(Added(named=parse(text, ANY)) for text in effects)
    return Model(**{"source": "lab.toml", "title": "", "article": "fmd+clumod-1", "hardware": "A", "effects": added, **changes})


def refused(model: Model, *campaigns: Campaign) -> BadInput:
    with pytest.raises(BadInput) as caught:
        require_pair(model, campaigns)
    return caught.value


def with_channel(name: str, **changes: Any) -> ChannelTable:
    return replace(TABLE, channels=tuple(replace(c, **changes) if c.name == name else c for c in TABLE.channels))


def shifted(channel: Channel, by: tuple[float, float, float]) -> tuple[Place, ...]:
    return tuple(replace(place, position=place.position + np.array(by)) for place in channel.places)


def test_one_model_serves_a_whole_series_of_which_one_has_the_part():
    effects = ("force-gain:fmd-z2=0.08", "modulus:upper-long=0.1", "point-mass:lower-2+=0.1", "appendage:z=m:0.1,f:20,zeta:0.01")
    series = [campaign(article) for article in ("fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4")]
    require_pair(model(*effects), series)
    require_pair(model("modulus:upper-long=0.1"), [campaign(), campaign("fmd+clumod-4")])


def test_what_is_not_stated_or_the_users_own_fits_and_what_acts_on_an_article_needs_one():
    require_pair(model(hardware=""), [campaign()])
    require_pair(model(), [campaign(hardware="")])
    own = model("point-mass:antenna=0.1", "modulus:boom=0.1", article="fmd+satellite", own={"fmd+satellite": "s.h5"})
    require_pair(own, [campaign("fmd+satellite"), campaign("fmd+disc+cuboid")])
    require_pair(model("point-mass:antenna=0.1", article="fmd+satellite", own={"satellite": "s.h5"}), [campaign("fmd+satellite")])
    fewer = TABLE.subset(range(14, len(TABLE)))
    require_pair(model(), [campaign(table=fewer)])
    error = refused(model("appendage:z=m:0.1,f:20,zeta:0.01", article="fmd"), campaign("fmd"))
    assert "nothing stands on the cover plate: fmd" in error.problem
    require_pair(model("force-gain:fmd-z1=0.1", article="fmd"), [campaign("fmd")])


OTHER = {"article": "fmd+clumod-4"}
FILE, ARTICLE, HARDWARE, GRAVITY = "fmd-clumod-1/campaign.toml", "model.article", "campaign.hardware", "environment.gravity"


@pytest.mark.parametrize(
    ("described", "tested", "source", "field", "says"),
    [
        ({}, [], "lab.toml", "", "there is no campaign to hold it against"),
        (
            {},
            [{"article": "fmd+cuboid"}],
            "lab.toml",
            ARTICLE,
            "is fmd+clumod-1, of which no campaign has a part: fmd+cuboid (fmd-cuboid)",
        ),
        ({}, [{"hardware": "B"}], FILE, HARDWARE, "is B, and lab.toml describes A"),
        ({"hardware": ""}, [OTHER, {"hardware": "B"}], FILE, HARDWARE, "is B, and that of fmd-clumod-4 is A"),
        ({}, [{"gravity": 0.0}], FILE, GRAVITY, "is 0 m/s^2, and `laboratory.gravity_m_s2` of lab.toml is 9.81"),
        ({}, [{"gravity": 1.62}], FILE, GRAVITY, "is 1.62 m/s^2"),
        (
            {"own": {"fmd+satellite": "s.h5"}},
            [{"article": "fmd+satelite"}],
            "fmd-satelite/campaign.toml",
            "campaign.article",
            "lab.toml has no model of it. Did you mean fmd+satellite?",
        ),
    ],
)
def test_what_does_not_belong_to_the_model_is_named(described, tested, source, field, says):
    error = refused(model(**described), *(campaign(**one) for one in tested))
    assert (error.source, error.field) == (source, field)
    assert says in f"{error.problem}. {error.remedy}"


@pytest.mark.parametrize("gravity", [9.80665, 9.78])
def test_gravity_of_another_place_fits(gravity):
    require_pair(model(), [campaign(gravity=gravity)])


@pytest.mark.parametrize(
    ("effect", "says"),
    [
        ("force-gain:fmd-z9=0.1", "no campaign has the force channel 'fmd-z9': fmd-clumod-1. Did you mean fmd-z4"),
        ("force-gain:cover-z1=0.1", "no campaign has the force channel 'cover-z1', where one of another kind is"),
        ("accelerometer-delay:fmd-z1=1e-4", "no campaign has the accelerometer 'fmd-z1', where one of another kind is"),
        ("accelerometer-position:cover-x9:y=0.01", "no campaign has the accelerometer 'cover-x9'"),
        ("channel-swap:fmd-z1:fmd-q", "no campaign has the channel 'fmd-q'"),
        ("modulus:upper-long=0.1", "no article here has the part 'upper-long': fmd+clumod-1"),
        ("layer-damping:upper-short=0.1", "no article here has the part 'upper-short': fmd+clumod-1"),
        ("point-mass:lower-2+=0.1", "no article here has the place 'lower-2+': fmd+clumod-1. Did you mean lower-1+"),
        ("slosh:top=m:1,f:6,zeta:0.01", "no article here has the place 'top': fmd+clumod-1"),
    ],
)
def test_an_effect_that_acts_on_nothing_is_named(effect, says):
    error = refused(model(effect), campaign())
    assert error.source == "lab.toml"
    assert error.field == f"effect {effect.partition('=')[0]}"
    assert re.search(re.escape(says), f"{error.problem}. {error.remedy}")


def test_the_parts_of_a_rigid_model_do_not_give():
    error = refused(model("modulus:mast=0.1", kind="rigid"), campaign())
    assert "the parts of a rigid model do not give" in error.problem
    own = model("modulus:boom=0.1", article="fmd+satellite", kind="rigid", own={"fmd+satellite": "s.h5"})
    assert "the parts of a rigid model do not give" in refused(own, campaign("fmd+satellite")).problem


def test_an_effect_on_the_way_in_is_held_against_the_same_and_a_channel_on_the_article_goes_with_it():
    with pytest.raises(BadInput, match="EFFECT: `effect force-gain:fmd-z9`: no campaign has the force channel"):
        require_target(model(), [campaign()], parse("force-gain:fmd-z9=0.1", ANY), "EFFECT")
    assert "lower-1+" in (vocabulary(model(), [campaign()]).places or ())
    place = Place(position=np.array([0.0, 0.0, 1.0]), direction=np.array([1.0, 0.0, 0.0]))
    tip = Channel(name="tip", quantity="acceleration", group="article", places=(place,))
    require_pair(model(), [campaign(), campaign("fmd+clumod-4", table=replace(TABLE, channels=(*TABLE.channels, tip)))])


def test_a_channel_that_one_of_two_campaigns_lacks_is_named():
    fewer = TABLE.subset([k for k, name in enumerate(TABLE.names) if name != "cover-z3"])
    error = refused(model(), campaign(), campaign("fmd+clumod-4", table=fewer))
    assert (error.source, error.field) == ("fmd-clumod-4/campaign.toml", "channel")
    assert error.problem == "cover-z3 is a channel of fmd-clumod-1 and not of fmd-clumod-4; both have the same hardware A"
    assert "cover-z3 is a channel of fmd-clumod-1" in refused(model(), campaign("fmd+clumod-4", table=fewer), campaign()).problem


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"group": "cover"}, "table-z1 belongs to the group table in fmd-clumod-1 and cover in fmd-clumod-4"),
        ({"senses_gravity": False}, "table-z1 senses gravity: True in fmd-clumod-1 and False in fmd-clumod-4"),
        ({"quantity": "force", "group": "fmd"}, "table-z1 measures acceleration in fmd-clumod-1 and force in fmd-clumod-4"),
    ],
)
def test_a_channel_that_is_another_is_named(changes, says):
    other = with_channel("table-z1", unit="", **changes)
    assert says in refused(model(), campaign(), campaign("fmd+clumod-4", table=other)).problem


def test_a_moved_and_a_turned_channel_are_named_and_the_same_places_in_another_frame_are_the_same():
    first = TABLE.channels[TABLE.names.index("cover-z1")]
    moved = with_channel("cover-z1", places=shifted(first, (0.01, 0.0, 0.0)))
    assert "cover-z1 lies at " in refused(model(), campaign(), campaign("fmd+clumod-4", table=moved)).problem
    turned = with_channel("cover-z1", places=(replace(first.places[0], direction=np.array([0.0, 0.0, -1.0])),))
    assert "cover-z1 points along (0, 0, 1)" in refused(model(), campaign(), campaign("fmd+clumod-4", table=turned)).problem
    double = with_channel("cover-z1", places=first.places * 2)
    assert "adds up 1 places" in refused(model(), campaign(), campaign("fmd+clumod-4", table=double)).problem
    by = (0.5, -0.2, 1.0)
    channels = tuple(replace(c, places=shifted(c, by)) for c in TABLE.channels)
    elsewhere = replace(TABLE, channels=channels, origin=TABLE.origin + np.array(by))
    require_pair(model(), [campaign(), campaign("fmd+clumod-4", table=elsewhere)])
    wrong = replace(TABLE, channels=channels)
    error = refused(model(), campaign(), campaign("fmd+clumod-4", table=wrong))
    assert "every channel lies (0.5, -0.2, 1) m farther from F than in fmd-clumod-1: one `frame.origin`" in error.problem
