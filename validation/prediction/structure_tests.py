"""What response functions and modal tables of a user's own structure should be, by one model: a prediction of each data set."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol, Self, TypeVar, runtime_checkable

import numpy as np

from fem.damping import Damping, is_assumed
from fem.structure import Sparse, Structure, place_rows, position_of
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point
from geometry.toml_file import nearest
from identification.modal_table import ModalTable
from identification.response_functions import ResponseFunctions
from validation.effects.catalogue import There
from validation.effects.effect import position
from validation.estimation.problem import Lines, Offsets, Prediction
from validation.model.model import Added, Model
from validation.prediction import effects, modal_table, mounting, response_functions
from validation.prediction import structure as reduction
from validation.prediction.dynamic_mass import AttachedResponse, Finite
from validation.prediction.structure import ReducedStructure

Test = ModalTable | ResponseFunctions


@runtime_checkable
class StructurePrediction(Prediction, Protocol):
    """A prediction of one data set by a model of a structure, whose effects may be exchanged."""

    @property
    def structure(self) -> effects.Nuisances | None:
        """What was tested, before any effect."""

    @property
    def effects(self) -> tuple[Added, ...]:
        """In the order in which they act."""

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was assumed, sentences."""

    @property
    def there(self) -> There:
        """What effects can act on."""

    def with_effects(self, effects: Sequence[Added]) -> Self:
        """The same by a model with these `effects` instead of its own."""


@runtime_checkable
class OnNodes(StructurePrediction, Protocol):
    """A prediction that says what anything attached to any node of its structure would do, where nodes are known."""

    def by(self, structure: effects.Nuisances) -> Self:
        """The same data by another model of the structure."""

    def attached(self, offsets: Offsets, lines: Lines, rows: Array, inputs: ComplexArray) -> AttachedResponse:
        """What a mass at places would change, to first order.

        Parameters
        ----------
        rows : (q, 3, k) what each coordinate of the structure moves the places along x, y, z
        inputs : (r, m, i) of the runs at these lines, as they are known or estimated
        """

    def finite(self, offsets: Offsets, lines: Lines) -> Finite:
        """What is read with a mass or a spring of any size at a place."""


def predictions(model: Model, tests: Sequence[Test]) -> tuple[StructurePrediction, ...]:
    """Predictions of `tests` by `model`, whose own structures they are about; a test may make several data sets.

    Raises
    ------
    BadInput : a structure that `model` does not name or that cannot be used, a place that it has not, two tests of one name, a
        gain that one test knows and another does not.
    CheckFailed : as `validation.prediction.structure.by_itself`.
    """
    found: list[StructurePrediction] = []
    for article in dict.fromkeys(one.article for one in tests):
        own = [one for one in tests if one.article == article]
        if article not in model.own:
            remedy = f"{nearest(article, model.own)}Name its file in [structure.own] of {model.source}, or correct the article"
            raise BadInput(own[0].source, "article", f"is {article}, and {model.source} has no model of it", remedy)
        path = model.own[article]
        users = mounting.users_model(path, mounting.stamp(path)).model
        if isinstance(users, Structure):
            own = [named(users, aligned(users, one)) for one in own]
        known = tested(model, article, own)
        for one in own:
            if isinstance(one, ResponseFunctions):
                found += response_functions.of(known, one, model.tolerances)
            else:
                found += modal_table.of(known, one, model.tolerances)
    names = [one.measured.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise BadInput(name, "test", "two tests have this name", "Give each a `title` of its own")
    stated: dict[str, tuple[bool, str]] = {}
    for made in found:
        for parameter in made.parameters:
            unknown, by = stated.setdefault(parameter.name, (parameter.logarithmic, made.measured.name))
            if unknown != parameter.logarithmic:
                pair = (by, made.measured.name) if unknown else (made.measured.name, by)
                remedy = 'State `gain` and `force_gain` alike, or name the sensor apart: { place = "tip:z", name = "tip-z-2" }'
                raise BadInput("test", parameter.name, f"is unknown in {pair[0]}, known in {pair[1]}", remedy)
    return tuple(found)


def tested(model: Model, article: str, tests: Sequence[Test]) -> effects.Nuisances:
    """The structure of `article` as it stands by itself, with all places of `tests`, up to the end of their bands.

    Raises
    ------
    BadInput, CheckFailed : see `predictions`.
    """
    from scipy.sparse import csr_array

    path = model.own[article]
    users = mounting.users_model(path, mounting.stamp(path))
    if not isinstance(users.model, Structure):
        raise BadInput(path, article, "is known by modal data alone, which have no places", "Bring its matrices or its mesh")
    structure = users.model
    points = {point.place: (one.source, point) for one in tests for point in points_of(one)}
    rows: dict[str, Sparse] = {}  # (3, n) what each degree of freedom moves a point, by its number or its coordinates
    n = structure.mass.shape[0]
    for source, point in (each for place, each in points.items() if place not in structure.places):
        word, _, number = point.place.partition(" ")
        if word == "dof" and number.isdecimal():
            if int(number) >= n:
                raise BadInput(source, point.place, f"there is no such row: the matrices have {n}, counted from 0", "Correct it")
            rows[point.place] = csr_array(([1.0], ([0], [int(number)])), shape=(3, n))
        elif (at := position(point.place) if point.position is None else point.position) is not None:
            rows[point.place] = place_rows(structure, at, source, point.place)[0]
        elif word == "node" and number.isdecimal() and structure.elements is not None:
            there = structure.elements.numbered(int(number))
            rows |= {} if there is None else {point.place: there}
    known = {name: row for name, row in structure.places.items() if name.replace("-", " ", 1) not in rows}  # dof-20 and dof 20
    structure = reduction.with_positions(replace(structure, places={**known, **rows}), mounting.positions_on(model, path))
    band = max(one.band[1] if isinstance(one, ResponseFunctions) else float(np.max(one.frequency)) for one in tests)
    damping = users.damping if model.damping_ratio is None else Damping(ratio=model.damping_ratio)
    made = reduction.by_itself(structure, band, damping=damping)
    return effects.nuisances(
        article,
        made.matrices,
        made.frequency,
        made.losses,
        model.structure,
        highest=reduction.ABOVE * band,
        part_tolerances=structure.part_tolerances,
        scaled=users.units.known,
        reduced=made,
        assumed=is_assumed(structure, damping),
        unchanged=all(isinstance(one, ModalTable) and one.before is not None for one in tests),
    )


P = TypeVar("P", bound=StructurePrediction)


def over(tests: Sequence[P], reduced_anew: Callable[[ReducedStructure], ReducedStructure]) -> tuple[P, ...]:
    """`tests` by the same models over other coordinates, as `reduced_anew` makes those of each structure."""
    made: dict[int, effects.Nuisances] = {}
    found: list[P] = []
    for one in tests:
        of = one.structure if isinstance(one, OnNodes) else None
        known = None if of is None else of.reduced
        if isinstance(one, OnNodes) and of is not None and known is not None:
            anew = made.get(id(of)) or made.setdefault(id(of), of.over(reduced_anew(known)))
            found.append(one if anew is of else one.by(anew))
        else:
            found.append(one)
    return tuple(found)


def points_of(test: Test) -> tuple[Point, ...]:
    """Where it is driven, and where it is read."""
    return (*test.drives, *test.responses) if isinstance(test, ResponseFunctions) else test.sensors


def with_points(test: Test, other: Callable[[Point], Point]) -> Test:
    """`test` with the `other` of each of its points."""
    if isinstance(test, ResponseFunctions):
        return replace(test, drives=tuple(map(other, test.drives)), responses=tuple(map(other, test.responses)))
    return replace(test, sensors=tuple(map(other, test.sensors)))


SAME = 1e-6
"""[m] within which a point of a test and a place of the model are one. By definition."""


def named(structure: Structure, test: Test) -> Test:
    """`test` whose points that lie where `structure` has a named place are at that place: nothing is looked for twice."""

    def is_nameless(one: Point) -> bool:
        return one.position is not None and one.place not in structure.places

    if not any(map(is_nameless, points_of(test))):
        return test
    known = {name: at for name in structure.places if (at := position_of(structure, name)) is not None}

    def there(one: Point) -> Point:
        if not is_nameless(one):
            return one
        at = np.asarray(one.position)
        return next((replace(one, place=name) for name, p in known.items() if np.linalg.norm(p - at) <= SAME), one)

    return with_points(test, there)


def within(test: Test, band: tuple[float, float] | None) -> Test:
    """`test` with what lies in `band` [Hz] alone, as it is where none is asked for.

    Raises
    ------
    BadInput : nothing of it does.
    """
    if band is None:
        return test
    low, high = test.band if isinstance(test, ResponseFunctions) else (float(test.frequency.min()), float(test.frequency.max()))
    if band[0] > high or band[1] < low:
        problem = f"is {band[0]:g} to {band[1]:g} Hz, and {test.title} has {low:g} to {high:g} Hz"
        raise BadInput("--band", test.title, problem, "Ask for a band that it has, or leave it out")
    if isinstance(test, ResponseFunctions):
        return replace(test, band=(max(band[0], low), min(band[1], high)))
    kept = np.flatnonzero((test.frequency >= band[0]) & (test.frequency <= band[1]))
    if not len(kept):
        problem = f"no mode of {test.title} lies within {band[0]:g} to {band[1]:g} Hz"
        raise BadInput("--band", test.title, problem, "Ask for a wider band, or leave it out")
    return test.of_modes(kept.tolist())


COMMON = 3
"""[count] of points that test and model must have in common for their frames to be compared."""

APART = 0.02
"""[share] of the size of what is common by which points may lie apart. Held by test_structure_tests.py."""


def aligned(structure: Structure, test: Test) -> Test:
    """`test` in the axes of `structure`, by all points whose coordinates both state, and the motion that brings them together.

    W. Kabsch, Acta Crystallographica A32 (1976), 922.

    Raises
    ------
    BadInput : they do not come together; by how much, where most, and the factor that would do it.
    """
    known = {one.place: one for one in points_of(test) if one.position is not None and one.place in structure.places}
    pairs = {name: (np.asarray(one.position), position_of(structure, name)) for name, one in known.items()}
    there = {name: (own, of) for name, (own, of) in pairs.items() if of is not None}
    if len(there) < COMMON:
        return test
    P, Q = (np.array([pair[k] for pair in there.values()]) for k in (0, 1))
    p, q = P - P.mean(axis=0), Q - Q.mean(axis=0)
    U, sizes, Vt = np.linalg.svd(p.T @ q)
    if sizes[1] < 1e-6 * sizes[0]:  # on one line: nobody knows how it is turned about it
        return test
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(Vt.T @ U.T))])
    R = Vt.T @ flip @ U.T
    off = np.linalg.norm(p @ R.T - q, axis=1)
    extent = float(np.sqrt(np.mean(np.sum(q**2, axis=1))))
    if off.max() > APART * extent:
        factor = float(np.sqrt(np.sum(q**2) / max(float(np.sum(p**2)), 1e-300)))
        scaled = np.linalg.norm(factor * p @ R.T - q, axis=1).max()
        units = f"; times {factor:.4g} they would match: look at their unit" if scaled < APART * extent else ""
        raise BadInput(
            test.source,
            "coordinates",
            "the points of test and model do not match: aligned as well as can be, "
            f"{list(there)[int(np.argmax(off))]} lies {1e3 * off.max():.4g} mm off, "
            f"all {len(there)} {1e3 * np.sqrt(np.mean(off**2)):.4g} mm in the mean{units}",
            "Correct the coordinates or the names of places, or leave the coordinates out",
        )
    if np.allclose(R, np.eye(3), atol=1e-3):
        R = np.eye(3)

    def moved(one: Point) -> Point:
        at = None if one.position is None else R @ (np.asarray(one.position) - P.mean(axis=0)) + Q.mean(axis=0)
        return replace(one, direction=R @ np.asarray(one.direction), position=at)

    return with_points(test, moved)
