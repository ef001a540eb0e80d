"""A rig on a base with prescribed motion, integrated by exudyn; its equations of motion are exudyn's own.

    table --[load cells]-- cover plate --[flange]-- article

Table and cover plate are exudyn rigid bodies, the table without mass and driven along all six coordinates; load cells, flange,
cables, dampers and friction are exudyn connectors; the article is its reduced matrices on a rigid node. Loads and cell forces are
what exudyn's constraints and connectors report.

Table and cover plate turn as far as they turn; the article is linear in small rotations. What that leaves out is told by
`fem.base_excitation.small_motion` and found by `fem.flexible_body.large_motion`.
"""

from fem.flexible_body.driven_base.response import respond
from fem.flexible_body.driven_base.solver import Solver

__all__ = ["Solver", "respond"]
