"""`ResponseFunctions`: what a structure answers per newton, measured with a hammer or a shaker, and its readers."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from geometry import sensors, toml_file
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen
from geometry.sensors import Point
from identification.files import files, text_table, uff, uff_tests
from identification.files.files import Samples, Signals
from identification.spectra import response_estimates

QUANTITIES = uff_tests.PER_NEWTON
"""What may be read per newton, and its SI unit."""

UPSIDE_DOWN = {f"force over {name}": f"N/({unit.removesuffix('/N')})" for name, unit in QUANTITIES.items()}

GAIN = 0.02
"""Standard deviation of the gains of sensors and of the force cell that a careful laboratory admits."""


DEAF = 1.5
"""[1] Coherence of a channel in that of noise, up to which it reads nothing of the force that others read. Held by
test_test_files.py."""

PEAKS = 0.05
"""[share] of the lines, as of two resonances, at which a channel that follows the force stands out of noise. Held there, too."""

LARGEST = 1e100
"""No record reads more, in any unit."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ResponseFunctions:
    """Response functions of one article at all pairs of its drives and responses.

    Attributes
    ----------
    source : the file that describes the test
    title : in a few words
    article : what was tested
    frequency : (n,) [Hz], ascending
    values : (r, n, c) complex, the response `c` per newton at the drive `r`, SI
    drives : (r,) where the force acts
    responses : (c,) where the answer is read
    quantity : of `QUANTITIES`
    coherence : (r, n, c) [0 to 1]; None where it is not known
    averages : blocks or blows that were averaged; 0 where it is not known
    band : (low, high) [Hz] of the lines that count
    gain : standard deviation of the gain of each sensor, relative; infinite where it is unknown
    force_gain : the same of the force cell
    scaled : whether the scale that all functions share is known within these gains; False for readings without calibration
    share : how far a reading repeats, as a share of it; None where the functions themselves must tell
    decay_rate : [1/s] inverse time constant of the exponential window of force and responses, with which a prediction is made; 0
        for none
    smeared : share of what a Hann window smears over the lines of functions that were made here, which a prediction has too
    warnings : what is odd, in words
    """

    source: str
    title: str
    article: str
    frequency: Array
    values: ComplexArray
    drives: tuple[Point, ...]
    responses: tuple[Point, ...]
    quantity: str = "acceleration"
    coherence: Array | None = None
    averages: int = 0
    band: tuple[float, float]
    gain: float = GAIN
    force_gain: float = GAIN
    scaled: bool = True
    share: float | None = None
    decay_rate: float = 0.0
    smeared: float = 0.0
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, "frequency")
        shape = (len(self.drives), len(self.frequency), len(self.responses))
        object.__setattr__(self, "values", frozen(self.values, shape, "values", np.complex128))
        if self.coherence is not None:
            object.__setattr__(self, "coherence", frozen(self.coherence, shape, "coherence"))
        for what, points in (("drives", self.drives), ("responses", self.responses)):
            names = [one.name for one in points]
            if len(set(names)) < len(names):
                raise ValueError(f"`{what}` must have names of their own, found {', '.join(names)}")
        if self.quantity not in QUANTITIES:
            raise ValueError(f"`quantity` must be one of {', '.join(QUANTITIES)}, found {self.quantity!r}")


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece:
    """One function of a file.

    Attributes
    ----------
    source : the file
    drive, response : where the force acts, and where the answer is read
    frequency : (n,) [Hz]
    values : (n,) complex, SI
    coherence : (n,), None where it is not known
    averages : how many; 0 where it is not known
    quantity : of `QUANTITIES`, where the file says it
    smeared : as in `ResponseFunctions`
    """

    source: str
    drive: Point
    response: Point
    frequency: Array
    values: ComplexArray
    coherence: Array | None = None
    averages: int = 0
    quantity: str = ""
    smeared: float = 0.0


KEYS = (
    *("format", "kind", "title", "article", "file", "files", "drive", "responses", "direction", "places", "separator", "columns"),
    *("parts", "unit", "quantity", "inverted", "band", "gain", "force_gain", "share", "decay", "records", "coordinates"),
)
"""Of a test of this kind; `of_table` says what they mean."""


def of_table(table: Mapping[str, Any], source: str, folder: Path) -> ResponseFunctions:
    """The test that `table` describes; its files lie in `folder`.

    ``files`` is a list of ``{ path, drive, responses }``, or ``file`` the path of a single one; ``drive``, ``responses`` and
    ``direction`` beside it hold for all. A text file has the frequency [Hz] in its first column, then the responses in their
    order, complex (``1+2j``) or real and imaginary part beside each other; ``parts`` says so if it is otherwise, and ``columns``
    names columns by response. ``unit`` is that of the functions (SI where nothing is said) and chooses the quantity. With
    ``records`` the files hold time histories of force and response. ``coordinates`` are those of places [m], for whoever asks
    where they are.

    Raises
    ------
    BadInput : whatever is wrong, by file and key.
    """
    toml_file.require_known(table, KEYS, source=source)
    toml_file.require_present(table, ("article",), source=source)
    quantity, factor = _unit(table, source)
    entries = [(toml_file.named_file(str(entry["path"]), folder, source, "files"), entry) for entry in _entries(table, source)]
    warnings: list[str] = []
    inverted = bool(table.get("inverted", False))
    if "records" in table:
        pieces, reach, warnings = _of_records(entries, table, source)
    else:
        pieces, reach = [], inf
        for path, entry in entries:
            if uff.is_universal(path):
                pieces += _of_universal(path, entry, table, source, warnings)
                continue
            (drive,), responses = points_of(entry, table, source)
            frequency, functions = _of_columns(path, entry, table, responses, source)
            pieces += [
                Piece(source=str(path), drive=drive, response=at, frequency=frequency, values=one, quantity=said)
                for at, (one, said) in zip(responses, functions, strict=True)
            ]
        if inverted:
            pieces = [_upright(one, warnings) for one in pieces]
    said = {one.quantity: one.source for one in pieces if one.quantity}  # by files that say it
    if len(said) > 1:
        raise BadInput(source, "quantity", f"functions of {' and of '.join(said)} stand together", "Make a test of each")
    if said and ("quantity" in table or "unit" in table) and quantity not in said:
        problem = f"is {quantity}, and {next(iter(said.values()))} says {next(iter(said))}"
        raise BadInput(source, "quantity", problem, "Correct it")
    quantity = next(iter(said), quantity)
    decay = _number(table.get("records", table), "decay", 0.0, source)
    pieces = [replace(one, values=(1.0 if factor is None else factor) * one.values) for one in pieces]
    whole = assembled(pieces, source)
    low, high = float(whole.frequency[0] or whole.frequency[1]), float(min(whole.frequency[-1], reach))
    stated = table.get("band")
    band = [low, high] if stated is None else stated
    good = isinstance(band, list) and len(band) == 2 and all(isinstance(one, int | float) for one in band)
    if stated is not None and (not good or not 0 < band[0] < band[1] or band[0] >= high or band[1] <= low):
        problem = f"must be [low, high] in Hz within {low:g} to {high:g}, found {band!r}"
        raise BadInput(source, "band", problem, "Write band = [5, 200]")
    where = sensors.coordinates_of(table, source)
    drives, read = (
        tuple(replace(one, position=where.get(one.place, one.position)) for one in each)
        for each in (whole.drives, whole.responses)
    )
    made = replace(
        whole,
        drives=drives,
        responses=read,
        title=str(table.get("title", Path(source).stem)),
        article=str(table["article"]),
        quantity=quantity,
        band=(float(band[0]), float(band[1])),
        gain=_tolerance(table.get("gain", GAIN), source, "gain"),
        force_gain=_tolerance(table.get("force_gain", GAIN), source, "force_gain"),
        scaled=table.get("gain") != "unknown" and table.get("force_gain") != "unknown",
        decay_rate=1 / decay if decay > 0 else 0.0,
        smeared=max(one.smeared for one in pieces),
        share=None if table.get("share") is None else _tolerance(table["share"], source, "share"),
        warnings=(*warnings, *whole.warnings),
    )
    return _without_silent(made)


def _without_silent(made: ResponseFunctions) -> ResponseFunctions:
    """`made` without the responses that read nothing of the force which others read within its band, at no resonance either."""
    within = (made.frequency >= made.band[0]) & (made.frequency <= made.band[1])
    if made.coherence is None or made.averages < 2 or not within.any():
        return made
    # Of what has nothing to do with the force half of the lines exceed the former, and one of a hundred the latter
    noise, rarely = 1 - np.array([0.5, 0.01]) ** (1 / (made.averages - 1))
    heard, often = np.quantile(made.coherence[:, within], [0.5, 1 - PEAKS], axis=1).max(axis=1)
    reads, best = (heard >= DEAF * noise) | (often > rarely), heard.max()
    reads |= best <= DEAF**2 * noise
    warnings = [
        f"{made.source}: {at.name} is left out: it reads nothing of the force, its coherence is {share:.2g}; look at its cable"
        for at, share, own in zip(made.responses, heard, reads, strict=True)
        if not own
    ]
    if best < DEAF * noise and not np.any(often > rarely):
        warnings.append(f"{made.source}: no response follows the force, the best coherence is {best:.2g}; look at its cell")
    kept = tuple(one for one, own in zip(made.responses, reads, strict=True) if own)
    values, coherence = made.values[:, :, reads], made.coherence[:, :, reads]
    return replace(made, values=values, coherence=coherence, responses=kept, warnings=(*made.warnings, *warnings))


def assembled(pieces: Sequence[Piece], source: str) -> ResponseFunctions:
    """All `pieces` as one, every drive with every response; what is longer is cut to the lines that all have.

    Raises
    ------
    BadInput : none, other lines, one function twice, a pair that is missing, what looks like force over response.
    """
    if not pieces:
        raise BadInput(source, "files", "no function is found", "Name the files that hold them")
    warnings: list[str] = []
    pieces = _from_a_common_line(pieces, warnings)
    first = min(pieces, key=lambda one: len(one.frequency))
    n, f = len(first.frequency), first.frequency
    if n < 2:
        raise BadInput(first.source, "frequency", f"it has {n} lines, and at least two are needed", files.DAMAGED)
    for one in pieces:
        step, other = float(np.median(np.diff(f))), float(np.median(np.diff(one.frequency)))
        if abs(other - step) > 1e-6 * step or np.abs(one.frequency[:n] - f).max() > 0.01 * step:
            problem = (
                f"has lines {other:.6g} Hz apart from {one.frequency[0]:g} Hz on, and {first.response.name} over "
                f"{first.drive.name} of {first.source} has them {step:.6g} Hz apart from {f[0]:g} Hz on"
            )
            remedy = "Export all functions with one resolution, or make a test of each"
            raise BadInput(one.source, f"{one.response.name} over {one.drive.name}", problem, remedy)
    longest = max(len(one.frequency) for one in pieces)
    if longest > n:
        warnings.append(f"{first.source} ends at {f[-1]:g} Hz; {longest - n} lines above that other functions have are left out")
    drives, responses = dict[str, Point](), dict[str, Point]()
    pieces = [_turned(_turned(one, "drive", drives), "response", responses) for one in pieces]
    by_pair: dict[tuple[str, str], Piece] = {}
    for one in pieces:
        pair = (one.drive.name, one.response.name)
        if pair in by_pair:
            problem = "is there twice" if by_pair[pair].source == one.source else f"is in {by_pair[pair].source} as well"
            raise BadInput(one.source, f"{pair[1]} over {pair[0]}", problem, "Leave one of them out")
        by_pair[pair] = one
    missing = [f"{response} over {drive}" for drive in drives for response in responses if (drive, response) not in by_pair]
    if missing:
        problem = f"of {len(drives)} references and {len(responses)} responses these are missing: {', '.join(missing[:4])}" + (
            f" and {len(missing) - 4} more" if len(missing) > 4 else ""
        )
        raise BadInput(source, "files", problem, "Add the file, or make a test of each reference that has other responses")
    values = np.array([[by_pair[d, c].values[:n] for c in responses] for d in drives]).transpose(0, 2, 1)
    read = np.flatnonzero(np.any(values != 0, axis=(0, 2)))
    low, high = (0, n) if len(read) < 2 else (int(read[0]) if read[0] > 1 else 0, int(read[-1]) + 1)  # zero at 0 Hz is none
    if high - low < n:
        warnings.append(
            f"{n - high + low} lines outside {f[low]:g} to {f[high - 1]:g} Hz, where all functions are 0, are left out"
        )
    f, values = f[low:high], values[:, low:high]
    coherence = None
    _require_upright(f, values, source)
    averages = min(one.averages for one in pieces)
    if all(one.coherence is not None for one in pieces):
        told = [[one.coherence[:n][low:high] for c in responses if (one := by_pair[d, c]).coherence is not None] for d in drives]
        coherence = np.array(told).transpose(0, 2, 1)
    return ResponseFunctions(
        source=source,
        title="",
        article="",
        frequency=f,
        values=values,
        drives=tuple(drives.values()),
        responses=tuple(responses.values()),
        coherence=coherence,
        averages=averages,
        band=(float(f[0]), float(f[-1])),
        warnings=tuple(warnings),
    )


def _upright(piece: Piece, warnings: list[str]) -> Piece:
    """One over `piece`, without the lines at its ends at which it is 0."""
    name = f"{piece.response.name} over {piece.drive.name}"
    read = np.abs(piece.values) > 1 / LARGEST
    within = slice(int(np.argmax(read)), len(read) - int(np.argmax(read[::-1])))
    if not np.all(read[within]):
        problem = f"is 0 at {piece.frequency[within][np.argmin(read[within])]:g} Hz, where one over it is needed"
        raise BadInput(piece.source, name, problem, "Leave this line out of all functions")
    if not np.all(read):
        warnings.append(f"{piece.source}: lines at the ends, where force over response is 0, are left out of {name}")
    coherence = None if piece.coherence is None else piece.coherence[within]
    return replace(piece, frequency=piece.frequency[within], values=1 / piece.values[within], coherence=coherence)


def _turned(piece: Piece, end: str, known: dict[str, Point]) -> Piece:
    """`piece` with its drive or response along the direction that the first of `known` with this name has."""
    at: Point = getattr(piece, end)
    first = known.setdefault(at.name, at)
    along = float(np.asarray(first.direction) @ np.asarray(at.direction))
    if abs(abs(along) - 1) > 1e-6:
        problem = f"{at.name} has one direction here, and another in {piece.source}"
        raise BadInput(piece.source, end, problem, "Give each direction a name of its own")
    return piece if along > 0 else replace(piece, values=-piece.values)


def _from_a_common_line(pieces: Sequence[Piece], warnings: list[str]) -> list[Piece]:
    """`pieces` without the lines below the first that all have; one whose lines lie between those of others is left as it is."""
    latest = max(pieces, key=lambda one: one.frequency[0])
    low, found, cut = float(latest.frequency[0]), list[Piece](), 0
    for one in pieces:
        at = int(np.argmin(np.abs(one.frequency - low)))
        step = float(np.median(np.diff(one.frequency))) if len(one.frequency) > 1 else 0.0
        if at and abs(one.frequency[at] - low) <= 0.01 * step:
            coherence = None if one.coherence is None else one.coherence[at:]
            one = replace(one, frequency=one.frequency[at:], values=one.values[at:], coherence=coherence)
            cut = max(cut, at)
        found.append(one)
    if cut:
        warnings.append(f"{latest.source} begins at {low:g} Hz; {cut} lines below that other functions have are left out")
    return found


# What functions are, and what they are mistaken for.

COMPLEX, PAIRS = "complex", "real-imaginary"
POLAR = ("magnitude-degrees", "magnitude-radians", "decibel-degrees", "decibel-radians")
PARTS = (COMPLEX, PAIRS, *POLAR)
"""How a text file writes a complex number."""

UNEVEN_PEAKS = 1.5
"""How many times as far the dips that all functions have in common may stand out as the peaks."""


def _require_upright(f: Array, values: ComplexArray, source: str) -> None:
    """Refuse what looks like force over response.

    A resonance is a peak in all functions at the same line, an antiresonance a dip that each has elsewhere; the mean of their
    logarithms keeps the former and blurs the latter. Turned upside down the common peaks become common dips.
    """
    from scipy.signal import find_peaks

    functions = np.moveaxis(values, 1, 2).reshape(-1, len(f))
    if len(functions) < 2 or len(f) < 16:
        return
    level = np.log(np.maximum(np.abs(functions), np.finfo(np.float64).tiny)).mean(axis=0)
    width = max(3, len(f) // 200)
    smooth = np.convolve(np.pad(level, width, mode="edge"), np.ones(width) / width, mode="same")[width:-width]
    out = [np.sort(find_peaks(sign * smooth, prominence=1.0)[1]["prominences"])[-3:].sum() for sign in (1, -1)]
    if out[1] > UNEVEN_PEAKS * out[0] and out[1] > 3.0:
        problem = "the functions look like force over response: they have dips in common where resonances are peaks"
        remedy = "Write inverted = true if each is force over response, or export response over force"
        raise BadInput(source, "files", problem, remedy)


def _unit(table: Mapping[str, Any], source: str) -> tuple[str, float | None]:
    """The quantity of the functions, and what one of their unit is in SI; None where no `unit` is stated."""
    stated = table.get("quantity")
    if stated is not None:
        toml_file.one_of(stated, tuple(QUANTITIES), source=source, where="quantity")
    unit = table.get("unit", "")
    if not unit:
        return str(stated or "acceleration"), None
    inverted = bool(table.get("inverted", False))
    found, factor = toml_file.unit_among(str(unit), {**QUANTITIES, **UPSIDE_DOWN}, source=source, field="unit")
    if (found in UPSIDE_DOWN) != inverted:
        wanted = "inverted = true says otherwise" if inverted else "response over force is needed"
        remedy = "Take inverted = true out" if inverted else "Write inverted = true, or export response over force"
        raise BadInput(source, "unit", f"{unit!r} is {found}, and {wanted}", remedy)
    found = found.removeprefix("force over ")
    if stated is not None and stated != found:
        raise BadInput(source, "unit", f"{unit!r} is one of {found}, and the quantity is {stated}", "Correct one of them")
    return found, (1 / factor if inverted else factor)


def _tolerance(value: Any, source: str, field: str) -> float:
    """A standard deviation relative to the value; infinite for ``"each unknown"``, and the usual one for ``"unknown"``."""
    words = {"unknown": GAIN, "each unknown": inf}
    if isinstance(value, str) and value in words:
        return words[value]
    if isinstance(value, str):
        return float(toml_file.quantity(value, "ratio", source=source, field=field).n)
    if not toml_file.is_number(value) or not 0 <= value < 10:
        problem = f"must be a share such as 0.02, or one of {', '.join(words)}, found {value!r}"
        raise BadInput(source, field, problem, "Correct it")
    return float(value)


# Files.

SIGNALS = (".mat", ".h5", ".hdf5")
"""Endings of files that hold vectors by name."""


def _entries(table: Mapping[str, Any], source: str) -> list[dict[str, Any]]:
    """Of every file its path, drive and responses as they are stated."""
    if ("file" in table) == ("files" in table):
        remedy = 'Write file = "functions.csv", or files = [{ path = "one.csv", drive = "tip:z" }, ...]'
        raise BadInput(source, "files", "one of `file` and `files` is needed", remedy)
    stated = table.get("files", [{"path": table.get("file")}])
    listed = stated if isinstance(stated, list) else [stated]
    found = []
    for k, one in enumerate(listed):
        where = f"files[{k + 1}]"
        entry = dict(one) if isinstance(one, dict) else {"path": one}
        toml_file.require_known(entry, ("path", "drive", "responses", "columns"), source=source, where=where)
        if not isinstance(entry.get("path"), str) or not entry["path"]:
            raise BadInput(source, where, f"names no file, found {one!r}", 'Write { path = "a.csv" }')
        defaults = {key: table[key] for key in ("drive", "responses", "columns") if key in table}
        found.append({**defaults, **entry})
    return found


def points_of(
    entry: Mapping[str, Any], table: Mapping[str, Any], source: str, *, several: bool = False
) -> tuple[list[Point], list[Point]]:
    """Where the force of a file acts, or `several` at a time, and where its answers are read."""
    direction = str(table.get("direction", ""))
    stated = entry.get("responses", [])
    listed = stated if isinstance(stated, list) else [stated]
    responses = [sensors.point(one, source=source, field="responses", direction=direction) for one in listed]
    if not responses:
        raise BadInput(source, "responses", "is missing", 'Write responses = ["tip:z", ...] in the order of the columns')
    if entry.get("drive") is None:
        problem = f"is not said for {entry['path']}: the reference is missing"
        raise BadInput(source, "drive", problem, 'Write drive = "tip:z", where the force acts')
    drives = entry["drive"] if isinstance(entry["drive"], list) else [entry["drive"]]
    if not drives or (len(drives) > 1 and not several):
        remedy = 'Write one; several at a time are read from records of shakers, with records = { kind = "shaker" }'
        raise BadInput(source, "drive", f"are {len(drives)} of {entry['path']}", remedy)
    return [sensors.point(one, source=source, field="drive", direction=direction) for one in drives], responses


# Records of force and response.

RECORDED = {"block": 0.0, "overlap": 0.5, "decay": 0.0}
RECORDS = ("kind", "window", "estimator", *RECORDED)
SHAKER, HAMMER = "shaker", "hammer"


def _of_records(
    entries: Sequence[tuple[Path, Mapping[str, Any]]], table: Mapping[str, Any], source: str
) -> tuple[list[Piece], float, list[str]]:
    """Functions of time histories, the highest frequency [Hz] that every force drives, and what is to be said.

    Of files with one drive and the same responses the blows of a hammer are averaged together.
    """
    how = toml_file.require_table(table["records"], source=source, where="records")
    toml_file.require_known(how, RECORDS, source=source, where="records")
    kind = toml_file.one_of(how.get("kind", SHAKER), (SHAKER, HAMMER), source=source, where="records.kind")
    of = toml_file.one_of(how.get("estimator", "H1"), response_estimates.ESTIMATORS, source=source, where="records.estimator")
    block, overlap, decay = [_number(how, key, usual, source) for key, usual in RECORDED.items()]
    together: dict[tuple[str, ...], list[tuple[Path, Mapping[str, Any], list[Point], list[Point]]]] = {}
    for path, entry in entries:
        drives, responses = points_of(entry, table, source, several=kind == SHAKER)
        key = tuple(one.name for one in (*drives, *responses))
        together.setdefault(key if kind == HAMMER else (*key, str(path)), []).append((path, entry, drives, responses))
    pieces: list[Piece] = []
    warnings: list[str] = []
    ringing: dict[Path, float] = {}
    reach = inf
    for members in together.values():
        path, _, drives, responses = members[0]
        names = [one.name for one in responses]
        blows: list[response_estimates.Blow] = []
        for path, entry, _, _ in members:
            rate, force, read, quantities = _record(path, entry, table, len(drives), responses, source)
            if not all(np.all(np.abs(one) < LARGEST) for one in (force, read)):  # NaN is not below, either
                problem = f"holds numbers that are none, or beyond {LARGEST:g}"
                raise BadInput(str(path), "records", problem, "Export it again; it may be damaged")
            if kind == SHAKER:
                window = str(how.get("window", "hann"))
                band = table.get("band")
                end = max((one for one in band if isinstance(one, int | float)), default=inf) if isinstance(band, list) else inf
                how_long = {"block": block, "overlap": overlap, "end": end}
                made = response_estimates.shaken(
                    force, read, rate, **how_long, window=window, estimator=of, source=str(path), names=names
                )
            else:
                blows += response_estimates.blows(force[:, 0], read, rate, block=block, source=str(path), names=names)
                made = None
        if made is None:
            made = response_estimates.struck(blows, rate, decay=decay, estimator=of, source=str(path))
        reach = min(reach, made.reach)
        warnings += made.warnings
        if made.rings:
            ringing[path] = made.rings
        pieces += [
            Piece(
                source=str(path),
                drive=drive,
                response=at,
                frequency=made.frequency,
                values=made.values[r, :, k],
                coherence=made.coherence[r, :, k],
                averages=made.averages,
                smeared=made.smeared,
                quantity=quantities[k],
            )
            for r, drive in enumerate(drives)
            for k, at in enumerate(responses)
        ]
    if ringing:
        worst = max(ringing, key=lambda path: ringing[path])
        more = len(ringing) - 1
        others = f" and of {more} other file{'s' * (more > 1)}" if more else ""
        rest = f"{100 * ringing[worst]:.0f} % of the answers of {worst}{others} still ring at the end of a block"
        warnings.append(f"{rest}; damping will seem larger, take a longer block")
    alike: dict[str, list[str]] = {}
    for one in warnings:
        where, _, text = one.partition(": ")
        alike.setdefault(text, []).append(where)
    return pieces, reach, [f"{', '.join(paths)}: {text}" if text else paths[0] for text, paths in alike.items()]


def _number(how: Mapping[str, Any], key: str, usual: float, source: str) -> float:
    """A number of ``records``, seconds as a number or with their unit."""
    value = how.get(key, usual)
    if isinstance(value, str):
        return float(toml_file.quantity(value, "time", source=source, field=key).n)
    if not toml_file.is_number(value) or not 0 <= value < 1e6:
        raise BadInput(source, key, f"must be a number that is not negative, found {value!r}", 'Write block = "4 s"')
    return float(value)


def _record(
    path: Path, entry: Mapping[str, Any], table: Mapping[str, Any], count: int, responses: Sequence[Point], source: str
) -> tuple[float, Array, Array, list[str]]:
    """Rate [Hz], `count` forces (n, r) and responses (n, c) of one file, whose ratios are in SI if it says how, and of what."""
    columns = _columns(entry, responses, source)
    file = _channels(path, columns, table)
    known = list(file.samples)
    if len(responses) == 1 and "response" in columns:
        columns[responses[0].name] = columns["response"]
    named = {**(_called(known, responses) or {}), **columns}
    read = [named[one.name][0] for one in responses if one.name in named]
    first = ["force"] if "force" in known else [name for name in known if name not in read][:1]
    forces = columns.get("force", first if count == 1 else [])
    if len(set(forces)) != count:
        problem = f"names {len(set(forces))} forces, and the drives are {count}"
        raise BadInput(source, "columns.force", problem, 'Write columns = { force = ["F1", "F2"] }, in the order of the drives')
    rest = [name for name in known if name not in forces]
    if not read and len(rest) == len(responses):
        read = rest
    if len(read) != len(responses):
        problem = f"it has {len(rest)} columns beside time and force, and the responses are {len(responses)}"
        raise BadInput(str(path), "responses", problem, f"Name all in order, or state `columns`; there are {', '.join(rest)}")
    force, found = (np.column_stack([_samples(file, name).real for name in of]) for of in (forces, read))
    units = [[_said(file, name, at, False) for name in read] for at in forces]
    what, stated = [f"the record of {name}" for name in read], _unit(table, source)[1]
    sizes = np.array([[one.size(str(path), of, stated) for one, of in zip(row, what, strict=True)] for row in units])
    scaled = force * sizes[0, 0] / sizes[:, 0], found * sizes[0]
    return float(file.sampling_rate or 0), *scaled, [one.quantity for one in units[0]]


def _channels(path: Path, columns: Mapping[str, Sequence[str]], table: Mapping[str, Any]) -> Signals:
    """A file of signals or a table in text, whose first column is the axis if `columns` says no other; records or functions."""
    records = "records" in table
    if path.suffix.lower() in (*SIGNALS, *uff.ENDINGS):
        found = files.read(path)
        if (found.sampling_rate if records else found.frequency) is None:
            problem = f"it holds functions of {'frequency' if records else 'time'}, and the test says otherwise"
            raise BadInput(str(path), "", problem, "Write records = { } to make functions of records, and leave it out of others")
        return found
    text = text_table.read(path, str(table.get("separator", "")))
    what, units = ("time", files.TIMES) if records else ("frequency", files.FREQUENCIES)
    at = text.column(columns[what][0], f"columns.{what}") if what in columns else 0
    known = text.header or tuple(str(k + 1) for k in range(len(text.cells[0])))
    axis, field = text.real(at, units, what), text.header[at] if text.header else what
    if not records:
        files.require_lines(axis, str(path), field)
    names = {k: name if known.count(name) == 1 else f"{name}, column {k + 1}" for k, name in enumerate(known)}
    numbers = [k for k in names if k != at and text_table.as_number(text.cells[0][k]) is not None]
    return Signals(
        source=str(path),
        samples={names[k]: text.numbers(k) for k in numbers},
        sampling_rate=files.rate_of_times(axis, str(path), field) if records else None,
        frequency=None if records else axis,
        labels={names[k]: text.unit(k) for k in numbers},
    )


def _samples(file: Signals, name: str) -> Samples:
    if name not in file.samples:
        raise BadInput(
            file.source, name, "no column is called so", f"Name them in `columns`; there are {', '.join(file.samples)}"
        )
    return file.samples[name]


def _said(file: Signals, response: str, force: str, inverted: bool) -> uff_tests.Unit:
    """What `file` says of the unit of a function, or of the one of two records."""
    over, under = file.units.get(response), file.units.get(force)
    stated = over.length / under.force if over and under else None
    return uff_tests.unit_of([file.labels.get(response, ""), file.labels.get(force, "")], "", stated, inverted)


def _of_universal(
    path: Path, entry: Mapping[str, Any], table: Mapping[str, Any], source: str, warnings: list[str]
) -> list[Piece]:
    """The response functions of a universal file, which says itself where they were read and in which unit.

    Where it names no nodes, ``drive`` and ``responses`` say where they are, and ``unit`` where it contradicts itself.
    """
    file = uff_tests.read(path)
    functions, coherences, at = file.functions, file.coherences, list[tuple[Point, Point]]()
    if not functions:
        remedy = "Export response functions as dataset 58, or modes as a modal table"
        raise BadInput(str(path), "", "it holds no response function (dataset 58, function type 4)", remedy)
    warnings += file.warnings
    places = uff_tests.places_of(table, source)
    direction, inverted = str(table.get("direction", "")), bool(table.get("inverted", False))
    if all(one.response == uff_tests.NOWHERE for one in functions) and "responses" in entry:
        (drive,), listed = points_of(entry, table, source)
        if len(listed) != len(functions):
            problem = f"are {len(listed)}, and the file has {len(functions)} functions without nodes"
            raise BadInput(str(path), "responses", problem, "Name one of each, in their order")
        if coherences and len(coherences) != len(functions):
            problem = f"it has {len(coherences)} coherences and {len(functions)} functions without nodes"
            raise BadInput(str(path), "coherence", problem, "Export one with each function, or none")
        at = [(drive, response) for response in listed]
    elif len({(one.response, one.reference) for one in coherences}) < len(coherences):
        warnings.append(f"{path} holds several coherences of the same nodes, and they are passed over")
    if "unit" not in table and "quantity" not in table and not all(one.unit.quantity for one in functions):
        warnings.append(f"{path} does not say what was read per newton; acceleration is taken")
    if not (at or places or file.nodes):
        warnings.append(f"{path} has no coordinates, and its nodes are those of the model by number, unless `places` names them")
    unit, found, driven = _unit(table, source)[1], [], entry.get("drive")
    driven = None if driven is None else sensors.point(driven, source=source, field="drive", direction=direction)
    for k, one in enumerate(functions):
        if not at and one.reference == uff_tests.NOWHERE and (driven is None or inverted):
            problem = f"the function of node {one.response.node} names no reference node: where the force acted is missing"
            remedy = 'Write drive = "tip:z", and `responses` as well where it names no nodes at all'
            raise BadInput(str(path), "reference", problem, remedy)
        values = one.upright(str(path), inverted, unit)
        ends = (one.response, one.reference) if inverted else (one.reference, one.response)
        points = (uff_tests.point(end, file, places, direction) for end in ends if end != uff_tests.NOWHERE)
        drive, response = at[k] if at else [*([driven] if driven and one.reference == uff_tests.NOWHERE else []), *points]
        coherence = coherences[k] if at and coherences else file.coherence(one)
        f = one.frequency if coherence is None else coherence.frequency
        if f.shape != one.frequency.shape or not np.allclose(f, one.frequency, rtol=1e-5):
            problem = f"of {response.name} over {drive.name} has other lines than its function"
            raise BadInput(str(path), "coherence", problem, "Export both with the same lines")
        found.append(
            Piece(
                source=str(path),
                drive=drive,
                response=response,
                frequency=one.frequency,
                values=values,
                coherence=None if coherence is None else coherence.values.real,
                quantity=one.unit.quantity,
            )
        )
    return found


def _columns(entry: Mapping[str, Any], responses: Sequence[Point], source: str) -> dict[str, list[str]]:
    """By response, or ``frequency``, the columns that hold it."""
    stated = toml_file.require_table(entry.get("columns", {}), source=source, where="columns")
    named = {key: one.name for one in responses for key in (one.place, one.name, f"{one.place}:{one.name.rpartition('-')[2]}")}
    toml_file.require_known(stated, ("frequency", "time", "force", "response", *named), source=source, where="columns")
    return {
        named.get(key, key): [str(one) for one in (value if isinstance(value, list) else [value])]
        for key, value in stated.items()
    }


def _called(known: Sequence[str], responses: Sequence[Point], each: int = 1) -> dict[str, list[str]] | None:
    """By response the `each` names of `known` that begin with its own, however it is punctuated; None where not all have them."""

    def plain(name: str) -> str:
        return re.sub(r"[\W_]+", "-", name.lower()).strip("-") + "-"

    found = {one.name: [name for name in known if plain(name).startswith(plain(one.name))] for one in responses}
    taken = [name for names in found.values() for name in names]
    return found if all(len(names) == each for names in found.values()) and len(set(taken)) == len(taken) else None


def _of_columns(
    path: Path, entry: Mapping[str, Any], table: Mapping[str, Any], responses: Sequence[Point], source: str
) -> tuple[Array, list[tuple[ComplexArray, str]]]:
    """Frequency, and by response its function and the quantity that a header names in brackets."""
    columns = _columns(entry, responses, source)
    file = _channels(path, columns, table)
    known, stated, inverted = list(file.samples), table.get("parts"), bool(table.get("inverted", False))
    each = 2 if len(known) == 2 * len(responses) else 1
    called = _called(known, responses, 2) or (_called(known, responses) if each == 1 else None)
    named = {**(called or {}), **columns}
    if not all(one.name in named for one in responses) and len(known) != each * len(responses):
        problem = f"it has {len(known)} columns beside the frequency, neither one nor two for each of {len(responses)} responses"
        raise BadInput(str(path), "responses", problem, "Name all of them in order, or state `columns`")
    if stated is not None:
        toml_file.one_of(stated, PARTS, source=source, where="parts")
    found = []
    for k, one in enumerate(responses):
        names = named.get(one.name, known[each * k : each * (k + 1)])
        values = _joined([_samples(file, name) for name in names], names, stated, str(path))
        unit = _said(file, next((name for name in names if file.labels.get(name)), ""), "", inverted)
        size = unit.size(str(path), f"the function in {names[0]}", _unit(table, source)[1])
        found.append((values / size if inverted else size * values, unit.quantity))
    return np.asarray(file.frequency), found


TURNS = 120.0
"""[deg] by which phases in degrees turn at least where there is a resonance: a half-turn, less what damping and the ends of a
band take. Imaginary parts beside real ones that are never negative (a mobility where it is driven) seldom span as much. Held by
test_odd_studies.py."""

_POLAR_WORDS = re.compile(r"(?<![a-z])(?:phase|deg|grad|angle|arg|db|decibel|mag|abs|ampl|modul)", re.IGNORECASE)


def _joined(columns: list[Any], header: Sequence[str], stated: str | None, source: str) -> ComplexArray:
    """One complex function of the columns that hold it.

    Raises
    ------
    BadInput : what is no complex number and is not said to be one.
    """

    def refused(problem: str, remedy: str) -> BadInput:
        return BadInput(source, "parts", problem, remedy)

    if len(columns) == 1:
        if np.iscomplexobj(columns[0]) and stated in (None, COMPLEX):
            return np.asarray(columns[0])
        what = "in decibels" if (header and "db" in header[0].lower()) or np.mean(columns[0].real < 0) > 0.9 else "a magnitude"
        problem = f"a function has one real number a line where a complex one is needed; it may be {what} without its phase"
        raise refused(problem, "Export real and imaginary part, or magnitude and phase with `parts`, two columns a response")
    if len(columns) != 2:
        raise refused(f"a function has {len(columns)} columns", "Name one complex column, or two")
    if any(np.iscomplexobj(one) for one in columns):
        raise refused("a function has two columns of which one is complex", "Name one complex column, or two real ones")
    one, other = columns
    if stated in (None, PAIRS):
        polar_header = any(_POLAR_WORDS.search(name) for name in header)
        degrees = np.all(np.abs(other) <= 360) and np.ptp(other) > TURNS and np.all(one >= 0)
        if stated is None and (polar_header or degrees):
            problem = "its columns look like magnitude and phase where real and imaginary part were meant"
            raise refused(problem, f"Write parts = one of {', '.join(PARTS[1:])}")
        return files.as_complex(one, other)
    if stated == COMPLEX:
        raise refused("a function has two real columns, and parts says complex", 'Write parts = "real-imaginary"')
    magnitude = 10 ** (one / 20) if stated.startswith("decibel") else one
    if np.any(magnitude < 0):
        raise refused("a magnitude is negative; is it in decibels?", 'Write parts = "decibel-degrees"')
    angle = np.radians(other) if stated.endswith("degrees") else other
    return np.asarray(magnitude * np.exp(1j * angle))
