"""What changes a structure beside its drawing, with all derivatives: tolerances that are declared, and effects on any stage.

An effect that the model holds for known is no parameter. Effects act in their order; one whose place or part the stage has not
leaves it alone, so that one model serves a series of articles.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, log, sqrt
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.damping import ASSUMED_WITHIN, DEFAULT_RATIO
from fem.structure import Structure, position_of
from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.frames import Array
from validation.effects.catalogue import FAMILIES, Named, There, acts, there
from validation.effects.effect import BODY_STAGE, CHANNEL_STAGE, OPENED, STRUCTURE_STAGE, SizeSpec, position
from validation.effects.stages import ChannelResponse, Matrices, MountedDynamicMass, Shares
from validation.estimation.problem import DECLARED, EFFECT, STRUCTURAL, WITHIN, Offsets, Parameter, Wanted, is_wanted
from validation.model.model import Added, StructureTolerances
from validation.prediction.structure import HIGHEST, ReducedStructure, sheet
from validation.prediction.tangents import (
    DAMPING_LAW,
    LAWS,
    LOSS_COUPLING,
    NEIGHBOURS,
    Tangent,
    between,
    crossed,
    of_arrays,
    plus,
    scaled,
)

# What a model declares to know of a structure only within tolerances: moduli, frequencies, damping, participation, coupling.
#
#     K' = E K E,  S' = D E S E D,  C' = D G C G D + c,  M_br' = M_br + l,      E = diag(e^ln f),  D = diag(e^(ln zeta / 2)),
#
# on the nominal modal basis, K and S with the moduli, the thicknesses and the loss factors of the parts in them, M with their
# densities and thicknesses: a part of modulus e, density 1 + d and thickness t, as shares of what is drawn, has
#
#     K_p' = e (K_p + (t - 1) K_p1 + (t³ - 1) K_p3),        M_p' = (1 + d) t M_p .
#
# A support has a factor on its stiffness instead of a modulus. G lets viscous damping grow with
# the frequency of its mode, G_rr = (K'_rr / K_rr)^(1/4), so that a stated ratio stays what it is. Nothing is re-diagonalised: the
# matrices are smooth in every parameter, stay symmetric, K and C positive, and a cluster of frequencies needs no tracking.
#
# What is not known of the stiffness that one mode feels couples it with others as well: of a small symmetric error without a
# preferred direction the entries beside the diagonal have 1 / sqrt(2) of the deviation of those on it (M. L. Mehta, Random
# Matrices, 2004, section 2.3), and two modes turn into each other by it, the more the closer they lie. On a base participations
# do that, too; a structure by itself has, of modes r and s, K_rs' = K_rs + v sqrt(K_rr K_ss), v known to sqrt(2) times the
# tolerance of a frequency.
#
# Where parts have loss factors, these are what is not known of damping: one number moves all modes in which the part bends, in
# all configurations, and what it cannot do is left to the modes within the small tolerance `mode_damping`. A third of freedom
# on each mode would swallow any loss of a part. The offset of a loss factor is a relative change of it and no logarithm:
# effects add to the same matrix, and only in a straight valley between the two does a fit find the lowest point. Where damping
# is given by mode there is nothing else to move, and the modes have it all.

ASSUMED = (
    f"nobody states what the structure loses: {100 * DEFAULT_RATIO:g} % of critical in every mode is assumed, within a factor of "
    f"{ASSUMED_WITHIN:g}; `loss_factor` of the model or of its parts states it"
)
"""What is said of it."""

DENSITY, THICKNESS, SUPPORT = (FAMILIES[name].tolerance for name in ("mass", "thickness", "support-stiffness"))
"""Standard deviations of what nobody states: of a part's density and thickness, and of the logarithm of a support's stiffness."""

APART_BY_MESH = 0.25
"""[share of what a mesh is too stiff by] that is not common to all modes: 0.2 over 25 modes of three structures against CalculiX,
see `fem.mesh.places.ENERGY_TOO_HIGH`. Held by test_structure_tests.py."""

APART_BY_SHELLS = 0.8
"""[share of what a mesh of shells may be off by] likewise: one mode is too stiff and the next too soft in 72 of three structures
against shells of a quarter of the size, see `fem.mesh.places.OF_JUMPS`. Held by test_nuisances.py."""

LEFT = 0.9
"""[share of the stiffness of any motion] that a mesh may be too stiff by in a fit at most. Held by test_nuisances.py."""

TURNED = 1e-3
"""[share of one mode's shape in another's] that a mesh may leave unsure unsaid: where the other hardly moves, its resonance
raises it fiftyfold. Held by test_structure_tests.py."""

SOFTEST = 1e-9
"""[share of the stiffest coordinate's stiffness] below which one moves without strain. By definition."""

FINE_MESH = 0.1
"""[tolerance of a frequency] below which what a mesh leaves unsure of every mode is no parameter: it adds half a per cent to the
tolerance. By definition."""


BODY = 1.0
"""Standard deviation of the mass of a body as a fault, a share: a box with its cables and contents may weigh twice what a drawing
says of it, where a density hardly differs. Exercised by test_any_structure.py."""

UNCHANGED = 0.1
"""Share of its tolerances that an article may have changed by between two tests: 0.25 % of a modulus is what 5 K do to steel.
Exercised by test_modal_table.py."""

TOGETHER = 1 / 3
"""Greatest distance of two frequencies, as a share of the higher one, at which two modes may lose together where no base drives.
Held by test_diagnosed.py."""


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
    part_tolerances : by part, of "modulus", "density", "loss_factor", "thickness", where they are stated for it
    scaled : whether the matrices are in SI; else nothing can be said of a mass or a spring at a place, only of shares
    reduced : of which they are, of a structure by itself
    weighed : share by which all that bends may be heavier than drawn, its modes with it
    assumed : whether nobody stated what it loses
    unchanged : whether it is asked how it has changed since a test before, so that but for its losses it is the same article
    last : by name what was made of them last and for what, one value since threads share it: see `lately`
    """

    configuration: str
    nominal: Matrices
    losses: Mapping[str, float]
    frequency: Array
    tolerances: StructureTolerances
    part_tolerances: Mapping[str, Mapping[str, float]] = field(default_factory=lambda: MappingProxyType({}))
    scaled: bool = True
    reduced: ReducedStructure | None = None
    weighed: float = 0.0
    assumed: bool = False
    unchanged: bool = False
    last: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    def over(self, made: ReducedStructure) -> "Nuisances":
        """The same where its structure is reduced to other coordinates, itself where to these."""
        if made is self.reduced:
            return self
        return replace(self, nominal=made.matrices, frequency=made.frequency[: len(self.frequency)], reduced=made)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """All of them; a tolerance of 0 closes a family."""
        of, m, modes = self.tolerances, self.nominal, range(1, len(self.frequency) + 1)
        parts = self.nominal.parts if len(self.frequency) else ()
        made = [_factor(self.stiffness_of(part), self.known(part, "modulus", of.modulus)) for part in parts]
        made += [_factor(f"thickness:{part}", self.known(part, "thickness", THICKNESS)) for part in parts if part in m.sections]
        made += [_declared(f"mesh:{part}", of.mesh) for part in self.coarse]
        weighing = {part: 0.0 for part in parts if part in m.part_mass} | dict.fromkeys(m.bodies, BODY)
        for part, most in weighing.items():  # nothing loses more than it weighs, by a tolerance no more than by a fault
            one = _declared(f"mass:{part}", self.known(part, "density", DENSITY))
            made.append(replace(one, low=FAMILIES["mass"].sizes[0].low, plausible=most))
        made += [replace(_declared(f"loss:{part}", self.known(part, "loss_factor", of.damping)), low=-1.0) for part in self.lossy]
        shares = {DAMPING_LAW: of.damping_law, LOSS_COUPLING: of.loss_coupling}
        made += [replace(_declared(law, shares[law]), low=0.0, high=1.0) for law in self.laws]
        known = self.frequency_tolerance
        made += [_declared(f"frequency:{self.configuration}:{r}", known[r - 1]) for r in modes]
        left = [of.mode_damping if own else of.damping for own in self.by_parts]
        made += [_factor(f"damping:{self.configuration}:{r}", left[r - 1]) for r in modes]
        if self.nominal.base:
            names = (f"participation:{self.configuration}:{r}:{axis}" for r in modes for axis in MOTIONS)
            made += [Parameter(name=name, unit="1", tolerance=of.participation, kind=STRUCTURAL) for name in names]
            name = f"density:{self.configuration}"
            made.append(Parameter(name=name, unit="1", tolerance=self.weighed if len(modes) else 0.0, kind=STRUCTURAL))
        between = {f"coupling:{self.configuration}:{r + 1}:{s + 1}": of.mode_coupling for r, s in self.pairs}
        for r, s in self.mixed:
            between[f"mixing:{self.configuration}:{r + 1}:{s + 1}"] = sqrt(2 * known[r] * known[s])
        made += [Parameter(name=name, unit="1", tolerance=one, kind=STRUCTURAL) for name, one in between.items()]
        if self.unchanged:
            losing = ("loss", "damping", "coupling", *LAWS)
            made = [one if one.family in losing else replace(one, tolerance=UNCHANGED * one.tolerance) for one in made]
        return tuple(one for one in made if one.tolerance > 0)

    def known(self, part: str, what: str, usual: float) -> float:
        """Tolerance of a part; where none is stated for it the `usual` one, of a support that of supports."""
        usual = SUPPORT if what == "modulus" and part in self.nominal.supports else usual
        return self.part_tolerances.get(part, {}).get(what, usual)

    def stiffness_of(self, part: str) -> str:
        """How the parameter for the stiffness of a part is called: a support has no modulus."""
        return f"support-stiffness:{part}" if part in self.nominal.supports else f"modulus:{part}"

    @cached_property
    def too_stiff(self) -> dict[str, Array]:
        """By part (m,) the tolerance of every frequency by the mesh of that part."""
        at, squares = self.nominal.base + np.arange(len(self.frequency)), (2 * np.pi * self.frequency) ** 2
        return {part: self.tolerances.mesh * np.diag(share)[at] / squares / 2 for part, share in self.nominal.unresolved.items()}

    @cached_property
    def farthest(self) -> float:
        """[energy of the jumps of strains] to which a mesh is too stiff at most, by which the stiffness stays positive."""
        own = slice(self.nominal.base, None)
        squares, axes = np.linalg.eigh(self.nominal.stiffness[own, own])
        kept = squares > SOFTEST * squares.max()
        scaled = axes[:, kept] / np.sqrt(squares[kept])
        jumps = sum(self.nominal.unresolved.values(), np.zeros_like(self.nominal.stiffness))[own, own]
        return float(LEFT / max(np.linalg.eigvalsh(scaled.T @ jumps @ scaled)[-1], SOFTEST))

    @property
    def coarse(self) -> tuple[str, ...]:
        """Parts whose mesh leaves a mode unsure by more than a share of what is not known of its frequency anyway."""
        least = FINE_MESH * self.tolerances.frequency
        return tuple(part for part, share in self.too_stiff.items() if np.any(share > least))

    @property
    def apart_by_mesh(self) -> Array:
        """(m,) share of a frequency that the mesh is too stiff by other than to the other modes."""
        share = {True: APART_BY_SHELLS, False: APART_BY_MESH}
        of_parts = (share[part in self.nominal.shells] * one for part, one in self.too_stiff.items())
        return np.asarray(sum(of_parts, np.zeros(len(self.frequency))))

    @property
    def frequency_tolerance(self) -> list[float]:
        """(m,) of every mode by itself; 0 where a frequency is stated to be exact."""
        stated = self.tolerances.frequency
        return np.hypot(stated, self.apart_by_mesh if stated else 0.0 * self.frequency).tolist()  # type: ignore[no-any-return]

    @cached_property
    def lossy(self) -> tuple[str, ...]:
        """Parts that have a loss factor."""
        parts = self.nominal.parts if len(self.frequency) else ()
        return tuple(part for part in parts if self.losses.get(part, 0.0) > 0)

    @property
    def laws(self) -> tuple[str, ...]:
        """Of `LAWS` what is open of its losses, see `with_damping_law` and `with_losses_by_mode`: one loss factor of all couples
        nothing, but beside an effect on one part; that is counted where a base drives."""
        known = (self.tolerances.damping_law, self.tolerances.loss_coupling)
        factors = len(self.lossy if self.nominal.base else {self.losses[part] for part in self.lossy})
        least = {DAMPING_LAW: 1, LOSS_COUPLING: 0 if not all(self.by_parts) else 2}
        return tuple(law for law, tolerance in zip(LAWS, known, strict=True) if factors >= least[law] and tolerance > 0)

    @cached_property
    def by_parts(self) -> tuple[bool, ...]:
        """(m,) whether the damping of a mode is that of its parts alone, and none of it was given for the mode."""
        own = np.diag(self.nominal.viscous)[self.nominal.base :]
        return tuple(bool(self.lossy) and not own[r] for r in range(len(self.frequency)))

    @cached_property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Pairs of modes, from 0, that may lose together: neighbours, and what a mesh turns, which takes its losses with it;
        where no base drives, of which the law of losses says it, also those that effects may turn into each other.
        """
        return self._near(NEIGHBOURS if self.nominal.base else TOGETHER)

    @cached_property
    def mixed(self) -> tuple[tuple[int, int], ...]:
        """Those that may turn into each other; of what stands on a base and has no coarse mesh, participations say that."""
        return self._near(NEIGHBOURS) if self.coarse or not self.nominal.base else ()

    def _near(self, within: float) -> tuple[tuple[int, int], ...]:
        f = self.frequency
        unsure = self.apart_by_mesh if self.tolerances.frequency else 0 * f
        close = np.abs(f - f[:, None]) <= within * np.maximum(f, f[:, None])
        turned = np.sqrt(2 * unsure * unsure[:, None]) * f * f[:, None] > TURNED * np.abs(f**2 - f[:, None] ** 2)
        r, s = np.nonzero(np.triu(close | turned, 1))
        return tuple(zip(r.tolist(), s.tolist(), strict=True))

    def lately(self, what: str, key: object, make: Callable[[], Any]) -> Any:
        """`what` was made last, for the same `key`; else made anew."""
        if (known := self.last.get(what, ((), None)))[0] != key:
            known = self.last[what] = key, make()
        return known[1]

    def at(self, offsets: Offsets, *, derivatives: Wanted = True) -> tuple[Matrices, dict[str, Tangent]]:
        """The matrices at `offsets`, before effects and laws of damping, and their `derivatives` by parameters but those laws."""
        now: _Now = self.lately("now", frozenset((name, x) for name, x in offsets.items() if x), lambda: self._now(offsets))
        wanted = (one.name for one in self.parameters if is_wanted(one.name, derivatives) and one.name not in LAWS)
        return now.matrices, {name: now.tangent(name) for name in wanted}

    def _now(self, offsets: Offsets) -> "_Now":
        m, name, b = self.nominal, self.configuration, self.nominal.base
        E, D = np.ones(len(m.mass)), np.ones(len(m.mass))
        for r in range(len(self.frequency)):
            E[b + r] = np.exp(offsets.get(f"frequency:{name}:{r + 1}", 0.0))
            D[b + r] = np.exp(offsets.get(f"damping:{name}:{r + 1}", 0.0) / 2)
        K, S, mass, parts = np.array(m.stiffness), np.array(m.structural), np.array(m.mass), dict(m.parts)
        mass *= 1 + offsets.get(f"density:{name}", 0.0)
        for part, share in m.parts.items():
            stiffer, lossier = offsets.get(self.stiffness_of(part), 0.0), offsets.get(f"loss:{part}", 0.0)
            thicker, denser = offsets.get(f"thickness:{part}", 0.0), offsets.get(f"mass:{part}", 0.0)
            eta, drawn = self.losses.get(part, 0.0), share
            if thicker:
                one, cubed = m.sections[part]
                share = share + np.expm1(thicker) * one + np.expm1(3 * thicker) * cubed
            if unsure := offsets.get(f"mesh:{part}", 0.0):
                share = share - self.farthest * np.tanh(unsure / self.farthest) * m.unresolved[part]
            if share is not drawn:
                K += share - drawn
                S += eta * (share - drawn)
                parts[part] = share
            if stiffer:
                K += np.expm1(stiffer) * share
                parts[part] = np.exp(stiffer) * share
            if eta and (stiffer or lossier):
                S += (np.exp(stiffer) * (1 + lossier) - 1) * eta * share
            if (thicker or denser) and part in m.part_mass:
                mass += (np.exp(thicker) * (1 + denser) - 1) * m.part_mass[part]
        for body in m.bodies:
            mass += offsets.get(f"mass:{body}", 0.0) * m.part_mass[body]
        stiffness = scaled(K, E)
        for r, s in self.mixed:
            mixed = offsets.get(f"mixing:{name}:{r + 1}:{s + 1}", 0.0) * self.between(r, s) * E[b + r] * E[b + s]
            stiffness[b + r, b + s] += mixed
            stiffness[b + s, b + r] += mixed
        # G: square root of how much the frequency of every coordinate has grown; 1 where it has none
        old, new = np.diag(m.stiffness), np.diag(stiffness)
        # Rigid motions of what floats have but rounding there, of either sign
        GD = D * np.divide(new, old, out=np.ones_like(old), where=(old > 0) & (new > 0)) ** 0.25
        C = scaled(m.viscous, GD)
        for r, a in np.ndindex(len(self.frequency), b):
            if more := offsets.get(f"participation:{name}:{r + 1}:{MOTIONS[a]}", 0.0) * self.largest(r, a):
                mass[a, b + r] += more
                mass[b + r, a] += more
        S = scaled(S, D * E)
        structural, viscous = self.coupling(offsets)
        losses = {part: eta * (1 + offsets.get(f"loss:{part}", 0.0)) for part, eta in self.losses.items()}
        S_all, C_all = S + structural, C + viscous
        made = replace(m, mass=mass, stiffness=stiffness, structural=S_all, viscous=C_all, parts=parts, lossier=D, losses=losses)
        return _Now(of=self, matrices=made, E=E, D=D, uncoupled=C, lost=S, offsets=offsets)

    def coupling(self, offsets: Offsets) -> tuple[Array, Array]:
        """(k, k) structural and viscous damping by which pairs of modes lose together at `offsets`, beside what parts say."""
        made, b = {field: np.zeros_like(self.nominal.mass) for field in ("structural", "viscous")}, self.nominal.base
        for r, s in self.pairs:
            if change := offsets.get(f"coupling:{self.configuration}:{r + 1}:{s + 1}", 0.0):
                field, size = self.coupled(r, s)
                made[field][[b + r, b + s], [b + s, b + r]] = change * size
        return made["structural"], made["viscous"]

    def coupled(self, r: int, s: int) -> tuple[str, float]:
        """Matrix and entry by which two modes lose together as much as the geometric mean of what each loses: by the law of their
        parts where both lose by it. Two modes that have turned into each other are as lossy as before, by the same law."""
        if self.by_parts[r] and self.by_parts[s]:
            return "structural", float(self.geometric[r, s] * 2 * np.pi * np.sqrt(self.frequency[r] * self.frequency[s]))
        return "viscous", float(self.geometric[r, s])

    def largest(self, r: int, axis: int) -> float:
        """Largest participation of mode `r` as a share of the body's own mass there, in the unit of `axis`."""
        return float(self._largest[r, axis])

    @cached_property
    def _largest(self) -> Array:
        size, of = np.sqrt(np.diag(self.nominal.mass)[:6]), self.nominal.mass[:6, 6 : 6 + len(self.frequency)]
        return np.asarray(np.max(np.abs(of) / size[:, None], axis=0)[:, None] * size)

    def between(self, r: int, s: int) -> float:
        """Geometric mean of the stiffness of two modes as they are computed."""
        at = self.nominal.base + np.array([r, s])
        return float(np.sqrt(max(np.prod(np.diag(self.nominal.stiffness)[at]), 0.0)))

    @cached_property
    def geometric(self) -> Array:
        """(m, m) geometric means of the damping [rad/s] of two modes, structural damping counted as it acts at resonance."""
        at, omega = self.nominal.base + np.arange(len(self.frequency)), 2 * np.pi * self.frequency
        structural = np.diag(self.nominal.structural)[at]
        own = np.diag(self.nominal.viscous)[at] + np.divide(structural, omega, out=np.zeros_like(omega), where=omega > 0)
        return np.asarray(np.sqrt(np.maximum(own[:, None] * own, 0.0)))


def nuisances(
    configuration: str,
    matrices: Matrices,
    frequency: Array,
    losses: Mapping[str, float],
    tolerances: StructureTolerances | None = None,
    *,
    highest: float = HIGHEST,
    part_tolerances: Mapping[str, Mapping[str, float]] = MappingProxyType({}),
    scaled: bool = True,
    reduced: ReducedStructure | None = None,
    weighed: float = 0.0,
    assumed: bool = False,
    unchanged: bool = False,
) -> Nuisances:
    """The nuisances of `matrices`.

    Parameters
    ----------
    frequency : (n,) [Hz] of the kept modes, the first of the article's own coordinates
    losses : loss factor by part of the structure, sheets of one material alike; none where damping is given by mode
    highest : [Hz] modes above are taken as computed
    part_tolerances : as in `fem.structure.Structure`
    scaled, reduced, weighed, assumed, unchanged : as `Nuisances` has them
    """
    known = tolerances or StructureTolerances()
    if assumed and known.damping:
        known = replace(known, damping=max(known.damping, log(ASSUMED_WITHIN)))
    return Nuisances(
        configuration=configuration,
        nominal=matrices,
        losses={part if part in matrices.parts else sheet(part): eta for part, eta in losses.items()},
        frequency=np.asarray(frequency[np.asarray(frequency) <= highest], dtype=np.float64),
        tolerances=known,
        part_tolerances=part_tolerances,
        scaled=scaled,
        reduced=reduced,
        weighed=weighed,
        assumed=assumed,
        unchanged=unchanged,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Now:
    """Matrices `of` some nuisances at `offsets`: E and D (k,), C and S before the coupling."""

    of: Nuisances
    matrices: Matrices
    E: Array
    D: Array
    uncoupled: Array
    lost: Array
    offsets: Offsets

    def tangent(self, parameter: str) -> Tangent:
        """The derivative by one of the parameters."""
        family, *names = parameter.split(":")
        by_family: Callable[..., Tangent] = getattr(self, f"_of_{family.replace('-', '_')}")
        return by_family(*names)

    def _of_modulus(self, part: str) -> Tangent:
        return self._stiffer(part, self.matrices.parts[part])  # d / d ln: the part as it is now

    _of_support_stiffness = _of_modulus

    def _of_density(self, _: str) -> Tangent:
        return of_arrays(len(self.of.nominal.mass), mass=self.of.nominal.mass)

    def _of_thickness(self, part: str) -> Tangent:
        tau, m = np.exp(self.offsets.get(f"thickness:{part}", 0.0)), self.of.nominal
        one, cubed = m.sections[part]
        stiffer = np.exp(self.offsets.get(self.of.stiffness_of(part), 0.0)) * (tau * one + 3 * tau**3 * cubed)
        if part not in m.part_mass:
            return self._stiffer(part, stiffer)
        heavier = tau * (1 + self.offsets.get(f"mass:{part}", 0.0)) * m.part_mass[part]
        return self._stiffer(part, stiffer, heavier)

    def _of_mesh(self, part: str) -> Tangent:
        slope = 1 - np.tanh(self.offsets.get(f"mesh:{part}", 0.0) / self.of.farthest) ** 2
        stiffer = np.exp(self.offsets.get(self.of.stiffness_of(part), 0.0))
        return self._stiffer(part, -slope * stiffer * self.of.nominal.unresolved[part])

    def _of_mass(self, part: str) -> Tangent:
        share = np.exp(self.offsets.get(f"thickness:{part}", 0.0)) * self.of.nominal.part_mass[part]
        return of_arrays(len(share), mass=share)

    def _stiffer(self, part: str, K: Array, mass: Array | None = None) -> Tangent:
        """The tangent of a share of `part` in the stiffness that grows by `K` (k, k), and of one in the mass by `mass`."""
        stiffness, whole, drawn = scaled(K, self.E), np.diag(self.matrices.stiffness), np.diag(self.of.nominal.stiffness)
        grows = np.divide(np.diag(stiffness), 4 * whole, out=np.zeros_like(whole), where=(whole > 0) & (drawn > 0))
        changes = {"stiffness": stiffness}
        if (eta := self.matrices.losses.get(part, 0.0)) > 0:
            changes["structural"] = eta * scaled(K, self.D * self.E)
        if self.uncoupled.any():
            changes["viscous"] = self.uncoupled * (grows[:, None] + grows)
        if mass is not None:
            changes["mass"] = mass
        return of_arrays(len(K), {part: K}, **changes)

    def _of_loss(self, part: str) -> Tangent:
        DE, eta = self.D * self.E, self.of.losses[part]
        lost = of_arrays(len(DE), structural=eta * scaled(self.matrices.parts[part], DE))
        return replace(lost, losses={part: eta})

    def _of_frequency(self, configuration: str, mode: str) -> Tangent:
        r, m = self.of.nominal.base + int(mode) - 1, self.matrices
        return crossed(r, stiffness=m.stiffness[r], structural=self.lost[r], viscous=self.uncoupled[r] / 2)

    def _of_damping(self, configuration: str, mode: str) -> Tangent:
        r = self.of.nominal.base + int(mode) - 1
        changed = crossed(r, structural=self.lost[r] / 2, viscous=self.uncoupled[r] / 2)
        return replace(changed, lossier=r)

    def _of_participation(self, configuration: str, mode: str, axis: str) -> Tangent:
        r, a = int(mode) - 1, MOTIONS.index(axis)
        return self._pair("mass", a, self.of.nominal.base + r, self.of.largest(r, a))

    def _of_coupling(self, configuration: str, one: str, other: str) -> Tangent:
        r, s, b = int(one) - 1, int(other) - 1, self.of.nominal.base
        field, size = self.of.coupled(r, s)
        return self._pair(field, b + r, b + s, size)

    def _of_mixing(self, configuration: str, one: str, other: str) -> Tangent:
        r, s, b = int(one) - 1, int(other) - 1, self.of.nominal.base
        return self._pair("stiffness", b + r, b + s, self.of.between(r, s) * self.E[b + r] * self.E[b + s])

    def _pair(self, field: str, i: int, j: int, value: float) -> Tangent:
        return crossed(i, **{field: value * (np.arange(len(self.E)) == j)})


def _factor(name: str, tolerance: float) -> Parameter:
    """A relative change of a positive figure, known by its logarithm; of a support the factor itself."""
    above = 0.0 if name.startswith("support-stiffness:") else -1.0
    return replace(_declared(name, tolerance), nominal=1.0, logarithmic=True, above=above)


def _declared(name: str, tolerance: float) -> Parameter:
    return Parameter(name=name, unit="1", tolerance=tolerance, kind=DECLARED, within=WITHIN * tolerance)


# Effects applied to a stage of a prediction, with all its derivatives carried through and their own added.
#
# Derivatives by the size of an effect are differences of its equation. Those of reduced matrices are central and exact for the
# polynomials of second degree that masses, springs and resonators are; those of a dynamic mass and of channels take five
# points, at steps so small that a resonance of a per mille does not notice them. Derivatives that come from before pass an
# equation of the matrices as they are, because it adds, unless they change the share of a part that it reads; they pass one of
# a dynamic mass by a directional difference, and one of the channels, which is linear, by the equation itself.

COARSE = 1e-3
"""Step of matrices, as a share of the size: polynomials do not care, and rounding least."""

FINE = 1e-5
"""Step of transfers: small beside the width of a resonance, large beside rounding."""


UNSEEN = 0.2
"""[share of omega²] by which a plausible fault of a structure by itself moves the mode that it moves most: a tenth of a
frequency, or a tenth of the critical damping. More than that nobody overlooks, whatever the structure weighs."""

FIELDS_OF_FAULTS = ("stiffness", "mass", "structural")

NEXT_TO_NOTHING = 1e-7
"""[plausible size] at which an equation is as good as linear."""


def plausible(of: Nuisances, named: Named, size: SizeSpec) -> float:
    """Standard deviation of a fault before anything was measured, of a size that has a unit or is a loss: by the modes of the
    structure."""
    modes = of.nominal.base + np.arange(len(of.frequency))
    drawn = of.nominal.base and of.reduced is None  # an article of the catalogue, by whose sizes it goes
    if drawn or not len(modes) or size.logarithmic or FAMILIES[named.family].stage != STRUCTURE_STAGE:
        return size.plausible
    step = min(NEXT_TO_NOTHING * size.plausible, COARSE * _straight(_with(named, size, size.null), of.nominal, inf))
    before, after = (_changed(_with(named, size, size.null + one), of.nominal) for one in (0.0, step))
    squares = (2 * np.pi * of.frequency) ** 2
    K, M, S = ((np.diag(getattr(after, one)) - np.diag(getattr(before, one)))[modes] / step for one in FIELDS_OF_FAULTS)
    if size.unit == "1" and (K.any() or M.any()):
        return size.plausible
    moved = float(np.abs((S if size.unit == "1" else K) / squares - M).max(initial=0.0))
    return min(UNSEEN / moved, size.high if size.unit == "1" else inf) if moved > 0 else size.plausible


def parameters(effects: Sequence[Added], structure: Nuisances | None = None) -> tuple[Parameter, ...]:
    """One for every size that a fit may move, of the effects that have an equation.

    Offset 0 of an additive one is no effect, of a logarithmic one the size as it stands; a fit starts at the size as it stands.

    Parameters
    ----------
    structure : that is tested by itself, by which plausible sizes go; else they are those of the catalogue
    """
    return tuple(_parameter(added.named, size, structure) for added in effects for size in _free(added))


def name(named: Named, key: str) -> str:
    """How the parameter for the size `key` of an effect is called."""
    return f"{named.id}[{key}]" if key else named.id


def at(effects: Sequence[Added], offsets: Mapping[str, float]) -> tuple[Added, ...]:
    """`effects` with the sizes that `offsets` say; where they say nothing of a free size it stands at offset 0."""
    found = []
    for added in effects:
        sizes = {size.key: _parameter(added.named, size) for size in _free(added)}
        values = {key: one.value(offsets.get(one.name, 0.0)) for key, one in sizes.items()}
        found.append(replace(added, named=replace(added.named, values={**added.named.values, **values})))
    return tuple(found)


BY_ITSELF = (STRUCTURE_STAGE, CHANNEL_STAGE, OPENED)
"""Stages whose effects change what a test of a structure reads that no base drives."""


def reaching(effects: Sequence[Added], there: There) -> tuple[Added, ...]:
    """Those of `effects` that act on a structure by itself, of which `there` says what it has."""
    return tuple(one for one in effects if FAMILIES[one.named.family].stage in BY_ITSELF and acts(one.named, there))


def there_of(configuration: str, of: Nuisances, channels: tuple[str, ...]) -> There:
    """What effects can act on in a test of a structure by itself."""
    found = there(configuration, of.nominal, channels)
    return found if of.scaled else replace(found, places=(), rigid=False)


def opened(parameters: Sequence[Parameter], effects: Sequence[Added]) -> tuple[tuple[Parameter, ...], dict[str, float]]:
    """Parameters of which effects without an equation are faults, and the offsets of those that are no parameter any more.

    A parameter by the name of an effect leaves its tolerance; that of a fixed effect leaves the list.
    """
    by_name = {added.named.id: added for added in effects if FAMILIES[added.named.family].stage == OPENED}
    left, known = [], {}
    for one in parameters:
        added = by_name.get(one.name)
        if added is None:
            left.append(one)
        elif added.fixed:
            known[one.name] = one.offset(added.named.value)
        else:
            (size,) = added.named.sizes
            start = one.offset(added.named.value)
            low, high = bounds(one, size)
            if FAMILIES[added.named.family].limits is not None:  # which the parameter has from the structure
                low, high = max(low, one.low), min(high, one.high)
            left.append(
                replace(one, tolerance=one.plausible or size.plausible, kind=EFFECT, start=start, within=inf, low=low, high=high)
            )
    return tuple(left), known


def structure(
    stage: Matrices, tangents: Mapping[str, Tangent], effects: Sequence[Added], *, derivatives: Wanted = True
) -> tuple[Matrices, dict[str, Tangent]]:
    """The effects on reduced matrices, and by parameter the derivatives that are wanted."""
    found = dict(tangents)
    for added in _of(effects, STRUCTURE_STAGE):
        if not acts(added.named, there("article", stage)):
            continue
        # What an equation reads of no part does not change with it; most add beside the parts, whose shares are made when read
        drawn = stage.parts
        parts = Shares(drawn, drawn.__getitem__)
        stage = replace(stage, parts=parts)
        after = _changed(added.named, stage)
        read, n = frozenset(parts.read), len(stage.mass)
        lossy = not np.array_equal(after.structural[:n, :n], stage.structural)
        for key, tangent in found.items() if read and not _is_nothing(added.named) else ():
            if (met := read & {*tangent.parts}) or (lossy and (tangent.lossier is not None or tangent.losses)):
                below, above = (_changed(added.named, _moved(stage, drawn, tangent, met, side)) for side in (-COARSE, COARSE))
                told = plus(tangent, between(below, above, 2 * COARSE), len(after.mass))
                found[key] = told if met else replace(told, parts=tangent.parts)
        for size in _free(added):
            if not is_wanted(name(added.named, size.key), derivatives):
                continue
            value, scale, slope = _scale(added.named, size)
            step = COARSE * _straight(added.named, stage, scale)
            below, above = (_changed(_with(added.named, size, value + side * step), stage) for side in (-1, 1))
            found[name(added.named, size.key)] = between(below, above, 2 * step / slope)
        stage = after
    return stage, found


def _moved(stage: Matrices, drawn: Mapping[str, Array], tangent: Tangent, met: frozenset[str], step: float) -> Matrices:
    """What an equation reads of `stage` where a parameter stands a `step` farther: the shares of `met` parts, and all losses."""
    lossier = stage.lossier * np.exp(step / 2 * (np.arange(len(stage.lossier)) == tangent.lossier))
    losses = {part: stage.losses[part] + step * rate for part, rate in tangent.losses.items()}
    moved = replace(stage, lossier=lossier, losses={**stage.losses, **losses})
    if not met:
        return moved
    n = len(stage.mass)
    parts = {part: drawn[part] + step * np.pad(tangent.parts[part], (0, n - len(tangent.parts[part]))) for part in met}
    return replace(moved, parts={**drawn, **parts})


def body(
    stage: MountedDynamicMass, tangents: Mapping[str, ComplexArray], effects: Sequence[Added], *, derivatives: bool = True
) -> tuple[MountedDynamicMass, dict[str, ComplexArray]]:
    """The effects on a dynamic mass, and by parameter its derivatives (n, 6, 6)."""
    found = dict(tangents)
    for added in _of(effects, BODY_STAGE):
        sizes = _free(added) if derivatives else ()
        own = {name(added.named, size.key): _slope(added.named, size, stage, "matrix") for size in sizes}
        if not _is_nothing(added.named):
            found = {key: _directional(added.named, stage, tangent) for key, tangent in found.items()}
        found |= own
        stage = _changed(added.named, stage)
    return stage, found


def channels(
    stage: ChannelResponse, tangents: Mapping[str, ComplexArray], effects: Sequence[Added], *, derivatives: bool = True
) -> tuple[ChannelResponse, dict[str, ComplexArray]]:
    """The effects on what the channels read, and by parameter its derivatives (n, c, k)."""
    found = dict(tangents)
    for added in _of(effects, CHANNEL_STAGE):
        sizes = _free(added) if derivatives else ()
        own = {name(added.named, size.key): _slope(added.named, size, stage, "rows") for size in sizes}
        if not _is_nothing(added.named):
            found = {key: _changed(added.named, replace(stage, rows=rows)).rows for key, rows in found.items()}
        found |= own
        stage = _changed(added.named, stage)
    return stage, found


def channels_pass(effects: Sequence[Added]) -> bool:
    """Whether derivatives pass all effects on what the channels read as they are: none of them changes anything yet."""
    return all(_is_nothing(added.named) for added in _of(effects, CHANNEL_STAGE))


def _is_nothing(named: Named) -> bool:
    """Whether it stands at the size at which its equation changes nothing, so that derivatives pass as they are."""
    sizes = named.fitted_sizes
    return bool(sizes) and all(named.values[size.key] == size.null and not size.logarithmic for size in sizes)


def _of(effects: Sequence[Added], stage: str) -> Iterator[Added]:
    return (added for added in effects if FAMILIES[added.named.family].stage == stage)


def _free(added: Added) -> tuple[SizeSpec, ...]:
    """Sizes that a fit may move; none of an opened effect, whose parameter is somebody else's."""
    if added.fixed or FAMILIES[added.named.family].change is None:
        return ()
    return added.named.fitted_sizes


def _parameter(named: Named, size: SizeSpec, structure: Nuisances | None = None) -> Parameter:
    value = named.values[size.key]
    made = Parameter(
        name=name(named, size.key),
        unit=size.unit,
        tolerance=size.plausible if structure is None else plausible(structure, named, size),
        kind=EFFECT,
        nominal=value if size.logarithmic else size.null,
        logarithmic=size.logarithmic,
        start=0.0 if size.logarithmic else value - size.null,
    )
    low, high = bounds(made, size)
    made = replace(made, low=low, high=high)
    if structure is None or structure.reduced is None or not named.targets:
        return made
    return limited(made, structure.reduced.structure, named.target)


def limited(
    one: Parameter, whole: Structure, at: npt.ArrayLike | str | None, direction: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> Parameter:
    """`one`, of an effect `at` a place of a structure, a name or (3,) [m], and along `direction`, within what its family allows
    there; where it stands is always allowed."""
    if one.family not in FAMILIES or (limits := FAMILIES[one.family].limits) is None:
        return one
    if isinstance(at, str):
        at = position(at) or (position_of(whole, at) if at in whole.places else None)
    low, high = limits(whole, None if at is None else np.asarray(at), np.asarray(direction))
    return replace(one, low=max(one.low, min(one.start, low)), high=min(one.high, max(one.start, high)))


def bounds(one: Parameter, size: SizeSpec) -> tuple[float, float]:
    """Least and greatest offset of `one` at which `size` is what its family allows; that of no effect is always allowed."""
    if one.logarithmic:
        return one.offset(size.low), one.offset(size.high)
    return one.offset(min(size.low, size.null)), one.offset(max(size.high, size.null))


def _changed(named: Named, stage: Any) -> Any:
    if (change := FAMILIES[named.family].change) is None:
        raise ValueError(f"`{named.id}` has no equation")
    return change(stage, named.targets, named.values)


def _with(named: Named, size: SizeSpec, value: float) -> Named:
    return replace(named, values={**named.values, size.key: value})


def _scale(named: Named, size: SizeSpec) -> tuple[float, float, float]:
    """A size as it stands, what to measure steps by, and d size / d offset."""
    value = named.values[size.key]
    return (value, abs(value), value) if size.logarithmic else (value, max(abs(value), size.plausible), 1.0)


def _straight(named: Named, stage: Any, scale: float) -> float:
    """`scale` of a size, or less where the equation is no straight line over a small part of that."""
    straight = FAMILIES[named.family].straight
    return scale if straight is None else min(scale, straight(stage, named.targets, named.values))


def _slope(named: Named, size: SizeSpec, stage: Any, field: str) -> ComplexArray:
    """d `field` / d offset of a stage behind the equation, at the size as it stands, exact to the fourth power of the step."""
    value, scale, slope = _scale(named, size)
    step = FINE * scale
    around = (_changed(_with(named, size, value + k * step), stage) for k in (-2, -1, 1, 2))
    two_below, below, above, two_above = (np.asarray(getattr(one, field)) for one in around)
    return np.asarray((8 * (above - below) - (two_above - two_below)) / (12 * step) * slope)


def _directional(named: Named, stage: MountedDynamicMass, tangent: ComplexArray) -> ComplexArray:
    """d matrix behind the equation along `tangent` before it."""
    size = np.abs(tangent).max(initial=0.0)
    if not size:
        return tangent
    step = FINE * np.abs(stage.matrix).max() / size
    below, above = (_changed(named, replace(stage, matrix=stage.matrix + side * step * tangent)).matrix for side in (-1, 1))
    return np.asarray((above - below) / (2 * step))
