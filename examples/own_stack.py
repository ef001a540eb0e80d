"""Draw a stack like that of a satellite as a STEP assembly in millimetres: adapter ring, deck, mast and instrument.

Run it as ``python examples/own_stack.py [FILE]``; ``docs/your-own-structure.md`` tests what it leaves
(``out/structure/stack.step`` when no file is given). Your own assembly comes from your CAD, a body a part.
"""

from __future__ import annotations

import sys
from pathlib import Path

import cadquery as cq


def stack() -> cq.Assembly:
    """Four bodies, each with a name, that touch with plane faces: 320 mm high on a ring 160 mm across."""
    ring = cq.Workplane().circle(80).circle(70).extrude(60)
    deck = cq.Workplane(origin=(0, 0, 60)).rect(220, 220).extrude(12)
    mast = cq.Workplane(origin=(40, 0, 72)).rect(24, 24).extrude(180)
    instrument = cq.Workplane(origin=(20, 0, 252)).rect(100, 70).extrude(60)
    made = cq.Assembly(name="stack")
    for name, body in (("ring", ring), ("deck", deck), ("mast", mast), ("instrument", instrument)):
        made.add(body, name=name)
    return made


if __name__ == "__main__":
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/structure/stack.step")
    path.parent.mkdir(parents=True, exist_ok=True)
    stack().export(str(path))
