"""A user's own article: figures against closed forms and a CAD's own, and every refusal with its evidence."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
import yaml
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
from geometry.user_article import UserArticle, agreement, inertias, load

TOOLS = "workshop_tools"


def box_inertia(mass: float, size: tuple[float, ...], cog: tuple[float, ...]) -> Inertia:
    a, b, c = size
    return Inertia.from_cog(mass, cog, mass / 12 * np.diag([b**2 + c**2, a**2 + c**2, a**2 + b**2]))


def write_box(path: Path, size=(160.0, 70.0, 400.0), centre=(0.0, 0.0, 0.0), comment: bytes = b"") -> Path:
    """A box in the numbers of the file, with a comment where the format has one."""
    solid = trimesh.creation.box(size)
    solid.apply_translation(centre)
    content = solid.export(file_type=path.suffix[1:].lower())
    content = content.encode() if isinstance(content, str) else content
    if path.suffix.lower() == ".ply":
        content = re.sub(rb"^(format .*)$", rb"\1\ncomment " + comment, content, count=1, flags=re.MULTILINE)
    if path.suffix.lower() == ".obj":
        content = b"# " + comment + b"\n" + content
    if path.suffix.lower() == ".stl":
        content = comment.ljust(80)[:80] + content[80:]
    path.write_bytes(content)
    return path


def refused(*arguments: object, **options: str) -> BadInput:
    with pytest.raises(BadInput) as caught:
        load(*arguments, **options)
    assert caught.value.remedy
    return caught.value


def described(folder: Path, text: str) -> Path:
    path = folder / "article.toml"
    path.write_text(text, encoding="utf-8")
    return path


def one_part(folder: Path, **fields: str) -> Path:
    """An ``article.toml`` with one part, `fields` written as TOML values over good ones, None to leave one out."""
    write_box(folder / "block.stl")
    good = {"name": '"block"', "file": '"block.stl"', "unit": '"mm"', "material": '"aluminium"'}
    rows = [f"{key} = {value}" for key, value in {**good, **fields}.items() if value]
    return described(folder, "\n".join(["format = 1", "[[part]]", *rows]) + "\n")


@pytest.mark.parametrize("ending", [".stl", ".PLY", ".Obj", ".STL"])
@pytest.mark.parametrize(
    ("unit", "metres"), [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("in", 0.0254), ("ft", 0.3048), ("Inches", 0.0254)]
)
def test_a_box_in_any_format_and_unit_is_the_box_of_the_textbook(tmp_path: Path, ending: str, unit: str, metres: float) -> None:
    size = tuple(value / metres for value in (0.16, 0.07, 0.4))
    article = load(write_box(tmp_path / f"block{ending}", size, (0.0, 0.0, size[2] / 2)), unit=unit, material="aluminium")
    expected = box_inertia(2700 * 0.16 * 0.07 * 0.4, (0.16, 0.07, 0.4), (0.0, 0.0, 0.2))
    assert article.warnings == ()
    # files hold single precision (STL) or about seven digits (OBJ)
    assert_allclose(inertias(article)["trimesh"].parameters, expected.parameters, rtol=1e-6, atol=1e-8)
    assert agreement(article, inertias(article)).agree


def test_a_missing_unit_is_refused_and_one_that_the_file_states_is_believed(tmp_path: Path) -> None:
    for ending in (".stl", ".ply", ".obj"):
        assert "does not say in which unit" in refused(write_box(tmp_path / f"a{ending}"), material="steel").problem
        stated = write_box(tmp_path / f"b{ending}", comment=b"made by a CAD, length unit = millimeters")
        assert_allclose(inertias(load(stated, material="steel"))["trimesh"].mass, 7850 * 0.16 * 0.07 * 0.4, rtol=1e-6)


def test_a_unit_that_contradicts_the_file_is_refused_with_both(tmp_path: Path) -> None:
    problem = refused(write_box(tmp_path / "b.ply", comment=b"length unit = millimeters"), unit="in", material="steel").problem
    assert problem == "the unit given is in, but the file says of itself that its unit is millimeters"


def test_an_unknown_unit_is_refused_with_the_nearest(tmp_path: Path) -> None:
    error = refused(write_box(tmp_path / "b.stl"), unit="millimetrs", material="steel")
    assert error.field == "unit"
    assert error.remedy == "Did you mean millimetres? Give one of mm, cm, m, in, ft"
    assert "'furlong'" in refused(write_box(tmp_path / "b.stl"), unit="furlong", material="steel").problem


@pytest.mark.parametrize(
    ("scale", "unit", "text"),
    [
        (1.0, "m", "with unit m it is 400 m long, which is suspicious; in mm or cm it would be of ordinary size"),
        (1.0, "ft", "121.9 m long"),
        (1e-3, "mm", "0.0004 m long, which is suspicious; in m or in or ft it would be of ordinary size"),
    ],
)
def test_a_suspicious_size_is_said_but_the_user_may_insist(tmp_path: Path, scale: float, unit: str, text: str) -> None:
    size = (160.0 * scale, 70.0 * scale, 400.0 * scale)
    article = load(write_box(tmp_path / "block.stl", size), unit=unit, material="aluminium")
    (warning,) = article.warnings
    assert text in warning
    assert inertias(article)["trimesh"].mass > 0


def test_materials_are_names_or_densities(tmp_path: Path) -> None:
    block, volume = write_box(tmp_path / "block.stl"), 0.16 * 0.07 * 0.4
    for text, density in (("steel", 7850), ("7800 kg/m^3", 7800), ("7.8 g/cm^3", 7800), ("0.1 lb/in^3", 2767.990)):
        assert_allclose(inertias(load(block, unit="mm", material=text))["trimesh"].mass, density * volume, rtol=1e-6)


@pytest.mark.parametrize(
    ("material", "problem"),
    [
        (None, "no material is given"),
        ("steal", "no material is called 'steal'"),
        ("-7800 kg/m^3", "a density must be positive and finite, found '-7800 kg/m^3'"),
        ("0 kg/m^3", "a density must be positive and finite"),
        ("7800", "a density needs its unit, found '7800'"),
        ("7800 kg", "'kg' is a mass, where a density should be"),
        ("7800 kg/m^3 (", "a density cannot be read from"),
        ("7800 +/- 10 kg/m^3", "no tolerance of a density is carried on"),
    ],
)
def test_a_missing_or_bad_material_is_refused(tmp_path: Path, material: str, problem: str) -> None:
    assert problem in refused(write_box(tmp_path / "block.stl"), unit="mm", material=material).problem


def test_what_is_no_mesh_is_refused(tmp_path: Path) -> None:
    junk = b"ply\nformat nonsense\nelement vertex many\nend_header\n\x00\x01"
    meshes = {"a.stl": b"hello", "b.ply": b"ply\nnot", "c.obj": b"v 1 2 x\nf 1 1 1", "d.stl": b"", "e.ply": junk}
    meshes |= {"f.stl": bytes(range(200)), "g.obj": b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}
    for name, content in meshes.items():
        (tmp_path / name).write_bytes(content)
        problem = refused(tmp_path / name, unit="mm", material="steel").problem
        assert "no mesh can be read from it as" in problem
        assert "Error" not in problem
    (tmp_path / "nan.obj").write_text("v 0 0 nan\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n", encoding="utf-8")
    assert "1 of its 4 vertices are not finite" in refused(tmp_path / "nan.obj", unit="mm", material="steel").problem
    (tmp_path / "a.step2").write_text("", encoding="utf-8")
    assert "a file that ends in .step2 cannot be read" in refused(tmp_path / "a.step2").problem
    assert "no such file" in refused(tmp_path / "absent.stl").problem


def test_a_pointer_in_place_of_a_file_is_said_to_be_one_and_a_last_line_that_is_missing_takes_no_face_away(
    tmp_path: Path,
) -> None:
    for name in ("a.stl", "a.obj", "a.ply", "a.step"):
        (tmp_path / name).write_text(
            "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n", encoding="utf-8"
        )
        assert (
            "a pointer of Git LFS"
            in refused(tmp_path / name, material="steel", **({} if name == "a.step" else {"unit": "mm"})).problem
        )
    corners = np.array([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]])
    faces = [corners[list(face)] for face in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))]
    facets = [
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in face) + "endloop\nendfacet\n"
        for face in faces
    ]
    (tmp_path / "b.stl").write_text("solid b\n" + "".join(facets), encoding="utf-8")
    assert_allclose(inertias(load(tmp_path / "b.stl", unit="mm", material="1000 kg/m^3"))["trimesh"].mass, 1e-3 / 6, rtol=1e-12)
    (tmp_path / "c.stl").write_text("solid c\n" + "".join(facets[:3]), encoding="utf-8")
    assert "3 open edges in 1 hole" in refused(tmp_path / "c.stl", unit="mm", material="steel").problem


def cad(data: Path, tool: str) -> tuple[Inertia, float]:
    """What the CAD says of a tool: its inertia about the mesh's origin, and its volume [m³]."""
    sheet = yaml.safe_load((data / TOOLS / tool / "Inertia.yaml").read_text(encoding="utf-8"))["OBJECT"]
    volume = re.search(r"Volume = ([\d.]+)", (data / TOOLS / tool / "Inertia.txt").read_text(encoding="utf-8"))
    inertia = Inertia.from_cog(sheet["MASS"], sheet["COM_WRT_MESH"], sheet["INERTIA_WRT_COM"])
    return inertia, float(volume.group(1)) * 1e-9


@pytest.mark.parametrize("tool", ["allen_key", "box_wrench"])
def test_tools_of_one_material_agree_with_their_cad(data: Path, tool: str) -> None:
    expected, volume = cad(data, tool)
    article = load(data / TOOLS / tool / "mesh.ply", material=f"{expected.mass / volume} kg/m^3")
    found = inertias(article)["trimesh"]
    assert article.warnings == ()
    assert_allclose(found.cog, expected.cog, atol=0.2e-3)
    assert found.mass == pytest.approx(expected.mass, rel=5e-3)
    moments = expected.moments_cog
    assert_allclose(found.moments_cog, moments, rtol=5e-3)
    assert_allclose(found.products_cog, expected.products_cog, atol=5e-3 * moments.max())


def test_a_hammer_taken_as_one_density_is_tens_of_mm_wrong_and_the_user_is_told(data: Path) -> None:
    expected, volume = cad(data, "machinist_hammer")
    article = load(data / TOOLS / "machinist_hammer" / "mesh.ply", material=f"{expected.mass / volume} kg/m^3")
    assert np.linalg.norm(inertias(article)["trimesh"].cog - expected.cog) == pytest.approx(0.0791, rel=0.01)
    touch, bodies = article.warnings
    assert "pieces 1 and 2 touch and their meshes overlap by 52.1126 mm³, 0.41% of the smaller one, which counts twice" in touch
    assert "2 separate bodies are taken as one material (body 1: 12661.7 mm³ around (" in bodies
    assert "body = 1, 2 ..." in bodies


def test_the_hammer_comes_right_with_a_density_for_each_body(data: Path, tmp_path: Path) -> None:
    mesh = data / TOOLS / "machinist_hammer" / "mesh.ply"
    rows = (("head", 1, "cast-carbon-steel"), ("handle", 2, "oak"))
    parts = [f'[[part]]\nname = "{n}"\nfile = "{mesh}"\nbody = {b}\nmaterial = "{m}"\n' for n, b, m in rows]
    article = load(described(tmp_path, "format = 1\n" + "\n".join(parts)))
    found, (expected, _) = inertias(article)["trimesh"], cad(data, "machinist_hammer")
    assert [part.name for part in article.parts] == ["head", "handle"]
    assert np.linalg.norm(found.cog - expected.cog) < 0.1e-3
    assert found.mass == pytest.approx(expected.mass, rel=5e-3)
    assert_allclose(found.moments_cog, expected.moments_cog, rtol=5e-3)
    assert any("overlap" in warning for warning in article.warnings)


def test_parts_of_different_materials_and_places_add_up(tmp_path: Path) -> None:
    write_box(tmp_path / "block.stl")
    write_box(tmp_path / "plate.obj", (0.2, 0.1, 0.01))
    text = """
        format = 1
        article.name = "stack"
        material.lead.density = "11.34 g/cm^3"
        [[part]]
        name = "block"
        file = "block.stl"
        unit = "mm"
        material = "lead"
        position_mm = [10, 20, 30]
        rotation_deg = [30, 0, 90]
        [[part]]
        name = "plate"
        file = "plate.obj"
        unit = "m"
        density = "1000 kg/m^3"
        position_mm = [500, 0, 0]
    """
    article = load(described(tmp_path, text).parent)
    pose = Pose(position=np.array([0.01, 0.02, 0.03]), rotation=rotation_about("z", np.pi / 2) @ rotation_about("x", np.pi / 6))
    block = box_inertia(11340 * 0.16 * 0.07 * 0.4, (0.16, 0.07, 0.4), (0, 0, 0)).placed(pose)
    plate = box_inertia(1000 * 0.2 * 0.1 * 0.01, (0.2, 0.1, 0.01), (0.5, 0, 0))
    assert article.name == "stack"
    assert_allclose(inertias(article)["trimesh"].parameters, (block + plate).parameters, rtol=1e-6, atol=1e-7)
    assert article.warnings == ()


def test_parts_that_overlap_are_named_with_the_share_that_counts_twice(tmp_path: Path) -> None:
    path = one_part(tmp_path)
    second = '[[part]]\nname = "again"\nfile = "block.stl"\nunit = "mm"\nmaterial = "steel"\nposition_mm = [80, 0, 0]\n'
    alone = path.read_text(encoding="utf-8")
    with pytest.raises(BadInput, match=r"block and again overlap: 50\.00% of the smaller one counts twice"):
        load(described(tmp_path, alone + second))
    sliver = second.replace("[80, 0, 0]", "[159.5, 0, 0]")
    (warning,) = load(described(tmp_path, alone + sliver)).warnings
    assert warning == "parts block and again overlap: 0.31% of the smaller one counts twice"


@pytest.mark.parametrize(
    ("scale", "words"), [(1e3, "400 m long, which is suspicious"), (1, None), (1e-3, "0.0004 m long, which")]
)
def test_a_suspicious_size_is_said_of_step_too(tmp_path: Path, scale: float, words: str | None) -> None:
    import cadquery

    file = tmp_path / "block.step"
    cadquery.exporters.export(cadquery.Workplane().box(160 * scale, 70 * scale, 400 * scale), str(file))
    warnings = load(file, material="aluminium").warnings
    assert [words in warning for warning in warnings] == ([True] if words else [])


@pytest.mark.parametrize(
    ("fields", "place", "problem", "remedy"),
    [
        ({"materail": '"oak"'}, "part 1.materail", "found the unknown key", "Did you mean material?"),
        ({"file": '"none.stl"'}, "part 1.file", "there is no file 'none.stl'", "Looked for"),
        ({"name": ""}, "part 1.name", "is missing", "Add name"),
        ({"file": "3"}, "part 1.file", "must be text, found 3", ""),
        ({"material": ""}, "material", "no material is given", "Give a name"),
        ({"material": '"unobtainium"'}, "material", "no material is called 'unobtainium'", "Known are"),
        ({"density": '"1 kg/m^3"'}, "part 1.density", "is given beside a material", "Leave one"),
        ({"material": "", "density": "7800"}, "part 1.density", "needs its unit, found the bare number 7800", "Write it"),
        ({"material": "", "density": '"-1 kg/m^3"'}, "part 1.density", "positive and finite", "Write it"),
        ({"material": "", "density": '"0 kg/m^3"'}, "part 1.density", "positive and finite", "Write it"),
        ({"material": "", "density": '"5 s"'}, "part 1.density", "'s' is a time", "Write it"),
        ({"unit": '"parsec"'}, "part 1.unit", "no unit of length is called 'parsec'", "Give one of"),
        ({"unit": ""}, "unit", "does not say in which unit", "Give one of"),
        ({"position_mm": "[1, 2]"}, "part 1.position_mm", "must be three finite numbers, found [1, 2]", ""),
        ({"rotation_deg": '"x"'}, "part 1.rotation_deg", "must be three finite numbers", ""),
        ({"position_mm": "[nan, 0, 0]"}, "part 1.position_mm", "must be three finite numbers", ""),
        ({"body": "7"}, "body", "it holds no body '7'", "It holds 1"),
        ({"body": "1.5"}, "part 1.body", "must be a body's name (STEP) or its number", ""),
        ({"materials": '{a = "oak"}'}, "materials", "bodies of a mesh have no names", "[[part]]"),
    ],
)
def test_a_bad_field_is_named_with_what_was_found(
    tmp_path: Path, fields: dict[str, str], place: str, problem: str, remedy: str
) -> None:
    error = refused(one_part(tmp_path, **fields))
    assert error.field == place
    assert problem in error.problem
    assert remedy in error.remedy


@pytest.mark.parametrize(
    ("text", "place", "problem"),
    [
        ("format = 2\n", "format", "must be 1, found 2"),
        ("", "format", "is missing"),
        ("format = true\n", "format", "must be 1, found True"),
        ("format = 1\n", "part", "there is no part"),
        ("format = 1\npart = 3\n", "part", "there is no part"),
        ("format = 1\npart = [3]\n", "part", "must be a table, found 3"),
        ("format = 1\nmaterial.a.densty = 3\n", "material.a.densty", "found the unknown key"),
        ("format = 1\nmaterial.a = 3\n", "material.a", "must be a table, found 3"),
        ("format = 1\nmaterial.a = {}\n", "material.a.density", "is missing"),
        ("format = 1\narticle.nam = 'x'\n", "article.nam", "found the unknown key"),
        ("format = ", "", "it is not TOML"),
        ("formt = 1\n", "formt", "found the unknown key"),
    ],
)
def test_a_bad_description_is_refused(tmp_path: Path, text: str, place: str, problem: str) -> None:
    error = refused(described(tmp_path, text))
    assert error.field == place
    assert problem in error.problem


def test_doubled_part_names_are_refused(tmp_path: Path) -> None:
    path = one_part(tmp_path)
    twice = path.read_text(encoding="utf-8") + '[[part]]\nname = "block"\nfile = "block.stl"\n'
    assert "'block' names more than one part" in refused(described(tmp_path, twice)).problem


def test_options_go_to_the_parts_that_state_nothing_themselves(tmp_path: Path) -> None:
    volume = 0.16 * 0.07 * 0.4
    bare = one_part(tmp_path, unit="", material="")
    assert_allclose(inertias(load(bare, unit="mm", material="steel"))["trimesh"].mass, 7850 * volume, rtol=1e-6)
    assert_allclose(inertias(load(one_part(tmp_path), unit="m", material="steel"))["trimesh"].mass, 2700 * volume, rtol=1e-6)


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    assert "neither article.toml nor a part" in refused(tmp_path).problem


@pytest.fixture(scope="module")
def example(root: Path, apart: Callable[..., subprocess.CompletedProcess[str]], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What ``examples/own_article.py`` writes."""
    folder = tmp_path_factory.mktemp("own")
    program = "import runpy, sys; del sys.argv[0]; runpy.run_path(sys.argv[0], run_name='__main__')"
    done = apart(str(root / "examples" / "own_article.py"), str(folder), program=program)
    assert done.returncode == 0, done.stderr
    return folder


HANDLE = (560 * np.pi / 4 * 0.025**2 * 0.25, 0.125)
HEAD = (7800 * 0.11 * 0.03 * 0.03, 0.265)


def exact_hammer() -> Inertia:
    m, z = HANDLE
    side = m / 12 * (3 * 0.0125**2 + 0.25**2)
    return Inertia.from_cog(m, (0, 0, z), np.diag([side, side, m / 2 * 0.0125**2])) + box_inertia(
        HEAD[0], (0.11, 0.03, 0.03), (0, 0, HEAD[1])
    )


def hammer_of(folder: Path, tmp_path: Path, materials: str) -> UserArticle:
    row = f'format = 1\n[[part]]\nname = "hammer"\nfile = "{folder / "hammer.step"}"\nmaterials = {{{materials}}}\n'
    return load(described(tmp_path, row))


def test_the_hammer_from_step_has_the_closed_form_on_the_exact_route_and_the_mesh_agrees(example: Path, tmp_path: Path) -> None:
    article = hammer_of(example, tmp_path, 'handle = "oak", head = "cast-carbon-steel"')
    found = inertias(article)
    assert [part.name for part in article.parts] == ["hammer/handle", "hammer/head"]
    assert list(found) == ["occ", "trimesh"]
    assert_allclose(found["occ"].parameters, exact_hammer().parameters, rtol=1e-10, atol=1e-12)
    assert agreement(article, found).agree
    off = Inertia(parameters=found["trimesh"].parameters * 1.01)
    assert not agreement(article, {"occ": found["occ"], "trimesh": off}).agree


def test_the_mesh_of_a_solid_is_as_fine_as_it_is_asked_for(example: Path) -> None:
    coarse, fine = (load(example / "hammer.step", material="steel", chord=chord) for chord in (1e-4, 1e-6))
    assert {part.chord for part in fine.parts} == {1e-6}
    off = [abs(inertias(article)["trimesh"].mass - inertias(article)["occ"].mass) for article in (coarse, fine)]
    assert off[1] < off[0] / 20  # the error falls with the chord error, a hundredfold


def test_the_example_folder_of_two_stl_files_is_the_same_hammer(example: Path) -> None:
    assert_allclose(inertias(load(example))["trimesh"].mass, exact_hammer().mass, rtol=1e-4)  # chord error 0.01 mm
    assert_allclose(inertias(load(example))["trimesh"].cog, exact_hammer().cog, atol=1e-5)


def test_bodies_without_material_are_listed_by_name(example: Path, tmp_path: Path) -> None:
    error = refused(example / "hammer.step")
    assert error.problem == "no material is given for handle, head"
    with pytest.raises(BadInput, match="no material is given for head"):
        hammer_of(example, tmp_path, 'handle = "oak"')
    with pytest.raises(BadInput, match="it holds no body 'haed'"):
        hammer_of(example, tmp_path, 'handle = "oak", haed = "steel"')


def test_one_body_of_a_step_file_can_be_taken_and_placed(example: Path, tmp_path: Path) -> None:
    row = f'file = "{example / "hammer.step"}"\nbody = "head"\nmaterial = "cast-carbon-steel"\nposition_mm = [0, 0, -265]\n'
    article = load(described(tmp_path, 'format = 1\n[[part]]\nname = "only"\n' + row))
    for inertia in inertias(article).values():
        assert_allclose(inertia.parameters, box_inertia(HEAD[0], (0.11, 0.03, 0.03), (0, 0, 0)).parameters, rtol=1e-9, atol=1e-12)


def test_a_unit_beside_a_step_file_is_refused(example: Path) -> None:
    assert "states its own unit" in refused(example / "hammer.step", unit="in", material="steel").problem


def write_assembly(path: Path, names: list[str]) -> Path:
    """Boxes of 10 mm in a nested assembly, the second half of them in a turned sub-assembly of their own."""
    import cadquery

    outer, inner = cadquery.Assembly(name="outer"), cadquery.Assembly(name="inner")
    half = (len(names) + 1) // 2
    for target, chosen in ((outer, names[:half]), (inner, names[half:])):
        for k, name in enumerate(chosen):
            target.add(cadquery.Solid.makeBox(10, 10, 10), name=name, loc=cadquery.Location((20 * k, 0, 0)))
    if len(names) > 1:
        outer.add(inner, loc=cadquery.Location((0, 100, 0), (0, 0, 1), 90))
    outer.export(str(path), "STEP")
    return path


def test_nested_assemblies_put_every_body_in_its_place_and_number_doubled_names(tmp_path: Path) -> None:
    article = load(write_assembly(tmp_path / "a.STEP", ["bolt", "nut", "bolt"]), material="1000 kg/m^3")
    assert [part.name for part in article.parts] == ["bolt-1", "nut", "bolt-2"]
    centres = [part.mesh.bounds.mean(axis=0) for part in article.parts]
    assert_allclose(centres, [[0.005, 0.005, 0.005], [0.025, 0.005, 0.005], [-0.005, 0.105, 0.005]], atol=1e-12)


def test_a_body_that_is_used_several_times_is_computed_once_and_is_right_at_every_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import cadquery

    from geometry import cad

    drawn = cadquery.Workplane().box(30, 20, 10).faces(">Z").workplane().center(5, 2).hole(6).val()
    places = [((0, 0, 0), (0, 0, 1), 0), ((50, 7, -3), (1, 2, 3), 40), ((-40, 0, 60), (0, 1, 1), 170)]
    assembly = cadquery.Assembly(name="three")
    for k, place in enumerate(places):
        assembly.add(drawn, name=f"brick {k}", loc=cadquery.Location(*place))
    assembly.export(str(tmp_path / "three.step"), "STEP")
    asked, by_occ = [], cad.from_occ
    monkeypatch.setattr(cad, "from_occ", lambda *of: asked.append(of) or by_occ(*of))
    article = load(tmp_path / "three.step", material="steel")
    assert len(asked) == 1
    found = inertias(article)
    one_by_one = sum((by_occ(part.solid, 7850.0) for part in article.parts), Inertia(parameters=np.zeros(10)))
    assert_allclose(found["occ"].parameters, one_by_one.parameters, rtol=1e-12, atol=1e-12)
    assert agreement(article, found).agree
    for part in article.parts:  # the mesh stands where the solid does, and its curved face is within what bounds it
        middle = cad.tessellate_solid(part.solid, part.chord).bounds.mean(axis=0)
        assert_allclose(part.mesh.bounds.mean(axis=0), middle, atol=2 * part.chord)
        assert_allclose(part.curved_reach.mean(axis=0), cad.curved(part.solid)[1].mean(axis=0), atol=1e-5)


def test_a_material_by_the_name_that_bodies_share_goes_to_all_of_them(tmp_path: Path) -> None:
    write_assembly(tmp_path / "a.step", ["bolt", "nut", "bolt"])
    row = 'format = 1\n[[part]]\nname = "a"\nfile = "a.step"\nmaterials = {bolt = "1000 kg/m^3", nut = "steel"}\n'
    densities = {part.name: part.material.density for part in load(described(tmp_path, row)).parts}
    assert densities == {"a/bolt-1": 1000, "a/nut": 7850, "a/bolt-2": 1000}


def test_a_step_file_is_read_in_the_unit_that_it_states(tmp_path: Path) -> None:
    text = write_assembly(tmp_path / "mm.step", ["a"]).read_text(encoding="utf-8")
    metres = text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)")
    assert metres != text
    (tmp_path / "m.stp").write_text(metres, encoding="utf-8")
    for name, volume in (("mm.step", 1e-6), ("m.stp", 1e3)):
        assert_allclose(inertias(load(tmp_path / name, material="1 kg/m^3"))["occ"].mass, volume, rtol=1e-9)


def test_a_box_with_round_edges_has_its_mesh_though_triangles_shrink_to_nothing_at_its_corners(tmp_path: Path) -> None:
    import cadquery as cq

    length, width, height, radius = 10.0, 6.0, 4.0, 1.0
    solid = cq.Workplane().box(length, width, height).edges().fillet(radius)
    cq.exporters.export(solid, str(tmp_path / "box.step"))
    article = load(tmp_path / "box.step", material="1000 kg/m^3")
    found = inertias(article)
    a, b, c = (size - 2 * radius for size in (length, width, height))  # of the box whose parallel body it is (Steiner)
    volume = a * b * c + 2 * radius * (a * b + b * c + c * a) + np.pi * radius**2 * (a + b + c) + 4 / 3 * np.pi * radius**3
    assert list(found) == ["occ", "trimesh"]
    assert found["occ"].mass == pytest.approx(1e-6 * volume, rel=1e-9)
    assert agreement(article, found).agree


def write_surface(path: Path) -> Path:
    import cadquery

    cadquery.exporters.export(cadquery.Workplane(obj=cadquery.Face.makePlane(10, 20)), str(path))
    return path


@pytest.mark.parametrize(
    ("make", "problem"),
    [
        (lambda p: write_surface(p), "it holds no solid body, only 1 shell(s), 1 face(s)"),
        (lambda p: p.write_text("solid nothing", encoding="utf-8"), "it is not a STEP file"),
        (lambda p: p.write_bytes(b"\x00\xff" * 500), "it is not a STEP file"),
        (
            lambda p: p.write_text("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n", encoding="utf-8"),
            "it holds no",
        ),
        (lambda p: p.write_text("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=BOGUS(", encoding="utf-8"), "it is cut short"),
        (
            lambda p: p.write_text("ISO-10303-21;\nDATA;\n#1=A();\n #1 =B(#1);\nENDSEC;\nEND-ISO-10303-21;\n", encoding="utf-8"),
            "two of its entities are #1",
        ),
    ],
    ids=["surface", "text", "binary", "empty", "cut", "doubled"],
)
def test_a_step_file_without_a_body_is_refused_without_noise(
    tmp_path: Path, make: Callable[[Path], object], problem: str, capfd: pytest.CaptureFixture[str]
) -> None:
    make(tmp_path / "part.step")
    capfd.readouterr()  # what writing says is not what is looked at here
    assert problem in refused(tmp_path / "part.step", material="steel").problem
    assert capfd.readouterr() == ("", "")


def test_parts_of_the_same_name_are_numbered_in_the_suggested_description(tmp_path: Path) -> None:
    for number, name in enumerate(("x.obj", "x.ply", "x.stl", "x-2.stl")):
        write_box(tmp_path / name, centre=(1000.0 * number, 0, 0))
    remedy = refused(tmp_path).remedy
    described(tmp_path, remedy.partition("corrected:")[2].partition("Then try again")[0])
    assert {part.name: Path(part.source).name for part in load(tmp_path).parts} == {
        "x-2": "x-2.stl",
        "x": "x.obj",
        "x-3": "x.ply",
        "x-4": "x.stl",
    }
