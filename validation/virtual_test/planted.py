"""Effects on what stands on the table: masses, joint, cables, resonators, where the article stands, what its parts are made of.

The article is a reduced body: six motions of its base about its own origin, then coordinates of its own. A place moves as
``phi^T x`` with phi (6 + n,) for each axis, so that a mass or a spring there is one product; a resonator is one more coordinate.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fem.base_excitation.rig import Flange, FlexibleBody, Friction, Rig, Strut
from geometry.articles import changes_of, locations
from geometry.errors import BadInput
from geometry.frames import Array, rigid_transformation, rigid_transformation_6, rotation_about
from geometry.inertia import PARAMETERS, Inertia
from geometry.toml_file import nearest
from validation.effects import catalogue
from validation.effects.catalogue import FAMILIES, SOURCES, Named, There
from validation.effects.effect import AXES, COVER, FMD, PENDULUM, PROCESSING, TABLE
from validation.excite.question import ALONG
from validation.excite.question import COMPLIANT as JOINT
from validation.virtual_test.layout import ChainTruth
from validation.virtual_test.plan import MAINS, RIGID, SOURCE, Part, Plan, PlantedEffect, Sensed
from validation.virtual_test.shaker import parts_of

BASE = 6

LAYER = "-silicone"
"""Ending of the part of a blade that is its layer."""


def point_mass(named: Named, rig: Rig) -> Rig:
    """``M += m phi phi^T`` along x, y and z; the base is among the coordinates, and with it L and M_F."""
    rows = rig.article.places[named.target]
    return _with_mass(rig, named, named.value * rows.T @ rows)


def rigid_inertia(named: Named, rig: Rig) -> Rig:
    """``H += dp`` times the matrix of a parameter about the article's centre of gravity."""
    M = rig.article.reduced.mass
    delta = Inertia(parameters=named.value * _unit(named.target, PARAMETERS), reference_point=np.zeros(3)).mass_matrix
    G = rigid_transformation_6(Inertia.from_mass_matrix(M[:BASE, :BASE]).cog)
    added = np.zeros_like(M)
    added[:BASE, :BASE] = G.T @ delta @ G
    return _with_mass(rig, named, added)


def joint(named: Named, rig: Rig) -> Rig:
    """``H' = (1 - omega^2 H C)^-1 H``: a spring without damping between cover plate and article."""
    compliance = np.zeros(BASE) if rig.flange is None else np.array(rig.flange.compliance)
    compliance[list(JOINT[named.target])] += named.value
    return replace(rig, flange=Flange(compliance=compliance))


def cable(named: Named, rig: Rig) -> Rig:
    """A spring from a place to the ground, along all axes or along those that are named."""
    stiffness = np.zeros(3)
    stiffness[list(ALONG[named.targets[1] if len(named.targets) > 1 else ""])] = named.value
    return replace(rig, struts=(*rig.struts, Strut(place=named.target, to="ground", stiffness=stiffness)))


def friction(named: Named, rig: Rig) -> Rig:
    """A loose part on the flange, held along x or y by nothing but the slip force; below it the part is a mass of its own."""
    axis: Any = named.targets[1]
    loose = Friction(axis=axis, slip_force=named.value, mass=named.values["mass"])
    return replace(rig, frictions=(*rig.frictions, loose))


def gap(named: Named, rig: Rig) -> Rig:
    """A load cell that lifts off where its preload is used up."""
    number = int(named.target) - 1
    return replace(
        rig, cells=tuple(replace(cell, preload=named.value) if k == number else cell for k, cell in enumerate(rig.cells))
    )


def orientation(named: Named, rig: Rig) -> Rig:
    """``R H R^T``: the article stands turned about its own z axis."""
    R = rotation_about("z", named.value)
    body, T = rig.article, np.eye(len(rig.article.reduced.mass))
    T[:3, :3] = T[3:BASE, 3:BASE] = R
    of = body.reduced
    turned = replace(of, mass=T @ of.mass @ T.T, basis=of.basis @ T.T)  # its stiffness and damping know no base
    places = {name: R @ rows @ T.T for name, rows in body.places.items()}
    return replace(rig, article=replace(body, reduced=turned, places=places))


def offset(named: Named, rig: Rig) -> Rig:
    """``T H T^T``: the article stands beside its place."""
    return replace(rig, seat=rig.seat + named.value * _unit(named.target, AXES))


def appendage(named: Named, rig: Rig) -> Rig:
    """``H_kk += m (omega_a^2 + 2 i zeta omega_a omega) / (omega_a^2 - omega^2 + 2 i zeta omega_a omega)`` at F."""
    axis = AXES.index(named.target)
    row = np.zeros(len(rig.article.reduced.mass))
    row[:BASE] = rigid_transformation(-rig.seat)[axis]
    return replace(rig, article=_with_resonator(rig.article, row, named))


def absorber(named: Named, rig: Rig) -> Rig:
    """The same at a place of the article, along all three axes."""
    return _resonators(named, rig, (0, 1, 2))


def slosh(named: Named, rig: Rig) -> Rig:
    """Two alike, along x and y, at a height; what of the liquid does not swing belongs to the article."""
    return _resonators(named, rig, (0, 1))


def modulus(named: Named, parts: Mapping[str, Part]) -> Mapping[str, Part]:
    """``K += v K_part``, on top of what was drawn: the part is (1 + v) times as stiff."""
    return {
        name: replace(part, modulus=(1 + part.modulus) * (1 + named.value) - 1) if _belongs(name, named.target) else part
        for name, part in parts.items()
    }


def damping(named: Named, parts: Mapping[str, Part]) -> Mapping[str, Part]:
    """``D += i eta K_part``: a loss factor beside the drawn one."""
    return {
        name: replace(part, added_loss=part.added_loss + named.value) if _belongs(name, named.target) else part
        for name, part in parts.items()
    }


def layer_damping(named: Named, parts: Mapping[str, Part]) -> Mapping[str, Part]:
    """The same of the layer in a blade alone."""
    return damping(replace(named, targets=(f"{named.target}{LAYER}",)), parts)


def _belongs(name: str, part: str) -> bool:
    """Whether the structure's part `name` is `part` or one of its sheets; a blade's modulus is not that of its layer."""
    return name in (part, f"{part}-bottom", f"{part}-top")


def _resonators(named: Named, rig: Rig, axes: tuple[int, ...]) -> Rig:
    body = rig.article
    for axis in axes:
        body = _with_resonator(body, body.places[named.target][axis], named)
    return replace(rig, article=body)


def _with_resonator(body: FlexibleBody, row: Array, named: Named) -> FlexibleBody:
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
    return FlexibleBody(name=body.name, reduced=reduced, kept=np.append(body.kept, f), places=places)


def _with_mass(rig: Rig, named: Named, added: Array) -> Rig:
    """`rig` with more mass, which may be less: what is left must still be a body."""
    mass = rig.article.reduced.mass + added
    size = np.sqrt(np.abs(np.diag(rig.article.reduced.mass)))
    if not np.linalg.eigvalsh(mass / np.outer(size, size))[0] > 0:
        raise BadInput("--effect", named.id, f"{rig.article.name} would have a negative mass in some direction", "Take less away")
    return replace(rig, article=replace(rig.article, reduced=replace(rig.article.reduced, mass=mass)))


def _unit(word: str, words: tuple[str, ...]) -> Array:
    return np.array([float(one == word) for one in words])


# Effects that are another measurement chain than the drawn one: gains, delays, places, angles, load cells, gravity, noise.
#
# Each adds to what the seed has drawn, so that a fault of 5 % makes of a channel that reads 1.002 one that reads 1.002 x 1.05.


BOARDS = {"force": FMD, "cover": COVER, "table": TABLE}
"""Channels that are sampled together, by the name of their board."""

COMPLIANT = ("lateral", "vertical")


def gain(named: Named, chain: ChainTruth) -> ChainTruth:
    """``y (1 + g)``"""
    return chain.more_gain(named.target, named.value)


def polarity(named: Named, chain: ChainTruth) -> ChainTruth:
    """``-y``"""
    return chain.more_gain(named.target, -2.0)


def shunt(named: Named, chain: ChainTruth) -> ChainTruth:
    """Every channel along an axis reads ``y (1 - s)``: the share s passes all of its cells by."""
    along = tuple(name for name in FMD if name.startswith(f"fmd-{named.target}"))
    return _each(chain, along, lambda one, name: one.more_gain(name, -named.value))


def delay(named: Named, chain: ChainTruth) -> ChainTruth:
    """``y(t - tau)``"""
    return chain.later(named.target, named.value)


def board_delay(named: Named, chain: ChainTruth) -> ChainTruth:
    """The same for all channels of a board."""
    return _each(chain, BOARDS[named.target], lambda one, name: one.later(name, named.value))


def crosstalk(named: Named, chain: ChainTruth) -> ChainTruth:
    """``X = I + kappa E_ij``: of ``zx``, kappa F_x shows in the channels along z."""
    shown, source = (AXES.index(axis) for axis in named.target)
    changed = np.array(chain.crosstalk)
    changed[shown, source] += named.value
    return replace(chain, crosstalk=changed)


def plane_offset(named: Named, chain: ChainTruth) -> ChainTruth:
    """``M_y -= h F_x``, or ``M_x += h F_y``: moments of the cells that they do not measure."""
    return replace(chain, plane_offset=chain.plane_offset + named.value * _unit(named.target, ("x", "y")))


def compliance(named: Named, chain: ChainTruth) -> ChainTruth:
    """All cells give so many times as much."""
    return replace(chain, compliance=chain.compliance * (1 + (named.value - 1) * _unit(named.target, COMPLIANT)))


def cell_stiffness(named: Named, chain: ChainTruth) -> ChainTruth:
    """``k (1 + v)`` of one cell along one axis: it takes load from the other three, and none is lost."""
    cell, axis = int(named.target[0]) - 1, AXES.index(named.target[1])
    return chain.stiffer(cell, axis, named.value)


def position(named: Named, chain: ChainTruth) -> ChainTruth:
    """``d^T [G](p + dp)``"""
    return chain.moved(named.target, named.value * _unit(named.targets[1], AXES))


def misalignment(named: Named, chain: ChainTruth) -> ChainTruth:
    """``(d + dd)^T [G]``, dd = v e x d: the pick-up is turned by v about the axis e."""
    return chain.turned(named.target, named.value * _unit(named.targets[1], AXES))


def gravity(named: Named, chain: ChainTruth) -> ChainTruth:
    """The structure's half of gravity: loads are those of the apparent acceleration, or of the kinematic one."""
    return replace(chain, gravity=named.value)


def tilt(named: Named, chain: ChainTruth) -> ChainTruth:
    """The sensors' half: accelerometers read a tilt, or nothing but motion."""
    return replace(chain, accelerometer_tilt=named.value)


def noise(named: Named, chain: ChainTruth) -> ChainTruth:
    """More noise, independent of what there is: variances add."""
    before = chain.noise_rms.get(named.target, 0.0)
    return replace(chain, noise_rms={**chain.noise_rms, named.target: float(np.hypot(before, named.value))})


def mains(named: Named, chain: ChainTruth) -> ChainTruth:
    """So many times the ordinary hum in every channel, instead of what there is."""
    ordinary = dict.fromkeys((*TABLE, *COVER), MAINS["acceleration"]) | dict.fromkeys(FMD, MAINS["force"])
    return replace(chain, mains={name: named.value * size for name, size in ordinary.items()})


def _each(chain: ChainTruth, names: tuple[str, ...], change: Callable[[ChainTruth, str], ChainTruth]) -> ChainTruth:
    for name in names:
        chain = change(chain, name)
    return chain


# Effects on the way of a signal: an amplifier's corner, a plate that gives, a sensor at its limit, crossed plugs.


VERTICAL = 2


def highpass(named: Named, sensed: Sensed) -> Sensed:
    """``1 / (1 - i f_c / f)``: a first-order corner at f_c, by the bilinear rule at the rate of the simulation."""
    from scipy.signal import lfilter

    half = np.pi * named.value / sensed.sampling_rate
    filtered = lfilter([1.0, -1.0], [1.0 + half, half - 1.0], sensed.values[:, sensed.column(named.target)])
    return with_column(sensed, named.target, np.asarray(filtered))


def flexible_cover(named: Named, sensed: Sensed) -> Sensed:
    """``-omega^2 c f_z``: the cover plate gives c under the whole vertical load, and its pick-ups ride on that along z."""
    if sensed.response is None:
        raise ValueError("`response` must be there: a plate bends under the load that is simulated")
    bending = named.value * second_derivative(sensed.response.load[:, VERTICAL], sensed.sampling_rate)
    seen = [c.places[0].direction[VERTICAL] if c.group == "cover" else 0.0 for c in sensed.table.channels]
    return replace(sensed, values=sensed.values + np.outer(bending, seen))


def saturation(named: Named, sensed: Sensed) -> Sensed:
    """``y (1 - s (y / y_p)^2)``, y_p the peak of the run at nominal level: at half the level a quarter of it is lost."""
    y = sensed.values[:, sensed.column(named.target)]
    peak = np.max(np.abs(y), initial=np.finfo(np.float64).tiny) / sensed.level
    return with_column(sensed, named.target, y * (1 - named.value * (y / peak) ** 2))


def unit(named: Named, sensed: Sensed) -> Sensed:
    """The numbers of a channel are not in the unit that the file states."""
    return with_column(sensed, named.target, named.value * sensed.values[:, sensed.column(named.target)])


def swap(named: Named, sensed: Sensed) -> Sensed:
    """Each of two channels holds what the other measured."""
    one, other = (sensed.column(name) for name in named.targets)
    values = np.array(sensed.values)
    values[:, [one, other]] = values[:, [other, one]]
    return replace(sensed, values=values)


def with_column(sensed: Sensed, channel: str, values: Array) -> Sensed:
    """`sensed` with other `values` (n,) of one channel."""
    changed = np.array(sensed.values)
    changed[:, sensed.column(channel)] = values
    return replace(sensed, values=changed)


def second_derivative(signal: Array, rate: float) -> Array:
    """Of `signal` (n,) at `rate` [Hz], by central differences: short by (omega / rate)^2 / 12. Nothing moves at its ends."""
    return np.asarray(np.diff(signal, n=2, prepend=signal[:1], append=signal[-1:]) * rate**2)


# From a named effect to the changes that it makes in a virtual test.


ELSEWHERE = (
    "it arises where spectra are made of a record, which holds nothing of it",
    'Plant nothing, and evaluate the campaign with [processing] method = "peak-reference-hold"',
)
OF_A_PENDULUM = ("it is an error of a pendulum, and a shaker has none", "Simulate a pendulum with `massline swing`")
UNPLANTED = ("its family says no `plant`", "Write plant=at(...) of validation.effects.plants in its file")
"""Why a family is planted by no virtual test, and what to do."""


def planted(effects: Sequence[Named]) -> tuple[PlantedEffect, ...]:
    """The changes that `effects` make, in their order.

    Raises
    ------
    BadInput : one of them cannot be planted in a virtual test; why, and what can.
    """
    found: list[PlantedEffect] = []
    for named in effects:
        plant = FAMILIES[named.family].plant
        if plant is None:
            known = {PENDULUM: OF_A_PENDULUM, PROCESSING: ELSEWHERE} if named.family not in SOURCES else {}
            problem, remedy = known.get(FAMILIES[named.family].side, UNPLANTED)
            raise BadInput("--effect", named.id, problem, remedy)
        found.append(plant(named))
    return tuple(found)


# Which articles of a series an effect reaches; the rule is that of `validation.effects.catalogue`.


def reaching(effects: Sequence[Named], plan: Plan) -> tuple[Named, ...]:
    """Those of `effects` that act in `plan`."""
    there = _there(plan)
    return tuple(named for named in effects if catalogue.acts(named, there))


def require_reaching(effects: Sequence[Named], plans: Sequence[Plan], *, source: str = "--effect") -> None:
    """Refuse an effect that acts in none of `plans`.

    Parameters
    ----------
    source : where the effects stand, for messages

    Raises
    ------
    BadInput : such an effect, with what it could act on; damping of a part where that of every mode is stated.
    """
    for named in effects:
        if not any(catalogue.acts(named, _there(plan)) for plan in plans):
            what = ", ".join(plan.article for plan in plans)
            local, parts = catalogue.is_local(named), catalogue.of_parts(named)
            known = tuple(dict.fromkeys(name for plan in plans for name in catalogue.known(named, _there(plan)))) if local else ()
            kind = "part" if parts else "place"
            nowhere_problem = (
                f"{what} has no {kind} {named.target!r}" if local else f"nothing stands on the cover plate of {what}"
            )
            if parts and any(plan.model == RIGID for plan in plans):
                nowhere_problem = "the parts of a rigid article do not give"
            remedy = "Leave it out, or name another article"
            if known:
                remedy = f"{nearest(named.target, known)}Known are {', '.join(known)}"
            raise BadInput(source, named.id, nowhere_problem, remedy)
        if catalogue.of_parts(named) and any(plan.damping is not None for plan in plans) and "damping" in named.family:
            problem = "--damping (`Plan.damping`) states the damping of every mode, whatever the parts do"
            raise BadInput(source, named.id, problem, "Leave one of them out")


def require_planted(plan: Plan) -> None:
    """Refuse a plan with an effect of the catalogue that cannot act in it; effects of other names are their maker's own affair.

    Raises
    ------
    BadInput : see `require_reaching`.
    """
    known = []
    for effect in plan.effects:
        family, *targets = effect.id.split(":")
        if family in FAMILIES:
            known.append(Named(family=family, targets=tuple(targets), values=effect.value))
    require_reaching(known, [plan], source=SOURCE)


def _there(plan: Plan) -> There:
    places = tuple(locations(plan.on_fmd, changes_of(plan.on_fmd, plan.dimensions))) if plan.on_fmd else ()
    return There(article=plan.on_fmd, parts=parts_of(plan), places=places)
