"""How many nats a test is expected to give for the right one of two explanations, in closed form.

By explanation a the test reads A_a u + n, the tolerances within what the present data left of them: whitened and with the latent
inputs taken out, a Gaussian with mean m_a and covariance S_a = 1 + J C_a J^T. If a is true, it gains on b

    1/2 d^T S_b^-1 d ,        d = m_a - m_b ,

the part of their difference that b cannot take up by what it does not know (Lindley, Annals of Mathematical Statistics 27, 1956;
the mean of the logarithm of a ratio of Gaussians). With C = L L^T and N = J^T J everything is of the size of the parameters:

    d^T S^-1 d = d^T d - |K^-1/2 L^T J^T d|² ,    K = 1 + L^T N L .

What a itself does not know, 1/2 [tr S_b^-1 (S_a - S_b) + ln det S_b - ln det S_a], is left out. It is never negative, so that
the figure is a cautious one; and it would ask for J of both: at a narrow resonance no difference of J is small.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.elimination import Normal


def nats(difference: Normal, spread: Array) -> float:
    """Expected evidence against an explanation that knows its parameters as `spread` (p, s) L says.

    Parameters
    ----------
    difference : half |d|², J^T d (p,) and N (p, p) of how the right explanation differs from it
    """
    K = np.eye(spread.shape[1]) + spread.T @ difference.matrix @ spread
    taken_up = np.linalg.solve(np.linalg.cholesky(K), spread.T @ difference.gradient)
    return max(difference.cost - 0.5 * float(taken_up @ taken_up), 0.0)
