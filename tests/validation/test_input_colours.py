"""Expected and found shares are laid beside each other: an input keeps its colour."""

from identification.quality import TO_ADD
from validation.report.scenes.scene import OF_INPUTS, colours


def test_an_input_has_a_colour_of_its_own_whatever_stands_beside_it():
    first, second = colours(["noise", "elasticity", "mass_kg of scale.toml"]), colours(["elasticity", "tare"])
    assert first["elasticity"] == second["elasticity"]
    assert len(set(first.values())) == 3
    assert list(second) == ["elasticity", "tare"]
    assert set(TO_ADD) <= set(OF_INPUTS)
    assert len(set(OF_INPUTS.values())) == len(OF_INPUTS)
