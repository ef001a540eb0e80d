"""OCC's solids: no two bodies share volume."""

from dataclasses import replace

import pytest
from numpy.testing import assert_allclose

from geometry import cad
from geometry.article import Article, placed
from geometry.articles import SETUPS, built_in
from geometry.cad import MM, solid
from geometry.frames import Pose


@pytest.mark.parametrize("name", SETUPS)
def test_no_two_bodies_of_a_set_up_overlap(name: str) -> None:
    assert cad.overlaps(built_in(name)) == {}


def test_an_overlap_is_found_and_measured() -> None:
    """A disc sunk by a millimetre into the cover plate shares what it displaces, counted by its solid area."""
    fmd, disc = built_in("fmd"), built_in("disc")
    sunk = placed(disc, Pose(position=[0, 0, 0.0445 - 0.0005]))
    both = Article(name="both", parts=fmd.parts + sunk.parts)
    (pair, shared), *rest = cad.overlaps(both).items()
    assert rest == []
    assert set(pair) == {"cover-plate", "plate"}
    plate = solid(disc.parts[0])
    assert shared == pytest.approx(plate.Volume() * MM**3 / 0.0145 * 0.001, rel=1e-6)


def test_uncounted_parts_are_looked_at_too() -> None:
    cuboid = built_in("cuboid")
    ghost = replace(cuboid.parts[0], name="ghost", counted=False)
    assert cad.overlaps(Article(name="two", parts=(*cuboid.parts, ghost)))


def test_uncounted_parts_have_no_inertia() -> None:
    fmd = built_in("fmd")
    counted = Article(name="fmd", parts=fmd.counted_parts)
    assert len(counted.parts) < len(fmd.parts)
    assert_allclose(cad.inertia(fmd).parameters, cad.inertia(counted).parameters, rtol=0)
