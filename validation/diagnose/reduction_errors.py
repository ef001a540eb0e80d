"""How far effects on reduced matrices are from the same effects on the whole structure, at several times what the tests of a
study would name: `massline model --examine STUDY`, of a model file that names its tests.

An effect shifts squares of frequencies; with d what it shifts those of the band of the tests by, each as a share of the square,

    error = |d_reduced - d_whole| / |d_whole| ,      whole: modes of K and M on all degrees of freedom, with the effect in them.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from fem.modes import floating_shift, lowest
from fem.structure import Sparse, Structure, hold
from geometry.dynamic_mass import MOTIONS
from geometry.frames import Array
from validation.diagnose.candidates import baseline, candidates, detectable, screen
from validation.effects.catalogue import FAMILIES, Named, acts, there
from validation.effects.effect import OPENED, joints_named
from validation.effects.stages import ALONG
from validation.model.model import Added
from validation.output import entry
from validation.prediction import dynamic_mass
from validation.prediction import structure as reduction
from validation.prediction.effects import Nuisances, opened
from validation.prediction.modal_table import real_modes
from validation.prediction.structure import ReducedStructure
from validation.study import Study

MULTIPLE = 5.0
"""[factor] over the smallest size that the tests would name at which effects are put in. By definition."""

BAR = 1e-3
"""[share] of what an effect changes that the reduction may be off. By definition."""

SAME_END = 1.01
"""[factor] up to which a mode belongs to a band: it may end at a measured one. By definition."""

LARGEST = 20_000
"""[count] of degrees of freedom up to which this is measured: two whole solutions an effect. By definition."""

RANGES = {"modulus": reduction.FAR, "mass": reduction.FAR, "thickness": reduction.FAR_THICKNESS}
"""Relative changes that the reduction is made for; larger ones are asked at their end."""

ATTACHED = 0.5
"""[share] of omega² by which something at a place moves the mode that it moves most, beyond which it is not asked there: nobody
overlooks it. By definition."""


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
    band, modes : [Hz] where its tests end, and how many are compared
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
    tested = {of.configuration: of for one in study.tests if (of := one.structure) is not None}
    small = {name: of for name, of in tested.items() if of.reduced is not None and len(of.reduced.basis) <= LARGEST}
    if not small:
        return ()
    base = baseline(study)
    menu = [one for one in candidates(study) if one.named.family in FAMILIES_MOVING and "every" not in one.named.targets]
    by_id = {one.named.id: one.named for one in menu}
    limits = {by_id[one.id]: one.size for one in detectable(screen(study, base, menu))}
    found = []
    for name, of in small.items():
        reduced = of.reduced
        assert reduced is not None
        count = max(int(np.sum(reduced.frequency <= SAME_END * reduced.band)), 1)
        effects = [one for named, size in limits.items() for one in _sized(named, MULTIPLE * size)]
        errors = sorted(_errors(of, reduced, effects, count), key=lambda one: -one.error)
        n, k = reduced.basis.shape
        if errors:
            made = ReductionErrors(article=name, freedoms=n, coordinates=k, band=reduced.band, modes=count, effects=tuple(errors))
            found.append(made)
    return tuple(found)


def _sized(named: Named, size: float) -> Iterator[Named]:
    """`named` at that distance from no effect, to either side where there is one."""
    (spec, *_) = named.sizes
    if named.family == "support-stiffness":
        low, high = (1 + end for end in reduction.FAR_SUPPORT)
        sizes = {min(1 + size, high), max(1 / (1 + size), low)}
    else:
        low, high = RANGES.get(named.family, (min(size, spec.high), spec.high))
        sizes = {min(size, high), max(-size, low)}
    yield from (replace(named, values={**named.values, spec.key: one}) for one in sorted(sizes))


def _errors(of: Nuisances, reduced: ReducedStructure, effects: Iterable[Named], count: int) -> Iterator[ReductionError]:
    """Of those of `effects` that move one of the lowest `count` modes, at a place none by more than nobody overlooks."""
    structure = reduced.structure
    slowest = 1e-3 * (2 * np.pi * reduced.frequency[0]) ** 2  # below is the motion of what floats

    def lowest_of(squares: Array) -> Array:
        return np.sort(squares[squares > slowest])[:count]

    def of_whole(K: Sparse, M: Sparse) -> Array:
        free = hold(replace(structure, stiffness=K.tocsr(), mass=M.tocsr()))
        shift = floating_shift(free.stiffness, free.mass) if structure.floating else 0.0
        return lowest_of(lowest(free.stiffness, free.mass, count + 6 * structure.floating, shift=shift).values)

    def of_reduced(acting: tuple[Added, ...]) -> Array:
        open_, here = ([one for one in acting if (FAMILIES[one.named.family].stage == OPENED) is side] for side in (True, False))
        matrices, _ = dynamic_mass.structure(of, opened(of.parameters, open_)[1], here, derivatives=False)
        return lowest_of(real_modes(matrices).squares)

    whole, few = of_whole(structure.stiffness, structure.mass), of_reduced(())
    for named in effects:
        d = of_whole(*_changed(structure, named)) / whole - 1
        change = float(np.abs(d).max())
        if change < SEEN or (named.family in ("point-mass", "cable") and change > ATTACHED):
            continue
        off = float(np.linalg.norm(of_reduced((Added(named=named, fixed=True),)) / few - 1 - d) / np.linalg.norm(d))
        yield ReductionError(id=named.id, size=named.value, change=change, error=off)


SEEN = 1e-6
"""[share] of a squared frequency that an effect must move for its error to be more than rounding. By definition."""

FAMILIES_MOVING = ("modulus", "support-stiffness", "mass", "thickness", "point-mass", "cable", "connection-compliance")
"""Families that are put into whole structures here; losses move no frequency."""


def swinging_with(reduced: ReducedStructure, effects: Iterable[Added]) -> ReducedStructure:
    """`reduced` whose coordinates hold how the whole structure swings with those of `effects` that change its matrices; itself
    where none does.

    Raises
    ------
    CheckFailed : as `ReducedStructure.swinging_as`.
    """
    whole, has = reduced.structure, there("article", reduced.matrices)
    for one in effects:
        if one.named.family in FAMILIES_MOVING and acts(one.named, has):
            K, M = _changed(whole, one.named)
            whole = replace(whole, stiffness=K, mass=M)
    return reduced if whole is reduced.structure else reduced.swinging_as(whole.stiffness, whole.mass)


def _changed(structure: Structure, named: Named) -> tuple[Sparse, Sparse]:
    """K and M of a whole structure with an effect."""
    from scipy.sparse import csr_array

    K, M, value, what = structure.stiffness, structure.mass, named.value, named.targets[0]
    if named.family in ("modulus", "support-stiffness"):
        K = K + (value - (named.family == "support-stiffness")) * reduction.parts_of(structure)[what]
    elif named.family == "thickness":
        linear, cubed = structure.sections[what]
        K = K + value * linear + ((1 + value) ** 3 - 1) * cubed
    elif named.family in ("point-mass", "cable"):
        rows = structure.places[what].tocsr()[list(ALONG["".join(named.targets[1:])])]
        more = value * (rows.T @ rows)
        K, M = (K, M + more) if named.family == "point-mass" else (K + more, M)
    elif named.family != "mass":
        for joint in joints_named(what, structure.joints):
            if (springs := reduction.joint_springs(structure, joint)) is not None:
                p, k = (one[MOTIONS.index(named.targets[1])] for one in springs)
                p = csr_array(p.reshape(-1, 1))
                K = K - value / (1 + value * k) * (p @ p.T)
    if named.family in ("mass", "thickness") and what in structure.part_mass:
        M = M + value * structure.part_mass[what]
    return K, M
