"""A problem is the union of its data sets, which must agree about what they share."""

from dataclasses import replace

import numpy as np
import pytest

from validation.estimation.problem import AT_MOST, Problem, chosen


def test_parameters_of_the_same_name_are_one(lab):
    one, two = lab.toy({}, name="one"), lab.toy({}, name="two", seed=1)
    names = [p.name for p in Problem((one, two)).parameters]
    assert names == [*(p.name for p in one.parameters), "frequency:two"]


@pytest.mark.parametrize(
    "change", [{"tolerance": 0.1}, {"kind": "sensor"}, {"nominal": 7.0}, {"logarithmic": False}, {"unit": "g"}, {"within": 1.0}]
)
def test_two_data_sets_that_disagree_about_a_parameter_are_both_named(lab, change):
    mass, *rest = lab.LABORATORY
    one, two = lab.toy({}, name="one"), lab.toy({}, name="two", parameters=(replace(mass, **change), *rest))
    with pytest.raises(ValueError, match=rf"'mass'.*{next(iter(change))}.* in one and .* in two"):
        Problem((one, two))


def test_facts_share_the_parameters_too(lab):
    class Weight:
        name = "weight of the article"
        parameters = (replace(lab.LABORATORY[0], tolerance=0.2),)

        def residual(self, offsets):
            return 0.0, {}

    with pytest.raises(ValueError, match=r"in one and 0\.2 in weight of the article"):
        Problem((lab.toy({}, name="one"),), (Weight(),))


def test_two_data_sets_of_one_name_are_refused(lab):
    with pytest.raises(ValueError, match="'one' twice"):
        Problem((lab.toy({}, name="one"), lab.toy({}, name="one", seed=3)))


def test_lines_are_thinned_by_the_data_alone_and_denser_where_they_turn(lab):
    """The same lines whatever the model, so that parent and child are compared on the same data."""
    toy = lab.toy({}, lines=800, motion=(1.0, 0.1))
    lines = chosen(toy.measured)
    assert len(lines) <= AT_MOST
    assert np.all(np.diff(lines) > 0)
    assert (lines[0], lines[-1]) == (0, 799)
    f = toy.measured.frequency
    assert np.diff(f[lines])[np.abs(f[lines][:-1] - 12.0) < 1.0].mean() < 0.6 * np.diff(f[lines])[f[lines][:-1] > 20.0].mean()
    other = replace(toy, parameters=(*toy.parameters, lab.effect("offset", 1.0, start=3.0)))
    np.testing.assert_array_equal(Problem((other,)).thinned().lines["one"], Problem((toy,)).thinned().lines["one"])


def test_few_lines_stay_as_they_are(lab):
    np.testing.assert_array_equal(chosen(lab.toy({}, lines=60).measured), np.arange(60))


def test_stages_before_the_last_take_fewer_lines_where_enough_are_left(lab):
    problem = Problem((lab.toy({}, lines=60), lab.toy({}, name="two", lines=59)))
    lines = problem.sparser(3).lines
    np.testing.assert_array_equal(lines["one"], np.arange(0, 60, 3))
    np.testing.assert_array_equal(lines["two"], np.arange(59))
