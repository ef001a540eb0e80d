"""The library of materials and what it refuses."""

from typing import Any

import pytest

from geometry.article import Material, library, material
from geometry.errors import BadInput


@pytest.mark.parametrize("density", [0.0, -7850.0, float("nan"), float("inf")])
def test_a_density_that_no_material_has_is_refused_in_words(density: float) -> None:
    with pytest.raises(BadInput, match=r"material lead: `density`: .* found .* kg/m³\. Give it in kg/m³") as caught:
        Material(name="lead", density=density)
    assert (caught.value.source, caught.value.field) == ("material lead", "density")


def test_the_library_knows_what_the_articles_are_made_of_by_their_own_names() -> None:
    assert {"steel", "aluminium", "silicone"} <= set(library())
    assert all(entry.name == name for name, entry in library().items())
    assert material("steel").density == 7850.0
    assert material("steel").youngs_modulus == 207e9


def test_steel_is_the_heaviest_of_the_three_and_silicone_the_lightest() -> None:
    assert material("steel").density > material("aluminium").density > material("silicone").density


def test_an_unknown_material_is_refused_with_the_list_of_the_known() -> None:
    with pytest.raises(BadInput, match=r"parts\.toml: `material`: no material is called 'stel'.*aluminium.*steel"):
        material("stel", source="parts.toml")


def test_the_library_cannot_be_changed() -> None:
    entries: Any = library()
    with pytest.raises(TypeError):
        entries["steel"] = Material(name="steel", density=1.0)
