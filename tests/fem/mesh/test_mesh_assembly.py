"""STEP assemblies: a part a body, faces in contact bonded; held against the drawn article and the closed form."""

from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.modes import fixed_base
from fem.structure import Structure
from fem.user_model import reading
from geometry.errors import BadInput

HEAD = 'format = 1\n[fe_model]\nkind = "assembly"\nfile = "stack.step"\nsize = "40 mm"\n'
PARTS = '[fe_model.parts.plate]\nmaterial = "steel"\n[fe_model.parts.box]\nmaterial = "aluminium"\nloss_factor = 0.01\n'


@pytest.fixture(scope="module")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stack")
    assembly = cq.Assembly(name="stack")
    assembly.add(cq.Workplane().box(200, 200, 20, centered=(True, True, False)), name="plate")
    assembly.add(cq.Workplane().box(100, 100, 200, centered=(True, True, False)), name="box", loc=cq.Location((0, 0, 20)))
    assembly.export(str(folder / "stack.step"))
    return folder


def made(folder: Path, text: str) -> Structure:
    (folder / "stack.toml").write_text(text)
    found = reading.read(folder / "stack.toml")
    assert isinstance(found, Structure)
    return found


def test_bodies_are_parts_and_stand_on_their_lowest_plane(stack: Path) -> None:
    structure = made(stack, f'{HEAD}places.top = ["0 mm", "0 mm", "220 mm"]\n{PARTS}')
    masses = {name: share.sum() / 3 for name, share in structure.part_mass.items()}
    assert_allclose(masses["box"] / masses["plate"], 0.1 * 0.1 * 0.2 * 2700 / (0.2 * 0.2 * 0.02 * 7850), rtol=0.02)
    assert set(structure.part_stiffness) == {"plate", "box"}
    assert structure.loss_factors["box"] == 0.01
    whole = made(stack, HEAD.replace("[fe_model]", "[fe_model]\nloss_factor = 0.03") + PARTS)
    assert whole.loss_factors == {"plate": 0.03, "box": 0.01}  # what is written goes before a handbook's of steel
    assert_allclose(structure.points[np.unique(structure.held // 3), 2], 0, atol=1e-9)
    assert_allclose(structure.places["top"] @ structure.rigid[:, 3], [0, -0.22, 0], atol=1e-9)
    jointed = made(
        stack,
        f'{HEAD}{PARTS}[fe_model.joints.glue]\nbetween = ["plate", "box"]\nat = ["0 mm", "0 mm", "20 mm"]\n'
        f"stiffness = {['1e7 N/m'] * 3 + ['1e5 N m/rad'] * 3}\n",
    )
    assert jointed.joints == ("glue",)
    assert fixed_base(jointed, 1).frequency[0] < fixed_base(structure, 1).frequency[0]


def test_a_body_without_material_and_a_part_without_body_are_named(stack: Path) -> None:
    with pytest.raises(BadInput, match="1 of 2 bodies have no material: box"):
        made(stack, f'{HEAD}[fe_model.parts.plate]\nmaterial = "steel"\n')
    with pytest.raises(BadInput, match=r"stack.step holds no body 'bx'. Did you mean box\?"):
        made(stack, f'{HEAD}{PARTS}[fe_model.parts.bx]\nmaterial = "steel"\n')


@pytest.mark.proof  # three meshes; test_mesh_structure.py holds supports
def test_on_the_ground_an_assembly_is_clamped_where_it_would_stand_but_not_if_it_is_on_springs(stack: Path) -> None:
    driven = made(stack, HEAD + PARTS)
    clamped = made(stack, f'{HEAD}support = "ground"\n{PARTS}')
    assert_allclose(fixed_base(clamped, 2).frequency, fixed_base(driven, 2).frequency, rtol=1e-6)
    corners = [(x, y) for x in (-100, 100) for y in (-100, 100)]
    feet = "".join(
        f'[fe_model.springs.foot-{k}]\nat = ["{x} mm", "{y} mm", "0 mm"]\nstiffness = {["1e5 N/m"] * 3 + ["0 N m/rad"] * 3}\n'
        for k, (x, y) in enumerate(corners)
    )
    soft = made(stack, f'{HEAD}support = "ground"\n{PARTS}{feet}')
    up = np.sqrt(4e5 / sum(share.sum() / 3 for share in soft.part_mass.values())) / (2 * np.pi)
    assert np.min(np.abs(fixed_base(soft, 6).frequency / up - 1)) < 0.01
