"""The truth of a virtual test as JSON values: every figure that was drawn, under its id of the catalogue, and what follows."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from dataclasses import asdict, replace

import numpy as np
import numpy.typing as npt

from fem.base_excitation.rig import Rig
from geometry.dynamic_mass import MOTIONS
from geometry.inertia import PARAMETERS, Inertia
from validation.virtual_test.layout import ChainTruth
from validation.virtual_test.plan import Plan, changed_rig
from validation.virtual_test.shaker import SetUp, nominal_fmd

FORMAT = 1

LINES = (4.0, 8.0, 12.0, 16.0, 24.0, 32.0)
"""[Hz] at which the dynamic mass is stated."""

AXES = "xyz"

SWINGING = ("appendage", "absorber", "slosh")
"""Families of effects that belong to no rigid body."""

Json = dict[str, object]


def truth(plan: Plan, chain: ChainTruth, made: SetUp, rig: Rig) -> Json:
    """Everything about the virtual test of `plan`; `rig` is the one that was driven."""
    # Inertia of what stands on the FMD about its own origin
    # The rig with all effects but those that swing on a spring of their own: some weigh along one axis only, as no body does
    without_resonators = changed_rig(made.rig, [effect for effect in plan.effects if effect.id.partition(":")[0] not in SWINGING])
    article = Inertia.from_mass_matrix(without_resonators.article.reduced.mass[:6, :6])
    # How the FMD's moving part differs from its drawing: relative, the centre of gravity in metres
    found, nominal = moving_part(rig, plan), nominal_fmd(plan)
    relative = {
        "mass": found.mass / nominal.mass - 1,
        "cog_m": listed(found.cog - nominal.cog),
        "moi_cog": listed(found.moments_cog / nominal.moments_cog - 1),
    }
    if made.modes is None:
        modes: Json = {"frequency_hz": [], "damping_ratio": []}
    else:
        modes = {"frequency_hz": listed(made.modes.frequency), "damping_ratio": listed(made.modes.damping_ratio)}
    from importlib.metadata import version

    names = ("massline", "numpy", "scipy")
    versions = {"python": platform.python_version(), **{name: version(name) for name in names}}
    return {
        "format": FORMAT,
        "seed": plan.seed,
        "plan": stated(plan),
        "effects": [{"id": effect.id, "value": dict(effect.value)} for effect in plan.effects],
        "tolerances": dict(deviations(chain)) | dict(_parts(made)) | {"fmd-inertia": relative},
        "fmd": inertia(moving_part(rig, plan)),
        "article": {"own_frame": inertia(article), "about_F": inertia(article.moved(rig.seat))} if plan.on_fmd else None,
        "mounting_origin_m": listed(rig.seat),
        "modes": modes,
        "cell_stiffness_N_per_m": [listed(cell.stiffness) for cell in rig.cells],
        "dynamic_mass": _dynamic_mass(rig),
        "versions": dict(versions),
    }


def deviations(chain: ChainTruth) -> Iterator[tuple[str, float]]:
    """Every deviation of `chain` under its id of the catalogue, SI."""
    for what in ("gain", "delay"):
        for channel, value in getattr(chain, what).items():
            yield f"{'force' if channel.startswith('fmd') else 'accelerometer'}-{what}:{channel}", float(value)
    for family, vectors in (("accelerometer-position", chain.position), ("accelerometer-misalignment", chain.angle)):
        for channel, vector in vectors.items():
            yield from ((f"{family}:{channel}:{axis}", float(v)) for axis, v in zip(AXES, vector, strict=True))
    for (cell, axis), value in np.ndenumerate(chain.cell_stiffness):
        yield f"cell-stiffness:{cell + 1}{AXES[axis]}", float(value)
    for (to, of), value in np.ndenumerate(chain.crosstalk):
        if to != of:
            yield f"force-crosstalk:{AXES[to]}{AXES[of]}", float(value)


def moving_part(rig: Rig, plan: Plan) -> Inertia:
    """Inertia of the FMD's moving part about F; of the FMD alone one half of it stands for the article."""
    cover = Inertia(parameters=np.zeros(10)) if rig.cover is None else rig.cover
    return cover if plan.on_fmd else cover.scaled(2.0)


def inertia(of: Inertia) -> Json:
    """Ten parameters about the origin of the frame, and the usual way to say them."""
    return {
        "parameters": dict(zip(PARAMETERS, listed(of.about(np.zeros(3)).parameters), strict=True)),
        "mass_kg": of.mass,
        "cog_mm": listed(1e3 * of.cog),
        "moi_cog_kgm2": listed(of.moments_cog),
        "poi_cog_kgm2": listed(of.products_cog),
        "about": "cog",
    }


def stated(plan: Plan) -> Json:
    """`plan` without its effects."""
    return {
        "article": plan.article,
        "model": plan.model,
        "pattern": plan.pattern,
        "levels": list(plan.levels),
        "band_hz": list(plan.band),
        "octaves_per_minute": plan.octaves_per_minute,
        "cross": plan.cross,
        "noise_rms": dict(plan.noise_rms),
        "mains": dict(plan.mains),
        "rate_hz": plan.rate,
        "simulation_rate_hz": plan.simulation_rate,
        "quiet_s": plan.quiet,
        "ringing": plan.ringing,
        "highest_hz": plan.highest,
        "gravity": plan.gravity,
        "dimensions": dict(plan.dimensions),
        "tolerances": asdict(plan.tolerances),
        "scatter": asdict(plan.scatter),
    }


def listed(values: npt.ArrayLike) -> list[float]:
    """Plain numbers."""
    return [float(value) for value in np.ravel(np.asarray(values, dtype=np.float64))]


def _parts(made: SetUp) -> Iterator[tuple[str, float]]:
    for name, part in made.parts.items():
        yield f"modulus:{name}", part.modulus
        yield f"loss:{name}", part.loss


def _dynamic_mass(rig: Rig) -> Json:
    """Of all that the cells carry, about F: on a rigid table in their place, and without what is loose."""
    from fem.base_excitation.rig import dynamic_mass

    H = dynamic_mass(replace(rig, cells=(), frictions=()), LINES).matrix
    return {"frequency_hz": list(LINES), "re": H.real.tolist(), "im": H.imag.tolist(), "about": "F", "order": list(MOTIONS)}
