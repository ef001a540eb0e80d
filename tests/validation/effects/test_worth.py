"""What evidence an effect is asked for."""

import pytest

from validation.effects.catalogue import FAMILIES
from validation.effects.effect import EVIDENCE_THRESHOLD, WORTH_OF, evidence_threshold


def test_a_limit_of_its_own_belongs_to_a_family_of_the_catalogue() -> None:
    assert set(WORTH_OF) <= set(FAMILIES)


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_every_family_is_asked_for_its_own_limit_or_the_common_one(family: str) -> None:
    assert evidence_threshold(family) == WORTH_OF.get(family, EVIDENCE_THRESHOLD)
    assert 3.0 < evidence_threshold(family) < 30.0  # more than 20 to 1, and within what a null or a clear fault brings


def test_a_loss_factor_is_asked_for_more_than_a_gain_and_a_modulus_for_less() -> None:
    assert (
        evidence_threshold("modulus")
        < evidence_threshold("force-gain")
        < evidence_threshold("cell-stiffness")
        < evidence_threshold("structural-damping")
    )
    assert evidence_threshold("structural-damping") == evidence_threshold("layer-damping")
    assert evidence_threshold("an-effect-of-somebody") == EVIDENCE_THRESHOLD
