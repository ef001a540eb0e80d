"""What evidence an effect is asked for."""

import pytest

from validation.effects.catalogue import FAMILIES
from validation.effects.worth import WORTH, WORTH_OF, worth


def test_a_limit_of_its_own_belongs_to_a_family_of_the_catalogue() -> None:
    assert set(WORTH_OF) <= set(FAMILIES)


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_every_family_is_asked_for_more_than_chance_and_less_than_a_clear_fault_brings(family: str) -> None:
    assert worth(family) == WORTH_OF.get(family, WORTH)
    assert 3.0 < worth(family) < 30.0


def test_a_loss_factor_is_asked_for_more_than_a_gain_and_a_modulus_for_less() -> None:
    assert worth("modulus") < worth("force-gain") < worth("cell-stiffness") < worth("structural-damping")
    assert worth("structural-damping") == worth("layer-damping")
    assert worth("an-effect-of-somebody") == WORTH
