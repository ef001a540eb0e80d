"""Pendulum files: one swing or several of one article, down to moments of inertia or to the whole tensor.

    kind = "pendulum"
    gravity = "9.811 +/- 0.001 m/s^2"
    [article]
    name = "clumod-4"
    mass = "47.40 +/- 0.05 kg"
    cog_z = "603.0 +/- 0.5 mm"              # also cog_x, cog_y; only for attachments given as positions
    [corrections]                           # optional switches; a term whose size is stated is on unless switched off
    amplitude = true
    damping = true
    rope-mass = false
    [torsion_rod]                           # for torsion rods: calibrated with a known rod
    rod_mass = "5.56 +/- 0.02 kg"
    rod_length = "1.05 +/- 0.001 m"
    rod_diameter = "30 +/- 0.1 mm"
    period = "1.894 s"
    [[swing]]
    about = "x"                             # or a direction in the article's frame, about = [1, 0, 1]
    suspension = "ropes"                    # "ropes", "compound" or "torsion-rod"
    rope_length = "2.000 +/- 0.002 m"
    s1 = "550 +/- 1 mm"                     # CoG to attachment; or positions = ["53 +/- 1 mm", "1503 +/- 1 mm"] along
    s2 = "900 +/- 1 mm"                     # positions_along = "z", from which s1, s2 follow with cog_z; or, for
    cycles = 20                             # three ropes or more, radius = "300 +/- 1 mm"
    time = "61.2 +/- 0.1 s"                 # or period = "...", times = ["..."], or signal = "record.csv" (time [s], signal)
    amplitude = "0.05 +/- 0.01 rad"         # sizes of the corrections, each optional
    damping = "0.2 +/- 0.1 %"
    rope_mass = "0.3 kg"                    # all ropes together

A compound swing needs `arm` (pivot to CoG) instead of ropes. Several swings about one coordinate axis are averaged.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.errors import BadInput
from geometry.quantities import quantity
from validation import period as periods
from validation.measurement_file import HEAD, Fields
from validation.orientations import SIX, tensor_from_axes
from validation.pendulum import rod_inertia, torsion_stiffness
from validation.pendulum_corrections import TERMS, CompoundSwing, RopeSwing, Terms, TorsionSwing
from validation.reduction import Reduction

if TYPE_CHECKING:
    from uncertainties import UFloat

_PERIOD_KEYS = ("period", "cycles", "time", "times", "signal")
_SIZES = {"amplitude": "angle", "damping": "ratio", "rope_mass": "mass"}
_OWN_KEYS = {
    "ropes": ("rope_length", "s1", "s2", "positions", "positions_along", "radius", "amplitude", "damping", "rope_mass"),
    "compound": ("arm", "amplitude", "damping"),
    "torsion-rod": ("damping",),
}
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
HONEST = (
    "One period is one number: it cannot separate amplitude, damping and rope mass, nor show that one of them is missing. "
    "Two amplitudes, two rope lengths and the decay can."
)
"""What a pendulum record does not say, said with every one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Swing:
    """A swing that has been read.

    Attributes
    ----------
    axis : (3,) direction of its axis in the article's frame
    pendulum : lengths, mass and period
    terms : its corrections
    stated : what the file or the record says of the sizes of corrections, switched off ones too
    ropes : how many there are, as far as the file says: three where it states their radius; 0 for a pivot or a torsion rod
    notes : what was noted on the way
    """

    axis: tuple[float, ...]
    pendulum: RopeSwing | CompoundSwing | TorsionSwing
    terms: Terms
    stated: Terms
    ropes: int
    notes: tuple[str, ...]

    @property
    def moment(self) -> UFloat:
        """Moment of inertia [kg m²] about the axis through the CoG."""
        return self.pendulum.inertia(self.terms)

    def moment_at(self, period: float) -> float:
        """The same, had it swung with another `period` [s]."""
        bare: Any = _bare(self.pendulum)
        return float(replace(bare, period=period).inertia(_bare(self.terms)))

    def effects(self) -> dict[str, float]:
        """Relative change of the result by each term, the others as they are."""
        whole = self.moment.nominal_value
        return {name: whole / self.pendulum.inertia(self.terms.without(name)).nominal_value - 1 for name in self.terms.names}


def _bare(noun: RopeSwing | CompoundSwing | TorsionSwing | Terms) -> Any:
    """The same in plain numbers, which are many times quicker than those that carry tolerances."""
    given = {each.name: getattr(noun, each.name) for each in fields(noun)}
    bare: dict[str, Any] = {name: None if value is None else float(value.nominal_value) for name, value in given.items()}
    return replace(noun, **bare)


def reduce(file: Fields, off: tuple[str, ...] = ()) -> Reduction:
    """The moments of inertia about the CoG [kg m²] that the pendulum `file` comes down to, corrections in `off` left out.

    Raises
    ------
    BadInput : something in the file cannot be used, contradicts itself, or does not determine the tensor.
    """
    found = swings(file, off)
    results, terms = _moments(found, file)
    return Reduction(
        title=file.text("title", "Pendulum"),
        origin=file.text("origin", "origin not stated"),
        article=file.inner("article").text("name"),
        results=results,
        terms=terms,
        notes=(*(note for swing in found for note in swing.notes), HONEST),
    )


def swings(file: Fields, off: tuple[str, ...] = ()) -> list[Swing]:
    """Every swing of the pendulum `file`, corrections in `off` left out.

    Raises
    ------
    BadInput : something in the file cannot be used, or contradicts itself.
    """
    file.only((*HEAD, "gravity", "corrections", "torsion_rod", "components", "swing"))
    article = file.inner("article").only(("name", "mass", "cog_x", "cog_y", "cog_z"))
    return [_swing(entry, file, article, off) for entry in file.each("swing")]


def _moments(swings: list[Swing], file: Fields) -> tuple[dict[str, UFloat], dict[str, Mapping[str, float]]]:
    coordinate = all(swing.axis in _AXES.values() for swing in swings)
    if not coordinate or "components" in file.table:
        components = file.table.get("components", list(SIX))
        if not isinstance(components, list) or not components or not set(map(str, components)) <= set(SIX):
            raise file.refused("components", f"found {components!r}", f"A list of some of {', '.join(SIX)}")
        moments = [swing.moment for swing in swings]
        tensor = tensor_from_axes([swing.axis for swing in swings], moments, components, file.source)
        return {f"I{name}": value for name, value in tensor.items()}, {}
    results: dict[str, UFloat] = {}
    terms: dict[str, Mapping[str, float]] = {}
    for letter, axis in _AXES.items():
        same = [swing for swing in swings if swing.axis == axis]
        if same:
            results[f"I{letter}{letter}"] = sum(swing.moment for swing in same) / len(same)
            terms[f"I{letter}{letter}"] = _mean_effects(same)
    return results, terms


def _mean_effects(swings: list[Swing]) -> dict[str, float]:
    each = [swing.effects() for swing in swings]
    names = [name for name in TERMS if any(name in effects for effects in each)]
    return {name: sum(effects.get(name, 0.0) for effects in each) / len(each) for name in names}


def _swing(entry: Fields, file: Fields, article: Fields, off: tuple[str, ...]) -> Swing:
    suspension = entry.choice("suspension", tuple(_OWN_KEYS))
    entry.only(("about", "suspension", *_PERIOD_KEYS, *_OWN_KEYS[suspension]))
    period, recorded, notes = _period(entry)
    pendulum = _SUSPENSIONS[suspension](entry, file, article, period)
    (terms, stated), ropes = (
        _terms(entry, file, off, recorded),
        (3 if "radius" in entry.table else 2) if suspension == "ropes" else 0,
    )
    swing = Swing(axis=_axis(entry), pendulum=pendulum, terms=terms, stated=stated, ropes=ropes, notes=notes)
    moment = _moment(swing, entry).nominal_value
    if moment <= 0:
        problem = f"the swing contradicts itself: its moment of inertia comes out as {moment:.4g} kg m²"
        why = "No body swings faster than a point mass there; check period, lengths and mass"
        raise BadInput(source=entry.source, field=entry.place, problem=problem, remedy=why)
    return swing


def _moment(swing: Swing, entry: Fields) -> UFloat:
    try:
        return swing.moment
    except BadInput as error:  # the equations know the quantity that is at fault, but not the file
        raise entry.refused(error.field, error.problem, error.remedy) from None


def _axis(entry: Fields) -> tuple[float, ...]:
    about = entry.table.get("about")
    if isinstance(about, str) and about in _AXES:
        return _AXES[about]
    if isinstance(about, list) and len(about) == 3 and all(isinstance(c, int | float) and not isinstance(c, bool) for c in about):
        length = float(np.linalg.norm(about))
        if np.isfinite(length) and length > 0:
            return tuple(float(c) / length for c in about)
    raise entry.refused("about", f"an axis is expected, found {about!r}", 'Write "x", "y", "z" or a direction like [1, 0, 1]')


def _gravity(file: Fields) -> UFloat:
    return file.positive("gravity", "acceleration")


def _ropes(entry: Fields, file: Fields, article: Fields, period: UFloat) -> RopeSwing:
    s1, s2 = _radii(entry, article)
    mass, length = article.positive("mass", "mass"), entry.positive("rope_length", "length")
    return RopeSwing(mass=mass, gravity=_gravity(file), s1=s1, s2=s2, length=length, period=period)


def _compound(entry: Fields, file: Fields, article: Fields, period: UFloat) -> CompoundSwing:
    mass, arm = article.positive("mass", "mass"), entry.positive("arm", "length")
    return CompoundSwing(mass=mass, gravity=_gravity(file), arm=arm, period=period)


def _torsion(entry: Fields, file: Fields, article: Fields, period: UFloat) -> TorsionSwing:
    rod = file.inner("torsion_rod").only(("known_inertia", "rod_mass", "rod_length", "rod_diameter", "period"))
    if "known_inertia" in rod.table:
        inertia = rod.positive("known_inertia", "moment of inertia")
    else:
        length, diameter = (rod.positive(key, "length") for key in ("rod_length", "rod_diameter"))
        inertia = rod_inertia(mass=rod.positive("rod_mass", "mass"), length=length, diameter=diameter)
    return TorsionSwing(
        stiffness=torsion_stiffness(known_inertia=inertia, period=rod.positive("period", "time", "period with the known rod")),
        period=period,
    )


_SUSPENSIONS: Mapping[str, Callable[[Fields, Fields, Fields, UFloat], RopeSwing | CompoundSwing | TorsionSwing]] = {
    "ropes": _ropes,
    "compound": _compound,
    "torsion-rod": _torsion,
}


def _radii(entry: Fields, article: Fields) -> tuple[UFloat, UFloat]:
    """s1 and s2 [m], in whichever of three ways the file gives them."""
    ways = [key for key in ("s1", "positions", "radius") if key in entry.table]
    if len(ways) != 1:
        remedy = "Give s1 and s2, or positions and positions_along, or radius (three ropes or more)"
        raise entry.refused("s1", f"the attachments must be given in one way, found {len(ways)}", remedy)
    if ways == ["radius"]:
        radius = entry.positive("radius", "length")
        return radius, radius
    if ways == ["s1"]:
        return entry.positive("s1", "length"), entry.positive("s2", "length")
    return _radii_from_positions(entry, article)


def _radii_from_positions(entry: Fields, article: Fields) -> tuple[UFloat, UFloat]:
    letter = entry.choice("positions_along", tuple(_AXES))
    texts = entry.table["positions"]
    if not isinstance(texts, list) or len(texts) != 2:
        raise entry.refused("positions", f"two are expected, found {texts!r}", "Give both ropes' places along the article")
    names = [f"position of rope {i}" for i in (1, 2)]
    one, two = (
        quantity(text, "length", source=entry.source, field=entry.path("positions"), name=name)
        for text, name in zip(texts, names, strict=True)
    )
    cog = article.quantity(f"cog_{letter}", "length", f"position of the CoG ({letter})")
    s1, s2 = cog - one, two - cog
    if s1.nominal_value * s2.nominal_value <= 0:
        places = f"{one.nominal_value:.6g} and {two.nominal_value:.6g} m"
        problem = f"the CoG at {cog.nominal_value:.6g} m is not between the ropes at {places}"
        raise entry.refused("positions", problem, "One rope would have to push; check the places and the CoG")
    return s1, s2  # both negative where the places are listed downwards: only their product and squares are used


def _period(entry: Fields) -> tuple[UFloat, periods.Decay | None, tuple[str, ...]]:
    """The period [s], the fitted decay where a signal was recorded, and notes."""
    ways = [key for key in ("period", "cycles", "times", "signal") if key in entry.table]
    if len(ways) != 1 or ("time" in entry.table) != (ways == ["cycles"]):
        remedy = "Give period, or cycles and time, or times, or signal"
        raise entry.refused("period", f"the period must be given in one way, found {', '.join(ways) or 'none'}", remedy)
    source = f"{entry.source}: {entry.place}"
    if ways == ["period"]:
        return entry.positive("period", "time"), None, ()
    if ways == ["cycles"]:
        count = entry.integer("cycles", 1, 1)
        return periods.from_cycles(count, entry.positive("time", "time", "time of the cycles"), source), None, ()
    if ways == ["times"]:
        return periods.from_times(_times(entry), source), None, ()
    decay = periods.from_signal(*_record(entry), source)
    return decay.period, decay, decay.notes


def _times(entry: Fields) -> list[UFloat]:
    texts = entry.table["times"]
    if not isinstance(texts, list):
        raise entry.refused("times", f"a list is expected, found {texts!r}", 'Write ["0.0 +/- 0.1 s", "3.1 +/- 0.1 s", ...]')
    return [quantity(text, "time", source=entry.source, field=entry.path("times"), name="passage times") for text in texts]


def _record(entry: Fields) -> tuple[Any, Any]:
    path = Path(entry.source).parent / entry.text("signal")
    if not path.is_file():
        raise entry.refused("signal", f"no file {path}", "The path is relative to the measurement file")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an empty file is refused below, in words
            columns = np.genfromtxt(path, delimiter=",", comments="#", dtype=np.float64)
    except (ValueError, UnicodeDecodeError) as error:
        why = str(error).splitlines()[0]
        raise entry.refused("signal", f"{path} is no table of numbers ({why})", "Two columns, comma between") from None
    if columns.ndim == 2 and np.all(np.isnan(columns[0])):
        columns = columns[1:]  # a line of headings
    if columns.ndim != 2 or columns.shape[1] != 2:
        raise entry.refused("signal", f"{path} has shape {columns.shape}", "Two columns, time in s and the signal, comma between")
    return columns[:, 0], columns[:, 1]


def _terms(entry: Fields, file: Fields, off: tuple[str, ...], recorded: periods.Decay | None) -> tuple[Terms, Terms]:
    """The corrections that are on, and the sizes of all that are stated."""
    switches = file.inner("corrections").only(TERMS)
    sizes: dict[str, UFloat | None] = {}
    known: dict[str, UFloat | None] = {}
    for key, dimension in _SIZES.items():
        name = key.replace("_", "-")
        stated = entry.optional(key, dimension)
        if stated is not None and (stated.nominal_value < 0 or (key == "damping" and stated.nominal_value >= 1)):
            remedy = "Damping is a ratio from 0 to 1, the others are not negative"
            raise entry.refused(key, f"out of range: {entry.table[key]!r}", remedy)
        if key == "damping" and stated is None and recorded is not None:
            stated = recorded.damping_ratio
        if stated is None and switches.switch(name, False) and key in _OWN_KEYS[entry.text("suspension")]:
            raise entry.refused(
                key, f"the correction {name} is switched on, but its size is missing", "State it, or switch it off"
            )
        known[key] = stated
        sizes[key] = stated if switches.switch(name, True) and name not in off else None
    return Terms(**sizes), Terms(**known)
