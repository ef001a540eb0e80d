"""Sections: shear coefficients, Saint-Venant torsion, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from fem.beam.elements import cowper_rectangle, cowper_tube, moduli, rectangle, rectangle_torsion, tube
from geometry.article import material
from geometry.errors import BadInput

STEEL = material("steel")


def test_cowpers_coefficients_are_those_he_prints() -> None:
    """Rectangle 5/6 and rod 6/7 without Poisson's effect; the thin tube 2 (1 + nu) / (4 + 3 nu)."""
    assert cowper_rectangle(0.0) == pytest.approx(5 / 6)
    assert cowper_tube(0.0, 0.0) == pytest.approx(6 / 7)
    assert cowper_tube(0.3, 1.0) == pytest.approx(2 * 1.3 / 4.9)
    assert cowper_tube(0.3, 0.0) == pytest.approx(0.886, abs=5e-4)
    assert cowper_rectangle(0.3) == pytest.approx(0.850, abs=5e-4)


def test_torsion_of_a_rectangle_meets_the_printed_table_and_the_thin_strip() -> None:
    """Timoshenko and Goodier's table for a/b = 1, 2, 10: J / (a b³) = 0.1406, 0.229, 0.312; thin: (1 - 0.63 b/a) / 3."""
    for ratio, printed in ((1, 0.1406), (2, 0.229), (10, 0.312)):
        assert rectangle_torsion(ratio, 1) / ratio == pytest.approx(printed, abs=5e-4)
    assert rectangle_torsion(30, 1) == pytest.approx(30 / 3 * (1 - 0.63 / 30), rel=1e-4)
    assert rectangle_torsion(2, 3) == rectangle_torsion(3, 2)


def test_rod_is_a_tube_without_a_bore_and_scales_with_the_fourth_power() -> None:
    small, large = tube(0.1, 0.0, STEEL), tube(0.2, 0.0, STEEL)
    assert large.bending_y / small.bending_y == pytest.approx(16)
    assert large.shear_y / small.shear_y == pytest.approx(4)
    assert small.torsion == pytest.approx(2 * small.bending_y * moduli(STEEL)[1] / moduli(STEEL)[0])


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("youngs_modulus", -1.0, "must be positive and finite, found -1 Pa"),
        ("youngs_modulus", 0.0, "must be positive and finite, found 0 Pa"),
        ("youngs_modulus", float("nan"), "must be positive and finite"),
        ("youngs_modulus", None, "is missing"),
        ("poisson_ratio", None, "is missing"),
        ("poisson_ratio", 0.5, "between -1 and 0.5, found 0.5"),
    ],
)
def test_material_that_makes_no_beam_is_refused(field: str, value: float | None, said: str) -> None:
    with pytest.raises(BadInput, match=said) as refused:
        rectangle(0.1, 0.01, replace(STEEL, **{field: value}))
    assert refused.value.field == field


def test_section_without_material_is_refused() -> None:
    for make in (lambda: rectangle(0.1, -0.01, STEEL), lambda: rectangle(np.nan, 0.1, STEEL)):
        with pytest.raises(BadInput, match="must be positive and finite"):
            make()
    with pytest.raises(BadInput, match=r"must lie between 0 and the outer diameter 0\.05 m, found 0\.06 m"):
        tube(0.05, 0.06, STEEL)
