"""The share of a frame's stiffness that loses energy: the plan with every part's stiffness times its loss factor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem.frame import Member, Plan
from fem.sandwich import Sandwich
from fem.section import Section

_STIFFNESSES = ("axial", "torsion", "bending_y", "bending_z", "shear_y", "shear_z")


def lossy(plan: Plan) -> Plan:
    """`plan` with its stiffness scaled by the loss factor of each part, so that exudyn's stiffness of it is sum of eta_p K_p."""
    eta = plan.loss_factors
    ports = tuple(replace(p, stiffness=eta.get(p.part, 0.0) * p.stiffness) for p in plan.ports)
    return replace(plan, members=tuple(_scaled(member, plan) for member in plan.members), ports=ports)


def viscous(plan: Plan, frequency: float) -> Plan:
    """`plan` with viscous dampings instead of stiffnesses: C = sum of eta_p K_p / omega, equal to its loss at `frequency` [Hz].

    Below it loses less, above it more: in time there is no damping that follows the displacement.
    """
    omega = 2 * np.pi * frequency
    return lossy(replace(plan, loss_factors={part: eta / omega for part, eta in plan.loss_factors.items()}))


def _scaled(member: Member, plan: Plan) -> Member:
    eta, section = plan.loss_factors, member.section
    if not isinstance(section, Sandwich):
        return replace(member, section=_times(section, eta.get(member.part, 0.0)))
    bottom, layer, top = (eta.get(part, 0.0) for part in section.parts)
    face = float(np.mean([bottom, top]))
    faces = _times(section.faces, face)
    return replace(member, section=replace(section, faces=faces, stretching=face * section.stretching, slip=layer * section.slip))


def _times(section: Section, factor: float) -> Section:
    return replace(section, **{name: factor * getattr(section, name) for name in _STIFFNESSES})
