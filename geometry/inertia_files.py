"""Inertia written for other programs: robot descriptions, finite-element decks, multibody models, and our own result file."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np

from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia, require_physical

# One table, `FORMATS`. Every format states mass, centre of mass and a tensor *about the centre of mass*, in SI and in the axes of
# the frame in which the body is given, and every file says so in a comment. What differs is the sign of the products and whether
# there are any:
#
# ========== ======================= =======================================================================================
# format     products                source
# ========== ======================= =======================================================================================
# urdf       matrix entries          ROS URDF specification, ``<inertia>``
# mjcf       none (principal axes)   MuJoCo XML reference, ``diaginertia`` in the axes of ``quat``
# sdf        matrix entries          SDFormat specification, ``<inertia>``
# nastran    positive integrals      MSC Nastran Quick Reference Guide, CONM2: the matrix has -I21, -I31, -I32
# opensees   none (six point masses) OpenSees ``mass`` takes a diagonal only
# adams      none (principal axes)   Adams/View ``part create rigid_body mass_properties`` about an inertia marker
# toml       matrix entries          `docs/reference-tables.md`
# ========== ======================= =======================================================================================
#
# OpenSees has no products of inertia at a node, so the body is six equal point masses at ``± sqrt(3 s_k / m) e_k`` from its
# centre, with s_k and e_k the eigenvalues and eigenvectors of its second moments of mass, Sigma = tr(I)/2 1 - I: the same mass,
# centre and tensor exactly. MuJoCo and Adams get the principal moments and axes, which need no sign; MuJoCo would find the axes
# of a full tensor to six digits only (``fullinertia``, 3.3.7: 6e-7 of the largest moment).


@dataclass(frozen=True, eq=False, kw_only=True)
class InertiaFormat:
    """One way to write inertia.

    Attributes
    ----------
    program : what reads it
    endings : of its files, the first one the usual
    body : one body, filled in by `_fields`
    head, tail : around all bodies; ``{title}`` is what the whole is called, ``{quoted}`` the same as an attribute of XML
    most : how many bodies a file can hold
    """

    program: str
    endings: tuple[str, ...]
    body: str
    head: str = ""
    tail: str = ""
    most: int = 9999


def written(form: str, name: str, bodies: Mapping[str, Inertia]) -> str:
    """`bodies` by name as a file of the format `form`, the whole called `name`; each in its own frame.

    Raises
    ------
    BadInput : more bodies than the format holds, or parameters that no body has.
    """
    known = FORMATS[form]
    if len(bodies) > known.most:
        problem = f"a file of {form} holds {known.most} {'body' if known.most == 1 else 'bodies'}, found {len(bodies)}"
        raise BadInput("--format", "", problem, "Choose one, or write one file for each")
    title = " ".join(name.split())
    text = [known.head.format(title=title, quoted=quoteattr(title))]
    for number, (label, inertia) in enumerate(bodies.items(), start=1):
        text.append(known.body.format_map(_fields(number, label, require_physical(inertia, label, rounding=1e-9))))
    return "".join(text) + known.tail


def _plain(values: Sequence[float] | Array, between: str = " ") -> str:
    """Numbers with every digit that they have, zeros without a sign."""
    return between.join(repr(float(value) + 0.0) for value in values)


def _quaternion(rotation: Array) -> Array:
    """Unit quaternion w, x, y, z (4,) of `rotation` (3, 3): largest eigenvector of Bar-Itzhack's K (JGCD 23, 2000)."""
    R = rotation
    K = np.array(
        [
            [R[0, 0] + R[1, 1] + R[2, 2], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]],
            [0, R[0, 0] - R[1, 1] - R[2, 2], R[1, 0] + R[0, 1], R[2, 0] + R[0, 2]],
            [0, 0, R[1, 1] - R[0, 0] - R[2, 2], R[2, 1] + R[1, 2]],
            [0, 0, 0, R[2, 2] - R[0, 0] - R[1, 1]],
        ]
    )
    return np.asarray(np.linalg.eigh(K, UPLO="U")[1][:, -1])


def nastran_field(value: float | None) -> str:
    """A large field of Nastran: 16 characters, the exponent without its letter, as many digits as fit; blank for None."""
    texts = (f"{(value or 0.0) + 0.0:.{digits}e}".split("e") for digits in range(16, 0, -1))
    short = (f"{mantissa}{int(exponent):+d}" if int(exponent) else mantissa for mantissa, exponent in texts)
    return " " * 16 if value is None else next(f"{text:>16}" for text in short if len(text) <= 16)


def _fields(number: int, label: str, body: Inertia) -> dict[str, str]:
    """What the formats say of one body, as text by the names that `FORMATS` has in braces."""
    mass, cog, tensor = body.mass, body.cog, body.tensor_cog
    title = " ".join(label.split())
    entries = [float(tensor[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    xx, yy, zz, xy, xz, yz = entries
    # CONM2: grid and frame 0, mass, X1 to X3, an empty field, I11, I21, I22, I31, I32, I33
    cells = [nastran_field(one) for one in (mass, *cog, None, xx, -xy, yy, -xz, -yz, zz)]
    rows = [f"CONM2*  {number:>16}{1000 + number:>16}{0:>16}{cells[0]}*"]
    rows += ["*       " + "".join(cells[k : k + 4]) + "*" * (k < 9) for k in (1, 5, 9)]
    masses = []
    # Six equal masses about their centre have together the mass and the tensor
    second, own = np.linalg.eigh(0.5 * np.trace(tensor) * np.eye(3) - tensor)
    arms = (own * np.sqrt(3 * np.maximum(second, 0.0) / mass)).T
    for k, place in enumerate(np.vstack([arms, -arms]), start=100 * number + 1):
        share = _plain([mass / 6] * 3)
        masses += [f"node {k} {_plain(cog + place)}", f"mass {k} {share} 0 0 0", f"rigidLink beam {100 * number} {k}"]
    moments, axes = np.linalg.eigh(tensor)
    axes = axes * np.sign(np.linalg.det(axes))
    # Turns about z, x and z of the body, of which axes that stand upright leave one to choose
    upright = math.hypot(axes[2, 0], axes[2, 1]) < 1e-12
    turns = (
        math.atan2(axes[1, 0], axes[0, 0]) if upright else math.atan2(axes[0, 2], -axes[1, 2]),
        math.acos(max(-1.0, min(1.0, float(axes[2, 2])))),
        0.0 if upright else math.atan2(axes[2, 0], axes[2, 1]),
    )
    listed = {
        "cogs": ", ".join(f'"{_plain([one])} m"' for one in cog),
        "moments": ", ".join(f'"{_plain([one])} kg m^2"' for one in entries[:3]),
        "products": ", ".join(f'"{_plain([one])} kg m^2"' for one in entries[3:]),
    }
    return {
        "number": str(number),
        "grid": str(1000 + number),
        "node": str(100 * number),
        "title": title,
        "quoted": quoteattr(title),
        "word": re.sub(r"[^A-Za-z0-9_]", "_", title) or "part",
        "mass": _plain([mass]),
        "cog": _plain(cog),
        "place": _plain(cog, ", "),
        "conm2": "\n".join(row.rstrip() for row in rows),
        "masses": "\n".join(masses),
        "principal": _plain(moments),
        "named": " ".join(f"i{key}={_plain([one])}" for key, one in zip(("xx", "yy", "zz"), moments, strict=True)),
        "quat": _plain(_quaternion(axes)),
        "turns": _plain(turns, ", "),
        **listed,
        **{key: _plain([value]) for key, value in zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), entries, strict=True)},
    }


FORMATS: Mapping[str, InertiaFormat] = {
    form: InertiaFormat(**{**one, "endings": tuple(one["endings"])})
    for form, one in toml_file.shipped("geometry", "inertia_formats.toml").items()
}
"""What can be written, by the word of ``--format``."""
