"""Normal equations of one run where most parameters are seen through the same few quantities, and most others in one channel.

With the inputs' directions Q and whitened rows W T of what the channels read of these j quantities, B = (1 - Q Q^H) W T, a
parameter that moves the quantities by z moves the residual by B z: of j numbers a line instead of one for every channel. What
is left of another's V beside the inputs meets it in B^H V alone,

    z^H (B^H B) z ,      z^H (B^H V) ,      V^H V - (Q^H V)^H (Q^H V) ,

and of the last the products of parameters of different channels are those of Q^H V.
"""

from dataclasses import dataclass

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, Integers
from identification.self_calibration import solve
from identification.self_calibration.solve import Normal


@dataclass(frozen=True, eq=False, kw_only=True)
class Ways:
    """The parameters of one prediction by how channels see them, each by index.

    Attributes
    ----------
    count : of all parameters
    channels : (l,) that see the quantities
    through : (m, l, j)
    common : (a,) parameters that move the quantities
    quantities : (m, a, j, k)
    single : (b,) parameters that move one channel
    at : (b,) that channel
    rows : (b, m, k)
    others : (d,) all others
    whole : (d, m, c, k) their rows, zeros where they change nothing
    """

    count: int
    channels: Integers
    through: ComplexArray
    common: Integers
    quantities: ComplexArray
    single: Integers
    at: Integers
    rows: ComplexArray
    others: Integers
    whole: ComplexArray


def normal(of: Ways, r: ComplexArray, Q: ComplexArray | None, u: ComplexArray, w: Array) -> Normal:
    """Of one run, from its residual (m, c), the directions (m, c, k) of its inputs, these (m, k), and weights (m, c)."""
    # B (m, c, j), what the quantities do beside the inputs, and z (m, a, j), what the common parameters move them by
    T = np.zeros((*w.shape, of.through.shape[2]), dtype=np.complex128)
    T[:, of.channels] = w[:, of.channels, None] * of.through
    B = T if Q is None else T - Q @ (Q.conj().transpose(0, 2, 1) @ T)
    m, a, j, k = of.quantities.shape
    z = (of.quantities.reshape(m, a * j, k) @ u[..., None]).reshape(m, a, j)
    single = w[:, of.at].T * np.einsum("bmk,mk->bm", of.rows, u)
    whole = w * (of.whole @ u[..., None])[..., 0]
    met = np.concatenate([_met(B, single, of.at), _met_by_all(B, whole)])
    matrix, gradient = np.empty((of.count, of.count)), np.empty(of.count)
    across = z @ (B.conj().transpose(0, 2, 1) @ B).transpose(0, 2, 1)
    common, rest = solve.as_real(z.transpose(1, 0, 2)), solve.as_real(met)
    apart = np.concatenate([of.single, of.others])
    matrix[np.ix_(of.common, of.common)] = common @ solve.as_real(across.transpose(1, 0, 2)).T
    matrix[np.ix_(of.common, apart)] = both = common @ rest.T
    matrix[np.ix_(apart, of.common)] = both.T
    # (b + d, b + d) the products of the parameters that go no common way
    b = len(single)
    apart_matrix = np.zeros((b + len(whole), b + len(whole)))
    one = solve.as_real(single)
    apart_matrix[:b, :b] = (one @ one.T) * (of.at[:, None] == of.at)
    if len(whole):
        flat = solve.as_real(whole)
        apart_matrix[b:, b:] = flat @ flat.T
        for channel in np.unique(of.at):
            own = np.flatnonzero(of.at == channel)
            apart_matrix[b:, own] = solve.as_real(whole[:, :, channel]) @ one[own].T
        apart_matrix[:b, b:] = apart_matrix[b:, :b].T
    if Q is not None:
        along = solve.as_real(np.concatenate([_met(Q, single, of.at), _met_by_all(Q, whole)]))
        apart_matrix -= along @ along.T
    matrix[np.ix_(apart, apart)] = apart_matrix
    gradient[of.common] = -(common @ solve.as_real((B.conj().transpose(0, 2, 1) @ r[..., None])[None, ..., 0])[0])
    gradient[of.single] = -np.sum((single.conj() * r.T[of.at]).real, axis=1)
    gradient[of.others] = -np.sum((whole.conj() * r).real, axis=(1, 2))
    return Normal(cost=0.5 * float(np.sum(np.square(np.abs(r)))), gradient=gradient, matrix=matrix)


def _met(directions: ComplexArray, single: ComplexArray, at: Integers) -> ComplexArray:
    """(b, m, q) directions (m, c, q) met by what is in the one channel `at` of each."""
    return np.asarray(directions.conj().transpose(1, 0, 2)[at] * single[..., None])


def _met_by_all(directions: ComplexArray, whole: ComplexArray) -> ComplexArray:
    """(d, m, q) the same of what is in all channels (d, m, c)."""
    return np.asarray((whole.transpose(1, 0, 2) @ directions.conj()).transpose(1, 0, 2))
