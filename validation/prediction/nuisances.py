"""What a model declares to know of a structure only within tolerances: moduli, frequencies, damping, participation, coupling.

    K' = E K E,  S' = D E S E D,  C' = D G C G D + c,  M_br' = M_br + l,      E = diag(e^ln f),  D = diag(e^(ln zeta / 2)),

on the nominal modal basis, K and S with the moduli and the loss factors of the parts in them. G lets viscous damping grow with
the frequency of its mode, G_rr = (K'_rr / K_rr)^(1/4), so that a stated ratio stays what it is. Nothing is re-diagonalised: the
matrices are smooth in every parameter, stay symmetric, K and C positive, and a cluster of frequencies needs no tracking.

Where parts have loss factors, these are what is not known of damping: one number moves all modes in which the part bends, in all
configurations, and what it cannot do is left to the modes within the small tolerance `mode_damping`. A third of freedom on each
mode would swallow any loss of a part. The offset of a loss factor is a relative change of it and no logarithm: effects add to
the same matrix, and only in a straight valley between the two does a fit find the lowest point. Where damping is given by mode
there is nothing else to move, and the modes have it all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import MOTIONS
from geometry.frames import Array, Integers
from validation.effects.stages import Matrices
from validation.estimation.problem import DECLARED, STRUCTURAL, WITHIN, Offsets, Parameter
from validation.model.model import StructureTolerances
from validation.prediction.structure import sheet

# `Tangent`: how reduced matrices change with one parameter, on the few coordinates that do.


@dataclass(frozen=True, eq=False, kw_only=True)
class Tangent:
    """d `Matrices` / d offset of one parameter.

    Attributes
    ----------
    at : (s,) the coordinates concerned; coordinates that later effects append need no change here
    mass, stiffness, viscous, structural : (s, s)
    parts : by name (k, k), where the share of a part changes
    crossing : position in `at` of the coordinate whose row and column alone change; None where more may
    """

    at: Integers
    mass: Array
    stiffness: Array
    viscous: Array
    structural: Array
    parts: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    crossing: int | None = None


FIELDS = ("mass", "stiffness", "viscous", "structural")


def of_arrays(
    size: int, parts: Mapping[str, Array] = MappingProxyType({}), crossing: int | None = None, **changes: Array
) -> Tangent:
    """The tangent of full (size, size) `changes` by the names of `FIELDS`; what is not named does not change.

    Parameters
    ----------
    crossing : the coordinate whose row and column alone change, if there is one
    """
    moving = np.zeros(size, dtype=bool)
    for change in changes.values():
        moving |= np.any(change != 0, axis=0) | np.any(change != 0, axis=1)
    at = np.flatnonzero(moving)
    nothing = np.zeros((len(at), len(at)))
    where = None if crossing is None or not moving[crossing] else int(np.searchsorted(at, crossing))
    mass, stiffness, viscous, structural = (changes[name][np.ix_(at, at)] if name in changes else nothing for name in FIELDS)
    return Tangent(at=at, mass=mass, stiffness=stiffness, viscous=viscous, structural=structural, parts=parts, crossing=where)


def between(before: Matrices, after: Matrices, step: float) -> Tangent:
    """(after - before) / step."""
    changes = {name: (getattr(after, name) - getattr(before, name)) / step for name in FIELDS}
    parts = {name: (share - before.parts[name]) / step for name, share in after.parts.items() if share is not before.parts[name]}
    return of_arrays(len(before.mass), {name: change for name, change in parts.items() if np.any(change)}, **changes)


def plus(one: Tangent, other: Tangent, size: int) -> Tangent:
    """The sum of both, on matrices of `size`."""
    whole = {name: full(one, name, size) + full(other, name, size) for name in FIELDS}
    return of_arrays(size, {**one.parts, **other.parts}, None, **whole)


def full(tangent: Tangent, name: str, size: int) -> Array:
    """The field `name` of `tangent` on all coordinates, (size, size)."""
    whole = np.zeros((size, size))
    whole[np.ix_(tangent.at, tangent.at)] = getattr(tangent, name)
    return whole


# Whether the losses of a structure follow its displacement or its velocity: nobody knows, and beside a resonance it matters.
#
# Structural damping S and viscous damping that is equal to it at every resonance, C_rs = S_rs / sqrt(omega_r omega_s), take the
# same off every peak, and differ by (1 - omega / omega_r) of themselves beside it. Real joints and layers lie in between (L.
# Gaul, Mechanical Systems and Signal Processing 13 (1999), 473). So a share p of what is structural is taken for viscous:
#
#     S' = (1 - p) S ,        C' = C + p W S W ,        W = diag(omega_r^-1/2) of the nominal modes.


NAME = "damping-law"
"""Of the share; one for all structures of a series."""


def parameter(tolerance: float) -> Parameter:
    """The share p, which is 0 in the model as it stands."""
    return Parameter(name=NAME, unit="1", tolerance=tolerance, kind=DECLARED, within=WITHIN * tolerance)


def applied(
    matrices: Matrices, tangents: Mapping[str, Tangent], nominal: Matrices, offsets: Offsets, *, derivatives: bool
) -> tuple[Matrices, dict[str, Tangent]]:
    """`matrices` with the share of `offsets`, their `tangents` behind it, and that by the share.

    Parameters
    ----------
    nominal : the matrices at offset 0 and without effects, whose modes say at which frequency the two dampings agree
    derivatives : whether any are wanted
    """
    share, W = offsets.get(NAME, 0.0), _weights(nominal, len(matrices.mass))
    turned = W[:, None] * matrices.structural * W
    found = dict(tangents)
    if share:
        found = {name: _behind(tangent, share, W) for name, tangent in found.items()}
    if derivatives:
        found[NAME] = of_arrays(len(W), viscous=turned, structural=-matrices.structural * _own(W, W))
    left = matrices.structural * (1 - share * _own(W, W))
    return replace(matrices, structural=left, viscous=matrices.viscous + share * turned), found


def _weights(nominal: Matrices, size: int) -> Array:
    """(size,) omega^-1/2 of every coordinate; 0 of the base and of what effects append, which brings its own losses."""
    W, own = np.zeros(size), slice(nominal.base, len(nominal.mass))
    square = np.diag(nominal.stiffness)[own] / np.diag(nominal.mass)[own]
    W[own] = np.where(square > 0, square, np.inf) ** -0.25
    return W


def _behind(tangent: Tangent, share: float, W: Array) -> Tangent:
    if not np.any(tangent.structural):
        return tangent
    at = W[tangent.at]
    left = tangent.structural * (1 - share * _own(at, at))
    return replace(tangent, structural=left, viscous=tangent.viscous + share * at[:, None] * tangent.structural * at)


def _own(one: Array, other: Array) -> Array:
    """1 where both coordinates lose by this law, 0 elsewhere."""
    return np.outer(one > 0, other > 0).astype(np.float64)


NEIGHBOURS = 0.1
"""Greatest distance of two frequencies, as a share of the higher one, at which the damping of one mode is taken to pull at the
other: beyond it their resonances do not overlap, and the coupling is of second order in the damping."""

HIGHEST = 50.0
"""[Hz] Modes above it answer quietly: their frequency, damping and participation are what was computed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Nuisances:
    """The uncertain numbers of one article.

    Attributes
    ----------
    configuration : name of the article, which stands in the names of what is its own
    nominal : the matrices at offset 0
    losses : loss factor of every part as the model has it, by which its share of K enters S
    frequency : (m,) [Hz] of the modes that are uncertain, the first of the article's own coordinates
    tolerances : how well they are known
    """

    configuration: str
    nominal: Matrices
    losses: Mapping[str, float]
    frequency: Array
    tolerances: StructureTolerances

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All of them; a tolerance of 0 closes a family."""
        of, modes = self.tolerances, range(1, len(self.frequency) + 1)
        parts = self.nominal.parts if len(self.frequency) else ()
        made = [replace(_declared(f"modulus:{part}", of.modulus), nominal=1.0, logarithmic=True, above=-1.0) for part in parts]
        made += [_declared(f"loss:{part}", of.damping) for part in self.lossy]
        made += [parameter(of.damping_law)] if self.has_law else []
        made += [_declared(f"frequency:{self.configuration}:{r}", of.frequency) for r in modes]
        left = [of.mode_damping if own else of.damping for own in self.by_parts]
        made += [_declared(f"damping:{self.configuration}:{r}", left[r - 1]) for r in modes]
        if self.nominal.base:
            names = (f"participation:{self.configuration}:{r}:{axis}" for r in modes for axis in MOTIONS)
            made += [Parameter(name=name, unit="1", tolerance=of.participation, kind=STRUCTURAL) for name in names]
        names = (f"coupling:{self.configuration}:{r + 1}:{s + 1}" for r, s in self.neighbours)
        made += [Parameter(name=name, unit="1", tolerance=of.mode_coupling, kind=STRUCTURAL) for name in names]
        return tuple(one for one in made if one.tolerance > 0)

    @property
    def lossy(self) -> tuple[str, ...]:
        """Parts that have a loss factor."""
        parts = self.nominal.parts if len(self.frequency) else ()
        return tuple(part for part in parts if self.losses.get(part, 0.0) > 0)

    @property
    def has_law(self) -> bool:
        """Whether it is open which law the losses of its parts follow, see `damping_law`."""
        return bool(self.lossy) and self.tolerances.damping_law > 0

    @property
    def by_parts(self) -> tuple[bool, ...]:
        """(m,) whether the damping of a mode is that of its parts alone, and none of it was given for the mode."""
        own = np.diag(self.nominal.viscous)[self.nominal.base :]
        return tuple(bool(self.lossy) and not own[r] for r in range(len(self.frequency)))

    @property
    def neighbours(self) -> tuple[tuple[int, int], ...]:
        """Pairs of modes, from 0, whose damping may be coupled."""
        f = self.frequency
        pairs = ((r, s) for r in range(len(f)) for s in range(r + 1, len(f)))
        return tuple((r, s) for r, s in pairs if abs(f[s] - f[r]) <= NEIGHBOURS * max(f[r], f[s]))

    def at(self, offsets: Offsets, *, derivatives: bool = True) -> tuple[Matrices, dict[str, Tangent]]:
        """The matrices at `offsets`, before effects and the damping law, and their derivative by every parameter but that law."""
        now = _now(self, offsets)
        if not derivatives:
            return now.matrices, {}
        own = (one.name for one in self.parameters if one.name != NAME)
        return now.matrices, {name: _tangent(self, now, name) for name in own}


def of(
    configuration: str,
    matrices: Matrices,
    frequency: Array,
    losses: Mapping[str, float],
    tolerances: StructureTolerances | None = None,
    *,
    highest: float = HIGHEST,
) -> Nuisances:
    """The nuisances of `matrices`.

    Parameters
    ----------
    frequency : (n,) [Hz] of the kept modes, the first of the article's own coordinates
    losses : loss factor by part of the structure, sheets of one material alike; none where damping is given by mode
    highest : [Hz] modes above are taken as computed
    """
    return Nuisances(
        configuration=configuration,
        nominal=matrices,
        losses={sheet(part): eta for part, eta in losses.items()},
        frequency=np.asarray(frequency[np.asarray(frequency) <= highest], dtype=np.float64),
        tolerances=tolerances or StructureTolerances(),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Now:
    """Matrices at some offsets, and what they are made of: E and D (k,), C before the coupling, the loss factors of the parts."""

    matrices: Matrices
    E: Array
    D: Array
    uncoupled: Array
    losses: Mapping[str, float]


def _now(of: Nuisances, offsets: Offsets) -> _Now:
    m, name, b = of.nominal, of.configuration, of.nominal.base
    E, D = np.ones(len(m.mass)), np.ones(len(m.mass))
    for r in range(len(of.frequency)):
        E[b + r] = np.exp(offsets.get(f"frequency:{name}:{r + 1}", 0.0))
        D[b + r] = np.exp(offsets.get(f"damping:{name}:{r + 1}", 0.0) / 2)
    K, S, parts = m.stiffness, m.structural, dict(m.parts)
    for part, share in m.parts.items():
        stiffer, lossier = offsets.get(f"modulus:{part}", 0.0), offsets.get(f"loss:{part}", 0.0)
        if stiffer:
            K, parts[part] = K + np.expm1(stiffer) * share, np.exp(stiffer) * share
        if stiffer or lossier:
            S = S + (np.exp(stiffer) * (1 + lossier) - 1) * of.losses.get(part, 0.0) * share
    stiffness = E[:, None] * K * E
    GD = D * _grown(m.stiffness, stiffness)
    C = GD[:, None] * m.viscous * GD
    made = replace(
        m,
        mass=_participating(of, offsets),
        stiffness=stiffness,
        structural=(D * E)[:, None] * S * (D * E),
        viscous=C + _coupled(of, offsets),
        parts=parts,
    )
    losses = {part: eta * (1 + offsets.get(f"loss:{part}", 0.0)) for part, eta in of.losses.items()}
    return _Now(matrices=made, E=E, D=D, uncoupled=C, losses=losses)


def _grown(before: Array, after: Array) -> Array:
    """G (k,): square root of how much the frequency of every coordinate has grown; 1 where it has none."""
    old, new = np.diag(before), np.diag(after)
    return np.asarray(np.divide(new, old, out=np.ones_like(old), where=old > 0) ** 0.25)


def _participating(of: Nuisances, offsets: Offsets) -> Array:
    mass = np.array(of.nominal.mass)
    for r, axis in np.ndindex(len(of.frequency), of.nominal.base):
        change = offsets.get(f"participation:{of.configuration}:{r + 1}:{MOTIONS[axis]}", 0.0) * _largest(of, r, axis)
        mass[axis, of.nominal.base + r] += change
        mass[of.nominal.base + r, axis] += change
    return mass


def _coupled(of: Nuisances, offsets: Offsets) -> Array:
    viscous, b = np.zeros_like(of.nominal.mass), of.nominal.base
    for r, s in of.neighbours:
        change = offsets.get(f"coupling:{of.configuration}:{r + 1}:{s + 1}", 0.0) * _geometric(of, r, s)
        viscous[b + r, b + s] = viscous[b + s, b + r] = change
    return viscous


def _largest(of: Nuisances, r: int, axis: int) -> float:
    """Largest participation of mode `r` as a share of the body's own mass there, in the unit of `axis`."""
    size = np.sqrt(np.diag(of.nominal.mass)[:6])
    return float(size[axis] * np.max(np.abs(of.nominal.mass[:6, 6 + r]) / size))


def _geometric(of: Nuisances, r: int, s: int) -> float:
    """Geometric mean of the damping [rad/s] of two modes, structural damping counted as it acts at resonance."""
    at, omega = of.nominal.base + np.array([r, s]), 2 * np.pi * of.frequency[[r, s]]
    own = np.diag(of.nominal.viscous)[at] + np.diag(of.nominal.structural)[at] / omega
    return float(np.sqrt(max(np.prod(own), 0.0)))


_Maker = Callable[..., Tangent]


def _tangent(of: Nuisances, now: _Now, parameter: str) -> Tangent:
    family, *names = parameter.split(":")
    return _TANGENTS[family](of, now, *names)


def _of_modulus(of: Nuisances, now: _Now, part: str) -> Tangent:
    K, E, DE = now.matrices.parts[part], now.E, now.D * now.E  # d / d ln: the part as it is now
    stiffness, whole = E[:, None] * K * E, np.diag(now.matrices.stiffness)
    grows = np.divide(np.diag(stiffness), 4 * whole, out=np.zeros_like(whole), where=whole > 0)
    changes = {
        "stiffness": stiffness,
        "structural": now.losses.get(part, 0.0) * DE[:, None] * K * DE,
        "viscous": now.uncoupled * (grows[:, None] + grows),
    }
    return of_arrays(len(K), {part: K}, **changes)


def _of_loss(of: Nuisances, now: _Now, part: str) -> Tangent:
    DE = now.D * now.E
    return of_arrays(len(DE), structural=of.losses[part] * DE[:, None] * now.matrices.parts[part] * DE)


def _of_frequency(of: Nuisances, now: _Now, configuration: str, mode: str) -> Tangent:
    r, m = of.nominal.base + int(mode) - 1, now.matrices
    viscous = _crossed(now.uncoupled, r) / 2
    stiffness, structural = _crossed(m.stiffness, r), _crossed(m.structural, r)
    return of_arrays(len(m.mass), crossing=r, stiffness=stiffness, structural=structural, viscous=viscous)


def _of_damping(of: Nuisances, now: _Now, configuration: str, mode: str) -> Tangent:
    r, m = of.nominal.base + int(mode) - 1, now.matrices
    viscous, structural = _crossed(now.uncoupled, r) / 2, _crossed(m.structural, r) / 2
    return of_arrays(len(m.mass), crossing=r, viscous=viscous, structural=structural)


def _of_participation(of: Nuisances, now: _Now, configuration: str, mode: str, axis: str) -> Tangent:
    r, a = int(mode) - 1, MOTIONS.index(axis)
    return _pair("mass", a, of.nominal.base + r, _largest(of, r, a))


def _of_coupling(of: Nuisances, now: _Now, configuration: str, one: str, other: str) -> Tangent:
    r, s, b = int(one) - 1, int(other) - 1, of.nominal.base
    return _pair("viscous", b + r, b + s, _geometric(of, r, s))


_TANGENTS: Mapping[str, _Maker] = {
    "modulus": _of_modulus,
    "loss": _of_loss,
    "frequency": _of_frequency,
    "damping": _of_damping,
    "participation": _of_participation,
    "coupling": _of_coupling,
}


def _crossed(matrix: Array, r: int) -> Array:
    """d (E matrix E) / d ln e_r: row and column `r`, twice where they meet."""
    changed = np.zeros_like(matrix)
    changed[r] += matrix[r]
    changed[:, r] += matrix[:, r]
    return changed


def _pair(field: str, i: int, j: int, value: float) -> Tangent:
    changes: dict[str, Array] = {name: np.zeros((2, 2)) for name in FIELDS}
    changes[field] = np.array([[0.0, value], [value, 0.0]])
    at = np.array([i, j], dtype=np.intp)
    mass, stiffness, viscous, structural = (changes[name] for name in FIELDS)
    return Tangent(at=at, mass=mass, stiffness=stiffness, viscous=viscous, structural=structural)


def _declared(name: str, tolerance: float) -> Parameter:
    return Parameter(name=name, unit="1", tolerance=tolerance, kind=DECLARED, within=WITHIN * tolerance)
