"""What a leftover looks like, in words: for somebody who knows axes and channels and nothing of this program."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from geometry.dynamic_mass import MOTIONS
from geometry.observability import LOADS
from geometry.sensors import GROUPS
from validation.diagnosing.diagnosis import Leftover
from validation.diagnosing.leftover.courses import DAMPING, MASS, RESONANCE, STIFFNESS
from validation.diagnosing.leftover.places import AXIS, CHANNEL, GROUP, HEARD, JOINT, LOCATION, PAIR, PART, SPAN, Place
from validation.diagnosing.leftover.ranking import Explanation

UNITS: Mapping[str, tuple[str, str, str]] = MappingProxyType(
    {
        "kg": ("kg", "kg m", "kg m^2"),
        "N/m": ("N/m", "N", "N m"),
        "N s/m": ("N s/m", "N s", "N s m"),
        "m/N": ("m/N", "1/N", "1/(N m)"),
    }
)
"""Of an entry of the dynamic mass between two translations, one and a rotation, two rotations."""

OF_PARTS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "modulus": (STIFFNESS, "the stiffness of {}"),
        "loss": (DAMPING, "the loss of {}"),
        "damping-law": (DAMPING, "how far losses follow the velocity"),
        "cell-stiffness": (STIFFNESS, "the stiffness of load cell {}"),
        "fmd-compliance": (STIFFNESS, "how far the FMD gives, {}"),
        "frequency": (RESONANCE, "the resonance at {}"),
        "damping": (DAMPING, "the damping of the resonance at {}"),
    }
)
"""By family of parameter: what it looks like, and what it is."""


def leftover(found: Explanation, share: float, resonance: float | None) -> Leftover:
    """`found`, which covers `share`, as what the leftover looks like; `resonance` [Hz] of the mode that it names."""
    size, unit = _size(found)
    return Leftover(
        text=f"{sentence(found, resonance)}. That is {min(share, 1):.0%} of what is left.",
        looks_like=found.course.looks_like or OF_PARTS[found.place.part.partition(":")[0]][0],
        load="" if found.place.kind == HEARD else found.place.load,
        motion="" if found.place.kind == HEARD else found.place.motion,
        channels=found.place.channels,
        frequency=found.course.frequency or resonance,
        share=share,
        size=size,
        unit=unit,
    )


def sentence(found: Explanation, resonance: float | None = None) -> str:
    """Where, and what it looks like, without a full stop."""
    where = f" ({found.data_set} alone)" if found.data_set else ""
    return f"{_where(found.place, resonance)}{where}, {_how(found)}"


def _where(place: Place, resonance: float | None) -> str:
    if place.kind == CHANNEL:
        return f"{place.channels[0]} alone"
    if place.kind == GROUP:
        return "all accelerometers" if not place.part else f"all channels of the {GROUPS[place.part].partition(',')[0]}"
    if place.kind == LOCATION:
        return f"{place.part}, along {place.along}"
    if place.kind == JOINT:
        return f"between cover plate and article, along {' and '.join((place.motion, *(one for _, one in place.others)))}"
    if place.kind == HEARD:
        return f"{place.channels[0]} hears {place.channels[1] if len(place.channels) > 1 else _axis(place)}"
    if place.kind == AXIS:
        return f"{_axis(place)} as the channels tell it"
    if place.kind in (PAIR, SPAN):
        return _pair(place)
    family, _, part = place.part.partition(":")
    return OF_PARTS[family][1].format(f"{resonance:.3g} Hz" if resonance else part)


def _axis(place: Place) -> str:
    return f"load {place.load}" if place.load else f"motion {place.motion}"


def _pair(place: Place) -> str:
    if place.kind == SPAN:
        others = ", ".join(f"{MOTIONS[LOADS.index(load)]} and {motion}" for load, motion in place.others)
        with_others = f", with {others}" if others else ""
        return f"between {MOTIONS[LOADS.index(place.load)]} and {place.motion}{with_others}"
    if not place.sign:
        return f"load {place.load} for motion {place.motion}"
    opposite = " with opposite signs" if place.sign < 0 else ""
    return f"between {MOTIONS[LOADS.index(place.load)]} and {place.motion}, both ways{opposite}"


def _how(found: Explanation) -> str:
    course, place = found.course, found.place
    if place.kind == PART:
        return f"different {course.text}"
    of_size = _of_size(*_size(found))
    if course.looks_like == RESONANCE:
        return f"as {course.text}{of_size}"
    if place.kind in (PAIR, SPAN):
        return f"like a {course.looks_like}{of_size}: it {course.text}"
    if place.kind == HEARD:
        return f"{course.text}{of_size}"
    if place.kind == LOCATION:
        tied = "" if course.looks_like == MASS else f" to {place.to}"
        return f"like {course.text}{tied}{of_size}"
    return f"as {course.text}{of_size}"


def _of_size(size: float | None, unit: str) -> str:
    if size is None:
        return ""
    if unit == "1":
        return f" of {100 * size:.3g} %"
    return f" of {1e3 * size:.3g} ms" if unit == "s" else f" of {size:.3g} {unit}"


def _size(found: Explanation) -> tuple[float | None, str]:
    place, course = found.place, found.course
    if not course.stated:
        return None, ""
    if place.kind in (PAIR, SPAN, JOINT):
        return found.size, UNITS[course.unit][_rotations(place)]
    if place.kind == LOCATION:
        return found.size, course.unit
    if place.kind == PART:
        return None, ""
    if place.kind == HEARD:
        return (found.size, place.unit) if place.unit else (None, "")
    return found.size, "1" if course.unit == "kg" else course.unit


def _rotations(place: Place) -> int:
    return (LOADS.index(place.load) >= 3) + (MOTIONS.index(place.motion) >= 3)
