"""What evidence an effect is asked for."""

import pytest

from validation.effects.catalogue import FAMILIES
from validation.effects.worth import WORTH, WORTH_OF, worth


def test_a_limit_of_its_own_belongs_to_a_family_of_the_catalogue() -> None:
    assert set(WORTH_OF) <= set(FAMILIES)


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_every_family_is_asked_for_its_own_limit_or_the_common_one(family: str) -> None:
    assert worth(family) == WORTH_OF.get(family, WORTH)
    assert 3.0 < worth(family) < 30.0  # more than 20 to 1, and within what a null or a clear fault brings


def test_a_loss_factor_is_asked_for_more_than_a_gain_and_a_modulus_for_less() -> None:
    assert worth("modulus") < worth("force-gain") < worth("cell-stiffness") < worth("structural-damping")
    assert worth("structural-damping") == worth("layer-damping")
    assert worth("an-effect-of-somebody") == WORTH
