"""Write a hammer of two materials as a CAD and a mesher would: one STEP assembly, two STL files with their article.toml, a URDF.

Run it as ``python examples/own_article.py [FOLDER]``; ``docs/own-article.md`` works with what it leaves in the folder
(``out/own-article`` when none is given).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from cadquery import Assembly

from geometry import atomic
from geometry.article import Box, Cylinder, Part, Shape, material, upright
from geometry.cad import silence, solid

ARTICLE = """\
format = 1

[article]
name = "hammer"

[[part]]
name = "handle"
file = "handle.stl"
unit = "mm"
material = "oak"

[[part]]
name = "head"
file = "head.stl"
unit = "mm"
density = "7800 kg/m^3"
"""

ROBOT = """\
<robot name="hammer">
  <link name="handle">
    <inertial>
      <origin xyz="0 0 0.125"/>
      <mass value="0.0687"/>
      <inertia ixx="3.6e-4" ixy="0" ixz="0" iyy="3.6e-4" iyz="0" izz="5.4e-6"/>
    </inertial>
    <visual><geometry><mesh filename="handle.stl" scale="0.001 0.001 0.001"/></geometry></visual>
  </link>
  <link name="head">
    <inertial>
      <origin xyz="0 0 0.265"/>
      <mass value="0.772"/>
      <inertia ixx="1.16e-4" ixy="0" ixz="0" iyy="8.36e-4" iyz="0" izz="8.36e-4"/>
    </inertial>
    <visual><geometry><mesh filename="head.stl"/></geometry></visual>
  </link>
</robot>
"""
"""The head's mesh is taken for metres: somebody forgot its scale."""


def parts() -> tuple[Part, Part]:
    """A round oak handle of 25 mm and 250 mm, and on it a steel head of 110 x 30 x 30 mm; z up, origin under the handle."""
    handle = Shape(solids=(upright(Cylinder(diameter=0.025, height=0.25), bottom=0.0),))
    head = Shape(solids=(upright(Box(size=np.array([0.11, 0.03, 0.03])), bottom=0.25),))
    return (
        Part(name="handle", material=material("oak"), shape=handle),
        Part(name="head", material=material("cast-carbon-steel"), shape=head),
    )


def write(folder: Path) -> None:
    """Write the hammer's files into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    solids = {part.name: solid(part) for part in parts()}
    assembly = Assembly(name="hammer")
    for name, body in solids.items():
        assembly.add(body, name=name)
        body.exportStl(str(folder / f"{name}.stl"), 0.01, 0.1)
    with silence():
        assembly.export(str(folder / "hammer.step"))
    atomic.write_text(folder / "article.toml", ARTICLE)
    atomic.write_text(folder / "robot.urdf", ROBOT)


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/own-article"))
