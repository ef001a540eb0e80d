"""`Statement`: what somebody says about a body's inertia - a route, a table in print, a balance, an identification.

A statement holds up to ten values in the form in which tables print them: the mass, the CoG from the frame's origin, and moments
and products *about the CoG*, products as matrix entries. Unlike `Inertia` it may be partial (the paper prints no products), and
each value carries its tolerance and the decimals that were printed. Seeing it from another frame keeps what can be kept: a value
that would need an unstated one becomes unstated itself.

Tolerances go through linearised, independent ones in quadrature; they are small beside the values, and every map here is a
polynomial of low degree.
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Array, Pose, frozen, proper_rotation, rotation_about
from geometry.inertia import Inertia, parallel_axis, six_from_tensor, tensor_from_six
from geometry.toml_file import LARGEST_QUANTITY, SI_UNITS, quantity
from identification.quality import NORMAL_95
from validation.output import NONE, derived, entry, plain_unit, rounded, unwritten

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text


@dataclass(frozen=True, eq=False, kw_only=True)
class Quantity:
    """One of the ten values of a statement.

    Attributes
    ----------
    key : as in CSV and messages
    label : as printed
    unit : as printed
    per_si : printed value of one SI unit
    """

    key: str
    label: str
    unit: str
    per_si: float = 1.0


QUANTITIES = (
    Quantity(key="mass", label="Mass m", unit="kg"),
    *(Quantity(key=f"cog_{axis}", label=f"CoG {axis}", unit="mm", per_si=1e3) for axis in "xyz"),
    *(Quantity(key=f"moi_{axes}", label=f"MoI Θ{axes}", unit="kg m²") for axes in ("xx", "yy", "zz")),
    *(Quantity(key=f"poi_{axes}", label=f"PoI Θ{axes}", unit="kg m²") for axes in ("xy", "xz", "yz")),
)
"""The ten values in the order of a statement, which is that of Eq. 4."""

MASS, COG, TENSOR = 0, slice(1, 4), slice(4, 10)


@dataclass(frozen=True, eq=False, kw_only=True)
class Stated:
    """One stated value.

    Attributes
    ----------
    value : [SI]
    tolerance : [SI], None where none is stated
    decimals : decimals printed in the unit of its `Quantity`; None where nothing was printed
    """

    value: float
    tolerance: float | None = None
    decimals: int | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Statement:
    """Up to ten values about the CoG, in the axes and from the origin of one frame.

    Attributes
    ----------
    name : heading of its column
    values : ten, in the order of `QUANTITIES`; None where not stated
    source : where it comes from: a table's number, a file, a route
    tolerance_note : what its tolerances are and how they came about, in words; says *assumed* where they are
    """

    name: str
    values: tuple[Stated | None, ...] = unwritten()
    source: str = ""
    tolerance_note: str = unwritten(default="")

    @property
    @derived("", before="name")
    def stated_values(self) -> dict[str, Any]:
        """INERTIA of the output contract, null for what is not stated."""
        return _shaped([None if stated is None else stated.value for stated in self.values]) | {"about": "cog"}

    @property
    @derived("tolerance")
    def stated_tolerances(self) -> dict[str, Any]:
        """The same of the tolerances."""
        return _shaped([None if stated is None else stated.tolerance for stated in self.values]) | {"note": self.tolerance_note}

    @property
    def complete(self) -> bool:
        """Whether all ten values are stated."""
        return None not in self.values

    @property
    def inertia(self) -> Inertia:
        """The stated body, products that are not stated taken as zero; about the frame's origin.

        Raises
        ------
        ValueError : the mass, the CoG or a moment is not stated.
        """
        missing = [q.label for q, stated in zip(QUANTITIES[:7], self.values, strict=False) if stated is None]
        if missing:
            raise ValueError(f"`values` must state mass, CoG and moments to be a body, {', '.join(missing)} not stated")
        return inertia_of(np.array([0.0 if stated is None else stated.value for stated in self.values]))


def _shaped(ten: Sequence[float | None]) -> dict[str, Any]:
    """`ten` values [SI] by the keys of INERTIA, with fifteen digits: what a printed 603.3 mm is, after its way through metres."""
    shown = [None if v is None else float(f"{v * q.per_si:.15g}") for v, q in zip(ten, QUANTITIES, strict=True)]
    return {"mass_kg": shown[0], "cog_mm": shown[1:4], "moi_cog_kgm2": shown[4:7], "poi_cog_kgm2": shown[7:]}


def about_cog(inertia: Inertia) -> Array:
    """Ten values of a statement from `inertia`: mass, CoG in the body's frame, moments and products about the CoG; SI."""
    return np.concatenate([[inertia.mass], inertia.cog, inertia.moments_cog, inertia.products_cog])


def inertia_of(values: npt.ArrayLike) -> Inertia:
    """The body with the ten `values` of a statement [SI], about the frame's origin."""
    v = np.asarray(values, dtype=np.float64)
    return Inertia.from_cog(v[MASS], v[COG], tensor_from_six(v[TENSOR]))


def seen_from(said: Statement, frame: Pose) -> Statement:
    """`said` from the origin and along the axes of `frame`, whose pose is given in the frame of `said`."""
    R, p = frame.rotation, frame.position

    def change(values: Array) -> Array:
        tensor = R.T @ tensor_from_six(values[TENSOR]) @ R
        return np.concatenate([values[:1], R.T @ (values[COG] - p), six_from_tensor(tensor)])

    values = through(change, said.values)
    lengths, moments = _largest(said.values[COG], *p), _largest(said.values[TENSOR])
    size = (0.0, *[lengths] * 3, *[moments] * 6)
    # The cosine of 90 degrees is not quite zero; what it leaves behind is.
    kept = (v if v is None or abs(v.value) > _LEFT * s else replace(v, value=0.0) for v, s in zip(values, size, strict=True))
    return replace(said, values=tuple(kept))


def _largest(values: Sequence[Stated | None], *more: float) -> float:
    return max((abs(v) for v in (*(s.value for s in values if s is not None), *more)), default=0.0)


def through(
    change: Callable[[Array], Array], values: Sequence[Stated | None], spread: Array | None = None
) -> tuple[Stated | None, ...]:
    """Ten `values` taken through `change`, a map of (10,) [SI] to (10,) [SI], with tolerance and printed decimals.

    `spread` (10, 10) is the square of the tolerances with what they share; by default they are independent.
    """
    stated = np.array([v is not None for v in values])
    point = np.array([0.0 if v is None else v.value for v in values])
    tolerance = np.array([0.0 if v is None or v.tolerance is None else v.tolerance for v in values])
    with_tolerance = np.array([v is not None and v.tolerance is not None for v in values])
    J = jacobian(change, point)
    # An unstated value stands in with a value that is nobody's zero, so that no dependence on it hides.
    depends = np.abs(jacobian(change, np.where(stated, point, _NOBODYS_ZERO))) > _SEEN
    result = change(point)
    squares = np.diag(tolerance**2) if spread is None else spread
    tolerances = np.sqrt(np.maximum(np.diag(J @ squares @ J.T), 0.0))

    def one(k: int) -> Stated | None:
        if np.any(depends[k] & ~stated):
            return None
        decimals = [v.decimals for v, used in zip(values, depends[k], strict=True) if used and v is not None]
        return Stated(
            value=float(result[k]),
            tolerance=float(tolerances[k]) if np.any(depends[k] & with_tolerance) else None,
            decimals=max((d for d in decimals if d is not None), default=None),
        )

    return tuple(one(k) for k in range(10))


def jacobian(change: Callable[[Array], Array], point: Array) -> Array:
    """Derivatives (10, 10) of `change` at `point` by central differences."""
    # All but the mass enter as polynomials of second degree, for which central differences are exact at any step.
    step = 1e-4 * np.maximum(np.abs(point), 1.0)
    step[MASS] = 1e-4 * (abs(point[MASS]) or 1.0)
    columns = [(change(point + h) - change(point - h)) / (2 * h[k]) for k, h in enumerate(np.diag(step))]
    J = np.column_stack(columns)
    whole = np.round(J)
    return np.where(np.abs(J - whole) < _SEEN, whole, J)


_NOBODYS_ZERO = np.array([0.917, 0.331, 0.457, 0.593, 0.709, 0.811, 0.929, 0.137, 0.173, 0.219])
_SEEN = 1e-9
_LEFT = 1e-13


# The user's own frame in one line: ``"0 0 45 mm; z 90 deg"``.
#
# Before the semicolon stands where the origin is, seen from the article's frame, with its unit; after it, optionally, the turns
# that carry the article's axes into the user's, each about an axis of the frame as turned so far, in the order written. A file
# may say the same as a table with ``origin = "0 0 45 mm"`` and ``rotation``, either such turns or a 3x3 matrix whose columns are
# the user's axes in the article's frame, written as three rows of three or as nine numbers row by row.


NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

_POSITION = re.compile(rf"\s*({NUMBER})[\s,]+({NUMBER})[\s,]+({NUMBER})\s*([A-Za-zµ]+)\s*")
_TURN = re.compile(rf"\s*([xyz])\s+({NUMBER})\s*([A-Za-z°]+)\s*")


def read_frame(option: str, source: str = "--frame") -> Pose:
    """The pose of the user's frame in the article's, from one line or from a TOML file with a ``[frame]`` table.

    Raises
    ------
    BadInput : neither; no such file or no TOML in it; a unit missing or of another dimension; a matrix that is no rotation.
    OSError : the file cannot be read.
    """
    if not option.strip().endswith(".toml"):
        return pose_of(option, source)
    table = toml_file.read(option, remedy='Name a TOML file with a [frame] table, or write the frame: "0 0 45 mm; z 90 deg"')
    toml_file.require_present(table, ["frame"], source=option)
    return pose_of(table["frame"], option)


def pose_of(frame: object, source: str, field: str = "frame") -> Pose:
    """The pose that a line of text or a table with `origin` and `rotation` describes.

    Raises
    ------
    BadInput : see `read_frame`.
    """
    if isinstance(frame, str):
        origin, _, turns = frame.partition(";")
        return Pose(position=position(origin, source, field), rotation=_rotation(turns, source, field))
    table = toml_file.require_table(frame, source=source, where=field)
    toml_file.require_known(table, ("origin", "rotation"), source=source, where=field)
    there = position(table.get("origin", "0 0 0 m"), source, f"{field}.origin")
    return Pose(position=there, rotation=_rotation(table.get("rotation", ""), source, f"{field}.rotation"))


def position(text: object, source: str, field: str) -> Array:
    """Position (3,) [m] from three numbers and one unit of length.

    Raises
    ------
    BadInput : it does not read so.
    """
    found = _POSITION.fullmatch(text) if isinstance(text, str) else None
    if found is None:
        problem = f"must be three numbers and a unit of length, found {text!r}"
        raise BadInput(source, field, problem, 'Write for example "0 0 45 mm", turns after a semicolon: "0 0 45 mm; z 90 deg"')
    numbers, unit = found.groups()[:3], found[4]
    return np.array([_si(f"{number} {unit}", "length", source, field) for number in numbers])


def _rotation(value: Any, source: str, field: str) -> Array:
    if isinstance(value, str):
        rotation = np.eye(3)
        for turn in filter(str.strip, value.split(",")):
            found = _TURN.fullmatch(turn)
            if found is None:
                problem = f"a turn must be an axis, a number and a unit of angle, found {turn.strip()!r}"
                raise BadInput(source, field, problem, 'Write for example "z 90 deg, x 5 deg"')
            angle = _si(f"{found[2]} {found[3]}", "angle", source, field)
            rotation = rotation @ rotation_about(found[1], angle)
        return rotation
    # The numbers of three rows of three, or of one list of nine, row by row; None when it is neither
    entries = value if isinstance(value, list) else []
    if len(entries) == 3 and all(isinstance(row, list) and len(row) == 3 for row in entries):
        entries = [entry for row in entries for entry in row]
    nine_numbers = all(toml_file.is_number(entry) for entry in entries)
    numbers = [float(entry) for entry in entries] if nine_numbers and len(entries) == 9 else None
    if numbers is None:
        raise _no_rotation(f"found {value!r}", source, field)
    try:
        return proper_rotation(np.array(numbers).reshape(3, 3), field)
    except ValueError as error:
        raise _no_rotation(str(error), source, field) from None


def _no_rotation(why: str, source: str, field: str) -> BadInput:
    remedy = 'Give nine numbers with ten digits each, row by row, or turns such as "z 30 deg"'
    return BadInput(source, field, f"is no rotation: {why}", remedy)


def _si(text: object, dimension: str, source: str, field: str) -> float:
    return float(quantity(text, dimension, source=source, field=field).nominal_value)


# Values with the digits that were printed: ``"33.92 kg"``, ``"47.40 +/- 0.05 kg"``.
#
# A value without a tolerance is known to half a unit of its last printed digit and no better: that is the rounding of the print,
# and it is the least that two such values can be held to.


NOT_STATED = "not stated"
_PLACES = round(math.log10(LARGEST_QUANTITY))
_LEADING = re.compile(r"\(?\s*[+-]?(\d*)\.?(\d*)(?:[eE]([+-]?\d+))?")
_SHOWN_PER_SI = {"length": 1e3}
"""Statements are shown in millimetres; everything else in SI."""


def stated(text: object, dimension: str, source: str, field: str) -> Stated | None:
    """Read ``value [+/- tolerance] unit`` of `dimension`; "not stated" (or null) gives None.

    Raises
    ------
    BadInput : see `quantity`.
    """
    if text is None or (isinstance(text, str) and text.strip() == NOT_STATED):
        return None
    typed = text.replace("−", "-") if isinstance(text, str) else text
    read = quantity(typed, dimension, source=source, field=field)
    value = float(read.nominal_value)
    # Decimal place of the last printed digit: 2 for 33.92, -3 for 12e3; none beyond those that `quantity` reads
    found = _LEADING.match(str(typed).strip())
    place = len(found[2]) - int(found[3] or 0) if found else 0
    last_digit = min(max(place, -_PLACES), _PLACES)
    # The SI value of the number 1 in the unit of `str(typed).strip()`
    one = float(quantity(_LEADING.sub("1 ", str(typed).strip(), count=1), dimension, source=source, field=field).nominal_value)
    tolerance = float(read.std_dev) or 0.5 * 10.0**-last_digit * one
    shown = one * _SHOWN_PER_SI.get(dimension, 1.0)
    return Stated(value=value, tolerance=tolerance, decimals=max(0, last_digit - round(math.log10(shown))))


# `Row`: one quantity with its tolerance beside its reference, and what becomes of a list of them.
#
# `weigh`, `cog`, `pendulum` and `validate` all answer with rows. The deviation is relative to the reference, as in the paper's
# Tables 1 and 2 (there the finite-element value). The verdict compares the deviation with both tolerances in quadrature; what
# states no tolerance counts as exact, so a row without any is within only where the values coincide. A row without a reference
# has nothing that contradicts it and is within.


HEADS = ("quantity", "value\n± tolerance", "reference", "deviation", "in tol.", "within", "dominated by")
"""Of the columns; all but the first and the last hold figures."""

MIN_WORDS = 11
"""Columns below which words are not squeezed: room for "CoG [kg m²]"."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Row:
    """One line of a table of results.

    Attributes
    ----------
    quantity : what it is, in the field's words, with the point it refers to
    value : in `unit`
    tolerance : in `unit`, of `value`; None where none is stated
    unit : as printed, for example "kg m²"
    reference : in `unit`; None where nothing is known to hold the value against
    reference_tolerance : in `unit`; None where none is stated
    dominated_by : name of the input that contributes most to `tolerance`; empty where nothing is propagated
    """

    quantity: str
    value: float
    tolerance: float | None
    unit: str = entry(write=plain_unit)
    reference: float | None = None
    dominated_by: str = ""
    reference_tolerance: float | None = None

    @property
    def deviation(self) -> float | None:
        """Value minus reference, in `unit`."""
        return None if self.reference is None else self.value - self.reference

    @property
    @derived("deviation_percent", before="dominated_by")
    def deviation_percent(self) -> float | None:
        """Deviation in per cent of the reference; None without one, or where it cannot be told from zero: no share of nothing."""
        if not self.reference or self.deviation is None or abs(self.reference) <= self.combined_tolerance:
            return None
        return 100 * self.deviation / abs(self.reference)

    @property
    def combined_tolerance(self) -> float:
        """Both tolerances in quadrature, in `unit`."""
        return math.hypot(self.tolerance or 0.0, self.reference_tolerance or 0.0)

    @property
    @derived("deviation_in_tolerances")
    def deviation_in_tolerances(self) -> float | None:
        """Deviation in units of the combined tolerance; None without a reference or without any tolerance."""
        return None if self.deviation is None or self.combined_tolerance == 0 else self.deviation / self.combined_tolerance

    @property
    @derived("within", before="dominated_by")
    def within(self) -> bool:
        """Whether value and reference agree within the combined tolerance; true as well where nothing is known."""
        return self.deviation is None or abs(self.deviation) <= self.combined_tolerance

    @property
    @derived("compared")
    def compared(self) -> bool:
        """Whether there is a reference: tells the two kinds of `within` apart."""
        return self.reference is not None


def rows_table(rows: Iterable[Row], title: str = "") -> "Table":
    """`rows` as a table to print; a value is rounded to the second significant digit of its tolerance.

    What no row has, as a reference where nothing is held against one, is no column. It fits 80 columns: figures are never broken
    or cut, only words wrap.
    """
    from rich import box
    from rich.table import Table
    from rich.text import Text

    wide = min(80, max(map(len, title.splitlines()), default=0))  # else a title breaks where its table ends
    said, plain = headline(title) if title else None, box.SIMPLE_HEAD
    table = Table(title=said, title_justify="left", box=plain, padding=(0, 1, 0, 0), pad_edge=False, min_width=wide)
    listed = list(rows)
    columns = list(zip(*map(_cells, listed), strict=True)) or [()] * len(HEADS)
    kept = [(head, cells) for head, cells in zip(HEADS, columns, strict=True) if not cells or set(cells) != {NONE}]
    for head, cells in kept:
        if head in HEADS[1:-1]:
            add_figures(table, head, cells)
        else:
            table.add_column(head, min_width=MIN_WORDS)
    for k, row in enumerate(listed):
        table.add_row(*(Text(cells[k]) for _, cells in kept), style=None if row.within else "bold red")
    return table


def add_figures(table: "Table", heading: str, cells: Iterable[str]) -> None:
    """Add a column to `table` that is never narrower than its `heading` and its `cells`, which are never broken."""
    width = max(map(len, (*heading.splitlines(), *cells)))
    table.add_column(heading, justify="right", no_wrap=True, min_width=width)


def headline(title: str) -> "Text":
    """`title` as it stands over a table: its first line bold, what follows ("constructed, not measured") to be seen as well."""
    from rich.text import Text

    first, *rest = title.splitlines()
    return Text("\n").join([Text(first, style="bold not italic"), *(Text(line, style="yellow not italic") for line in rest)])


def _cells(row: Row) -> tuple[str, ...]:
    percent, many = row.deviation_percent, row.deviation_in_tolerances
    own = rounded(row.value, row.tolerance)
    return (
        f"{row.quantity} [{row.unit}]",
        f"{own} ± {rounded(row.tolerance, row.tolerance)}" if row.tolerance else own,
        rounded(row.reference, row.reference_tolerance),
        NONE if percent is None else f"{percent:+.2f} %",
        NONE if many is None else f"{many:+.2f}",
        NONE if row.reference is None else ("yes" if row.within else "no"),
        row.dominated_by or NONE,
    )


# Ten parameters as a person writes them: the ``[inertia]`` table of a result file and of the published data.
#
# about         the point of the moments and products: "cog" (default), "origin", or three numbers and a unit, in the file's own
#               frame
# mass          with its unit, as every value; a value without "+/-" is taken as known to half a unit of its last digit
# cog           three, from the origin of the file's own frame; or instead
# first_moment  three, mass times CoG *from the point `about`* (Eq. 4: m x, m y, m z)
# moments       Θxx, Θyy, Θzz about `about`
# products      Θxy, Θxz, Θyz about `about`, with the sign that ``products_sign`` states: "matrix-entry", -∫xy dm, as in Eq. 4,
#               or "positive-integral", +∫xy dm, as SolidWorks and others print; there is no default
#
# Beside it, at most one of ``[tolerance]`` (a half-width for each group, absolute or per cent), ``[interval95]`` (low and high
# for each value) and `covariance` (10x10, SI, in the order mass, cog or first_moment, moments, products; half-widths are 1.96
# standard deviations). Values left out, or "not stated", stay unstated, and so does what would follow from them.


TABLES = ("name", "source", "inertia", "tolerance", "interval95", "covariance")
MATRIX_ENTRY, POSITIVE_INTEGRAL = "matrix-entry", "positive-integral"

_GROUPS = {
    "mass": (slice(0, 1), "mass"),
    "cog": (COG, "length"),
    "first_moment": (COG, "first moment"),
    "moments": (slice(4, 7), "moment of inertia"),
    "products": (slice(7, 10), "moment of inertia"),
}
_INERTIA = ("about", *_GROUPS, "products_sign")


@dataclass(frozen=True, eq=False, kw_only=True)
class _Form:
    """In which form the ten values stand: `about` is None for the CoG, else the point (3,) [m]."""

    about: Array | None
    first_moment: bool
    sign: float

    @property
    def keys(self) -> tuple[str, ...]:
        """Of the table, in the order of the values."""
        return ("mass", "first_moment" if self.first_moment else "cog", "moments", "products")

    def about_cog(self, values: Array, frame: Pose) -> Array:
        """The ten `values` about the CoG, seen from outside the `frame` in which they stand."""
        sign = self.sign
        mass, vector, six = values[MASS], values[COG], values[TENSOR] * np.array([1.0, 1.0, 1.0, sign, sign, sign])
        about = self.about if self.about is not None else vector
        lever = vector / mass if self.first_moment else vector - about
        tensor = tensor_from_six(six) - parallel_axis(mass, lever)
        R = frame.rotation
        return np.concatenate([values[:1], frame.apply(about + lever), six_from_tensor(R @ tensor @ R.T)])


def read(table: Mapping[str, Any], source: str, frame: Pose) -> Statement:
    """The statement that `table` makes, carried into the outer frame in which `frame` is the pose of the file's own.

    Raises
    ------
    BadInput : unknown or missing keys, a missing unit or another dimension, contradictory or unusable tolerances.
    """
    toml_file.require_present(table, ["inertia"], source=source)
    inertia = toml_file.require_table(table["inertia"], source=source, where="inertia")
    toml_file.require_known(inertia, _INERTIA, source=source, where="inertia")
    if ("cog" in inertia) and ("first_moment" in inertia):
        raise BadInput(source, "inertia", "states both cog and first_moment", "Keep one of them")
    about, first_moment = inertia.get("about", "cog"), "first_moment" in inertia
    if about == "cog" and first_moment:
        problem = "a first moment about the CoG is zero"
        raise BadInput(source, "inertia.first_moment", problem, 'State the point it is about, about = "origin" or "0 0 45 mm"')
    point = None if about == "cog" else np.zeros(3) if about == "origin" else position(about, source, "inertia.about")
    form = _Form(about=point, first_moment=first_moment, sign=_sign(inertia, source))
    listed: list[Stated | None] = []
    for key in form.keys:
        span, dimension = _GROUPS[key]
        length = span.stop - span.start
        entries = _entries(inertia.get(key, [None] * length if length > 1 else None), length, source, f"inertia.{key}")
        listed += [stated(entry, dimension, source, f"inertia.{key}") for entry in entries]
    # The values with the tolerance of whichever table is there, their squares when they are correlated, and a note
    given = [key for key in ("tolerance", "interval95", "covariance") if key in table]
    if len(given) > 1:
        raise BadInput(source, "", f"states {' and '.join(given)}", "Keep one of them")
    spread: Array | None = None
    if not given:
        values, note = tuple(listed), "as stated with each value; without one, half a unit of the last digit given"
    elif given == ["covariance"]:
        values, spread = _covariance(listed, table["covariance"], source)
        note = "1.96 standard deviations of the stated covariance"
    else:
        values, note = _toleranced(listed, given[0], table, form, source)
    mass = values[MASS]
    if form.first_moment and (mass is None or mass.value == 0):
        raise BadInput(source, "inertia.mass", "a first moment says nothing without a mass", "State the mass")
    return Statement(
        name=str(table.get("name", "result")),
        values=through(lambda ten: form.about_cog(ten, frame), values, spread),
        source=str(table.get("source", source)),
        tolerance_note=note,
    )


def _sign(inertia: Mapping[str, Any], source: str) -> float:
    if "products" not in inertia and "products_sign" not in inertia:
        return 1.0
    choices = (MATRIX_ENTRY, POSITIVE_INTEGRAL)
    if "products_sign" not in inertia:
        remedy = f'Write "{MATRIX_ENTRY}" for -∫xy dm (Eq. 4) or "{POSITIVE_INTEGRAL}" for +∫xy dm'
        raise BadInput(source, "inertia.products_sign", "is missing; products of inertia go by two signs", remedy)
    word = toml_file.one_of(inertia["products_sign"], choices, source=source, where="inertia.products_sign")
    return 1.0 if word == MATRIX_ENTRY else -1.0


def _entries(value: Any, length: int, source: str, field: str) -> list[Any]:
    entries = [value] if length == 1 else value
    if not isinstance(entries, list) or len(entries) != length:
        problem = f"must be a list of {length} values, found {value!r}"
        raise BadInput(source, field, problem, 'Write each with its unit; "not stated" holds a place')
    return entries


def _toleranced(
    values: Sequence[Stated | None], kind: str, table: Mapping[str, Any], form: _Form, source: str
) -> tuple[tuple[Stated | None, ...], str]:
    """`values` with half-widths or intervals, by the `kind` of table, and what is noted of them."""
    widths = kind == "tolerance"
    said = toml_file.require_table(table[kind], source=source, where=kind)
    toml_file.require_known(said, (*form.keys, "note") if widths else form.keys, source=source, where=kind)
    result = list(values)
    for key in filter(said.__contains__, form.keys):
        span, dimension = _GROUPS[key]
        length, field = span.stop - span.start, f"{kind}.{key}"
        alone = length == 1 or (widths and not isinstance(said[key], list))
        entries = [said[key]] * length if alone else _entries(said[key], length, source, field)
        for k, typed in zip(range(span.start, span.stop), entries, strict=True):
            value = result[k]
            if not widths:
                low, high = (stated(end, dimension, source, field) for end in _entries(typed, 2, source, field))
                if value is not None and low is not None and high is not None:
                    result[k] = with_interval(value, low.value, high.value, source, field)
            elif value is not None:
                # A half-width [SI] from "0.15 kg", or from "3 %" of the value
                relative = isinstance(typed, str) and typed.rstrip().endswith("%")
                width = _si(typed, "ratio" if relative else dimension, source, field)
                if width <= 0:
                    remedy = f"Give a half-width in {SI_UNITS[dimension]} or per cent"
                    raise BadInput(source, field, f"a tolerance must be positive, found {typed!r}", remedy)
                result[k] = replace(value, tolerance=width * abs(value.value) if relative else width)
    return tuple(result), str(said.get("note", "as stated")) if widths else "95 % intervals"


def with_interval(stated: Stated, low: float, high: float, source: str, field: str) -> Stated:
    """`stated` with the distance to the farther end of its interval [SI] as tolerance.

    Raises
    ------
    BadInput : the value lies outside its interval.
    """
    if not low <= stated.value <= high:
        problem = f"the value {stated.value:.6g} lies outside its interval {low:.6g} to {high:.6g} (SI)"
        raise BadInput(source, field, problem, "Give low and high in this order, around the value")
    return replace(stated, tolerance=max(high - stated.value, stated.value - low))


def _covariance(values: Sequence[Stated | None], matrix: Any, source: str) -> tuple[tuple[Stated | None, ...], Array]:
    """`values` with their half-widths, and the square of the tolerances with what they share."""
    if None in values:
        raise BadInput(source, "covariance", "needs all ten values", "State them, or use [tolerance]")
    try:
        C = frozen(matrix, (10, 10), "covariance")
    except (ValueError, TypeError) as error:
        raise BadInput(source, "covariance", str(error), "Write ten lists of ten numbers, SI") from None
    scale = np.sqrt(np.abs(np.diag(C)))
    correlation = C / np.outer(scale, scale) if np.all(scale > 0) else np.full((10, 10), np.nan)
    if not np.allclose(correlation, correlation.T, rtol=0, atol=1e-9) or np.linalg.eigvalsh(correlation)[0] < -1e-9:
        problem = "must be symmetric and positive, found a matrix that is no covariance"
        raise BadInput(source, "covariance", problem, "Check its order and units (SI)")
    toleranced = tuple(v and replace(v, tolerance=float(NORMAL_95 * s)) for v, s in zip(values, scale, strict=True))
    return toleranced, NORMAL_95**2 * C
