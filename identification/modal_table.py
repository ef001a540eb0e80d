"""`ModalTable`: measured frequencies, damping and shapes of an article with their standard deviations, and its readers."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry import sensors, toml_file
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen
from geometry.sensors import Point
from identification.files import arrays, files, text_table, uff, uff_tests
from identification.files.files import Samples

SOUND_SHAPE = 0.1
"""Share of its largest component by which the shape of a sound model may be off at a sensor, beside what is measured. One that is
off so much everywhere has a MAC of about 0.95, from which on models are taken as correlated (D. J. Ewins, Modal Testing, 2000,
chapter 5)."""

FREQUENCY_DEVIATION, DAMPING_DEVIATION, SHAPE_DEVIATION = 0.005, 0.2, 0.05
"""Standard deviations that hold where a table states none: of a frequency and of a damping ratio relative to it, of a shape
relative to its largest component. What ordinary modal tests scatter by (D. J. Ewins, Modal Testing, 2000, chapter 4)."""

HEAVY = 0.1
"""[1] Damping ratio that half the modes of a structure, three at least, hardly exceed: rubber has less. By definition."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalTable:
    """Modes as they were measured.

    Attributes
    ----------
    source : the file that describes the test
    title : in a few words
    article : what was tested
    frequency : (m,) [Hz]
    frequency_deviation : (m,) [Hz], positive
    damping_ratio, damping_deviation : (m,) [1]; None where they are not known
    sensors : (s,) where shapes were read, also one alone, whose shapes say nothing; empty where there are none
    shapes : (m, s), real or complex, each up to a factor; None where there are none
    shapes_deviation : (m, s), positive, in the scale of `shapes`
    gain : standard deviation of the gain of a sensor, relative
    before : (m, 2) [Hz] the same in an earlier state of the article, and the deviations of that test; None where none is named
    since : (m,) by which frequencies are multiplied so that the earlier ones are those of a model; None where they are as read
    names : (m,) of the modes
    warnings : what is odd, in words
    """

    source: str
    title: str
    article: str
    frequency: Array
    frequency_deviation: Array
    damping_ratio: Array | None = None
    damping_deviation: Array | None = None
    sensors: tuple[Point, ...] = ()
    shapes: Samples | None = None
    shapes_deviation: Array | None = None
    gain: float = 0.02
    before: Array | None = None
    since: Array | None = None
    names: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        m, s = len(np.atleast_1d(self.frequency)), len(self.sensors)
        stated = {"damping_ratio": (m,), "damping_deviation": (m,), "since": (m,), "before": (m, 2), "shapes_deviation": (m, s)}
        stated = {name: shape for name, shape in stated.items() if getattr(self, name) is not None}
        freeze(self, frequency=(m,), frequency_deviation=(m,), **stated)
        if not np.all(self.frequency > 0) or not np.all(self.frequency_deviation > 0):
            raise ValueError("`frequency` and `frequency_deviation` must be positive")
        if self.shapes is not None:
            shapes = np.array(self.shapes)
            if shapes.shape != (m, s) or not np.all(np.isfinite(shapes)) or not np.all(np.any(shapes != 0, axis=1)):
                raise ValueError(f"`shapes` must be finite, (m, s) = ({m}, {s}), none of them zero, found {shapes.shape}")
            object.__setattr__(self, "shapes", frozen(shapes, (m, s), "shapes", shapes.dtype.type))
        object.__setattr__(self, "names", self.names or tuple(f"mode {k + 1}" for k in range(m)))

    def of_modes(self, kept: Sequence[int]) -> "ModalTable":
        """The same of the modes numbered alone, from 0."""
        by_mode = ("frequency", "frequency_deviation", "damping_ratio", "damping_deviation", "shapes", "shapes_deviation")
        some = {name: value[list(kept)] for name in (*by_mode, "before", "since") if (value := getattr(self, name)) is not None}
        return replace(self, **some, names=tuple(self.names[k] for k in kept))


KEYS = [
    *("format", "kind", "title", "article", "file", "arrays", "frequencies", "damping"),
    *("shapes", "sensors", "direction", "places", "frequency_deviation", "damping_deviation"),
    *("shapes_deviation", "gain", "before", "modes", "leave_out", "separator"),
]
"""Of a test of this kind; `of_table` says what they mean."""


def of_table(table: Mapping[str, Any], source: str, folder: Path) -> ModalTable:
    """The test that `table` describes; its files lie in `folder`.

    ``frequencies`` is a list of numbers [Hz] or of texts such as ``"4.06 +/- 0.03 Hz"``, or ``{ file, frequency, deviation,
    damping, damping_deviation }`` with the names of columns. ``shapes`` is a list of a shape a mode, or ``{ file, sensor, modes,
    deviations }``: the column with the sensors, and those of the modes, where ``{}`` stands for the number of the mode.
    ``sensors`` names the points where the file does not, or says what the names in that column are; a sensor that is a whole
    number is a degree of freedom. ``file`` is in
    place of all of these: a universal file with dataset 55, whose ``places`` are names by number of the node; or the arrays of a
    program (.npz, .mat, .h5, .json) under the names of pyOMA2 or sdypy-EMA, or those that ``arrays`` gives them, for the
    ``sensors`` in their order. ``leave_out`` numbers modes, from 1, that are none of the structure: a machine's harmonic.
    ``before`` names another such description, of the same article in an earlier state: what a model is asked then is what has
    changed since.

    Raises
    ------
    BadInput : whatever is wrong, by file and key.
    """
    toml_file.require_known(table, KEYS, source=source)
    toml_file.require_present(table, ("article", *(() if "file" in table else ("frequencies",))), source=source)
    warnings: list[str] = []
    path = toml_file.named_file(str(table["file"]), folder, source, "file") if "file" in table else None
    file = None if path is None else _of_file(path, table, source, warnings)
    columns = _frequencies(table, source, folder) if file is None else file[0]
    frequency = columns["frequency"]
    if not np.all(frequency > 0):
        k = int(np.argmin(frequency > 0))
        raise BadInput(source, "frequencies", f"must be positive, found {frequency[k]:g} Hz of mode {k + 1}", "Correct it")
    if "damping" in columns and np.any(columns["damping"] >= 1):
        k = int(np.argmax(columns["damping"]))
        problem = f"must be a share below 1, found {columns['damping'][k]:g} of mode {k + 1}"
        raise BadInput(source, "damping", problem, 'Write 0.01 or "1 %" where it is in per cent')
    if "damping" in columns and np.sum(columns["damping"] > 0) > 2 and np.median(columns["damping"]) > HEAVY:
        low, high = np.min(columns["damping"]), np.max(columns["damping"])
        warnings.append(f"damping of {source} is {low:.3g} to {high:.3g} of critical: it is likely in per cent")
    for of, share in (("frequency", FREQUENCY_DEVIATION), ("damping", DAMPING_DEVIATION)):
        if of in columns and (name := f"{of}_deviation") not in columns:
            columns[name] = _deviation(table, name, share, columns[of], warnings, source)
        elif of in columns and np.any(none := columns[name] == 0) and isinstance(table.get("frequencies"), list):
            usual = _deviation(table, name, share, columns[of], warnings, source, " of some modes")
            columns[name] = np.where(none, usual, columns[name])
    points, shapes, deviation = _shapes(table, len(frequency), source, folder) if file is None else file[1:]
    seen = [one.name for one in points]
    if twice := sorted({name for name in seen if seen.count(name) > 1}):
        raise BadInput(source, "sensors", f"{twice[0]} stands twice", "Name every sensor once")
    if shapes is not None and not np.all(moving := np.isfinite(shapes).all(axis=1) & np.any(shapes != 0, axis=1)):
        problem = f"the shape of mode {int(np.argmin(moving)) + 1} is zero at every sensor, or not finite"
        raise BadInput(source, "shapes", problem, "Leave that mode's shape out, or correct it")
    if shapes is not None and len(points) == 1:
        warnings.append(f"shapes at {points[0].name} alone say nothing, since each is known up to a factor; they are left out")
        shapes, deviation = None, None  # its place is one of the structure all the same
    if shapes is not None and deviation is None:
        largest = np.abs(shapes).max(axis=1, keepdims=True) * np.ones(shapes.shape)
        deviation = _deviation(table, "shapes_deviation", SHAPE_DEVIATION, largest, warnings, source)
    elif shapes is not None and deviation is not None:
        # Instead of none at the component to which a shape was scaled what is usual of that shape
        found, scaled = np.array(deviation), []
        none = (deviation >= 0) & (deviation <= NOTHING * np.abs(shapes).max(axis=1, keepdims=True))
        for k, at in enumerate(none):
            if at.any() and not at.all():
                found[k, at] = np.median(deviation[k, ~at])
                scaled += [f"mode {k + 1} at {point.name}" for point, one in zip(points, at, strict=True) if one]
        if scaled:
            warnings.append(
                f"where a shape was scaled it has no deviation ({', '.join(scaled)}); the median of its others is taken"
            )
        deviation = found
    for name, values in (*columns.items(), ("shapes_deviation", deviation)):
        if values is not None and name.endswith("deviation") and not np.all(values > 0):
            problem = f"a standard deviation must be positive, found {values.min():g}"
            raise BadInput(source, name, problem, "Leave what is not known out of the table")
    left_out = table.get("leave_out", [])
    numbers = range(1, len(frequency) + 1)
    if not isinstance(left_out, list) or not all(one in numbers for one in left_out) or len(set(left_out)) == len(frequency):
        problem = f"must be numbers of modes from 1 to {len(frequency)}, not of all of them, found {left_out!r}"
        raise BadInput(source, "leave_out", problem, "Write leave_out = [3]")
    kept = [k - 1 for k in numbers if k not in left_out]
    stated = tuple(str(one) for one in table.get("modes", ()))
    called = stated if len(stated) == len(frequency) else tuple(f"mode {k}" for k in numbers)
    own = None if shapes is None else shapes[kept]
    before = _before(table, source, folder, frequency[kept], points, own) if "before" in table else None
    gain = table.get("gain", 0.02)
    if not toml_file.is_number(gain) or not 0 <= gain < 10:
        raise BadInput(source, "gain", f"must be a share such as 0.02, found {gain!r}", "Correct it")
    return ModalTable(
        source=source,
        title=str(table.get("title", Path(source).stem)),
        article=str(table["article"]),
        frequency=frequency[kept],
        frequency_deviation=columns["frequency_deviation"][kept],
        damping_ratio=columns["damping"][kept] if "damping" in columns else None,
        damping_deviation=columns["damping_deviation"][kept] if "damping" in columns else None,
        sensors=points,
        shapes=own,
        shapes_deviation=None if deviation is None else deviation[kept],
        gain=float(gain),
        before=before,
        names=tuple(called[k] for k in kept),
        warnings=tuple(warnings),
    )


def _before(
    table: Mapping[str, Any], source: str, folder: Path, frequency: Array, points: tuple[Point, ...], shapes: Samples | None
) -> Array:
    """(m, 2) frequencies of the modes of `table` in the earlier state that it names, and their deviations."""
    path = toml_file.named_file(str(table["before"]), folder, source, "before")
    if path.resolve() == Path(source).resolve():
        raise BadInput(source, "before", "names its own table", "Name an earlier test")
    known, article = {"article": table["article"], **toml_file.read(path)}, table["article"]
    if known.get("kind", "modal-table") != "modal-table":
        raise BadInput(source, "before", f"{path.name} has kind = {known['kind']!r}", "Name a table of modes")
    earlier = of_table({key: value for key, value in known.items() if key != "before"}, str(path), path.parent)
    alike = earlier.sensors == points
    of = paired(frequency, earlier.frequency, shapes if alike else None, earlier.shapes if alike else None)
    if earlier.article != str(article) or -1 in of:
        problem = f"{path.name} has {len(earlier.names)} modes of {earlier.article}, and here are {len(frequency)} of {article}"
        remedy = "Name a test of the same article, and leave out here what it has not: `leave_out`"
        raise BadInput(source, "before", problem, remedy)
    return np.stack([earlier.frequency, earlier.frequency_deviation], axis=1)[list(of)]


def _deviation(
    table: Mapping[str, Any], field: str, share: float, of: Array, warnings: list[str], source: str, whose: str = ""
) -> Array:
    """As `table` states it relative to `of`, else the usual `share`, which is then said."""
    stated = table.get(field, share)
    if field not in table:
        warnings.append(f"{field}{whose} of {source} is not stated; {100 * share:g} % is taken")
    if isinstance(stated, str):
        stated = float(toml_file.quantity(stated, "ratio", source=source, field=field).n)
    if not toml_file.is_number(stated) or not 0 < stated < 10:
        raise BadInput(source, field, f"must be a share such as {share:g}, found {stated!r}", "Correct it")
    return np.asarray(float(stated) * np.abs(of), dtype=np.float64)


NOTHING = 1e-9
"""Share of a shape's largest component up to which a deviation is none."""


def _frequencies(table: Mapping[str, Any], source: str, folder: Path) -> dict[str, Array]:
    """``frequency`` and what else is stated of every mode, by name."""
    stated = table["frequencies"]
    if isinstance(stated, dict):
        keys = ("file", "frequency", "deviation", "damping", "damping_deviation")
        toml_file.require_known(stated, keys, source=source, where="frequencies")
        toml_file.require_present(stated, ("file", "frequency"), source=source, where="frequencies")
        text = text_table.read(toml_file.named_file(str(stated["file"]), folder, source, "file"), str(table.get("separator", "")))
        found = dict[str, Array]()
        for key, name in ((key, name) for key, name in stated.items() if key != "file"):
            units, field = {"%": 0.01} if key.startswith("damping") else files.FREQUENCIES, f"frequencies.{key}"
            called = "frequency_deviation" if key == "deviation" else str(key)
            found[called] = text.real(text.column(str(name), field), units, field)
        return found
    found = {"frequency": stated, **({"damping": table["damping"]} if "damping" in table else {})}
    columns: dict[str, Array] = {}
    for name, values in found.items():
        if not isinstance(values, list) or not values:
            problem = f"must be a list of one number a mode, found {values!r}"
            raise BadInput(source, name, problem, "Write frequencies = [4.06, 4.55]")
        pairs = list[tuple[float, float]]()
        for one in values:
            if isinstance(one, str):
                made = toml_file.quantity(one, "frequency" if name == "frequency" else "ratio", source=source, field=name)
                pairs.append((float(made.n), float(made.s)))
            elif toml_file.is_number(one) and np.isfinite(one):
                pairs.append((float(one), 0.0))
            else:
                raise BadInput(source, name, f"must be a number, found {one!r}", "Correct it")
        columns[name] = np.array([value for value, _ in pairs])
        if any(sd > 0 for _, sd in pairs):
            columns[f"{name}_deviation"] = np.array([sd for _, sd in pairs])
        if len(pairs) != len(columns["frequency"]):
            problem = f"states {len(pairs)} modes, and frequencies {len(columns['frequency'])}"
            raise BadInput(source, name, problem, "State one of each")
    return columns


WRITTEN_AS = {
    "frequency": ("Fn", "nat_freq", "frequency"),
    "frequency_deviation": ("Fn_std", "frequency_deviation"),
    "damping": ("Xi", "nat_xi", "damping"),
    "damping_deviation": ("Xi_std", "damping_deviation"),
    "shapes": ("Phi", "phi", "A", "shapes"),
    "shapes_deviation": ("Phi_std", "shapes_deviation"),
}
"""Names of arrays in results of pyOMA2 (`SSIResult`, `MsPoserResult` and the others) and sdypy-EMA (`Model`), then our own; the
first that is there counts. Constants `A` are shapes but for a factor."""

FromFile = tuple[dict[str, Array], tuple[Point, ...], Samples | None, Array | None]
"""Frequencies and damping by name, sensors, shapes (m, s) and their deviations."""


def _of_file(path: Path, table: Mapping[str, Any], source: str, warnings: list[str]) -> FromFile:
    """A whole table in one file: universal, or arrays by name."""
    if uff.is_universal(path):
        return _of_universal(path, table, source, warnings)
    if path.suffix.lower() in (".csv", ".txt", ".dat"):
        remedy = "Name the columns of a text file under `frequencies` and `shapes`"
        raise BadInput(source, "file", f"{path.name} is no universal file and no arrays", remedy)
    called = toml_file.require_table(table.get("arrays", {}), source=source, where="arrays")
    toml_file.require_known(called, WRITTEN_AS, source=source, where="arrays")
    wanted = {key: (str(called[key]),) if key in called else names for key, names in WRITTEN_AS.items()}
    there = arrays.read(path, [name for names in wanted.values() for name in names])
    found: dict[str, Samples] = {}
    for key, names in wanted.items():
        name = next((one for one in names if one in there), None)
        if name is not None:
            found[key] = there[name]
        elif key == "frequency" or key in called:
            raise BadInput(source, f"arrays.{key}", f"{path.name} has no array {' or '.join(names)}", arrays.SAVE)
    modes = found["frequency"].size
    columns = {}
    for key in ("frequency", "frequency_deviation", "damping", "damping_deviation"):
        if key in found:
            one = found[key]
            if one.size != modes or one.size not in one.shape or np.iscomplexobj(one):
                problem = f"must be one real number a mode, {modes} in all, found {' x '.join(map(str, one.shape)) or 'one'}"
                raise BadInput(source, f"arrays.{key}", problem, "Save the modes that were chosen, not all poles")
            columns[key] = np.asarray(one.real.reshape(-1), dtype=np.float64)
    if "shapes" not in found:
        return columns, (), None, None
    points = _points(table, source)
    turned = {}
    for key in ("shapes", "shapes_deviation"):
        if key not in found:
            continue
        one = np.atleast_2d(found[key])
        if one.shape == (len(points), modes):  # a row a sensor, as these programs have them
            one = one.T
        if one.shape != (modes, len(points)):
            problem = f"are {' x '.join(map(str, one.shape))}, where {len(points)} sensors are named and {modes} modes there"
            raise BadInput(source, f"arrays.{key}", problem, "Name every sensor under `sensors`")
        turned[key] = one
    shapes = turned["shapes"]
    real = bool(np.all(shapes.imag == 0))
    deviation = np.abs(turned["shapes_deviation"]) if "shapes_deviation" in turned else None
    return columns, points, shapes.real if real else shapes, deviation


def _of_universal(path: Path, table: Mapping[str, Any], source: str, warnings: list[str]) -> FromFile:
    """Frequencies and damping by name, sensors, and shapes (m, s) of a universal file; axes that no mode has are left out."""
    file = uff_tests.read(path)
    if not file.modes:
        raise BadInput(str(path), "", "it holds no dataset 55 or 2414 of motions", "Export the modes as dataset 55")
    warnings += file.warnings
    nodes = file.modes[0].nodes
    for k, one in enumerate(file.modes):
        if one.nodes != nodes:
            raise BadInput(str(path), f"mode {k + 1}", "has other nodes than mode 1", "Export all modes at the same nodes")
    whole = np.array([one.shape for one in file.modes])
    there = [(k, axis) for k in range(len(nodes)) for axis in range(3) if np.any(whole[:, k, axis] != 0)]
    places = uff_tests.places_of(table, source)
    at = [uff_tests.NodeAxis(node=nodes[k], axis=uff_tests.AXES[axis]) for k, axis in there]
    points = tuple(uff_tests.point(one, file, places, "") for one in at)
    columns = {"frequency": np.array([one.frequency for one in file.modes])}
    damping = np.array([one.damping_ratio for one in file.modes])
    if np.all(damping > 0):
        columns["damping"] = damping
    elif np.any(damping > 0):
        warnings.append(f"{path}: mode {int(np.argmin(damping)) + 1} has no damping above zero; that of all modes is left out")
    return columns, points, np.array([[mode[k, axis] for k, axis in there] for mode in whole]), None


def _shapes(
    table: Mapping[str, Any], modes: int, source: str, folder: Path
) -> tuple[tuple[Point, ...], Samples | None, Array | None]:
    """Sensors, shapes (m, s) and their deviations, None where nothing is said of them."""
    stated, direction = table.get("shapes"), str(table.get("direction", ""))
    points = list(_points(table, source))
    if stated is None:
        return tuple(points), None, None
    deviation: Array | None = None
    if isinstance(stated, dict):
        toml_file.require_known(stated, ("file", "sensor", "modes", "deviations"), source=source, where="shapes")
        toml_file.require_present(stated, ("file", "modes"), source=source, where="shapes")
        text = text_table.read(toml_file.named_file(str(stated["file"]), folder, source, "file"), str(table.get("separator", "")))
        if "sensor" in stated:
            at = text.column(str(stated["sensor"]), "shapes.sensor")
            words = [f"dof {int(row[at])}" if row[at].isdecimal() else row[at] for row in text.cells]
            called = {one.name: one for one in points}
            points = [
                called.get(Point(place=one).name) or sensors.point(one, source=text.source, field=one, direction=direction)
                for one in words
            ]
        shapes = _of_columns(text, stated["modes"], modes, "shapes.modes", source)
        if "deviations" in stated:
            deviation = _of_columns(text, stated["deviations"], modes, "shapes.deviations", source).real
    else:
        shapes = _typed(stated, source)
    if shapes.shape != (modes, len(points)):
        problem = (
            f"hold {shapes.shape[0]} modes at {shapes.shape[1]} sensors, where {modes} modes and {len(points)} sensors are named"
        )
        raise BadInput(source, "shapes", problem, "State a shape a mode, a number a sensor")
    return tuple(points), shapes, deviation


def _points(table: Mapping[str, Any], source: str) -> tuple[Point, ...]:
    """The sensors that `table` names."""
    direction = str(table.get("direction", ""))
    return tuple(sensors.point(one, source=source, field="sensors", direction=direction) for one in table.get("sensors", []))


def _of_columns(text: text_table.TextTable, stated: Any, modes: int, field: str, source: str) -> Samples:
    """(m, s) of the columns that hold a mode each, by a list of their names or a text with ``{}`` for its number."""
    if isinstance(stated, str):
        stated = [stated.replace("{}", str(k + 1)) for k in range(modes)]
    if not isinstance(stated, list) or len(stated) != modes:
        problem = f"must name {modes} columns, found {stated!r}"
        raise BadInput(source, field, problem, 'Write "mode{}" for mode1, mode2 ..., or a list')
    return np.array([text.numbers(text.column(str(name), field)) for name in stated])


def _typed(stated: Any, source: str) -> Samples:
    """(m, s) of lists of numbers, or of texts where they are complex."""

    def refused(found: object) -> BadInput:
        problem = f"must be a list of numbers a mode, found {found!r:.60}"
        return BadInput(source, "shapes", problem, "Write shapes = [[1, 0.5], [1, -2]]")

    if not isinstance(stated, list) or not all(isinstance(row, list) for row in stated):
        raise refused(stated)
    if len({len(row) for row in stated}) != 1:
        raise refused([len(row) for row in stated])
    rows: list[list[complex]] = []
    for row in stated:
        made = [text_table.as_number(str(one)) for one in row]
        if any(one is None or not np.isfinite(one) for one in made):
            raise refused(row)
        rows.append([one for one in made if one is not None])
    found: npt.NDArray[np.complex128] = np.array(rows)
    return found if np.any(found.imag != 0) else found.real


def mac(one: npt.ArrayLike, other: npt.ArrayLike) -> Array:
    """(p, q) modal assurance criterion of shapes (p, s) and (q, s), real or complex: 1 where they are alike but for a factor.

    R. J. Allemang and D. L. Brown, A correlation coefficient for modal vector analysis, Proc. 1st IMAC, 1982.
    """
    a, b = np.atleast_2d(np.asarray(one)), np.atleast_2d(np.asarray(other))
    across = np.abs(a.conj() @ b.T) ** 2
    sizes = np.outer(np.sum(np.abs(a) ** 2, axis=1), np.sum(np.abs(b) ** 2, axis=1))
    return np.asarray(np.divide(across, sizes, out=np.zeros_like(across), where=sizes > 0))


def alike(frequency: npt.ArrayLike, deviation: npt.ArrayLike) -> tuple[list[int], ...]:
    """Groups of modes (m,) [Hz] that lie closer to a next one than both are known: any mix of them may be measured."""
    f, sd = np.asarray(frequency, dtype=np.float64), np.broadcast_to(deviation, np.shape(frequency))
    order = np.argsort(f, kind="stable")
    apart = np.diff(f[order]) > np.hypot(sd[order][1:], sd[order][:-1])
    groups = np.split(order, np.flatnonzero(apart) + 1)
    return tuple(group.tolist() for group in groups if len(group) > 1)


def mixes(measured: npt.ArrayLike, shapes: npt.ArrayLike, groups: Sequence[Sequence[int]]) -> Iterator[tuple[list[int], Array]]:
    """Each of `groups` (g,) with the (g, g) that makes of their `shapes` (m, s) those nearest to the ones `measured` (m, s).

    As most sensors say it: of all mixes by all sensors but none, one or two that of the least median deviation (P. J. Rousseeuw,
    Least median of squares regression, Journal of the American Statistical Association 79, 1984).
    """
    y, p = np.asarray(measured), np.asarray(shapes)
    every = range(p.shape[1])
    for group in map(list, groups):
        made, best = np.eye(len(group)), np.inf
        for left_out in ((), *combinations(every, 1), *(combinations(every, 2) if len(every) <= MOST_LEFT_OUT else ())):
            kept = np.setdiff1d(every, left_out)
            if len(kept) <= len(group):
                continue
            T = np.linalg.lstsq(p[group][:, kept].T, y[group][:, kept].T, rcond=None)[0].T
            off = float(np.median(np.sum(np.abs(y[group] - T @ p[group]) ** 2, axis=0)))
            if off < best:
                made, best = T, off
        yield group, made


MOST_LEFT_OUT = 24
"""[count] of sensors up to which two at a time are left out of a mix; cost only. By definition."""

FAR = 0.3
"""[log] Difference of two frequencies that counts as much against a pair as shapes that have nothing in common."""


def paired(
    frequency: npt.ArrayLike, other: npt.ArrayLike, shapes: npt.ArrayLike | None = None, others: npt.ArrayLike | None = None
) -> tuple[int, ...]:
    """(m,) which of `other` (q,) [Hz] is the partner of every one of `frequency` (m,); -1 of those for which none is left.

    The rule: of all assignments the one whose sum of ``1 - MAC + (ln f / f' / FAR)²`` is least (H. W. Kuhn, Naval Research
    Logistics 2, 1955). Without shapes it keeps the order of the frequencies.

    Parameters
    ----------
    shapes, others : (m, s) and (q, s) at the same sensors; None where there are none
    """
    from scipy.optimize import linear_sum_assignment

    f, g = np.asarray(frequency, dtype=np.float64), np.asarray(other, dtype=np.float64)
    apart = (np.log(f)[:, None] - np.log(np.maximum(g, 1e-6 * f.min()))) / FAR
    cost = apart**2
    if shapes is not None and others is not None:
        cost = cost + 1 - mac(shapes, others)
    rows, columns = linear_sum_assignment(cost)
    found = dict(zip(rows.tolist(), columns.tolist(), strict=True))
    return tuple(found.get(k, -1) for k in range(len(f)))
