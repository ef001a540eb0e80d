"""The same frame on a finer mesh: every element of a plan cut into equal pieces, the old nodes keeping their numbers."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from fem.frame import Member, Plan
from geometry.arrays import Array


def refined(plan: Plan, pieces: int) -> Plan:
    """`plan` with every element cut into `pieces`; new nodes come after the old ones.

    A new node between two that ride on the same body rides on it as well.
    """
    nodes, carriers = list(plan.nodes), list(plan.carriers)
    members = tuple(_cut(member, pieces, nodes, carriers) for member in plan.members)
    return replace(plan, nodes=np.array(nodes), carriers=tuple(carriers), members=members)


def _cut(member: Member, pieces: int, nodes: list[Array], carriers: list[int]) -> Member:
    chain = [member.nodes[0]]
    for a, b in pairwise(member.nodes):
        rigid = carriers[a] == carriers[b]
        for share in np.arange(1, pieces) / pieces:
            carriers.append(carriers[a] if rigid else len(nodes))
            chain.append(len(nodes))
            nodes.append(nodes[a] + share * (nodes[b] - nodes[a]))
        chain.append(b)
    return replace(member, nodes=tuple(chain))
