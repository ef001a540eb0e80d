"""How many nats a test is expected to give for the right one of two explanations, in closed form.

By explanation a the test reads A_a u + n, the tolerances within what the present data left of them: whitened and with the latent
inputs taken out, a Gaussian with mean m_a and covariance S_a = 1 + J C_a J^T. If a is true, it gains on b

    KL(a | b) = 1/2 d^T S_b^-1 d + 1/2 [tr S_b^-1 (S_a - S_b) + ln det S_b - ln det S_a] ,     d = m_a - m_b ,

on average over the noise and over what is not known (Kullback & Leibler, Annals of Mathematical Statistics 22, 1951; as a utility
of experiments Lindley, ibid. 27, 1956). The first term is the difference that no tolerance can take up. With C = L L^T and
N = J^T J everything is of the size of the parameters:

    d^T S^-1 d = d^T d - |K^-1/2 L^T J^T d|² ,    K = 1 + L^T N L ,    ln det S = ln det K .

J is that of one of the two: what they differ in changes it in second order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.elimination import Normal


@dataclass(frozen=True, eq=False, kw_only=True)
class Side:
    """One explanation of a test.

    Attributes
    ----------
    spread : (p, s) L
    factor : (s, s) Cholesky factor of K
    logdet : ln det K
    """

    spread: Array
    factor: Array
    logdet: float


def side(matrix: Array, spread: Array) -> Side:
    """From N (p, p) and L (p, s)."""
    factor = np.asarray(np.linalg.cholesky(np.eye(spread.shape[1]) + spread.T @ matrix @ spread), dtype=np.float64)
    return Side(spread=spread, factor=factor, logdet=2 * float(np.sum(np.log(np.diag(factor)))))


def nats(difference: Normal, matrix: Array, right: Side, wrong: Side) -> float:
    """KL(right | wrong), from half |d|² and J^T d of their `difference` and N (p, p)."""
    taken_up = np.linalg.solve(wrong.factor, wrong.spread.T @ difference.gradient)
    told = difference.cost - 0.5 * float(taken_up @ taken_up)
    through = np.linalg.solve(wrong.factor, wrong.spread.T @ matrix)
    left = matrix - through.T @ through
    trace = float(np.sum((left @ right.spread) * right.spread) - np.sum((left @ wrong.spread) * wrong.spread))
    return max(told + 0.5 * (trace + wrong.logdet - right.logdet), 0.0)
