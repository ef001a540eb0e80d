"""Modal data about the reference point as `Modes`: converted to SI and held against the rigid body that they belong to."""

from __future__ import annotations

import numpy as np

from fem.modes import Modes
from fem.user_model.description import Contents, Description, require_as_stated, require_rigid_body
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array

NEEDED = ("frequency", "damping_ratio", "participation", "rigid_mass")
OPTIONAL = ("residual", "viscous", "structural")

EXCESS = 1e-4
"""Effective masses may exceed the rigid mass by this share: the digits that programs print."""

SYMMETRIC = 1e-6


def modes(contents: Contents, description: Description) -> Modes:
    """The modes in `contents`.

    Frequencies are in Hz and the damping matrices in rad/s and rad²/s² in every unit system; masses, lever arms and the residual
    are in the user's. The residual is zero when there is none.

    Raises
    ------
    BadInput : whatever is wrong, with the file, the array, what was found and what to do.
    """
    contents.require(NEEDED, OPTIONAL)
    if description.interface or description.loss_factor is not None:
        field = "fe_model.interface" if description.interface else "fe_model.loss_factor"
        problem = "belongs to matrices, not to modal data, whose base is the reference point and whose damping is damping_ratio"
        raise BadInput(source=description.source, field=field, problem=problem, remedy="Leave it out")
    frequency = contents.numbers("frequency", (-1,))
    if not len(frequency):
        raise contents.refused("frequency", "holds no mode", "Write at least one; a rigid body needs no model")
    wrong = np.flatnonzero(frequency <= 0)
    if wrong.size:
        problem = f"must be positive, found {frequency[wrong[0]]:.6g} Hz for mode {wrong[0] + 1}"
        remedy = "The base is held, so that no mode is at 0 Hz; a negative one is the mark of an indefinite K or of rad²/s²"
        raise contents.refused("frequency", problem, remedy)
    falls = np.flatnonzero(np.diff(frequency) < 0)
    if falls.size:
        k = int(falls[0])
        problem = f"must ascend, found {frequency[k]:.6g} Hz for mode {k + 1} and {frequency[k + 1]:.6g} Hz for mode {k + 2}"
        remedy = "Sort frequency, damping_ratio and the columns of participation together; here nobody knows which are sorted"
        raise contents.refused("frequency", problem, remedy)
    n = len(frequency)
    u = description.units
    rigid = contents.numbers("rigid_mass", (6, 6)) * np.outer(u.six, u.six) * u.mass
    participation = contents.numbers("participation", (6, n)) * u.six[:, None] * np.sqrt(u.mass)
    about = "Write the 6 x 6 mass matrix about the reference point: products are matrix entries, Ixy = -∫xy dm"
    inertia = require_rigid_body(rigid, contents.source, "rigid_mass", about)
    require_as_stated(inertia, description)
    _require_within_rigid_mass(contents, rigid, participation)
    viscous, structural = (_damping(contents, name, n) for name in ("viscous", "structural"))
    ratio = contents.numbers("damping_ratio", (n,))
    wrong = np.flatnonzero((ratio < 0) | (ratio >= 1))
    if wrong.size:
        found = ratio[wrong[0]]
        problem = f"must be at least 0 and below 1, found {found:.6g} for mode {wrong[0] + 1}"
        raise contents.refused(
            "damping_ratio", problem, "Write the share of critical damping, 0.01 for 1 %" if found >= 1 else "Correct it"
        )
    omega = 2 * np.pi * frequency
    if viscous is None:
        viscous = np.diag(2 * ratio * omega - (0 if structural is None else np.diag(structural) / omega))
    # `damping_ratio` repeats the diagonals of the damping matrices where these are given
    equivalent = (np.diag(viscous) + (0 if structural is None else np.diag(structural) / omega)) / (2 * omega)
    off = np.abs(equivalent - ratio)
    mode = int(np.argmax(off))
    if off[mode] > 1e-3 * ratio[mode] + 1e-9 or np.any(np.diag(viscous) < -1e-9 * omega):
        problem = f"is {ratio[mode]:.6g} for mode {mode + 1} where the damping matrices make it {equivalent[mode]:.6g}"
        raise contents.refused(
            "damping_ratio", problem, "Write (C_rr + S_rr / omega_r) / (2 omega_r), with C in rad/s and S in rad²/s²"
        )
    return Modes(
        frequency=frequency,
        damping_ratio=ratio,
        participation=participation,
        rigid_mass=(rigid + rigid.T) / 2,
        residual=_residual(contents) * np.outer(u.six, u.six) * u.mass * u.time**2,
        reference_point=description.reference_point,
        shapes=np.zeros((0, n)),
        viscous=viscous,
        structural=np.zeros((n, n)) if structural is None else structural,
    )


def _damping(contents: Contents, name: str, n: int) -> Array | None:
    if name not in contents:
        return None
    D = contents.numbers(name, (n, n))
    worst = float(np.abs(D - D.T).max())
    if worst > SYMMETRIC * np.abs(D).max():
        raise contents.refused(name, f"is not symmetric, by {worst:.6g}", "Write both triangles of the modal damping matrix")
    lowest = float(np.linalg.eigvalsh((D + D.T) / 2)[0])
    if lowest < -SYMMETRIC * np.abs(D).max():
        raise contents.refused(name, f"has the negative eigenvalue {lowest:.6g}, which feeds energy in", "Correct it")
    return (D + D.T) / 2


def _residual(contents: Contents) -> Array:
    if "residual" not in contents:
        return np.zeros((6, 6))
    R = contents.numbers("residual", (6, 6))
    scale = np.sqrt(np.abs(np.diag(R)))
    unsymmetric = np.abs(R - R.T) > SYMMETRIC * np.outer(scale, scale) + 1e-30
    if np.any(unsymmetric):
        row, column = np.argwhere(unsymmetric)[0] + 1
        raise contents.refused("residual", f"is not symmetric in row {row}, column {column}", "Write both triangles")
    regular = np.where(scale > 0, scale, 1.0)
    lowest = float(np.linalg.eigvalsh((R + R.T) / 2 / np.outer(regular, regular))[0])
    if lowest < -EXCESS:
        problem = f"is not positive: it has the eigenvalue {lowest:.3g} when scaled to a diagonal of ones"
        raise contents.refused("residual", problem, "Write the sum of L L^T / omega² over the modes that are left out")
    return (R + R.T) / 2


def _require_within_rigid_mass(contents: Contents, rigid: Array, participation: Array) -> None:
    """What the modes carry is a part of the rigid mass: rigid - L L^T has no negative eigenvalue."""
    shares = np.sum(participation**2, axis=1) / np.diag(rigid)
    worst = int(np.argmax(shares))
    remedy = (
        "Write participation about the reference point, 6 x n, of modes normalised to unit modal mass, in the units of rigid_mass"
    )
    if shares[worst] > 1 + EXCESS:
        problem = f"carries {shares[worst]:.4g} times the rigid mass along {MOTIONS[worst]}: the effective masses exceed it"
        raise contents.refused("participation", problem, remedy)
    scale = 1 / np.sqrt(np.diag(rigid))
    left = scale[:, None] * (rigid - participation @ participation.T) * scale
    lowest = float(np.linalg.eigvalsh((left + left.T) / 2)[0])
    if lowest < -EXCESS:
        problem = f"carries more than the rigid mass in a combination of axes, by {-lowest:.3g} of it"
        raise contents.refused("participation", problem, f"Check the signs of its rows. {remedy}")
