"""Normal equations of one run where most parameters are seen through the same few quantities, and most others in one channel.

With the inputs' directions Q, the whitened rows W T of what the channels read of these j quantities, and (1 - Q Q^H) W T = O R,
a parameter that moves the quantities by z moves the residual by O R z: of j numbers a line instead of one for every channel. What
is left of another's V beside the inputs meets it in O^H V alone,

    y = R z:    y^H y ,      y^H (O^H V) ,      V^H V - (Q^H V)^H (Q^H V) ,

and of the last the products of parameters of different channels are those of Q^H V.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from geometry.arrays import Array, Integers
from geometry.dynamic_mass import ComplexArray
from identification.self_calibration.elimination import Normal
from validation.engine.prediction import Change, Conveyed

FEW = 24
"""Up to so many parameters of several channels that go no common way it is the quicker."""


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


def ways(changes: Mapping[str, Change | Conveyed], names: Sequence[str], count: int) -> Ways | None:
    """Of the parameters `names` of a prediction of `count` channels; None where most go ways of their own."""
    moves = [changes[name] for name in names]
    seen = Counter(id(one.through) for one in moves if isinstance(one, Conveyed))
    if not seen:
        return None
    ((way, _),) = seen.most_common(1)
    common = [k for k, one in enumerate(moves) if isinstance(one, Conveyed) and id(one.through) == way]
    rest = [k for k in range(len(moves)) if k not in set(common)]
    single = [k for k in rest if len(moves[k].channels) == 1]
    others = [k for k in rest if len(moves[k].channels) != 1]
    if len(others) > FEW or any(moves[k].rows.ndim != 3 for k in rest):
        return None
    conveyed = [one for k in common if isinstance(one := moves[k], Conveyed)]
    through, quantities = conveyed[0].through, np.stack([one.quantities for one in conveyed], axis=1)
    lines, inputs = len(through), quantities.shape[-1]
    whole = np.zeros((len(others), lines, count, inputs), dtype=np.complex128)
    for place, k in enumerate(others):
        whole[place][:, moves[k].channels] = moves[k].rows
    own = [np.broadcast_to(moves[k].rows[:, 0], (lines, inputs)) for k in single]
    return Ways(
        count=len(moves),
        channels=np.array(conveyed[0].channels, dtype=np.int64),
        through=through,
        common=np.array(common, dtype=np.int64),
        quantities=quantities,
        single=np.array(single, dtype=np.int64),
        at=np.array([moves[k].channels[0] for k in single], dtype=np.int64),
        rows=np.array(own, dtype=np.complex128).reshape(len(single), lines, inputs),
        others=np.array(others, dtype=np.int64),
        whole=whole,
    )


def normal(of: Ways, r: ComplexArray, Q: ComplexArray | None, u: ComplexArray, w: Array) -> Normal:
    """Of one run, from its residual (m, c), the directions (m, c, k) of its inputs, these (m, k), and weights (m, c)."""
    O, R = _beside_inputs(of, Q, w)
    y = _conveyed(of, u) @ R.transpose(0, 2, 1)
    single = w[:, of.at].T * np.sum(of.rows * u, axis=-1)
    whole = w * (of.whole @ u[..., None])[..., 0]
    met = np.concatenate([_met(O, single, of.at), _met_by_all(O, whole)])
    matrix, gradient = np.empty((of.count, of.count)), np.empty(of.count)
    common, rest = as_real(y.transpose(1, 0, 2)), as_real(met)
    apart = np.concatenate([of.single, of.others])
    matrix[np.ix_(of.common, of.common)] = common @ common.T
    matrix[np.ix_(of.common, apart)] = both = common @ rest.T
    matrix[np.ix_(apart, of.common)] = both.T
    matrix[np.ix_(apart, apart)] = _apart(of, single, whole, Q)
    gradient[of.common] = -(common @ as_real((O.conj().transpose(0, 2, 1) @ r[..., None])[None, ..., 0])[0])
    gradient[of.single] = -np.sum((single.conj() * r.T[of.at]).real, axis=1)
    gradient[of.others] = -np.sum((whole.conj() * r).real, axis=(1, 2))
    return Normal(cost=0.5 * float(np.sum(np.square(np.abs(r)))), gradient=gradient, matrix=matrix)


def _beside_inputs(of: Ways, Q: ComplexArray | None, w: Array) -> tuple[ComplexArray, ComplexArray]:
    """O (m, c, j) and R (m, j, j)."""
    T = np.zeros((*w.shape, of.through.shape[2]), dtype=np.complex128)
    T[:, of.channels] = w[:, of.channels, None] * of.through
    O, R = np.linalg.qr(T if Q is None else T - Q @ (Q.conj().transpose(0, 2, 1) @ T))
    return np.asarray(O), np.asarray(R)


def _conveyed(of: Ways, u: ComplexArray) -> ComplexArray:
    """(m, a, j) what the common parameters move the quantities by."""
    m, a, j, k = of.quantities.shape
    return np.asarray((of.quantities.reshape(m, a * j, k) @ u[..., None]).reshape(m, a, j))


def _met(directions: ComplexArray, single: ComplexArray, at: Integers) -> ComplexArray:
    """(b, m, q) directions (m, c, q) met by what is in the one channel `at` of each."""
    return np.asarray(directions.conj().transpose(1, 0, 2)[at] * single[..., None])


def _met_by_all(directions: ComplexArray, whole: ComplexArray) -> ComplexArray:
    """(d, m, q) the same of what is in all channels (d, m, c)."""
    return np.asarray((whole.transpose(1, 0, 2) @ directions.conj()).transpose(1, 0, 2))


def _apart(of: Ways, single: ComplexArray, whole: ComplexArray, Q: ComplexArray | None) -> Array:
    """(b + d, b + d) the products of the parameters that go no common way."""
    b = len(single)
    matrix = np.zeros((b + len(whole), b + len(whole)))
    one = as_real(single)
    matrix[:b, :b] = (one @ one.T) * (of.at[:, None] == of.at)
    if len(whole):
        flat = as_real(whole)
        matrix[b:, b:] = flat @ flat.T
        matrix[b:, :b] = np.sum((whole[:, :, of.at].transpose(0, 2, 1).conj() * single).real, axis=-1)
        matrix[:b, b:] = matrix[b:, :b].T
    if Q is not None:
        along = as_real(np.concatenate([_met(Q, single, of.at), _met_by_all(Q, whole)]))
        matrix -= along @ along.T
    return matrix


def as_real(V: ComplexArray) -> Array:
    """(p, ...) complex as (p, 2 ...) real."""
    return np.asarray(np.ascontiguousarray(V).reshape(len(V), prod(V.shape[1:])).view(np.float64))
