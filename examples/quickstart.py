"""massline in Python: an article, its inertia by three routes, and what may be done to an inertia.

python examples/quickstart.py
"""

from collections.abc import Mapping

import numpy as np
from rich.console import Console
from rich.table import Table

from geometry.articles import built_in
from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia, judge
from geometry.routes import agreement, by_routes


def main(console: Console) -> None:
    """Print what the program knows of the calibration set-up and of what stands on the FMD."""
    setup = built_in("fmd+disc+cuboid")
    routes = by_routes(setup, chord=1e-4)
    console.print(table("FMD, disc and Cuboid, from F", routes))
    console.print(agreement(setup, routes, chord=1e-4).text)

    # Tare: what is left when the FMD is taken off, first from F, then seen from the disc's underside.
    fmd = built_in("fmd")
    payload = routes["occ"] - by_routes(fmd)["occ"]
    seat = fmd.seat or Pose()
    own = payload.placed(seat.inverse)

    # The same body turned by a quarter about z: x and y change places.
    turned = own.rotated(rotation_about("z", np.pi / 2))
    console.print(table("Disc and Cuboid", {"from F": payload, "from their underside": own, "turned by 90° about z": turned}))

    moments, axes = own.principal()
    console.print(f"principal moments {np.round(moments, 4)} kg m², the first along {np.round(np.abs(axes[:, 0]), 4)}")
    console.print(f"6x6 mass matrix about the CoG (Eq. 1): diagonal {np.round(np.diag(own.about(own.cog).mass_matrix), 4)}")
    console.print(f"verdict: {judge(own).text}")


def table(title: str, inertias: Mapping[str, Inertia]) -> Table:
    """Mass, CoG and moments about the CoG, one line for each of `inertias`."""
    lines = Table("", "m (kg)", "CoG x, y, z (mm)", "Θxx, Θyy, Θzz about the CoG (kg m²)", title=title)
    for name, inertia in inertias.items():
        cog = ", ".join(f"{1e3 * c + 0.0:.2f}" for c in np.round(inertia.cog, 9))
        lines.add_row(name, f"{inertia.mass:.4f}", cog, ", ".join(f"{moment:.5f}" for moment in inertia.moments_cog))
    return lines


if __name__ == "__main__":
    main(Console())
