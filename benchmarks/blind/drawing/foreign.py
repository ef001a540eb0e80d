"""Physics that no family of the catalogue describes, as hooks of a virtual test: what a laboratory has and nobody wrote down.

Each is a change of what the sensors read, or of what stands on the table, at a size between two. None can be said by a family at
any size; a few look like one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fem.base_excitation.rig import Rig, Strut
from geometry.frames import Array, rigid_transformation
from validation.effects.effect import COVER, FMD
from validation.virtual_test.plan import PlantedEffect, Sensed
from validation.virtual_test.planted import second_derivative, with_column

PREFIX = "unknown-"
"""Of their names: no family is called so."""

TOP_OF_BAND = 32.0
"""[Hz] at which sizes that grow with frequency are stated."""

BASE = 6


@dataclass(frozen=True, eq=False, kw_only=True)
class Foreign:
    """One piece of physics.

    Attributes
    ----------
    what : in words
    low, high : between which its size is drawn, by its logarithm
    unit : of the size
    channels : of which one is drawn; none for what no channel names
    made : ``made(channel, size) -> changes`` of `Effect` by place
    without : families that say nearly the same, and without which it is diagnosed
    """

    what: str
    low: float
    high: float
    unit: str
    channels: tuple[str, ...] = ()
    made: Callable[[str, float], Mapping[str, Callable[..., object]]]
    without: tuple[str, ...] = ()


def rising(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """An accelerometer near its mounting resonance: ``y (1 + s (f / f_top)^2)``, by the second derivative of what it reads."""

    def signals(sensed: Sensed) -> Sensed:
        y = sensed.values[:, sensed.column(channel)]
        curved = second_derivative(y, sensed.sampling_rate) / (2 * np.pi * TOP_OF_BAND) ** 2
        return with_column(sensed, channel, y - size * curved)

    return {"signals": signals}


def hearing(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """A force channel whose cable runs beside that of an accelerometer: it hears ``s`` newtons for a metre per second squared."""

    def signals(sensed: Sensed) -> Sensed:
        heard = sensed.values[:, sensed.column("cover-y1" if "-x" in channel else "cover-x1")]
        return with_column(sensed, channel, sensed.values[:, sensed.column(channel)] + size * heard)

    return {"signals": signals}


def drifting(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """An amplifier that warms up: its gain moves by ``s`` from the beginning of every run to its end."""

    def signals(sensed: Sensed) -> Sensed:
        y = sensed.values[:, sensed.column(channel)]
        return with_column(sensed, channel, y * (1 + size * np.linspace(-0.5, 0.5, len(y))))

    return {"signals": signals}


def ringing(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """A loose cell: a share ``s`` of what its channel reads passes a resonance at 19 Hz of 3 % damping."""

    def signals(sensed: Sensed) -> Sensed:
        y = sensed.values[:, sensed.column(channel)]
        return with_column(sensed, channel, y + size * _resonance(y, 19.0, 0.03, sensed.sampling_rate))

    return {"signals": signals}


def strained(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """A pick-up that feels the strain of the plate under it: it reads ``s`` metres per second squared for a newton sideways."""

    def signals(sensed: Sensed) -> Sensed:
        if sensed.response is None:
            raise ValueError("`response` must be there: strain is that of the simulated load")
        y = sensed.values[:, sensed.column(channel)]
        return with_column(sensed, channel, y + size * sensed.response.load[:, 0])

    return {"signals": signals}


def slow_clock(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """Force channels with a clock of their own that is slow by the share ``s``: they lag the more the longer a run has lasted."""

    def signals(sensed: Sensed) -> Sensed:
        values, count = np.array(sensed.values), len(sensed.values)
        late = np.arange(count) * (1 - size)
        for name in FMD:
            column = sensed.column(name)
            values[:, column] = np.interp(late, np.arange(count), values[:, column])
        return replace(sensed, values=values)

    return {"signals": signals}


def gyroscope(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """A wheel that spins about z inside the article: ``M_x += h beta'``, ``M_y -= h alpha'``, which no symmetric matrix holds."""

    def signals(sensed: Sensed) -> Sensed:
        if sensed.response is None:
            raise ValueError("`response` must be there: a wheel resists the motion that is simulated")
        rate = np.cumsum(sensed.response.cover[:, 3:5], axis=0) / sensed.sampling_rate
        moments = size * rate @ np.array([[0.0, -1.0], [1.0, 0.0]])
        return replace(sensed, values=sensed.values + moments @ _of_moments(sensed))

    return {"signals": signals}


def dashpot(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """A damper in newton seconds per metre from the mast's top to the table: loss that grows with frequency, and sits nowhere."""

    def rig(made: Rig) -> Rig:
        place = "mast-top" if "mast-top" in made.article.places else ""
        strut = Strut(place=place, to="table", damping=np.array([size, size, 0.0]))
        return replace(made, struts=(*made.struts, strut)) if place else made

    return {"rig": rig}


def lashing(channel: str, size: float) -> dict[str, Callable[..., object]]:
    """A spring in newtons per metre from one corner of the cover plate to the frame, along x alone."""

    def rig(made: Rig) -> Rig:
        corner, body = np.array([0.2, -0.2, 0.03]), made.article
        rows = np.zeros((3, len(body.reduced.mass)))
        rows[:, :BASE] = rigid_transformation(corner - made.seat)
        placed = replace(body, places={**body.places, "corner": rows})
        strut = Strut(place="corner", to="ground", stiffness=np.array([size, 0.0, 0.0]))
        return replace(made, article=placed, struts=(*made.struts, strut))

    return {"rig": rig}


def _resonance(y: Array, frequency: float, ratio: float, rate: float) -> Array:
    """`y` (n,) through ``1 / (1 - (f / f_0)^2 + 2 i zeta f / f_0)``, less `y`, by the bilinear rule."""
    from scipy.signal import bilinear, lfilter

    omega = 2 * np.pi * frequency
    return np.asarray(lfilter(*bilinear([omega**2], [1.0, 2 * ratio * omega, omega**2], fs=rate), y)) - y


def _of_moments(sensed: Sensed) -> Array:
    """(2, c) what the z channels read for a moment about x and one about y, shared out over the cells by their places."""
    z = [c.name.startswith("fmd-z") for c in sensed.table.channels]
    x, y = (np.array([c.places[0].position[k] * on for c, on in zip(sensed.table.channels, z, strict=True)]) for k in (0, 1))
    return np.array([y / (y @ y), -x / (x @ x)])


VERTICAL = tuple(name for name in COVER if "-z" in name)

FOREIGN: Mapping[str, Foreign] = {
    "rising-gain": Foreign(what="a gain that rises with frequency", low=0.05, high=0.3, unit="1", channels=COVER, made=rising),
    "hearing": Foreign(
        what="a force channel hears an accelerometer", low=0.3, high=3.0, unit="N s²/m", channels=FMD, made=hearing
    ),
    "drift": Foreign(
        what="a gain that drifts during a run", low=0.05, high=0.3, unit="1", channels=(*COVER, *FMD), made=drifting
    ),
    "loose-cell": Foreign(what="a resonance in one load cell", low=0.003, high=0.03, unit="1", channels=FMD, made=ringing),
    "strain": Foreign(what="a pick-up that feels strain", low=1e-4, high=1e-3, unit="m/(s² N)", channels=VERTICAL, made=strained),
    "slow-clock": Foreign(what="a clock of its own", low=2e-5, high=2e-4, unit="1", made=slow_clock),
    "gyroscope": Foreign(what="a spinning wheel", low=0.3, high=3.0, unit="N m s", made=gyroscope),
    "dashpot": Foreign(what="a damper to the table", low=3.0, high=30.0, unit="N s/m", made=dashpot),
    "lashing": Foreign(
        what="a spring from the cover plate to the frame", low=2e3, high=2e4, unit="N/m", made=lashing, without=("cable",)
    ),
}


def effect(name: str, channel: str, size: float) -> PlantedEffect:
    """The hooks of the physics `name`."""
    what = FOREIGN[name]
    id = ":".join(filter(None, (PREFIX + name, channel)))
    changes: dict[str, Callable[..., object]] = dict(what.made(channel, size))
    return partial(PlantedEffect, id=id, value={"": size})(**changes)  # type: ignore[arg-type]


def of_text(text: str) -> PlantedEffect:
    """The hooks of what `benchmarks.blind.drawing.case.Planted.text` says.

    Raises
    ------
    KeyError : there is no such physics.
    """
    id, _, size = text.partition("=")
    name, _, channel = id.removeprefix(PREFIX).partition(":")
    return effect(name, channel, float(size))
