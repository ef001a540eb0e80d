"""`massline reference robot.urdf`: what is stated beside the mesh, every known slip found, frames and refusals."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from numpy.testing import assert_allclose

from geometry import robot
from geometry.frames import Array, Pose, rotation_about
from geometry.inertia import Inertia, six_from_tensor
from geometry.robot import Link
from validation.cli import main
from validation.reference.robot import SLIPS, findings

SKEW = np.array([[0.35, 0.2, -0.1], [0.05, 0.28, -0.1], [0.05, 0.2, -0.02], [0.05, 0.2, -0.1]])
"""Corners [m] of a tetrahedron: no symmetry hides a mirror, a wrong axis or a wrong sign."""


def write_mesh(folder: Path, scale: float = 1.0) -> None:
    corners = [f"v {x!r} {y!r} {z!r}" for x, y, z in (scale * SKEW).tolist()]
    (folder / "link.obj").write_text("\n".join([*corners, "f 1 2 3", "f 1 4 2", "f 2 4 3", "f 1 3 4"]), encoding="utf-8")


def tetrahedron(mass: float = 2.0) -> Inertia:
    """Closed form: the second moments of a tetrahedron are m/20 (sum v v^T + s s^T), v its corners and s their sum."""
    v = SKEW
    cog, s = v.mean(axis=0), v.sum(axis=0)
    second = mass / 20 * (v.T @ v + np.outer(s, s)) - mass * np.outer(cog, cog)
    return Inertia.from_cog(mass, cog, np.trace(second) * np.eye(3) - second)


def urdf(folder: Path, body: Inertia, inertial: Pose | None = None, tensor: Array | None = None, scale: str = "") -> Path:
    """One link that states `body` in the axes of `inertial`, or `tensor` as it stands."""
    R = np.eye(3) if inertial is None else inertial.rotation
    written = R.T @ body.tensor_cog @ R if tensor is None else tensor
    roll, pitch, yaw = pinocchio.rpy.matrixToRpy(R).tolist()
    six = " ".join(
        f'{key}="{v!r}"'
        for key, v in zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), six_from_tensor(written).tolist(), strict=True)
    )
    x, y, z = body.cog.tolist()
    path = folder / "robot.urdf"
    path.write_text(
        f'<robot name="one"><link name="arm"><inertial><origin xyz="{x!r} {y!r} {z!r}" rpy="{roll!r} {pitch!r} {yaw!r}"/>'
        f'<mass value="{body.mass!r}"/><inertia {six}/></inertial>'
        f'<visual><geometry><mesh filename="package://one/link.obj" {scale}/></geometry></visual></link></robot>',
        encoding="utf-8",
    )
    return path


def off(body: Inertia, share: float = 0.08) -> Inertia:
    """`body` with moments and CoG that are a little off, as a real link's are."""
    second = 0.5 * np.trace(body.tensor_cog) * np.eye(3) - body.tensor_cog
    wider = np.diag(1 + share * np.array([0.5, -0.4, 0.3])) @ second @ np.diag(1 + share * np.array([0.5, -0.4, 0.3]))
    shift = share * np.sqrt(np.trace(second) / body.mass) * np.array([0.6, 0.6, 0.5])
    return Inertia.from_cog(body.mass, body.cog + shift, np.trace(wider) * np.eye(3) - wider)


def test_three_routes_of_a_mesh_are_the_closed_form_and_what_is_stated_is_seen_from_the_link(tmp_path: Path) -> None:
    write_mesh(tmp_path)
    turned = Pose(rotation=rotation_about("z", 0.7) @ rotation_about("x", -0.4))
    path = urdf(tmp_path, tetrahedron(), turned)
    (one,) = findings(path).links
    assert (tuple(one.drawn.routes), one.wrong, one.doubts) == (("occ", "trimesh", "pinocchio"), (), ())
    for found in (*one.drawn.routes.values(), one.link.inertia):
        assert found is not None
        assert_allclose(found.tensor_cog, tetrahedron().tensor_cog, rtol=0, atol=1e-12)  # rounding of a part of 0.01 kg m²
        assert_allclose(found.cog, tetrahedron().cog, rtol=1e-12)
    model = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
    assert_allclose(one.link.inertia.tensor_cog, model.inertias[1].inertia, rtol=0, atol=1e-12)  # another reader of the frames
    stated = one.table.columns["stated"]
    assert all(said is not None for said in stated.values)
    assert all(value is not None and abs(value.deviation_percent or 0) < 1e-6 for value in _rows(one.table))


def _rows(table):  # type: ignore[no-untyped-def]
    from validation.reference.reference import rows

    return [row for k in range(10) for column, row in rows(table, k) if column == "stated"]


def planted(folder: Path, slip: str) -> Path:
    """A link 8 % off its shape in which the named slip was made."""
    own, scale = off(tetrahedron()), 1.0
    turned = Pose(rotation=rotation_about("y", 1.1) @ rotation_about("z", 0.6))
    tensor: Array | None = None
    factors = {"kg mm²": 1e6, "g mm²": 1e9, "kg cm²": 1e4}
    if "scale 0.001" in slip or "scale 0.0254" in slip:
        scale = 1000.0 if "0.001" in slip else 1 / 0.0254
    elif "1000 times too small" in slip:
        scale = 1e-3
    elif "mirror" in slip:
        flip = np.diag([-1.0 if axis == slip[-1] else 1.0 for axis in "xyz"])
        own = Inertia.from_cog(own.mass, flip @ own.cog, flip @ own.tensor_cog @ flip)
    elif "other sign" in slip:
        tensor = turned.rotation.T @ own.tensor_cog @ turned.rotation
        tensor = 2 * np.diag(np.diag(tensor)) - tensor
    elif "about the link's origin" in slip:
        tensor = turned.rotation.T @ own.about(np.zeros(3)).tensor @ turned.rotation
    elif "axes of the link" in slip:
        tensor = own.tensor_cog
    elif "centre of mass is in millimetres" in slip:
        own = Inertia.from_cog(own.mass, 1000 * own.cog, own.tensor_cog)
    else:
        tensor = turned.rotation.T @ own.tensor_cog @ turned.rotation * next(f for unit, f in factors.items() if unit in slip)
    write_mesh(folder, scale)
    return urdf(folder, own, turned, tensor)


@pytest.mark.parametrize("slip", SLIPS)
def test_a_planted_slip_is_named(slip: str, tmp_path: Path) -> None:
    assert findings(planted(tmp_path, slip)).links[0].wrong[-1] == slip


@pytest.mark.parametrize("share", [0.0, 0.08, 0.4])
def test_a_link_that_is_not_uniform_is_not_called_wrong(share: float, tmp_path: Path) -> None:
    write_mesh(tmp_path)
    assert findings(urdf(tmp_path, off(tetrahedron(), share))).links[0].wrong == ()


def test_a_link_that_comes_nearer_by_chance_made_no_slip(tmp_path: Path) -> None:
    """A trunk whose box only stands for it, its CoG a fifth of the radius of gyration off: no millimetres for that."""
    sides = np.array([0.376, 0.094, 0.114])
    box = Inertia.from_cog(5.2, np.zeros(3), np.diag(5.2 / 12 * ((sides**2).sum() - sides**2)))
    trunk = Inertia.from_cog(5.2, np.array([0.0223, 0.002, -0.0005]), 1.07 * box.tensor_cog)
    path = urdf(tmp_path, trunk)
    drawn = f'<box size="{" ".join(map(str, sides))}"/>'
    path.write_text(re.sub(r"<mesh [^>]*/>", drawn, path.read_text(encoding="utf-8")), encoding="utf-8")
    (one,) = findings(path).links
    assert one.cog_apart is not None
    assert one.cog_apart > 20
    assert one.wrong == ()


def test_a_moment_of_nothing_is_written_as_nothing(tmp_path: Path) -> None:
    write_mesh(tmp_path)
    turned = Pose(rotation=rotation_about("x", 0.3) @ rotation_about("y", 0.5))
    tensor = turned.rotation.T @ np.diag([0.0, 0.0, 3e-6]) @ turned.rotation
    (one,) = findings(urdf(tmp_path, tetrahedron(), turned, tensor)).links
    assert "principal moments 0, 0, 3e-06 kg m² break" in one.wrong[0]


def test_a_mesh_mirrored_by_its_scale_is_the_mirror_image(tmp_path: Path) -> None:
    flip, body = np.diag([1.0, -1.0, 1.0]), tetrahedron()
    write_mesh(tmp_path)
    mirrored = Inertia.from_cog(body.mass, flip @ body.cog, flip @ body.tensor_cog @ flip)
    (one,) = findings(urdf(tmp_path, mirrored, scale='scale="1 -1 1"')).links
    assert_allclose(one.drawn.routes["occ"].tensor_cog, mirrored.tensor_cog, rtol=0, atol=1e-12)
    assert one.wrong == ()


def test_mass_outside_the_shape_and_impossible_densities_are_doubted(tmp_path: Path) -> None:
    write_mesh(tmp_path)
    body = tetrahedron()
    heavy = findings(urdf(tmp_path, body.scaled(1e4))).links[0]
    assert "which nothing has" in heavy.doubts[0]
    wide = Inertia.from_cog(body.mass, body.cog, 60 * body.tensor_cog)
    assert "times as far as its visual shape allows" in findings(urdf(tmp_path, wide)).links[0].doubts[0]
    away = Inertia.from_cog(body.mass, body.cog + np.array([0, 0, 0.5]), body.tensor_cog)
    assert "outside its visual shape" in findings(urdf(tmp_path, away)).links[0].doubts[0]
    corner = Inertia.from_cog(body.mass, heavy.drawn.corners.min(axis=0), body.tensor_cog)
    assert "at the very edge of its visual shape" in findings(urdf(tmp_path, corner)).links[0].doubts[0]


MJCF = """<mujoco model="m"><compiler angle="degree" meshdir="meshes" eulerseq="zyx"/>
<default><default class="v"><geom contype="0" conaffinity="0" type="mesh"/><mesh scale="0.001 0.001 0.001"/></default></default>
<asset><mesh class="v" name="part" file="link.obj"/></asset>
<worldbody><body name="arm" childclass="v" pos="1 2 3" euler="10 20 30">{inertial}
<geom mesh="part" pos="0.1 0.2 0.3" euler="90 0 0"/><geom type="box" class="main" size="1 1 1"/>
<body><inertial mass="1" pos="0 0 0" diaginertia="1.0 1.0 3.0"/></body></body></worldbody></mujoco>"""


def test_mjcf_has_its_classes_angles_and_frames_and_says_what_no_body_has(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    write_mesh(tmp_path / "meshes", 1000.0)
    drawn = tetrahedron().placed(Pose(position=np.array([0.1, 0.2, 0.3]), rotation=rotation_about("z", np.pi / 2)))
    full = " ".join(repr(v) for v in six_from_tensor(drawn.tensor_cog).tolist())
    inertial = f'<inertial mass="2" pos="{" ".join(map(repr, drawn.cog.tolist()))}" fullinertia="{full}"/>'
    path = tmp_path / "robot.xml"
    path.write_text(MJCF.replace("{inertial}", inertial), encoding="utf-8")
    arm, inner = findings(path).links
    assert_allclose(arm.drawn.routes["pinocchio"].tensor_cog, drawn.tensor_cog, rtol=0, atol=1e-12)
    assert (arm.shape, arm.wrong, inner.name) == ("visual", (), "unnamed 1")
    assert "break the triangle inequality" in inner.wrong[0]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ('quat="0.5 0.5 0.5 0.5"', rotation_about("z", np.pi / 2) @ rotation_about("x", np.pi / 2)),
        ('axisangle="0 0 2 90"', rotation_about("z", np.pi / 2)),
        ('xyaxes="0 1 0 -1 0 0"', rotation_about("z", np.pi / 2)),
        ('zaxis="0 1 0"', rotation_about("x", -np.pi / 2)),
        ('euler="90 0 90"', rotation_about("x", np.pi / 2) @ rotation_about("z", np.pi / 2)),
    ],
)
def test_every_way_to_turn_a_frame_in_mjcf(words: str, expected: Array, tmp_path: Path) -> None:
    body = f'<body name="b"><inertial mass="1" pos="0 0 0" diaginertia="1 1.5 2" {words}/></body>'
    (tmp_path / "r.xml").write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>", encoding="utf-8")
    (link,) = robot.read(tmp_path / "r.xml").links
    assert isinstance(link, Link)
    assert_allclose(link.inertia.tensor_cog, expected @ np.diag([1, 1.5, 2]) @ expected.T, atol=1e-12)  # type: ignore[union-attr]


def test_shapes_said_by_their_ends_and_within_frames_are_where_mujoco_puts_them(tmp_path: Path) -> None:
    """Place, size and turn are those that MuJoCo 4.0 has for the same text."""
    ends = '<geom type="{}" size="0.02" fromto="0.1 -0.2 0.3 0.4 0.1 -0.5"/>'
    inner = (
        '<frame pos="0 0 1" euler="0 0 90"><body name="hand"><geom type="sphere" size="0.1"/></body><geom size="0.3"/></frame>'
    )
    geoms = "".join(ends.format(kind) for kind in ("capsule", "box", "ellipsoid"))
    text = f'<mujoco><worldbody><frame><body name="arm">{geoms}{inner}</body></frame></worldbody></mujoco>'
    (tmp_path / "r.xml").write_text(text, encoding="utf-8")
    arm, hand = robot.read(tmp_path / "r.xml").links
    assert (arm.name, hand.name, len(hand.shapes)) == ("arm", "hand", 1)
    length = 2 * 0.45276926
    sizes = [(0.02, length), (0.04, 0.04, length), (0.02, 0.02, length / 2), (0.3,)]
    for shape, size in zip(arm.shapes, sizes, strict=True):
        assert_allclose(shape.size, size, rtol=1e-7)
    x, _, z = arm.shapes[1].pose.rotation
    assert_allclose(arm.shapes[1].pose.position, [0.25, -0.05, -0.1], atol=1e-15)
    assert_allclose(x, [0.941726104, -0.058273896, -0.331294578], atol=1e-9)
    assert_allclose(z, [0.331294578, 0.331294578, 0.883452209], atol=1e-9)
    assert_allclose(arm.shapes[3].pose.position, [0, 0, 1], atol=1e-15)


def test_an_empty_line_before_the_declaration_is_no_damage(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text('\n<?xml version="1.0" ?>\n<robot name="r"><link name="arm"/></robot>', encoding="utf-8")
    assert [link.name for link in robot.read(tmp_path / "r.urdf").links] == ["arm"]


SDF = """<?xml version="1.0"?>
<sdf version="1.9"><world name="w"><model name="robot">
  <frame name="hand" attached_to="arm"><pose>0 0 0.5 0 0 0</pose></frame>
  <frame name="aside"><pose degrees="true">1 0 0 0 0 90</pose></frame>
  <link name="arm">
    <pose relative_to="aside">0 0 0.2 0 0 0</pose>
    <inertial><pose>{cog} {rpy}</pose><mass>{mass}</mass><inertia>{six}</inertia></inertial>
    <visual name="v"><pose>0 0 0 0 0 0</pose><geometry><mesh><uri>model://robot/link.obj</uri>{scale}</mesh></geometry></visual>
    <collision name="c"><pose relative_to="{frame}">{pose}</pose>
      <geometry><box><size>0.1 0.2 0.3</size></box></geometry></collision>
    <collision name="floor"><geometry><plane/></geometry></collision>
  </link>
  <joint name="turn" type="revolute"><parent>world</parent><child>arm</child><pose>0 0.3 0 0 0 0</pose></joint>
  {more}
</model></world></sdf>
"""


def sdf(folder: Path, body: Inertia, inertial: Pose | None = None, **words: str) -> Path:
    """One link of Gazebo that states `body` in the axes of `inertial`."""
    R = np.eye(3) if inertial is None else inertial.rotation
    six = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), six_from_tensor(R.T @ body.tensor_cog @ R).tolist(), strict=True)
    cog, rpy = (" ".join(map(repr, one.tolist())) for one in (body.cog, pinocchio.rpy.matrixToRpy(R)))
    said = {"scale": "", "more": "", "frame": "", "pose": "0 0 0 0 0 0", **words}
    tensor = "".join(f"<{key}>{value!r}</{key}>" for key, value in six)
    (folder / "robot.sdf").write_text(SDF.format(cog=cog, rpy=rpy, mass=repr(body.mass), six=tensor, **said), encoding="utf-8")
    return folder / "robot.sdf"


def test_a_link_of_gazebo_is_that_of_a_urdf(tmp_path: Path) -> None:
    write_mesh(tmp_path)
    turned = Pose(rotation=rotation_about("z", 0.7) @ rotation_about("x", -0.4))
    ours, theirs = (findings(form(tmp_path, tetrahedron(), turned)).links[0] for form in (sdf, urdf))
    assert (ours.wrong, ours.doubts, ours.shape) == ((), (), theirs.shape)
    assert_allclose(ours.link.inertia.parameters, theirs.link.inertia.parameters, rtol=0, atol=1e-15)  # type: ignore[union-attr]
    assert_allclose(ours.link.half_unit, theirs.link.half_unit)
    for route, one in ours.drawn.routes.items():
        assert_allclose(one.parameters, theirs.drawn.routes[route].parameters, rtol=1e-12)


def test_a_mesh_of_gazebo_in_millimetres_is_named(tmp_path: Path) -> None:
    write_mesh(tmp_path, 1000.0)
    one = findings(sdf(tmp_path, off(tetrahedron()))).links[0]
    assert one.wrong == ("its mesh is in millimetres: give it scale 0.001",)
    assert findings(sdf(tmp_path, off(tetrahedron()), scale="<scale>1e-3 1e-3 1e-3</scale>")).links[0].wrong == ()


@pytest.mark.parametrize(
    ("frame", "place", "turn"),
    [
        ("", (0.0, 0.0, 0.1), 0.0),
        ("arm", (0.0, 0.0, 0.1), 0.0),
        ("hand", (0.0, 0.0, 0.6), 0.0),
        ("turn", (0.0, 0.3, 0.1), 0.0),  # a joint stands in its child
        ("aside", (0.0, 0.0, -0.1), 0.0),
        ("__model__", (0.0, 1.0, -0.1), -np.pi / 2),
    ],
)
def test_poses_of_gazebo_are_told_from_any_frame(frame: str, place: tuple[float, ...], turn: float, tmp_path: Path) -> None:
    """The link stands at (1, 0, 0.2) of the model, turned by 90 degrees about z."""
    (link,) = robot.read(sdf(tmp_path, tetrahedron(), frame=frame, pose="0 0 0.1 0 0 0")).links
    box = link.shapes[1]
    assert (len(link.shapes), box.kind, box.size) == (2, "box", (0.1, 0.2, 0.3))
    assert_allclose(box.pose.position, place, atol=1e-12)
    assert_allclose(box.pose.rotation, rotation_about("z", turn), atol=1e-12)


def test_a_pose_of_gazebo_may_be_a_quaternion(tmp_path: Path) -> None:
    path = sdf(tmp_path, tetrahedron(), pose="1 2 3 0 0 0.7071067811865476 0.7071067811865476")
    path.write_text(path.read_text().replace('<pose relative_to="">', '<pose rotation_format="quat_xyzw">'))
    (link,) = robot.read(path).links
    assert_allclose(link.shapes[1].pose.rotation, rotation_about("z", np.pi / 2), atol=1e-12)
    assert_allclose(link.shapes[1].pose.position, [1, 2, 3])


def test_models_that_are_included_are_followed_and_called_by_their_names(tmp_path: Path) -> None:
    folder = tmp_path / "models" / "gripper"
    folder.mkdir(parents=True)
    (folder / "model.config").write_text("<model><sdf version='1.5'>old.sdf</sdf><sdf version='1.9'>new.sdf</sdf></model>")
    (folder / "new.sdf").write_text("<sdf version='1.9'><model name='gripper'><link name='jaw'/></model></sdf>")
    more = "<include><uri>model://{0}</uri></include><include merge='true'><name>b</name><uri>model://{0}</uri></include>"
    nested = "<model name='inner'><link name='pin'/></model>"
    path = sdf(tmp_path, tetrahedron(), more=more.format("models/gripper") + nested)
    found = robot.read(path)
    assert [link.name for link in found.links] == ["arm", "gripper::jaw", "jaw", "inner::pin"]
    assert found.links[1].note == "it states no inertia; Gazebo takes 1 kg and 1 kg m²"


@pytest.mark.parametrize(
    ("inertial", "mass", "note"),
    [
        ("<inertial auto='true'><density>1000</density></inertial>", 0.0, "Gazebo makes its inertia of its shapes"),
        ("<inertial><mass>2</mass></inertial>", 2.0, "it states no tensor, of which Gazebo takes 1"),
        ("<inertial/>", 1.0, "it states no mass and no tensor, of which Gazebo takes 1"),
        ("<inertial><mass>0</mass></inertial>", 0.0, "it states no tensor, of which Gazebo takes 1"),
    ],
)
def test_what_gazebo_makes_of_an_inertia_that_is_not_stated_is_said(
    inertial: str, mass: float, note: str, tmp_path: Path
) -> None:
    more = f"<link name='bare'>{inertial}</link>"
    link = robot.read(sdf(tmp_path, tetrahedron(), more=more)).links[1]
    assert (link.mass, link.note) == (mass, note)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"frame": "elbow"}, "the frame 'elbow' is none of its model"),
        (
            {
                "more": "<frame name='a'><pose relative_to='b'/></frame><frame name='b'><pose relative_to='a'/></frame>",
                "frame": "a",
            },
            "stands on itself",
        ),
        ({"more": "<include><uri>model://gripper</uri></include>"}, "it includes model://gripper, which is not there"),
        ({"more": "<include><uri>loop.sdf</uri></include>"}, "more than 60 models within models"),
        ({"more": "<include><uri>robot.sdf</uri></include>"}, "which is <sdf> and no model of an SDF"),
        ({"more": "<link name='arm'/>"}, "two links are called 'arm'"),
        ({"pose": "0 0 0"}, "must be 6 finite numbers, found '0 0 0'"),
        ({"scale": "<scale>1 1</scale>"}, "must be 3 finite numbers"),
    ],
)
def test_what_gazebo_would_not_read_is_refused(
    words: dict[str, str], said: str, refused: Callable[..., str], tmp_path: Path
) -> None:
    loop = "<include><uri>loop.sdf</uri></include>"
    (tmp_path / "loop.sdf").write_text(f"<sdf version='1.9'><model name='loop'>{loop}</model></sdf>")
    assert said in refused("reference", str(sdf(tmp_path, tetrahedron(), **words)))


def test_what_is_written_for_gazebo_is_read_back(run: Callable[..., tuple[int, str, str]], tmp_path: Path) -> None:
    write_mesh(tmp_path)
    path = str(urdf(tmp_path, tetrahedron(), Pose(rotation=rotation_about("x", 0.4))))
    assert run("reference", path, "--column", "occ", "--out", "again.sdf")[0] == main.DONE
    (found,) = robot.read(tmp_path / "again.sdf").links
    assert_allclose(found.inertia.tensor_cog, tetrahedron().tensor_cog, rtol=0, atol=1e-12)  # type: ignore[union-attr]


def test_a_tensor_of_zeros_is_doubted_as_that_of_a_point(tmp_path: Path) -> None:
    """A pulley of 100 kg without any moment had been no doubt at all."""
    write_mesh(tmp_path)
    (found,) = findings(urdf(tmp_path, tetrahedron(), tensor=np.zeros((3, 3)))).links
    assert found.doubts == ("its tensor is zero, as if all of it were one point",)
    (found,) = findings(urdf(tmp_path, tetrahedron(), tensor=np.diag([1e-2, 1e-2, 1e-2]))).links
    assert not any("zero" in one for one in found.doubts)


@pytest.mark.parametrize(("setting", "rescaled"), [("1.5", True), ("-1", False), ("-1.0", False), ("0", False)])
def test_masses_that_mujoco_rescales_are_said_to_be(setting: str, rescaled: bool, tmp_path: Path) -> None:
    body = '<body name="b"><inertial pos="0 0 0" mass="10" diaginertia="1 1 1"/><geom size="0.1"/></body>'
    text = f'<mujoco><compiler settotalmass="{setting}"/><worldbody>{body}</worldbody></mujoco>'
    (tmp_path / "r.xml").write_text(text, encoding="utf-8")
    assert ("MuJoCo rescales it (settotalmass)" in findings(tmp_path / "r.xml").links[0].notes) == rescaled


@pytest.mark.parametrize("name", ["", 'class="main"', 'class="arm"'])
def test_defaults_of_several_sections_are_one_whatever_the_first_is_called(name: str, tmp_path: Path) -> None:
    """MuJoCo merges sections of included files; the last had taken the place of all, one by another name was none."""
    first = f'<default {name}><geom type="box"/><default class="thin"><geom size="0.1 0.1 0.01"/></default></default>'
    body = '<body name="b"><geom size="0.1 0.2 0.3"/><geom class="thin"/></body>'
    text = f'<mujoco>{first}<default><geom pos="1 0 0"/></default><worldbody>{body}</worldbody></mujoco>'
    (tmp_path / "r.xml").write_text(text, encoding="utf-8")
    one, thin = robot.read(tmp_path / "r.xml").links[0].shapes
    assert (one.kind, one.size, one.pose.position[0]) == ("box", (0.2, 0.4, 0.6), 1.0)
    assert (thin.kind, thin.size) == ("box", (0.2, 0.2, 0.02))


def test_mujoco_uses_no_stated_inertia_where_geoms_are_to_make_it(tmp_path: Path) -> None:
    body = '<body name="b"><inertial mass="10"/><geom type="sphere" size="0.1"/></body>'
    text = f'<mujoco><compiler inertiafromgeom="true"/><worldbody>{body}</worldbody></mujoco>'
    (tmp_path / "r.xml").write_text(text, encoding="utf-8")
    (link,) = robot.read(tmp_path / "r.xml").links
    assert (link.inertia, link.mass) == (None, 0.0)
    assert "inertiafromgeom" in link.note


def test_the_command_says_what_is_wrong_first_ends_with_1_and_writes_for_other_programs(
    run: Callable[..., tuple[int, str, str]], tmp_path: Path
) -> None:
    path = planted(tmp_path, "its tensor is in kg mm²")
    code, out, err = run("reference", str(path))
    assert code == main.FAILED_CHECK
    assert out.index("WRONG  arm: its tensor is in kg mm²") < out.index("mass [kg]")
    assert "the inertia of 1 of 1 links is wrong: arm" in err
    write_mesh(tmp_path)
    right = str(urdf(tmp_path, tetrahedron()))
    assert run("reference", right, "--link", "arm")[0] == main.DONE
    assert run("reference", right, "--column", "occ", "--out", "again.urdf")[0] == main.DONE
    found = next(one for one in robot.read(tmp_path / "again.urdf").links if one.name == "arm")
    assert_allclose(found.inertia.tensor_cog, tetrahedron().tensor_cog, rtol=0, atol=1e-12)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("text", "arguments", "words"),
    [
        ("<robot/>", (), "it has no link"),
        ("<html/>", (), "neither a URDF"),
        ("<robot><link", (), "it is no XML"),
        ("<!DOCTYPE x><robot/>", (), "declares a document type"),
        ('<robot><link name="${x}"/></robot>', (), "xacro macros that are not expanded"),
        ('<robot><link name="a"/><link name="a"/></robot>', (), "two links are called 'a'"),
        ('<robot><link name="a"><inertial><mass value="1,5"/></inertial></link></robot>', (), "mass value"),
        ('<mujoco><compiler coordinate="global"/><worldbody><body/></worldbody></mujoco>', (), "in the axes of the world"),
        ('<robot><link name="arm"/></robot>', ("--link", "arn"), "Did you mean arm"),
        ('<robot><link name="arm"/></robot>', ("--unit", "mm"), "a frame, a mass and a unit of their own"),
        ('<robot><link name="arm"/></robot>', ("--format", "urdf"), "no link has"),
        ('<robot><link name="arm"/></robot>', ("--format", "urfd"), "Did you mean urdf"),
        ('<robot><link name="arm"/></robot>', ("--column", "occ"), "a text table has every column"),
    ],
)
def test_what_cannot_be_meant_is_refused(
    refused: Callable[..., str], tmp_path: Path, text: str, arguments: tuple[str, ...], words: str
) -> None:
    (tmp_path / "r.urdf").write_text(text, encoding="utf-8")
    assert words in refused("reference", "r.urdf", *arguments)
