"""How far effects on reduced matrices are from the same effects on the whole structure, at several times what the tests of a
study would name: `massline model --examine STUDY`, of a model file that names its tests.

An effect shifts squares of frequencies; with d what it shifts those of the band of the tests by, each as a share of the square,

    error = |d_reduced - d_whole| / |d_whole| .

Whole means K and M on all degrees of freedom with the effect put into them, and their modes solved anew.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fem.modes import floating_shift, lowest
from fem.structure import Sparse, Structure, hold
from geometry.dynamic_mass import MOTIONS
from geometry.frames import Array
from validation.diagnose.candidates import candidates, detectable, screen
from validation.diagnose.diagnosis import Candidate
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import OPENED
from validation.effects.stages import ALONG
from validation.model.model import Added
from validation.output import entry
from validation.prediction import dynamic_mass
from validation.prediction import structure as reduction
from validation.prediction.effects import Nuisances, opened
from validation.prediction.modal_table import real_modes
from validation.prediction.structure import ReducedStructure
from validation.prediction.structure_tests import OnNodes
from validation.study import Study

MULTIPLE = 5.0
"""[factor] over the smallest size that the tests would name at which effects are put in. By definition."""

BAR = 1e-3
"""[share] of what an effect changes that the reduction may be off. By definition."""

LARGEST = 20_000
"""[count] of degrees of freedom up to which this is measured: two solutions of the whole structure for each effect."""

RANGES = {"modulus": reduction.FAR, "mass": reduction.FAR, "thickness": reduction.FAR_THICKNESS}
"""Relative changes that the reduction is made for; larger ones are asked at their end."""

ATTACHED = 0.5
"""[share of omega²] by which something at a place moves the mode that it moves most, beyond which it is asked there: such a size
is overlooked by nobody. By definition."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReductionError:
    """Of one effect.

    Attributes
    ----------
    id : of the effect
    size : SI, at which it was put in
    change : largest relative change of a squared frequency in the band
    error : share of the change that the reduced structure is off
    """

    id: str
    size: float
    change: float
    error: float


@dataclass(frozen=True, eq=False, kw_only=True)
class ReductionErrors:
    """Of the structure of a study.

    Attributes
    ----------
    article : its name
    freedoms, coordinates : of the whole structure, and how many it is reduced to
    band : [Hz] where its tests end
    modes : how many are compared
    effects : the worst first
    """

    article: str
    freedoms: int
    coordinates: int
    band: float = entry(unit="Hz")
    modes: int
    effects: tuple[ReductionError, ...]

    @property
    def text(self) -> str:
        """One sentence."""
        head = f"its tests up to {self.band:.4g} Hz see {self.coordinates} coordinates of {self.freedoms} degrees of freedom"
        if not self.effects:
            return f"{head}; no effect on the structure is told by them"
        worst = self.effects[0]
        met = "below" if worst.error <= BAR else "ABOVE"
        return (
            f"{head}: of {len(self.effects)} effects at {MULTIPLE:g} times what they would name, {worst.id} = {worst.size:.3g} "
            f"is farthest from a solution of the whole structure, by {100 * worst.error:.2g} % of its change, {met} the bar of "
            f"{100 * BAR:g} %"
        )


def reduction_errors(study: Study) -> tuple[ReductionErrors, ...]:
    """Of every structure that `study` tests by itself and that is not too large.

    Raises
    ------
    CheckFailed : the model does not fit its tests, so that nobody knows what they would name; as `fem.modes.lowest`.
    """
    tested = {one.structure.configuration: one.structure for one in study.tests if isinstance(one, OnNodes)}
    known = {name: (of, of.reduced) for name, of in tested.items() if of.reduced is not None}
    small = {name: pair for name, pair in known.items() if pair[1].structure.mass.shape[0] <= LARGEST}
    if not small:
        return ()
    base = Candidate(effects=(), fit=study.all_free(), problem=study.problem())
    menu = [one for one in candidates(study) if one.named.family in CHANGES and "every" not in one.named.targets]
    by_id = {one.named.id: one.named for one in menu}
    limits = {by_id[one.id]: one.size for one in detectable(screen(study, base, menu))}
    found = []
    for name, (of, reduced) in small.items():
        both = _Both(of=of, reduced=reduced)
        errors = [both.error(one) for named, size in limits.items() for one in _sized(named, MULTIPLE * size, of)]
        told = [one for one in errors if one is not None]
        worst = tuple(sorted(told, key=lambda one: -one.error))
        found.append(
            ReductionErrors(
                article=name,
                freedoms=reduced.structure.mass.shape[0],
                coordinates=reduced.basis.shape[1],
                band=reduced.band,
                modes=both.count,
                effects=worst,
            )
        )
    return tuple(found)


def _sized(named: Named, size: float, of: Nuisances) -> Iterator[Named]:
    """`named` at that distance from no effect, to either side where there is one."""
    (spec, *_) = named.sizes
    if named.family == "support-stiffness":
        low, high = (1 + end for end in reduction.FAR_SUPPORT)
        sizes = {min(1 + size, high), max(1 / (1 + size), low)}
    elif named.family in RANGES:
        low, high = RANGES[named.family]
        sizes = {min(size, high), max(-size, low)}
    else:
        sizes = {min(size, spec.high)}
    yield from (replace(named, values={**named.values, spec.key: one}) for one in sorted(sizes))


@dataclass(frozen=True, eq=False, kw_only=True)
class _Both:
    """A structure, reduced and whole."""

    of: Nuisances
    reduced: ReducedStructure

    @cached_property
    def count(self) -> int:
        """Modes up to the end of the band, one at least."""
        return max(int(np.sum(self.reduced.frequency <= 1.01 * self.reduced.band)), 1)  # a band may end at a measured mode

    @cached_property
    def slowest(self) -> float:
        """[rad²/s²] below which a mode is the motion of what floats."""
        return 1e-3 * float((2 * np.pi * self.reduced.frequency[0]) ** 2)

    @cached_property
    def before(self) -> tuple[Array, Array]:
        """Squares without any effect, whole and reduced."""
        structure = self.reduced.structure
        return self.of_whole(structure.stiffness, structure.mass), self.of_reduced(())

    def error(self, named: Named) -> ReductionError | None:
        """None where it moves no frequency of the band, or more than anybody would overlook."""
        K, M = CHANGES[named.family](self.reduced.structure, named)
        whole, few = self.before
        d = self.of_whole(K, M) / whole - 1
        change = float(np.abs(d).max())
        if change < SEEN or (named.family in ("point-mass", "cable") and change > ATTACHED):
            return None
        off = self.of_reduced((Added(named=named, fixed=True),)) / few - 1 - d
        return ReductionError(id=named.id, size=named.value, change=change, error=float(np.linalg.norm(off) / np.linalg.norm(d)))

    def of_whole(self, K: Sparse, M: Sparse) -> Array:
        """(count,) squares [rad²/s²] of all degrees of freedom."""
        free = hold(replace(self.reduced.structure, stiffness=K.tocsr(), mass=M.tocsr()))
        floats = self.reduced.structure.floating
        shift = floating_shift(free.stiffness, free.mass) if floats else 0.0
        squares = lowest(free.stiffness, free.mass, self.count + 6 * floats, shift=shift).values
        return self._elastic(squares)

    def of_reduced(self, effects: tuple[Added, ...]) -> Array:
        """(count,) squares [rad²/s²] of the reduced structure."""
        open_, here = ([one for one in effects if (FAMILIES[one.named.family].stage == OPENED) is side] for side in (True, False))
        _, given = opened(self.of.parameters, open_)
        matrices, _ = dynamic_mass.structure(self.of, given, here, derivatives=False)
        return self._elastic(real_modes(matrices).squares)

    def _elastic(self, squares: Array) -> Array:
        return np.sort(squares[squares > self.slowest])[: self.count]


SEEN = 1e-6
"""[share] of a squared frequency that an effect must move for its error to be more than rounding. By definition."""


def _stiffer(structure: Structure, named: Named) -> tuple[Sparse, Sparse]:
    by = named.value - (named.family == "support-stiffness")
    return structure.stiffness + by * structure.part_stiffness[named.target], structure.mass


def _heavier(structure: Structure, named: Named) -> tuple[Sparse, Sparse]:
    return structure.stiffness, structure.mass + named.value * structure.part_mass[named.target]


def _thicker(structure: Structure, named: Named) -> tuple[Sparse, Sparse]:
    linear, cubed = structure.sections[named.target]
    K = structure.stiffness + named.value * linear + ((1 + named.value) ** 3 - 1) * cubed
    return K, _heavier(structure, named)[1] if named.target in structure.part_mass else structure.mass


def _attached(structure: Structure, named: Named) -> tuple[Sparse, Sparse]:
    rows = structure.places[named.targets[0]].tocsr()[list(ALONG["".join(named.targets[1:])])]
    more = named.value * (rows.T @ rows)
    if named.family == "cable":
        return structure.stiffness + more, structure.mass
    return structure.stiffness, structure.mass + more


def _looser(structure: Structure, named: Named) -> tuple[Sparse, Sparse]:
    from scipy.sparse import csr_array

    springs = reduction.joint_springs(structure, named.targets[0])
    if springs is None:
        return structure.stiffness, structure.mass
    p, k = (one[MOTIONS.index(named.targets[1])] for one in springs)
    p = csr_array(p.reshape(-1, 1))
    return structure.stiffness - named.value / (1 + named.value * k) * (p @ p.T), structure.mass


CHANGES = {
    "modulus": _stiffer,
    "support-stiffness": _stiffer,
    "mass": _heavier,
    "thickness": _thicker,
    "point-mass": _attached,
    "cable": _attached,
    "connection-compliance": _looser,
}
"""K and M of a whole structure with an effect, by family; losses move no frequency."""
