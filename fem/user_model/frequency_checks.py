"""Do matrices and modes answer as a structure does: definite, with the stated frequencies, enough modes, losing energy?"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fem import modes
from fem.structure import Sparse
from fem.user_model import description, matrices
from fem.user_model.matrix_checks import Finding, Submitted
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Integers

REPRODUCED = 0.005
"""Share by which a frequency may differ from the stated one, beyond three times its tolerance: digits, and other eigensolvers."""

ENOUGH = 0.8
"""Share of the mass along each axis that the modes of a model have to carry, where nothing stands for the others."""

HALF = 0.5
"""As `ENOUGH`, in the mean over the axes, where a reduction keeps the mass of the others on its interface."""

ROUNDED = 1e-9
"""Size of a negative eigenvalue, of a matrix scaled to a diagonal of ones, that is the rounding of a motion without energy."""

SMALL = 1_500
"""Rows up to which an eigenvector is found by LAPACK."""


def definiteness(model: Submitted, name: str) -> tuple[matrices.Factored | None, list[Finding]]:
    """Are all motions of `name` ("stiffness" or "mass") positive with the base held? Its factors when they are."""
    rows = model.free if model.support == "base" else np.arange(model.mass.shape[0])
    A = getattr(model, name)[rows][:, rows]
    diagonal, sums = A.diagonal(), np.asarray(abs(A).sum(axis=1)).ravel()
    without = np.flatnonzero((diagonal == 0) & (sums > 0))
    if without.size:
        what = f"the {name} couples a motion that has no {name} of its own: it is indefinite"
        remedy = "Write the whole matrix, or leave the row empty: a motion without mass has no couplings"
        amount = f"{len(without)} degree(s) of freedom"
        return None, [Finding(check="diagonal", what=what, where=model.places_of(rows[without]), amount=amount, remedy=remedy)]
    if name == "mass":
        heavy = np.flatnonzero(diagonal > 0)
        if not heavy.size:
            what, amount = "no free degree of freedom has mass", f"{len(rows)} rows"
            remedy = "Check that this is M, and the interface"
            return None, [Finding(check="no mass", what=what, where="array `mass`", amount=amount, remedy=remedy)]
        rows, A = rows[heavy], A[heavy][:, heavy]
    if np.any(A.diagonal() <= 0):
        return None, []  # said already, with the diagonal
    if name == "stiffness" and model.support == "free":
        # A free body costs no energy in six motions; negative and further ones are seen with a little mass added
        A = A - modes.floating_shift(A, model.mass[rows][:, rows]) * model.mass[rows][:, rows]
    factor = matrices.factored(A)
    if not factor.negative and not factor.zero.size:
        return factor, []
    moving, energy = _lowest_motion(A, factor.negative > 0)
    where = model.places_of(rows[moving])
    held = " with the interface held" if model.support == "base" else ""
    if factor.negative and not energy > -ROUNDED:
        what = f"the {name} is indefinite: {factor.negative} motion(s) give energy away{held}"
        amount = f"{factor.negative} negative eigenvalue(s); the lowest, scaled to a diagonal of ones, is {energy:.3g}"
        remedy = "Look there for a wrong entry: every principal minor of M is positive"
        if name == "stiffness":
            remedy = "Look there for a negative spring, a load or pre-stress beyond buckling, or a rounded reduction"
        return None, [Finding(check=f"indefinite {name}", what=what, where=where, amount=amount, remedy=remedy)]
    if name == "mass":
        what = "a combination of motions has no mass though each of them has"
        remedy = "Write the consistent mass, or a lumped one"
        return None, [
            Finding(check="singular mass", what=what, where=where, amount=f"{len(factor.zero)} zero pivot(s)", remedy=remedy)
        ]
    zero = max(len(factor.zero), 1)
    what = f"a mechanism: at least {zero} motion(s) cost no energy{held}"
    remedy = (
        "Join what moves there: a hinge too many, a rotation that no element holds, supports that leave the whole free to turn"
    )
    return None, [
        Finding(check="mechanism", what=what, where=where, amount=f"{zero} zero pivot(s) of {len(rows)}", remedy=remedy)
    ]


def _lowest_motion(A: Sparse, negative: bool) -> tuple[Integers, float]:
    """The rows that move most in the lowest eigenvector of A scaled to a diagonal of ones, and its eigenvalue.

    `negative` says that it is below zero; NaN and no rows where a large matrix does not give it away.
    """
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import ArpackNoConvergence, eigsh

    S = diags_array(1 / np.sqrt(A.diagonal()))
    B = csc_array(S @ A @ S)
    if B.shape[0] <= SMALL:
        values, vectors = np.linalg.eigh(B.toarray())
        value, vector = float(values[0]), vectors[:, 0]
    else:
        start = np.random.default_rng(0).standard_normal(B.shape[0])
        how: dict[str, Any] = {"which": "SA", "maxiter": 3_000} if negative else {"which": "LM", "sigma": -1e-6}
        try:
            found, pair = eigsh(B, 1, v0=start, tol=1e-3, **how)
            value, vector = float(found[0]), pair[:, 0]
        except (ArpackNoConvergence, RuntimeError):
            return np.zeros(0, dtype=np.intp), float("nan")
    size = np.abs(vector)
    order = np.argsort(-size)
    return order[size[order] > 0.3 * size.max()], value


# --- frequencies ------------------------------------------------------------------------------------------------------------


def frequencies(model: Submitted) -> tuple[Array, list[Finding]]:
    """The lowest frequencies [Hz] of the model, and what the stated ones say of K and M."""
    stated = model.stated.frequencies
    count = max(len(stated) + 4, 6)
    own = _frequencies(model, count, model.support)
    if own is not None and model.support == "free" and len(own) and own[0] < 1e-3 * own[-1]:
        what = "a mechanism: beside the six rigid motions others cost no energy"
        amount = f"the lowest frequencies are {_listed(own)} Hz"
        remedy = "Join what moves there: a hinge too many, a rotation that no element holds"
        return own, [Finding(check="mechanism", what=what, where="array `stiffness`", amount=amount, remedy=remedy)]
    if own is None or not len(stated) or not len(own):
        return np.zeros(0) if own is None else own, []
    listed = f"stated {_listed(stated[:, 0])} Hz; found {_listed(own[: len(stated)])} Hz"
    if _reproduced(own, stated):
        return own, []
    what = "K and M do not reproduce the stated frequencies"
    said = {"check": "frequencies", "what": what, "where": "`stated.frequencies`", "amount": listed}
    return own, [Finding(**said | _why_not(model, own, stated, count, what))]


def _why_not(model: Submitted, own: Array, stated: Array, count: int, what: str) -> dict[str, str]:
    """Fields of a finding that say why `count` of the model's `own` frequencies [Hz] are not those that are `stated`."""
    m = min(len(own), len(stated))
    ratio = own[:m] / stated[:m, 0]
    factor = float(np.exp(np.mean(np.log(ratio))))
    if m > 1 and np.ptp(np.log(ratio)) < 0.02 and abs(factor - 1) > 0.01:
        unit, remedy = _factor_named(factor)
        named = {"check": "unit of frequency"} if unit else {}
        return {**named, "what": f"{what}: all of them are {factor:.4g} times as high", "remedy": remedy}
    if model.support == "base":
        free = _frequencies(model, count, "free")
        if free is not None and _reproduced(free, stated):
            remedy = "Name the interface that they were computed with, or state those of the held structure"
            what = f"{what}, but the free structure does"
            return {"check": "boundary", "what": what, "where": "`fe_model.interface`", "remedy": remedy}
    for words, M in _lumped(model):
        other = _frequencies(replace(model, mass=M), count, model.support)
        if other is not None and _reproduced(other, stated):
            remedy = "Export the mass that the frequencies were computed with (Nastran: PARAM,COUPMASS), or state others"
            what = f"{what}, but with {words} they do"
            return {"check": "lumped mass", "what": what, "where": "array `mass`", "remedy": remedy}
    matched = [k for k, one in enumerate(stated) if np.min(np.abs(own / one[0] - 1)) <= max(REPRODUCED, 3 * one[1] / one[0])]
    labels, diagonal = model.dofs.labels, np.ones(model.mass.shape[0], dtype=bool)
    if len(labels):
        diagonal = np.isin(labels[:, 1:].ravel(), (1, 2, 3))
    off = model.mass[diagonal][:, diagonal]
    lumped = off.count_nonzero() == np.count_nonzero(off.diagonal())
    if lumped and m > 2 and np.all(ratio < 1 + REPRODUCED) and np.polyfit(stated[:m, 0], ratio, 1)[0] < 0:
        what = f"{what}: they fall short the more, the higher, as a lumped mass does, and M is lumped"
        remedy = "Export the consistent mass if they were computed with it (Nastran: PARAM,COUPMASS,1), or refine the mesh"
        return {"check": "lumped mass", "what": what, "where": "array `mass`", "remedy": remedy}
    if matched and len(matched) >= len(stated) / 2:
        missing = ", ".join(f"{one[0]:.5g} Hz" for k, one in enumerate(stated) if k not in matched)
        some = f"{missing} has no counterpart, the other {len(matched)} have"
        what = f"{what}: {some if missing else 'each has a counterpart, but others lie between'}"
        return {"what": what, "remedy": "Look for a part, spring or point mass that is in one of the two models only"}
    softer = "too soft or too heavy" if factor < 1 else "too stiff or too light"
    over = f"The matrices are {softer}, by {100 * (factor**2 - 1):+.3g} % of stiffness over mass in the mean"
    return {"remedy": f"{over}: look for a part, a support or a material that differs"}


def _frequencies(model: Submitted, count: int, support: str) -> Array | None:
    """The lowest [Hz] with this `support`, those of a floating body without its rigid motions; None where nothing converges."""
    rows = model.free if support == "base" else np.arange(model.mass.shape[0])
    K, M = (A[rows][:, rows] for A in (model.stiffness, model.mass))
    shift = modes.floating_shift(K, M) if support == "free" else 0.0
    try:
        values = modes.lowest(K.tocsc(), M.tocsc(), min(count + 6 * (support == "free"), len(rows)), shift=shift).values
    except (CheckFailed, BadInput, np.linalg.LinAlgError):
        return None
    values = values[6:] if support == "free" else values
    return np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)


def _reproduced(own: Array, stated: Array) -> bool:
    """Whether every stated frequency is that of the mode of its number."""
    if len(own) < len(stated):
        return False
    return bool(np.all(np.abs(own[: len(stated)] - stated[:, 0]) <= np.maximum(REPRODUCED * stated[:, 0], 3 * stated[:, 1])))


STIFFER = {
    1e3: "newtons and kilonewtons, N/m and N/mm, or tonnes and kilograms confused",
    1e6: "pascals and N/mm² confused, or tonnes and grams",
    1e9: "pascals and GPa confused",
    1e12: "N/mm² and N/m² with metres and millimetres confused",
    6894.757: "pounds per square inch and pascals confused",
    4.4482216: "pounds-force and newtons confused",
}
"""Ratios that stiffness over mass is off by when units are confused, beside those of masses."""


def _factor_named(factor: float) -> tuple[bool, str]:
    """Whether a unit makes all frequencies `factor` times as high, and what to do."""
    if min(abs(factor * 2 * np.pi - 1), abs(factor / (2 * np.pi) - 1)) < 0.01:
        return True, "A factor of 2 pi: rad/s are stated as Hz, or the time of the units is not the second"
    square, slips = factor**2, {**description.SLIPS, **STIFFER}
    named = next((words for slip, words in slips.items() if min(abs(square / slip - 1), abs(square * slip - 1)) < 0.03), "")
    words = named or "one modulus or density is wrong everywhere, by this factor or its inverse"
    over = f"Stiffness over mass is {square:.5g} times what it should be"
    return bool(named), f"{over}: {words}. Check `fe_model.units`, modulus and density"


def _lumped(model: Submitted) -> Iterator[tuple[str, Sparse]]:
    """The lumped masses that a program may have used instead of a consistent one."""
    from scipy.sparse import csr_array, diags_array

    labels, M = model.dofs.labels, model.mass
    if not len(labels) or model.reduced or M.count_nonzero() == np.count_nonzero(M.diagonal()):
        return
    moving, sums = labels[:, 1] <= 3, np.zeros(len(labels))
    for component in (1, 2, 3):
        along = labels[:, 1] == component
        sums[along] = np.asarray(M[along][:, along].sum(axis=1)).ravel()
    if np.all(sums[moving] >= 0):
        yield "its rows summed up on the diagonal, no rotary inertia", csr_array(diags_array(sums))
        yield "its rows summed up on the diagonal", csr_array(diags_array(np.where(moving, sums, M.diagonal())))
    scaled = np.zeros(len(labels))
    for component in (1, 2, 3):
        along = labels[:, 1] == component
        share = sums[along].sum() / max(M.diagonal()[along].sum(), 1e-300)
        scaled[along] = share * M.diagonal()[along]
        scaled[labels[:, 1] == component + 3] = share * M.diagonal()[labels[:, 1] == component + 3]
    yield "its diagonal scaled up to the whole mass", csr_array(diags_array(scaled))


def _listed(values: Array) -> str:
    return ", ".join(f"{value:.5g}" for value in values[:8]) + (" ..." if len(values) > 8 else "")


def enough_modes(shares: Array, highest: float, what: str) -> list[Finding]:
    """Too few modes, said for their `shares` (3,) of the mass along x, y, z and the frequency of the last one [Hz]."""
    worst = int(np.argmin(shares))
    amount = f"{100 * shares[worst]:.3g} % of the mass along {MOTIONS[worst]} up to {highest:.4g} Hz"
    remedy = "Keep modes up to twice the highest frequency of the test, or bring the residual of those left out"
    said = f"there are too few modes: {what}"
    return [Finding(check="too few modes", what=said, where="above the last mode", amount=amount, remedy=remedy)]


def reduction(model: Submitted) -> list[Finding]:
    """Do the modes of a Craig-Bampton model reach as far as it is meant for?

    Its mass as a rigid body is whole however few there are; so it is held against the stated frequencies, and without them it is
    enough that half of the mass takes part.
    """
    labels, T = model.dofs.labels, model.dofs.rigid
    generalised = np.flatnonzero(labels[:, 1:].ravel() == 0) if len(labels) else np.zeros(0, dtype=np.intp)
    k, m = model.stiffness.diagonal()[generalised], model.mass.diagonal()[generalised]
    if not generalised.size or not np.array_equal(generalised, model.free) or np.any(m <= 0) or np.any(k <= 0):
        return []
    L = (model.mass @ T)[generalised, :3] / np.sqrt(m)[:, None]
    shares = np.sum(L**2, axis=0) / np.maximum(np.diag(T.T @ (model.mass @ T))[:3], 1e-300)
    highest, stated = float(np.sqrt(np.max(k / m))) / (2 * np.pi), model.stated.frequencies
    if len(stated) and (len(stated) > len(generalised) or highest < stated[-1, 0]):
        return enough_modes(shares, highest, f"{len(stated)} frequencies up to {stated[-1, 0]:.4g} Hz are stated")
    return enough_modes(shares, highest, "half of the mass moves with none of them") if shares.mean() < HALF else []


# --- damping ----------------------------------------------------------------------------------------------------------------


def damping(model: Submitted) -> list[Finding]:
    """Do the damping matrices take energy out of every motion, and none of it out of a rigid one?"""
    found = []
    for name in ("viscous", "structural"):
        A = getattr(model, name)
        if A is None:
            continue
        diagonal = A.diagonal()
        negative = np.flatnonzero(diagonal < -1e-9 * np.abs(diagonal).max(initial=0.0))
        scaled = np.where(diagonal > 0, diagonal, np.maximum(np.abs(diagonal).max(initial=1e-300), 1e-300))
        moving, lowest = negative, float(diagonal.min(initial=0.0))
        if not negative.size:
            from scipy.sparse import diags_array

            some = np.flatnonzero(np.asarray(abs(A).sum(axis=1)).ravel() > 0)
            B = A[some][:, some] + 1e-6 * diags_array(scaled[some])
            if some.size and np.all(B.diagonal() > 0) and matrices.factored(B).negative:
                rows, lowest = _lowest_motion(B, True)
                moving = some[rows]
        if moving.size or lowest < -1e-5:
            what = f"the {name} damping feeds energy into a motion instead of taking it out"
            remedy = "Correct the sign of its entries: a damping matrix has no negative eigenvalue"
            amount = f"its lowest eigenvalue, on the scale of its diagonal, is {lowest:.3g}"
            found.append(Finding(check="damping", what=what, where=model.places_of(moving), amount=amount, remedy=remedy))
            continue
        if model.support == "ground" or not len(model.dofs.rigid):
            continue
        met, could = (np.abs(value).max(axis=0) for value in (A @ model.dofs.rigid, abs(A) @ np.abs(model.dofs.rigid)))
        share = met / np.maximum(could, np.finfo(np.float64).tiny)
        if share.max() > matrices.EXTERNAL:
            rows = np.argsort(-np.abs(A @ model.dofs.rigid)[:, int(np.argmax(share))])[:3]
            what = f"the {name} damping brakes rigid motions: dampers to the ground, or coordinates that do not belong to it"
            amount = f"{share.max():.2g} of its terms is left along {MOTIONS[int(np.argmax(share))]}"
            remedy = "Write the damping within the structure only"
            found.append(Finding(check="damping to ground", what=what, where=model.places_of(rows), amount=amount, remedy=remedy))
    return found


# --- modal data -------------------------------------------------------------------------------------------------------------


def modal(contents: description.Contents, described: description.Description) -> tuple[list[Finding], list[str]]:
    """What is wrong with modes that come as numbers, and what the arrays are that could not be looked at."""
    found: list[Finding] = []
    unread: list[str] = []
    u = described.units
    wanted = {"frequency": (-1,), "damping_ratio": (-1,), "participation": (6, -1), "rigid_mass": (6, 6)}
    read: dict[str, Array] = {}
    for name, shape in wanted.items():
        try:
            read[name] = contents.numbers(name, shape)
        except BadInput as error:
            found.append(refusal(error))
            unread.append(name)
    frequency, rigid, L = read.get("frequency"), read.get("rigid_mass"), read.get("participation")
    ratio = read.get("damping_ratio")
    if frequency is not None and len(frequency):
        for wrong, what in (
            (np.flatnonzero(frequency <= 0), "a frequency is not positive: with the base held no mode is at 0 Hz"),
            (np.flatnonzero(np.diff(frequency) < 0) + 1, "the frequencies do not ascend"),
        ):
            if wrong.size:
                amount = f"{frequency[wrong[0]]:.5g} Hz"
                remedy = "Sort frequency, damping_ratio and the columns of participation together"
                found.append(
                    Finding(check="order of modes", what=what, where=f"mode {wrong[0] + 1}", amount=amount, remedy=remedy)
                )
    if ratio is not None and np.any((ratio < 0) | (ratio >= 1)):
        wrong, feeds = np.flatnonzero((ratio < 0) | (ratio >= 1)), bool(np.any(ratio < 0))
        what = "a damping ratio of 1 and more: per cent are written for shares"
        if feeds:
            what = "a negative damping ratio feeds energy in"
        amount, where = f"{ratio[wrong[0]]:.4g} and {len(wrong) - 1} more", f"mode {wrong[0] + 1}"
        remedy = "Write the share of critical damping, 0.01 for 1 %"
        found.append(Finding(check="damping", what=what, where=where, amount=amount, remedy=remedy))
    if rigid is not None:
        rigid = rigid * np.outer(u.six, u.six) * u.mass
        about = (
            "Write the 6 x 6 mass about the reference point: products are matrix entries, Ixy = -∫xy dm; check the unit of length"
        )
        try:
            description.require_as_stated(description.require_rigid_body(rigid, contents.source, "rigid_mass", about), described)
        except BadInput as error:
            found.append(refusal(error))
            if error.field == "stated.mass" and "A factor of" in error.remedy:
                found[-1] = replace(found[-1], check="unit of mass")
    if rigid is not None and L is not None and np.all(np.diag(rigid) > 0):
        L = L * u.six[:, None] * np.sqrt(u.mass)
        shares = np.sum(L**2, axis=1) / np.diag(rigid)
        remedy = (
            "Write participation of modes normalised to unit modal mass, about the reference point, in the units of rigid_mass"
        )
        if np.any(shares > 1 + matrices.EXCESS):
            worst, turning = int(np.argmax(shares)), bool(np.all(shares[:3] <= 1 + matrices.EXCESS))
            what = "the modes carry more than the rigid mass" + (
                ", in rotations only: another reference point or unit of length"
                if turning
                else ": they are not normalised to unit modal mass"
            )
            amount = f"{shares[worst]:.5g} times the rigid mass along {MOTIONS[worst]}"
            found.append(
                Finding(check="participation", what=what, where=f"`participation`, row {worst + 1}", amount=amount, remedy=remedy)
            )
        elif shares[:3].max() < 1e-4:
            what = "the modes carry next to nothing: participation is in another unit than rigid_mass"
            amount = f"{shares[:3].max():.3g} of the mass at most"
            found.append(Finding(check="participation", what=what, where="`participation`", amount=amount, remedy=remedy))
        elif shares[:3].min() < ENOUGH and not np.any(np.asarray(contents.arrays.get("residual", 0.0))):
            highest = 0.0 if frequency is None else float(frequency.max(initial=0.0))
            found += enough_modes(shares[:3], highest, "how far those left out give way is missing")
    stated = described.stated.frequencies
    if frequency is not None and len(stated) and not _reproduced(frequency, stated):
        m = min(len(frequency), len(stated))
        factors = frequency[:m] / stated[:m, 0]
        constant = m > 1 and np.ptp(factors) < 0.02 * factors.mean()
        unit, remedy = _factor_named(float(factors.mean())) if constant else (False, "Find out which belong to this model")
        what = "the frequencies are not the stated ones"
        what += f": all of them are {factors.mean():.4g} times as high" if constant else ""
        amount = f"stated {_listed(stated[:, 0])} Hz; found {_listed(frequency[: len(stated)])} Hz"
        check = "unit of frequency" if unit else "frequencies"
        found.insert(0, Finding(check=check, what=what, where="`frequency`", amount=amount, remedy=remedy))
    return found, unread


def refusal(error: BadInput) -> Finding:
    """What a reader refuses, as a finding."""
    where = f"{error.source}: `{error.field}`"
    return Finding(check=error.field.partition("/")[0] or "file", what=error.problem, where=where, amount="", remedy=error.remedy)
