"""Effects on what stands on the table: masses, joint, cables, resonators, where the article stands, what its parts are made of.

The article is a reduced body: six motions of its base about its own origin, then coordinates of its own. A place moves as
``phi^T x`` with phi (6 + n,) for each axis, so that a mass or a spring there is one product; a resonator is one more coordinate.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from fem.base_excitation.rig import Body, Flange, Friction, Rig, Strut
from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.frames import rigid_transformation, rigid_transformation_6, rotation_about
from geometry.inertia import PARAMETERS, Inertia
from validation.effects.identifiers import Named
from validation.effects.targets import AXES
from validation.virtual_test.drawn import Part

Change = Callable[[Rig], Rig]

BASE = 6

JOINT = {"lateral": (0, 1), "vertical": (2,), "rotation": (3, 4), "torsion": (5,)}
ALONG = {"": (0, 1, 2), "lateral": (0, 1), "vertical": (2,)}
"""Which of x, y, z, alpha, beta, gamma a direction means."""

LAYER = "-silicone"
"""Ending of the part of a blade that is its layer."""


def point_mass(named: Named) -> Change:
    """``M += m phi phi^T`` along x, y and z; the base is among the coordinates, and with it L and M_F."""

    def change(rig: Rig) -> Rig:
        rows = rig.article.places[named.target]
        return _with_mass(rig, named, named.value * rows.T @ rows)

    return change


def rigid_inertia(named: Named) -> Change:
    """``H += dp`` times the matrix of a parameter about the article's centre of gravity."""

    def change(rig: Rig) -> Rig:
        M = rig.article.reduced.mass
        delta = Inertia(parameters=named.value * _unit(named.target, PARAMETERS), reference_point=np.zeros(3)).mass_matrix
        G = rigid_transformation_6(Inertia.from_mass_matrix(M[:BASE, :BASE]).cog)
        added = np.zeros_like(M)
        added[:BASE, :BASE] = G.T @ delta @ G
        return _with_mass(rig, named, added)

    return change


def joint(named: Named) -> Change:
    """``H' = (1 - omega^2 H C)^-1 H``: a spring without damping between cover plate and article."""

    def change(rig: Rig) -> Rig:
        compliance = np.zeros(BASE) if rig.flange is None else np.array(rig.flange.compliance)
        compliance[list(JOINT[named.target])] += named.value
        return replace(rig, flange=Flange(compliance=compliance))

    return change


def cable(named: Named) -> Change:
    """A spring from a place to the ground, along all axes or along those that are named."""
    stiffness = np.zeros(3)
    stiffness[list(ALONG[named.targets[1] if len(named.targets) > 1 else ""])] = named.value
    return lambda rig: replace(rig, struts=(*rig.struts, Strut(place=named.target, to="ground", stiffness=stiffness)))


def friction(named: Named) -> Change:
    """A loose part on the flange, held along x or y by nothing but the slip force; below it the part is a mass of its own."""
    axis: Any = named.targets[1]
    loose = Friction(axis=axis, slip_force=named.value, mass=named.values["mass"])
    return lambda rig: replace(rig, frictions=(*rig.frictions, loose))


def gap(named: Named) -> Change:
    """A load cell that lifts off where its preload is used up."""
    number = int(named.target) - 1
    return lambda rig: replace(
        rig,
        cells=tuple(replace(cell, preload=named.value) if k == number else cell for k, cell in enumerate(rig.cells)),
    )


def orientation(named: Named) -> Change:
    """``R H R^T``: the article stands turned about its own z axis."""

    def change(rig: Rig) -> Rig:
        R = rotation_about("z", named.value)
        body, T = rig.article, np.eye(len(rig.article.reduced.mass))
        T[:3, :3] = T[3:BASE, 3:BASE] = R
        of = body.reduced
        turned = replace(of, mass=T @ of.mass @ T.T, basis=of.basis @ T.T)  # its stiffness and damping know no base
        places = {name: R @ rows @ T.T for name, rows in body.places.items()}
        return replace(rig, article=replace(body, reduced=turned, places=places))

    return change


def offset(named: Named) -> Change:
    """``T H T^T``: the article stands beside its place."""
    return lambda rig: replace(rig, seat=rig.seat + named.value * _unit(named.target, AXES))


def appendage(named: Named) -> Change:
    """``H_kk += m (omega_a^2 + 2 i zeta omega_a omega) / (omega_a^2 - omega^2 + 2 i zeta omega_a omega)`` at F."""
    axis = AXES.index(named.target)

    def change(rig: Rig) -> Rig:
        row = np.zeros(len(rig.article.reduced.mass))
        row[:BASE] = rigid_transformation(-rig.seat)[axis]
        return replace(rig, article=_with_resonator(rig.article, row, named))

    return change


def absorber(named: Named) -> Change:
    """The same at a place of the article, along all three axes."""
    return _resonators(named, (0, 1, 2))


def slosh(named: Named) -> Change:
    """Two alike, along x and y, at a height; what of the liquid does not swing belongs to the article."""
    return _resonators(named, (0, 1))


def modulus(named: Named) -> Callable[[Mapping[str, Part]], Mapping[str, Part]]:
    """``K += v K_part``, on top of what was drawn: the part is (1 + v) times as stiff."""
    return lambda parts: {
        name: replace(part, modulus=(1 + part.modulus) * (1 + named.value) - 1) if _belongs(name, named.target) else part
        for name, part in parts.items()
    }


def damping(named: Named) -> Callable[[Mapping[str, Part]], Mapping[str, Part]]:
    """``D += i eta K_part``: a loss factor beside the drawn one."""
    return lambda parts: {
        name: replace(part, added_loss=part.added_loss + named.value) if _belongs(name, named.target) else part
        for name, part in parts.items()
    }


def layer_damping(named: Named) -> Callable[[Mapping[str, Part]], Mapping[str, Part]]:
    """The same of the layer in a blade alone."""
    return damping(replace(named, targets=(f"{named.target}{LAYER}",)))


def _belongs(name: str, part: str) -> bool:
    """Whether the structure's part `name` is `part` or one of its sheets; a blade's modulus is not that of its layer."""
    return name in (part, f"{part}-bottom", f"{part}-top")


def _resonators(named: Named, axes: tuple[int, ...]) -> Change:
    def change(rig: Rig) -> Rig:
        body = rig.article
        for axis in axes:
            body = _with_resonator(body, body.places[named.target][axis], named)
        return replace(rig, article=body)

    return change


def _with_resonator(body: Body, row: Array, named: Named) -> Body:
    """`body` with a mass on a spring that rides along ``row @ x``; its own coordinate is its motion relative to that."""
    m, f, zeta = (named.values[key] for key in ("m", "f", "zeta"))
    omega, of = 2 * np.pi * f, body.reduced
    rides = np.append(row, 1.0)
    mass, viscous, stiffness, structural = (np.pad(a, (0, 1)) for a in (of.mass, of.viscous, of.stiffness, of.structural))
    mass += m * np.outer(rides, rides)
    viscous[-1, -1] = 2 * zeta * omega * m
    stiffness[-1, -1] = omega**2 * m
    reduced = replace(
        of, mass=mass, viscous=viscous, stiffness=stiffness, structural=structural, basis=np.pad(of.basis, ((0, 0), (0, 1)))
    )
    places = {name: np.pad(rows, ((0, 0), (0, 1))) for name, rows in body.places.items()}
    return Body(name=body.name, reduced=reduced, kept=np.append(body.kept, f), places=places)


def _with_mass(rig: Rig, named: Named, added: Array) -> Rig:
    """`rig` with more mass, which may be less: what is left must still be a body."""
    mass = rig.article.reduced.mass + added
    size = np.sqrt(np.abs(np.diag(rig.article.reduced.mass)))
    if not np.linalg.eigvalsh(mass / np.outer(size, size))[0] > 0:
        problem = f"{rig.article.name} would have a negative mass in some direction"
        raise BadInput(source="--effect", field=named.id, problem=problem, remedy="Take less away")
    return replace(rig, article=replace(rig.article, reduced=replace(rig.article.reduced, mass=mass)))


def _unit(word: str, words: tuple[str, ...]) -> Array:
    return np.array([float(one == word) for one in words])
