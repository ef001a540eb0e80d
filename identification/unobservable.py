"""Combinations of parameters that no channel ever shows.

The motion u is latent: what changes all channels as another motion would is not seen. With A = A0 + A1 H, dA_k the change by
parameter k and P the projector off the columns of A, a combination w is invisible where

    sum_k w_k P dA_k = 0          at every line and for all six motions,

and those are the null space of the Jacobian of the likelihood, whatever the runs were. All accelerometers and load cells of
one common gain, or coming late alike, are the plainest. Priors alone decide along such a combination; data cannot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.frames import Array
from identification.chain import Chain

INVISIBLE = 1e-9
"""What a combination of one tolerance in all may change, relative to the levels of the channels, and still be rounding."""

NEGLIGIBLE = 1e-6
"""Weight beside the largest one below which a parameter does not take part."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Combination:
    """Parameters that move together without a trace.

    Attributes
    ----------
    weights : by name, offset in the parameter's own unit for an offset 1 of the first one
    text : the same in words, whole families together
    """

    weights: Mapping[str, float]
    text: str


def unobservable(
    chain: Chain,
    theta: npt.ArrayLike,
    frequency: npt.ArrayLike,
    H: npt.ArrayLike,
    *,
    structure: Mapping[str, npt.ArrayLike] = MappingProxyType({}),
) -> tuple[Combination, ...]:
    """Independent combinations of the chain's parameters, and of what is unknown of the structure, that no channel shows.

    Parameters
    ----------
    theta : (p,) where the chain stands
    frequency : (n,) lines [Hz]
    H : (n, 6, 6) dynamic mass of what stands above the force plane
    structure : by name, (6, 6) or (n, 6, 6) change of H by one unit of something that is not known of it either; of a size like
        that of a tolerance. None where H is known, as in a tare
    """
    from scipy.linalg import qr

    J = jacobian(chain, theta, frequency, H, tuple(structure.values()))
    _, singular, Vt = np.linalg.svd(J, full_matrices=False)
    null = Vt[singular < INVISIBLE]
    if len(null):  # a basis of the same space that is read more easily: each vector has one parameter to itself, of weight 1
        _, _, order = qr(null, mode="economic", pivoting=True)
        null = np.linalg.solve(null[:, order[: len(null)]], null)
    names = (*(one.name for one in chain.parameters), *structure)
    units = np.concatenate([chain.tolerances, np.ones(len(structure))])
    return tuple(_combination(weights, units, names) for weights in null)


def jacobian(
    chain: Chain, theta: npt.ArrayLike, frequency: npt.ArrayLike, H: npt.ArrayLike, structure: Sequence[npt.ArrayLike] = ()
) -> Array:
    """Change of the channels by one tolerance of each parameter, relative to their levels, beyond all motions.

    Shape (2 n c 6, p + s), real above imaginary parts, for the six motions at their nominal levels each; padded with zero rows
    to at least p + s.
    """
    matrix = np.asarray(H, dtype=np.complex128)
    A0, A1 = chain.rows(theta, frequency)
    levels = np.array([LEVELS[axis] for axis in MOTIONS])
    A = (A0 + A1 @ matrix) * levels
    size = np.sqrt(np.mean(np.sum(np.abs(A) ** 2, axis=2), axis=0))[:, None]
    Q, _ = np.linalg.qr(A / size)
    off = np.eye(len(chain)) - Q @ Q.conj().transpose(0, 2, 1)
    found: list[ComplexArray] = []
    for one, tolerance in zip(chain.derivatives(theta, frequency, matrix), chain.tolerances, strict=True):
        chosen = list(one.channels)
        found.append(off[:, :, chosen] @ (tolerance * one.rows * levels / size[chosen]))
    found += [np.asarray(off @ ((A1 @ np.asarray(change)) * levels / size)) for change in structure]
    flat = np.array([change.ravel() for change in found]).reshape(len(found), -1).T
    J = np.vstack([flat.real, flat.imag]) / np.sqrt(max(len(A), 1))
    return np.vstack([J, np.zeros((max(0, J.shape[1] - J.shape[0]), J.shape[1]))])


def _combination(weights: Array, units: Array, names: Sequence[str]) -> Combination:
    least = NEGLIGIBLE * float(np.abs(weights).max())
    kept = {name: float(w * unit) for name, w, unit in zip(names, weights, units, strict=True) if abs(w) > least}
    first = next(iter(kept.values()))
    offsets = {name: w / first for name, w in kept.items()}
    # Families of which all take part alike as one, everything else by its name
    said: dict[str, str] = {}
    for name, weight in offsets.items():
        family = name.partition(":")[0]
        members = [one for one in names if one.partition(":")[0] == family]
        alike = all(abs(offsets.get(one, 0.0) - weight) < NEGLIGIBLE * abs(weight) for one in members)
        whole = alike and len(members) > 1
        said[family if whole else name] = f"{weight:+.3g} {f'{family} (all {len(members)})' if whole else name}"
    return Combination(weights=MappingProxyType(offsets), text=" ".join(said.values()))
