"""An effect as it is written: what is understood, and that everything else is refused with what to write instead."""

import re
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES, Named, parse, parse_all
from validation.effects.effect import (
    ACCELEROMETER,
    BETWEEN,
    CABLE,
    CHANNEL,
    DRIVE,
    FIXED,
    FORCE,
    PART,
    PENDULUM,
    PLACE,
    SUPPORT,
    Vocabulary,
)


@pytest.mark.parametrize("text", [text for family in FAMILIES.values() for text in family.example.split(", or ")])
def test_every_example_of_the_catalogue_is_understood_and_written_back(text):
    found = parse(text)
    again = parse(str(found))
    assert found.id == text.partition("=")[0] == again.id
    assert again.values == pytest.approx(dict(found.values), rel=1e-8)  # nine digits are written


def test_every_family_says_what_it_is_of_kinds_that_are_known():
    kinds = {kind for family in FAMILIES.values() for kind in family.targets}
    assert kinds <= {*FIXED, CHANNEL, FORCE, ACCELEROMETER, PLACE, PART, SUPPORT, BETWEEN, CABLE, DRIVE}
    assert all(family.what and family.side for family in FAMILIES.values())
    assert all(not family.targets for family in FAMILIES.values() if family.side == PENDULUM)


def test_values_are_read_by_key_with_what_holds_otherwise():
    assert dict(parse("friction:flange:x=3").values) == {"": 3.0, "mass": 2.0}
    assert dict(parse("friction:flange:x=3,mass:1.5").values) == {"": 3.0, "mass": 1.5}
    assert dict(parse("appendage:z=f:21, zeta:0.01, m:50e-3").values) == {"m": 0.05, "f": 21.0, "zeta": 0.01}
    assert parse("gravity").value == 1.0
    assert parse("gravity=0").value == 0.0
    assert parse("polarity:fmd-z1").values == {}


def test_a_unit_may_be_named_as_the_factor_of_the_numbers_and_that_of_a_size_follows_the_target():
    assert parse("unit:cover-z3=g").value == pytest.approx(1 / 9.80665, rel=1e-12)
    assert parse("unit:fmd-z1=kN").value == pytest.approx(1e-3, rel=1e-12)
    units = {"rigid-inertia:m=1": "kg", "rigid-inertia:mx=1": "kg m", "rigid-inertia:Ixy=1": "kg m^2"}
    units |= {"joint-compliance:torsion=1e-6": "rad/(N m)", "joint-compliance:lateral=1e-9": "m/N"}
    assert {text: parse(text).unit for text in units} == units


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("force-gian:fmd-z2=0.1", "no effect is called 'force-gian'. Did you mean force-gain?"),
        ("force-gain:fmd-z5=0.1", "no force channel is called 'fmd-z5'. Did you mean fmd-z"),
        ("force-gain:cover-z3=0.1", "no force channel is called 'cover-z3'"),
        ("force-gain=0.1", "it acts on force channel, found none"),
        ("force-gain:fmd-z1:x=0.1", "it acts on force channel, found fmd-z1:x"),
        ("force-gain:fmd-z1", "its value [1] is missing"),
        ("force-gain:fmd-z1=", "its value is missing"),
        ("force-gain:fmd-z1=ten", "a number in SI units is expected, found 'ten'"),
        ("force-gain:fmd-z1=nan", "its size [1] must be between -0.9 and 9, found nan"),
        ("force-gain:fmd-z1=-1.5", "its size [1] must be between -0.9 and 9, found -1.5"),
        ("force-gain:fmd-z1=0.1,0.2", "its value is given twice"),
        ("force-gain:fmd-z1=m:0.2", "its value is a number, found 'm:0.2'"),
        ("force-delay:fmd-z1=200", "must be between -0.1 and 0.1, found 200. Check its unit"),
        ("gravity=0.5", "must be 0 or 1, found 0.5"),
        ("gravity:x=0", "it acts on no target, found x"),
        ("force-crosstalk:xx=0.1", "no pair of axes is called 'xx'"),
        ("cell-stiffness:5x=0.1", "no cell and axis is called '5x'"),
        ("accelerometer-position:cover-z3=0.1", "it acts on accelerometer and axis, found cover-z3"),
        ("accelerometer-position:cover-z3:w=0.1", "no axis is called 'w'"),
        ("channel-swap:cover-z1:cover-z1", "cover-z1 is named twice"),
        ("polarity:fmd-z1=1", "it is there or not and has no value, found '1'"),
        ("unit:fmd-z1=lbs", "neither a factor nor a unit of fmd-z1, found 'lbs'. Did you mean lbf?"),
        ("unit:fmd-z1=g", "neither a factor nor a unit of fmd-z1, found 'g'. Known are N,"),
        ("unit:cover-z1=m/s", "neither a factor nor a unit of cover-z1, found 'm/s'. Did you mean m"),
        ("appendage:z=m:0.1,f:21", "its zeta [1] is missing"),
        ("appendage:z=m:0.1,f:21,z:0.01", "its value is m:number, f:number, zeta:number, found 'z:0.01'"),
        ("appendage:z=0.1", "its value is m:number, f:number, zeta:number, found '0.1'"),
        ("point-mass:mast-tip=0.1", "no place is called 'mast-tip'. Did you mean mast-top?"),
        ("rigid-inertia:Ixz3=1", "no parameter is called 'Ixz3'. Did you mean Ixz?"),
        ("", "no effect is called ''"),
    ],
)
def test_what_is_not_understood_is_refused_with_what_to_write(text, says):
    with pytest.raises(BadInput, match=re.escape(says)) as refused:
        parse(text)
    assert refused.value.source == "--effect"


def test_an_effect_is_named_once_and_a_test_of_other_channels_has_other_targets():
    with pytest.raises(BadInput, match="`force-gain:fmd-z1`: is given twice"):
        parse_all(["force-gain:fmd-z1=0.1", "polarity:fmd-z1", "force-gain:fmd-z1=0.2"])
    words = Vocabulary(accelerometers=("a1",), forces=("f1",), places=())
    assert parse("force-gain:f1=0.1", words).target == "f1"
    with pytest.raises(BadInput, match=r"no force channel is called 'fmd-z1'\. Known are f1"):
        parse("force-gain:fmd-z1=0.1", words)
    with pytest.raises(BadInput, match=r"no place is called 'mast-top'\. Leave it out"):
        parse("point-mass:mast-top=0.1", words)
    assert parse("point-mass:anywhere=0.1", Vocabulary(places=None)).target == "anywhere"


@given(st.text(max_size=40))
def test_no_text_brings_anything_but_an_effect_or_a_refusal(text):
    with suppress(BadInput):
        assert isinstance(parse(text), Named)
