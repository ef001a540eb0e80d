"""Inertia written for other programs says the same there: read by their own readers, or from the definition of the format."""

import re
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.inertia import Inertia, tensor_from_six
from geometry.inertia_files import FORMATS, written
from geometry.routes import from_pinocchio
from validation.reference.reference import read_result

DIGITS = 1e-9
"""What a round trip may lose, relative to the body's own size: the bar of the issue."""


@pytest.fixture(params=["slender", "far", "tiny"])
def body(request: pytest.FixtureRequest) -> Inertia:
    """A body with products, far from its frame's origin, or of a few milligrams."""
    six = {
        "slender": [3, 2.9, 0.9, 0.3, -0.2, 0.15],
        "far": [1, 2, 2.5, -0.4, 0.1, 0.3],
        "tiny": [4e-12, 5e-12, 6e-12, 1e-12, 0, 0],
    }
    cog = {"slender": [0.1, -0.02, 0.4], "far": [40.0, -30.0, 20.0], "tiny": [1e-5, 0, -2e-6]}
    mass = {"slender": 12.5, "far": 7.0, "tiny": 3.1e-6}
    return Inertia.from_cog(mass[request.param], cog[request.param], tensor_from_six(np.array(six[request.param])))


def same(found: Inertia, body: Inertia) -> None:
    radius = np.sqrt(np.abs(body.tensor_cog).max() / body.mass)
    assert_allclose(found.mass, body.mass, rtol=DIGITS)
    assert_allclose(found.cog, body.cog, rtol=DIGITS, atol=DIGITS * radius)
    assert_allclose(found.tensor_cog, body.tensor_cog, rtol=0, atol=DIGITS * np.abs(body.tensor_cog).max())


@pytest.mark.parametrize("form", ["urdf", "mjcf"])
def test_pinocchio_reads_back_every_link_of_urdf_and_mjcf(form: str, body: Inertia, tmp_path: Path) -> None:
    path = tmp_path / f"robot{FORMATS[form].endings[0]}"
    # Pinocchio takes the first body of an MJCF alone for its root
    bodies = {"one & two": body, "other": body.scaled(2.0)} if form == "urdf" else {"one & two": body}
    path.write_text(written(form, 'a "b" <c>', bodies), encoding="utf-8")
    read = pinocchio.buildModelFromUrdf if form == "urdf" else pinocchio.buildModelFromMJCF
    inertias = list(read(str(path)).inertias)[1:]
    for found, own in zip(inertias, bodies.values(), strict=True):
        # the lever and tensor as they stand: moving the tensor through the origin and back would lose digits of a far body
        moved = from_pinocchio(pinocchio.Inertia(found.mass, np.zeros(3), found.inertia))
        same(Inertia.from_cog(found.mass, found.lever, moved.tensor), own)


def test_sdf_states_matrix_entries_about_the_centre_of_mass(body: Inertia) -> None:
    inertial = ElementTree.fromstring(written("sdf", "robot", {"one": body})).find("model/link/inertial")
    assert inertial is not None
    six = [float(inertial.findtext(f"inertia/{key}", "")) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")]
    place = [float(part) for part in inertial.findtext("pose", "").split()]
    assert place[3:] == [0, 0, 0]
    same(Inertia.from_cog(float(inertial.findtext("mass", "")), place[:3], tensor_from_six(np.array(six))), body)


def test_conm2_is_read_back_by_pyyeti_with_the_sign_that_nastran_gives_products(body: Inertia, tmp_path: Path) -> None:
    from pyyeti.nastran import bulk

    path = tmp_path / "mass.bdf"
    path.write_text(written("nastran", "stand", {"one": body}), encoding="utf-8")
    cards = np.asarray(bulk.rdcards(str(path), "conm2", return_var="array"), dtype=np.float64)
    mass, x, offset_blank, cells = cards[0, 3], cards[0, 4:7], cards[0, 7], cards[0, 8:14]
    i11, i21, i22, i31, i32, i33 = cells
    assert (cards[0, 1], offset_blank) == (1001, 0)
    # MSC Quick Reference Guide, CONM2: [[I11, -I21, -I31], [-I21, I22, -I32], [-I31, -I32, I33]] about the centre of mass
    same(Inertia.from_cog(mass, x, np.array([[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]])), body)


def test_six_masses_of_opensees_have_mass_centre_and_tensor_of_the_body(body: Inertia) -> None:
    text = written("opensees", "frame", {"one": body})
    places = {int(one[0]): np.array(one[1:], float) for one in re.findall(r"^node (\d+) (\S+) (\S+) (\S+)$", text, re.M)}
    masses = {int(node): float(mass) for node, mass in re.findall(r"^mass (\d+) (\S+) \2 \2 0 0 0$", text, re.M)}
    assert len(masses) == 6
    assert set(re.findall(r"^rigidLink beam 100 (\d+)$", text, re.M)) == set(map(str, masses))
    arms = {node: places[node] - places[100] for node in masses}
    tensor = sum(
        mass * ((arms[node] @ arms[node]) * np.eye(3) - np.outer(arms[node], arms[node])) for node, mass in masses.items()
    )
    centre = sum(mass * arms[node] for node, mass in masses.items()) / body.mass
    radius = np.sqrt(np.abs(body.tensor_cog).max() / body.mass)
    # a node 54 m away keeps 16 digits of its place and therefore fewer of its arm
    assert_allclose(centre, np.zeros(3), rtol=0, atol=DIGITS * radius)
    same(Inertia.from_cog(sum(masses.values()), places[100], np.asarray(tensor)), body)


def test_adams_principal_moments_about_turned_markers_are_the_tensor(body: Inertia) -> None:
    text = written("adams", "frame", {"a-b": body}).replace("&\n", "")
    place, turns = re.search(r"\.im location=(.*?) orientation=(.*)", text).groups()  # type: ignore[union-attr]
    psi, theta, phi = (float(part) for part in turns.split(","))

    def about(axis: int, angle: float) -> np.ndarray:
        return np.asarray(pinocchio.utils.rotate("xyz"[axis], angle))

    R = about(2, psi) @ about(0, theta) @ about(2, phi)
    moments = [float(re.search(rf"\bi{key}=(\S+)", text)[1]) for key in ("xx", "yy", "zz")]  # type: ignore[index]
    mass = float(re.search(r"mass=(\S+) center", text)[1])  # type: ignore[index]
    same(Inertia.from_cog(mass, [float(part) for part in place.split(",")], R @ np.diag(moments) @ R.T), body)
    assert ".massline.a_b" in text


def test_the_result_file_is_read_back_by_validate(body: Inertia, tmp_path: Path) -> None:
    path = tmp_path / "r.toml"
    path.write_text(written("toml", "one", {"one": body}), encoding="utf-8")
    assert tomllib.loads(path.read_text(encoding="utf-8"))["inertia"]["products_sign"] == "matrix-entry"
    same(read_result(str(path), article="one").statement.inertia, body)


def test_what_no_body_has_or_a_file_cannot_hold_is_refused() -> None:
    impossible = Inertia.from_cog(1.0, np.zeros(3), np.diag([1.0, 1.0, 3.0]))
    for form in FORMATS:
        with pytest.raises(BadInput, match="no body has these parameters"):
            written(form, "x", {"x": impossible})
    with pytest.raises(BadInput, match="holds 1 body, found 2"):
        written("toml", "x", {"x": impossible, "y": impossible})
    endings = [ending for one in FORMATS.values() for ending in one.endings]
    assert len(set(endings)) == len(endings)
