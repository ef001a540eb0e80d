"""An explanation without linearising, and the same in the time domain: records of another code path, read the same way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.frames import Array
from table_2_parts import forward, reading, ways
from table_2_parts.candidates import Candidate
from table_2_parts.forward import Test
from table_2_parts.inference import Explanation, covariance
from table_2_parts.published import DEVIATIONS, deviation_of_reading, seven
from table_2_parts.ways import answer
from validation.effects.catalogue import Named

ROUNDS = 4
"""Of Newton's way with the derivatives of the start: the map is so nearly linear that the third changes no printed digit."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Refined:
    """An explanation at its most probable point.

    Attributes
    ----------
    of : it
    sizes : (k,) of its faults
    alone : (7,) deviations of its faults in a laboratory without tolerances
    whole : (7,) with the tolerances where they are most probable
    price : sum of squares of these tolerances, in standard deviations
    chi2 : of Table 2 with the faults alone, tolerances and reference as noise; 7 degrees of freedom less the sizes
    """

    of: Explanation
    sizes: Array
    alone: Array
    whole: Array
    price: float
    chi2: float

    @property
    def left(self) -> Array:
        """(7,) Table 2 less `whole`, in standard deviations of reference and rounding."""
        return np.asarray((DEVIATIONS - self.whole) / deviation_of_reading())


def refined(of: Explanation) -> Refined:
    """The most probable sizes and tolerances of `of`: linearised at the start, the deviations exact in every round."""
    known = answer(of.way)
    columns = [known.candidates.index(one) for one in of.faults]
    J = np.column_stack([known.tolerances, known.effects[:, columns]])
    mean = np.concatenate([np.zeros(len(known.names)), [-1.0 if one.switch else 0.0 for one in of.faults]])
    variance = np.concatenate([np.ones(len(known.names)), [0.0 if one.switch else one.plausible**2 for one in of.faults]])
    gain = (variance[:, None] * J.T) @ np.linalg.inv(J @ (variance[:, None] * J.T) + np.diag(deviation_of_reading() ** 2))
    at = np.concatenate([np.zeros(len(known.names)), of.sizes])
    for _ in range(ROUNDS):
        found = _deviations(of, at)
        at = mean + gain @ (DEVIATIONS - found + J @ (at - mean))
    sizes = at[len(known.names) :]
    alone = ways.exact(of.way, sized(of.faults, sizes))
    off = DEVIATIONS - alone
    return Refined(
        of=of,
        sizes=sizes,
        alone=alone,
        whole=_deviations(of, at),
        price=float(np.sum(at[: len(known.names)] ** 2)),
        chi2=float(off @ np.linalg.solve(covariance(known), off)),
    )


def _deviations(of: Explanation, at: Array) -> Array:
    """(7,) at tolerances and sizes `at`; disc and Cuboid are not of the prediction, and enter by their derivative."""
    known = answer(of.way)
    by_name = dict(zip(known.names, at, strict=False))
    offsets = {name: by_name[name] * one for name, one in forward.tolerances(of.way.tests).items()}
    outside = [k for k, name in enumerate(known.names) if name not in offsets]
    inside = ways.exact(of.way, sized(of.faults, at[len(known.names) :]), offsets)
    return np.asarray(inside + known.tolerances[:, outside] @ at[outside])


def sized(faults: Sequence[Candidate], sizes: Array) -> tuple[Named, ...]:
    """`faults` at their `sizes` (k,)."""
    return tuple(one.sized(float(size)) for one, size in zip(faults, sizes, strict=True))


def recorded(of: Refined) -> Array:
    """(7,) of the faults of `of` alone, from records: simulated in time by the virtual shaker, read the same way."""
    tens = [of_records(test, sized(of.of.faults, of.sizes)) for test in of.of.way.tests]
    return seven(ways.article(tens[1] - tens[0]))


def of_records(test: Test, effects: Sequence[Named]) -> Array:
    """(10,) about F of `test` with these `effects`, from records."""
    from identification.spectra.of_campaign import spectra
    from validation.virtual_test.plan import BEAM, RIGID, Plan, exact
    from validation.virtual_test.planted import planted, reaching
    from validation.virtual_test.simulate import simulate

    plan = Plan(
        article=test.article,
        model=BEAM if test.stop else RIGID,
        band=SWEPT,
        octaves_per_minute=RATE,
        simulation_rate=SIMULATED,
        ringing=RINGING,
    )
    there = reaching(forward.there(test, effects), plan)
    campaign = simulate(replace(exact(plan), effects=planted(there))).campaign
    return reading.ten(spectra(campaign, frequency=forward.lines(test)), test.rows)


SWEPT, RATE, SIMULATED, RINGING = (3.5, 7.0), 8.0, 3384.0, 1e-3
"""Band [Hz] and rate [octaves a minute] of the sweeps that are simulated, rate [Hz] of the simulation, share of the load that
still rings at the end: quicker than the virtual shaker's own, and good to a hundredth of a per cent below 5 Hz."""
