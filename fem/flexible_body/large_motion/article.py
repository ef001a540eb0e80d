"""What stands on the table: a built-in article of rigid bodies and beams, or as one rigid body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fem import beam
from fem.frame import Body, Member, Plan, inertia
from fem.sandwich import Sandwich
from geometry.articles import built_in
from geometry.consistency import judge
from geometry.errors import BadInput
from geometry.inertia import Inertia
from geometry.multibody import inertia as drawn_inertia


def plan_of(article_name: str, changes: Mapping[str, float] = beam.NO_CHANGES, elements: int | None = None) -> Plan:
    """The built-in article or stack as a frame about its origin; as one rigid body, as it is drawn, when `elements` is None.

    Parameters
    ----------
    article_name, changes, elements : as `fem.beam.plan` takes them

    Raises
    ------
    BadInput : an article, a dimension or a number of elements that cannot be used.
    """
    if elements is None:
        return rigid(drawn_inertia(built_in(article_name, changes)))
    return able_to_turn(beam.plan(article_name, changes, elements=elements))


def rigid(body: Inertia) -> Plan:
    """One rigid body on the table, its inertia in the frame of the article."""
    return Plan(nodes=np.zeros((1, 3)), carriers=(0,), bodies=(Body(node=0, inertia=body),))


def able_to_turn(plan: Plan) -> Plan:
    """`plan` without what exudyn would only know as a matrix in the laboratory's axes, which does not turn with the table.

    Where more material is taken away from a node than its rigid bodies have (the holes of a column), the elements that meet
    there give their mass to both of their nodes, half of the rod to each: the same inertia about the same point.

    Raises
    ------
    BadInput : springs between ports, which are a matrix; material taken away that even then is no body.
    """
    if plan.ports:
        problem = f"springs between ports are matrices that do not turn with the table, found {len(plan.ports)}"
        raise BadInput(source="large motion", field="ports", problem=problem, remedy="Leave load cells and joints rigid")
    hollow = {node for node, body in _carried(plan).items() if not judge(body).physical}
    if not hollow:
        return plan
    filled = _lumped(plan, hollow)
    for node, body in _carried(filled).items():
        if not judge(body).physical:
            problem = f"more material is taken away at node {node} than there is, {judge(body).text}"
            raise BadInput(
                source="large motion", field="bodies", problem=problem, remedy="Take it as one rigid body, without elements"
            )
    return filled


def _carried(plan: Plan) -> dict[int, Inertia]:
    """Inertia of all rigid bodies on every node that carries some, about that node."""
    found: dict[int, Inertia] = {}
    for body in plan.bodies:
        node = plan.carriers[body.node]
        found[node] = body.inertia.about(plan.nodes[node]) + found.get(node, Inertia(parameters=np.zeros(10)))
    return {node: body for node, body in found.items() if body.parameters.any()}


def _lumped(plan: Plan, hollow: set[int]) -> Plan:
    """`plan` with the mass of every element that meets a `hollow` node given to its two nodes as rigid halves."""
    members: list[Member] = []
    bodies = list(plan.bodies)
    for member in plan.members:
        near = [bool({plan.carriers[n] for n in pair} & hollow) for pair in _elements(member)]
        if not any(near) or isinstance(member.section, Sandwich):
            members.append(member)
            continue
        weightless = replace(member.section, mass=0.0, rotary_y=0.0, rotary_z=0.0)
        for (a, b), given in zip(_elements(member), near, strict=True):
            members.append(replace(member, nodes=(a, b), section=weightless if given else member.section))
            bodies += _halves(plan, member, a, b) if given else []
    return replace(plan, members=tuple(members), bodies=tuple(bodies))


def _elements(member: Member) -> list[tuple[int, int]]:
    return list(zip(member.nodes[:-1], member.nodes[1:], strict=True))


def _halves(plan: Plan, member: Member, a: int, b: int) -> list[Body]:
    middle = (plan.nodes[a] + plan.nodes[b]) / 2
    rod = replace(member, nodes=(0, 1))
    return [Body(node=node, inertia=inertia(rod, np.array([plan.nodes[node], middle]))) for node in (a, b)]
