"""Mesh a bracket of three parts with gmsh, in millimetres: a foot of solids, a wall and a stiffener of shells.

Run it as ``python examples/own_mesh.py [FILE]``; ``docs/own-model.md`` describes what it leaves (``out/own-mesh/bracket.msh``
when no file is given; ``.inp``, ``.unv`` and ``.med`` do as well). Your own mesh comes from your pre-processor.
"""

from __future__ import annotations

import sys
from pathlib import Path

from fem.solid.assembly import session


def write(path: Path) -> None:
    """The bracket into `path`, its groups named foot, wall, stiffener, underside and tip."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with session() as gmsh:
        occ, model = gmsh.model.occ, gmsh.model
        foot = occ.addBox(0, 0, 0, 120, 80, 12)
        wall = occ.addRectangle(0, 0, 0, 80, 150)
        occ.rotate([(2, wall)], 0, 0, 0, 1, 0, 0, 1.5707963267948966)  # upright along x, then along y
        occ.rotate([(2, wall)], 0, 0, 0, 0, 0, 1, 1.5707963267948966)
        occ.translate([(2, wall)], 20, 0, 12)
        corners = [occ.addPoint(20, 40, 12), occ.addPoint(100, 40, 12), occ.addPoint(20, 40, 132)]
        edges = [occ.addLine(corners[k], corners[(k + 1) % 3]) for k in range(3)]
        stiffener = occ.addPlaneSurface([occ.addCurveLoop(edges)])
        _, pieces = occ.fragment([(3, foot)], [(2, wall), (2, stiffener)])
        occ.synchronize()
        for name, piece in zip(("foot", "wall", "stiffener"), pieces, strict=True):
            model.addPhysicalGroup(piece[0][0], [tag for _, tag in piece], name=name)
        model.addPhysicalGroup(2, [tag for _, tag in model.getEntitiesInBoundingBox(-1, -1, -1, 121, 81, 1, 2)], name="underside")
        model.addPhysicalGroup(0, [tag for _, tag in model.getEntitiesInBoundingBox(19, 79, 161, 21, 81, 163, 0)], name="tip")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 12)
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
        gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
        model.mesh.generate(3)
        model.mesh.setOrder(2)
        gmsh.write(str(path))


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/own-mesh/bracket.msh"))
