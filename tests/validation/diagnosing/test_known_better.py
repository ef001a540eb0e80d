"""What is known better now: tolerances that data narrow and that do not stand at their nominal; never what is identified."""

import math
from dataclasses import replace

import numpy as np

from identification.parameter import Parameter
from validation.diagnose.diagnosis import KnownBetter
from validation.estimation.problem import EFFECT, IDENTIFIED, SENSOR, Fit
from validation.output import from_json, to_json

PLANE = Parameter(name="force-plane-offset:x", unit="m", tolerance=2.5e-4, kind=SENSOR)


def fitted(*told: tuple[Parameter, float, float]) -> Fit:
    parameters, offsets, spread = zip(*told, strict=True)
    return Fit(
        parameters=parameters,
        offsets=np.array(offsets),
        covariance=np.diag(np.square(spread)),
        cost=0.0,
        chi2=0.0,
        degrees_of_freedom=1,
        tolerance_z2=0.0,
        tolerances=len(told),
        log_evidence=0.0,
        converged=True,
    )


def named(of: Parameter, name: str, **changes: str) -> Parameter:
    return replace(of, name=name, **changes)


def test_what_data_narrow_and_is_not_as_stated_is_a_calibration():
    found = KnownBetter.of(
        fitted(
            (PLANE, 2.4e-4, 4e-5),
            (named(PLANE, "narrow-enough"), -2.4e-4, 1.0e-4),
            (named(PLANE, "too-wide"), 5e-4, 1.6e-4),
            (named(PLANE, "as-stated"), 5e-5, 4e-5),
            (named(PLANE, "an-effect", kind=EFFECT), 2.4e-4, 4e-5),
            (named(PLANE, "identified", kind=IDENTIFIED), 2.4e-4, 4e-5),
            (named(PLANE, "held"), 2.4e-4, 0.0),
        )
    )
    assert [one.id for one in found] == ["force-plane-offset:x", "narrow-enough"]
    (first, _) = found
    np.testing.assert_allclose([first.low, first.high], 2.4e-4 + np.array([-1, 1]) * 1.6449 * 4e-5, rtol=1e-3)
    assert first.before == PLANE.tolerance
    assert from_json(KnownBetter, to_json(first)) == first


def test_a_logarithm_is_told_as_what_it_means_and_correct_knows_its_families():
    cell = Parameter(name="cell-stiffness:1x", unit="1", tolerance=0.1, kind=SENSOR, nominal=1.0, logarithmic=True, above=-1.0)
    gain = Parameter(name="force-gain:fmd-z2", unit="1", tolerance=0.01, kind=SENSOR)
    stiff, loud = sorted(KnownBetter.of(fitted((cell, 0.1, 0.01), (gain, 0.008, 0.001))), key=lambda one: one.id)
    assert (stiff.correctable, loud.correctable) == (False, True)
    np.testing.assert_allclose(stiff.value, np.expm1(0.1))


def test_a_factor_that_data_do_not_tell_is_without_bound_and_no_error() -> None:
    """The end of an interval: twice a thousand standard deviations of a logarithm is more than any number holds."""
    one = Parameter(name="modulus:wall", unit="1", tolerance=0.1, nominal=1.0, logarithmic=True, above=-1.0)
    assert (one.value(2000.0), one.slope(2000.0), one.value(-2000.0)) == (math.inf, math.inf, -1.0)
