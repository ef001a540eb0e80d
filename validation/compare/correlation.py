"""What analysts deliver beside the sigmas: pairs of modes, MAC, COMAC, cross-orthogonality, frequencies, FRAC of functions.

None of these numbers is a test of a model: MAC is blind to frequencies and to whatever leaves shapes as they are, FRAC to what
all functions have in common. Where they are green and the sigmas are not, the result says so.
"""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.files.files import Samples
from identification.modal_table import ModalTable, mac, mixes
from validation.estimation.problem import Offsets, Prediction
from validation.flexible.model import family
from validation.model.model import Added
from validation.output import derived, entry, unwritten
from validation.prediction import effects, modal_table
from validation.prediction.landmarks import resonance_table
from validation.prediction.modal_table import RealModes, TableFrequencies, TableShapes, partners, seen
from validation.prediction.response_functions import ResponseFunctionTest
from validation.prediction.structure_tests import StructurePrediction

GREEN = 0.9
"""MAC from which analysts call a pair one mode, FRAC from which they call two functions alike (Ewins, Modal Testing, 2000)."""

FAR = 3.0
"""[sigma] from which a frequency is off."""

BEYOND = 1.3
"""Times the highest frequency of a table up to which modes of the model are looked at."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModePair:
    """A mode of the table and its partner.

    Attributes
    ----------
    measured : name of the mode
    model : number of its partner in the model, from 1 and motions of a free body counted
    measured_hz, model_hz : frequencies [Hz]
    percent : by which the model is higher
    sigmas : the same in standard deviations of the measurement
    mac : 0 to 1; None without shapes
    """

    measured: str
    model: int
    measured_hz: float
    model_hz: float
    percent: float
    sigmas: float
    mac: float | None


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalCorrelation:
    """A table of modes beside a model.

    Attributes
    ----------
    data_set : title of the table
    rule : how modes were paired, in words
    pairs : in the order of the table
    missing : numbers of modes of the model within the frequencies of the table that have no partner
    modes : (q,) numbers of the modes of the model that `mac` and `cross_orthogonality` have as columns
    mac : (m, q) of table and model; empty without shapes
    cross_orthogonality : (m, q) the same weighed by the mass that the sensors see; empty where there are fewer sensors than modes
    comac : by sensor, 0 to 1, how alike its readings are over all pairs
    remarks : sentences
    measured_shapes, model_shapes : (m, s) and (q, s), of which `mac` is; empty without shapes
    """

    data_set: str
    rule: str
    pairs: tuple[ModePair, ...]
    missing: tuple[int, ...]
    modes: tuple[int, ...]
    mac: Array
    cross_orthogonality: Array
    comac: Mapping[str, float]
    remarks: tuple[str, ...]
    measured_shapes: Samples = unwritten(default_factory=lambda: np.zeros((0, 0)))
    model_shapes: Array = unwritten(default_factory=lambda: np.zeros((0, 0)))

    @property
    @derived("swapped")
    def swapped(self) -> tuple[tuple[str, str], ...]:
        """Pairs of modes of the table, next to each other, that stand the other way round in the model."""
        order = sorted(self.pairs, key=lambda one: one.measured_hz)
        return tuple((a.measured, b.measured) for k, a in enumerate(order) for b in order[k + 1 :] if a.model_hz > b.model_hz)

    def tables(self) -> dict[str, str]:
        """CSV by name: ``pairs``, ``mac``, ``cross-orthogonality``, ``comac``; those that there are."""
        names, found = [one.measured for one in self.pairs], {}
        head = ("measured", "model", "measured_hz", "model_hz", "percent", "sigmas", "mac")
        found["pairs"] = _csv(head, ([getattr(one, key) for key in head] for one in self.pairs))
        for name, matrix in (("mac", self.mac), ("cross-orthogonality", self.cross_orthogonality)):
            if matrix.size:
                rows = zip(names, matrix.tolist(), strict=True)
                found[name] = _csv(("measured", *(f"model {k}" for k in self.modes)), ([one, *row] for one, row in rows))
        if self.comac:
            found["comac"] = _csv(("sensor", "comac"), self.comac.items())
        return found


RULE = "of all assignments that with the least sum of 1 - MAC + (ln f/f' / 0.3)²"


def modal(test: TableFrequencies | TableShapes, offsets: Offsets) -> ModalCorrelation:
    """The table of `test` beside its model at `offsets`.

    Raises
    ------
    ValueError, numpy.linalg.LinAlgError : the model has no such modes.
    """
    modes, of, moved, _ = test.found(offsets, derivatives=True)
    meshes = [moved[one.name].squares * one.tolerance for one in test.structure.parameters if one.family == "mesh"]
    allowed = np.zeros(len(test.table.frequency))
    allowed[list(test.modes)] = np.sqrt(np.sum(np.square(meshes), axis=0)) / (2 * modes.squares[list(of)])
    return of_modes(modes, test.table, allowed, test.effects, test.together)


def of_modes(
    modes: RealModes,
    table: ModalTable,
    allowed: npt.ArrayLike = 0.0,
    added: Sequence[Added] = (),
    together: Sequence[list[int]] = (),
) -> ModalCorrelation:
    """`table` beside the `modes` of a model, whose frequencies its mesh leaves `allowed` (m,) unsure, one sd as a share, and
    whose effects are `added`. Of modes `together` in frequency, each of which is any mix of them, the mix nearest to the test
    counts, in the order of the frequencies."""
    of, f = np.array(partners(modes, table, added)), modes.frequency
    for group in together:
        of[np.array(group)[np.argsort(table.frequency[group])]] = np.sort(of[group])
    of = of.tolist()
    low, high = table.frequency.min() / BEYOND, table.frequency.max() * BEYOND
    looked = tuple(sorted({*of, *(int(k) for k in np.flatnonzero((f > low) & (f < high)))}))
    inside = [k for k in looked if table.frequency.min() <= f[k] <= table.frequency.max() and k not in of]
    matrix, crossed, by_sensor = np.zeros((0, 0)), np.zeros((0, 0)), {}
    read = seen_of = np.zeros((0, 0))
    if table.shapes is not None:
        shapes = (seen(modes.matrices, table) @ modes.shapes).T.astype(table.shapes.dtype)
        for group, mix in mixes(table.shapes, shapes[of], together):
            u, _, v = np.linalg.svd(mix / np.maximum(np.linalg.norm(mix, axis=1, keepdims=True), 1e-300))  # turned alone
            shapes[[of[k] for k in group]] = u @ v @ shapes[[of[k] for k in group]]
        read, seen_of = table.shapes, shapes[list(looked)]
        matrix, crossed = mac(read, seen_of), cross_orthogonality(read, seen_of)
        names = [point.name for point in table.sensors]
        by_sensor = dict(zip(names, comac(table.shapes, shapes[list(of)]).tolist(), strict=True))
    since = np.ones(len(of)) if table.since is None else table.since
    pairs = tuple(
        ModePair(
            measured=table.names[k],
            model=of[k] + 1,
            measured_hz=float(table.frequency[k] / since[k]),
            model_hz=float(f[of[k]] / since[k]),
            percent=float(100 * (f[of[k]] / table.frequency[k] - 1)),
            sigmas=float((f[of[k]] - table.frequency[k]) / table.frequency_deviation[k]),
            mac=float(matrix[k, looked.index(of[k])]) if matrix.size else None,
        )
        for k in range(len(of))
    )
    return ModalCorrelation(
        data_set=table.title,
        rule=RULE if table.shapes is not None else RULE.replace("1 - MAC + ", ""),
        pairs=pairs,
        missing=tuple(k + 1 for k in inside),
        modes=tuple(k + 1 for k in looked),
        mac=matrix,
        cross_orthogonality=crossed,
        comac=by_sensor,
        remarks=_remarks(pairs, [k + 1 for k in inside], np.hypot(allowed, table.frequency_deviation / table.frequency)),
        measured_shapes=read,
        model_shapes=seen_of,
    )


def _remarks(pairs: Sequence[ModePair], missing: Sequence[int], due: Array) -> tuple[str, ...]:
    """What is to be said of `pairs`, of which each frequency may be `due` (m,) off, one standard deviation as a share."""
    said = []
    order = sorted(pairs, key=lambda one: one.measured_hz)
    for k, a in enumerate(order):
        said += [
            f"{a.measured} and {b.measured} have changed places: {a.measured_hz:.4g} and {b.measured_hz:.4g} Hz are measured, "
            f"{a.model_hz:.4g} and {b.model_hz:.4g} Hz computed"
            for b in order[k + 1 :]
            if a.model_hz > b.model_hz
        ]
    known = [one for one in pairs if one.mac is not None]
    green = known and all(one.mac is not None and one.mac >= GREEN for one in known)
    sd, worst = max(((abs(one.percent) / (100 * of), one) for one, of in zip(pairs, due, strict=True)), key=lambda each: each[0])
    if green and sd > FAR:
        said.append(
            f"every MAC is {GREEN:g} or more, and the model is wrong: before any fit {worst.measured} is {worst.percent:+.2g} % "
            f"off, {sd:.0f} standard deviations of test and mesh; MAC does not see frequencies"
        )
    poor = [one.measured for one in known if one.mac is not None and one.mac < GREEN]
    if poor:
        said.append(f"MAC is below {GREEN:g} of {', '.join(poor)}")
    if missing:
        numbers = ", ".join(map(str, missing))
        said.append(f"the model has modes within the table that were not measured: {numbers}")
    return tuple(said)


def comac(measured: npt.ArrayLike, model: npt.ArrayLike) -> Array:
    """(s,) by sensor how alike paired shapes (m, s) are there, over all modes, each of unit length.

    N. A. J. Lieven and D. J. Ewins, Spatial correlation of mode shapes: the coordinate modal assurance criterion, IMAC 6, 1988.
    """
    a, b = np.atleast_2d(np.asarray(measured)), np.atleast_2d(np.asarray(model))
    a, b = (one / np.linalg.norm(one, axis=1, keepdims=True) for one in (a, b))
    both = np.sum(np.abs(a * b.conj()), axis=0) ** 2
    sizes = np.sum(np.abs(a) ** 2, axis=0) * np.sum(np.abs(b) ** 2, axis=0)
    return np.asarray(np.divide(both, sizes, out=np.ones_like(both), where=sizes > 0))


def cross_orthogonality(measured: npt.ArrayLike, model: npt.ArrayLike) -> Array:
    """(m, q) of measured shapes (m, s), scaled to unit mass, and shapes of the model (q, s) of unit mass: a unit matrix if alike.

    The mass is what the sensors see of that of the model, pinv(Phi)^T pinv(Phi) with the shapes Phi (s, q) as columns (J.
    O'Callahan, P. Avitabile, R. Riemer, System equivalent reduction expansion process, IMAC 7, 1989); empty where there are fewer
    sensors than modes, or modes that look alike at them.
    """
    a, b = np.atleast_2d(np.asarray(measured)), np.atleast_2d(np.asarray(model, dtype=np.float64))
    if b.shape[1] < len(b) or np.linalg.cond(b) > 1e6:
        return np.zeros((0, 0))
    back = np.linalg.pinv(b.T)
    coordinates = a @ back.T
    scaled = coordinates / np.maximum(np.linalg.norm(coordinates, axis=1, keepdims=True), np.finfo(np.float64).tiny)
    return np.asarray(np.abs(scaled))


@dataclass(frozen=True, eq=False, kw_only=True)
class FunctionCorrelation:
    """Response functions beside those of a model.

    Attributes
    ----------
    data_set : title of the test
    frac : by run and channel, ``run/channel``, 0 to 1, how alike the functions are but for a factor
    ratio : by run and channel the level of the model over that of the data [dB]
    remarks : sentences
    """

    data_set: str
    frac: Mapping[str, float]
    ratio: Mapping[str, float]
    remarks: tuple[str, ...]

    def tables(self) -> dict[str, str]:
        """CSV by name."""
        rows = ((*name.split("/", 1), self.frac[name], self.ratio[name]) for name in self.frac)
        return {"frac": _csv(("run", "channel", "frac", "ratio_db"), rows)}


def functions(test: ResponseFunctionTest, offsets: Offsets) -> FunctionCorrelation:
    """The functions of `test` beside those of its model at `offsets`.

    Raises
    ------
    ValueError, numpy.linalg.LinAlgError : the model breaks down there.
    """
    data, found = test.measured, test.at(offsets, derivatives=False).rows[..., 0]
    measured = data.values
    pairs = [(f"{run}/{channel}", r, c) for r, run in enumerate(data.runs) for c, channel in enumerate(data.channels)]
    alike = {name: frac(measured[r, :, c], found[r, :, c]) for name, r, c in pairs}
    least = np.finfo(np.float64).tiny ** 0.5  # a function that is zero, in data or model, is very low
    sizes = [np.maximum(np.linalg.norm(one, axis=1), least) for one in (found, measured)]
    level = {name: float(20 * np.log10(sizes[0][r, c] / sizes[1][r, c])) for name, r, c in pairs}
    said = []
    loud = {name: one for name, one in level.items() if alike[name] >= GREEN and abs(one) > 1}
    if loud:
        worst = max(loud, key=lambda name: abs(loud[name]))
        wrong = f"its level is {level[worst]:+.1f} dB off; FRAC does not see a factor"
        said.append(f"FRAC of {worst} is {alike[worst]:.2f}, and {wrong}")
    return FunctionCorrelation(data_set=test.measured.name, frac=alike, ratio=level, remarks=tuple(said))


def correlations(made: Sequence[Prediction]) -> tuple[ModalCorrelation | FunctionCorrelation, ...]:
    """Of all tests of structures among `made`, by the models as they are; of functions also that of the resonances they show."""
    found: list[ModalCorrelation | FunctionCorrelation] = []
    for one in made:
        tables = resonance_table(one) if isinstance(one, ResponseFunctionTest) else (one,)
        start = {each.name: each.start for each in one.parameters}
        with suppress(ValueError, np.linalg.LinAlgError):
            found += [modal(table, start) for table in tables if isinstance(table, TableFrequencies)]
            found += [functions(one, start)] if isinstance(one, ResponseFunctionTest) else []
    return tuple(found)


def frac(measured: ComplexArray, model: ComplexArray) -> float:
    """Frequency response assurance criterion of two functions (n,): 1 where they are alike but for a factor.

    R. J. Allemang, The modal assurance criterion: twenty years of use and abuse, Sound and Vibration 37, 2003.
    """
    sizes = float(np.sum(np.abs(measured) ** 2) * np.sum(np.abs(model) ** 2))
    return float(np.abs(np.vdot(measured, model)) ** 2 / sizes) if sizes > 0 else 0.0


def _csv(head: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(["" if one is None else one for one in row] for row in rows)
    return text.getvalue()


# Modes by the names that one speaks of them: the part that holds most of their strain energy, and their order among its modes.


ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")

RIGID = "rigid motion"
"""Name of a mode of a structure that floats which strains nothing."""

STRAINS_NOT = 1e-4
"""Share of the frequency of the first elastic mode up to which that of a rigid motion is rounding."""


@dataclass(frozen=True, kw_only=True)
class NamedMode:
    """One fixed-base mode.

    Attributes
    ----------
    name : "first mast mode"
    frequency : [Hz]
    damping_ratio : [1]
    effective_mass : (6,) along and about every axis [kg], [kg m²]; empty where it is not known
    """

    name: str
    frequency: float = entry("frequency_hz", unit="Hz")
    damping_ratio: float
    effective_mass: tuple[float, ...] = unwritten(default=())


def modes_of(prediction: StructurePrediction, offsets: Offsets) -> tuple[NamedMode, ...]:
    """The modes with the base held, ascending, of the structure at `offsets`, its effects acting; of one that floats first its
    rigid motions, which lose nothing. The last stand for the static answer of all others.
    """
    if prediction.structure is None:
        return ()
    matrices, _ = prediction.structure.at(offsets, derivatives=False)
    matrices = effects.structure(matrices, {}, effects.at(prediction.effects, offsets), derivatives=False)[0]
    own = np.arange(matrices.base, len(matrices.mass))
    if not own.size:
        return ()
    K, M, C, S = (one[np.ix_(own, own)] for one in (matrices.stiffness, matrices.mass, matrices.viscous, matrices.structural))
    squares, shapes = modal_table.real_pairs(K, M)
    moving = np.isfinite(squares)  # the others have no mass
    omega, shapes = np.sqrt(np.maximum(squares[moving], 0.0)), shapes[:, moving]
    floats = min(int(np.count_nonzero(matrices.rigid[:, own].any(axis=0))), len(omega) - 1)
    rigid = int(np.count_nonzero(omega[:floats] < STRAINS_NOT * omega[floats]))
    swings = np.append(np.full(rigid, np.inf), np.maximum(omega[rigid:], 1e-12))
    zeta = (_energy(C, shapes) + _energy(S, shapes) / swings) / (2 * swings)
    # By mode the part with the largest share of strain energy; empty words where the model does not say
    shares: dict[str, Array] = {}
    for part, stiffness in matrices.parts.items():
        shares[family(part)] = shares.get(family(part), 0.0) + _energy(stiffness[np.ix_(own, own)], shapes)
    most = np.argmax(np.stack(list(shares.values())), axis=0) if shares else ()
    holders = [list(shares)[k] for k in most] or [""] * len(omega)
    # "mast", "upper-long", "mast" as "first mast mode", "first upper-long mode", "second mast mode"
    found: list[NamedMode] = []
    effective = np.square(shapes.T @ matrices.mass[own, : matrices.base])
    for k, (part, w, z, m) in enumerate(zip(holders, omega, zeta, effective, strict=True)):
        place = holders[rigid:k].count(part)
        ordinal = ORDINALS[place] if place < len(ORDINALS) else f"{place + 1}th"
        name = RIGID if k < rigid else f"{ordinal} {part} mode".replace("  ", " ")
        mass = tuple(map(float, m))
        found.append(NamedMode(name=name, frequency=float(w / (2 * np.pi)), damping_ratio=float(z), effective_mass=mass))
    return tuple(found)


def _energy(matrix: Array, shapes: Array) -> Array:
    return np.asarray(np.einsum("im,ij,jm->m", shapes, matrix, shapes))
