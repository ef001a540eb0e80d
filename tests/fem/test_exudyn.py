"""Exudyn's bodies and beams: inertia, closed forms and rates, the built-in articles; and Ctrl-C while it works."""

import os
import runpy
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.beam import articles
from fem.beam.articles import Joint, Port
from fem.beam.elements import Section, rectangle, sandwich
from fem.beam.frame import Body, Member, Plan, Ports, assemble
from fem.dynamic_mass import LINES, modal
from fem.exudyn import frame, linear
from fem.exudyn.frame import refined
from fem.exudyn.linear import extrapolated, linearise
from fem.exudyn.run import exudyn_version, is_interruption, kept, quiet, running, to_exudyn
from fem.modes import Modes, Reduced, craig_bampton, fixed_base
from geometry.article import material
from geometry.articles import built_in
from geometry.articles.parts import load
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, rigid_transformation_6, rotation_about
from geometry.inertia import Inertia
from geometry.routes import inertia as drawn_inertia

IN_EXUDYN = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "in_exudyn.py"))
linearised, from_exudyn = IN_EXUDYN["linearised"], IN_EXUDYN["from_exudyn"]

STEEL = material("steel")
BAR = rectangle(0.02, 0.01, STEEL)
BETA = np.array([1.875104068711961, 4.694091132974175])
LENGTH = 1.0
BENDING = BETA**2 / (2 * np.pi * LENGTH**2) * np.sqrt(BAR.bending_y / BAR.mass)
TURN = rotation_about("x", 0.4) @ rotation_about("y", -0.8) @ rotation_about("z", 1.1)
COG = np.array([0.11, -0.23, 0.37])
BLOCK = Inertia.from_cog(3.0, COG, TURN @ np.diag([0.5, 0.7, 0.9]) @ TURN.T)
"""All ten parameters different and none zero: an exchanged index or sign cannot hide."""
COUNT = 30
Driven = Callable[..., Array]
TO_50_HZ = {"clumod-1": 5, "clumod-4": 20}


@pytest.fixture(scope="module")
def by_exudyn() -> dict[str, Modes]:
    return {name: linear.modes(name, COUNT) for name in ("cuboid", "clumod-1", "clumod-4")}


@pytest.fixture(scope="module")
def by_us() -> dict[str, Modes]:
    return {name: fixed_base(articles.structure(name, elements=24), COUNT) for name in ("cuboid", "clumod-1", "clumod-4")}


def cantilever(elements: int, axes: Array | None = None) -> Plan:
    """The bar, standing on node 0 along the x axis of `axes`, the identity by default."""
    R = np.eye(3) if axes is None else axes
    nodes = np.linspace([0.0, 0.0, 0.0], LENGTH * R[:, 0], elements + 1)
    member = Member(nodes=tuple(range(elements + 1)), section=BAR, z_axis=R[:, 2])
    return Plan(nodes=nodes, carriers=tuple(range(elements + 1)), members=(member,))


def solid_block() -> Plan:
    return Plan(nodes=np.zeros((1, 3)), carriers=(0,), bodies=(Body(node=0, inertia=BLOCK),))


def test_error_of_a_frequency_falls_with_the_square_of_the_element_length() -> None:
    counts = np.array([8, 16, 32])
    exact = fixed_base_of(cantilever(60), 6).frequency[2]  # second bending about the weak axis
    errors = [linearise(cantilever(n), 6).frequency[2] / exact - 1 for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(2, abs=0.1)


def test_two_meshes_give_the_closed_form_that_neither_has() -> None:
    """Rotary inertia and shear take (1 + E / k G) (beta r)² / 2, 4e-4, off the second mode of a bar this slender."""
    found = linear.modes_of_plan(cantilever(16), 3).frequency[[0, 2]]
    assert_allclose(found, BENDING, rtol=6e-4)
    assert_allclose(found, fixed_base_of(cantilever(60), 3).frequency[[0, 2]], rtol=5e-5)
    assert linearise(refined(cantilever(16), 2), 3).frequency[2] > 1.001 * BENDING[1]


@pytest.mark.parametrize("turn", [1, 2])
def test_a_beam_may_run_along_any_axis(turn: int) -> None:
    straight, turned = (linearise(cantilever(6, axes), 10).frequency for axes in (None, np.roll(np.eye(3), turn, axis=0)))
    assert_allclose(turned, straight, rtol=1e-7)


def test_a_beam_askew_is_refused() -> None:
    with pytest.raises(CheckFailed, match="members must run along x, y or z"):
        linearise(cantilever(6, TURN), 10)


@pytest.mark.parametrize("frequency", [0.5, 4.0, 32.0, 1000.0])
def test_dynamic_mass_of_a_rigid_block_is_its_mass_matrix_with_a_plus(frequency: float, driven: Driven) -> None:
    H = driven(linearise(solid_block(), COUNT), np.zeros((6, 6)), frequency)
    assert_allclose(H, BLOCK.mass_matrix, rtol=0, atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("axis", range(6))
def test_the_load_that_dynamic_mass_asks_for_gives_exudyns_block_that_acceleration(
    axis: int, sign: float, driven: Driven
) -> None:
    """f = H a put on the block as exudyn's own loads, integrated by exudyn for 0.1 ms: all six components come out as a."""
    acceleration = sign * np.eye(6)[axis]
    f = driven(linearise(solid_block(), COUNT), np.zeros((6, 6)), 10.0).real @ acceleration
    assert_allclose(accelerated_by(f), acceleration, rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", TO_50_HZ)
def test_frequencies_to_50_hz_are_those_of_the_beam_model(
    name: str, by_exudyn: dict[str, Modes], by_us: dict[str, Modes]
) -> None:
    """Measured: 2e-5 in the first eleven modes; 4.5e-3 at 40 Hz, where the sandwich twists and a clamp holds its warping."""
    ours, exudyns = by_us[name].frequency, by_exudyn[name].frequency
    count = int(np.sum(ours < 50))
    assert count == TO_50_HZ[name]
    assert_allclose(exudyns[:11][:count], ours[:11][:count], rtol=1e-4)
    assert_allclose(exudyns[:count], ours[:count], rtol=5e-3)


@pytest.mark.parametrize("name", ["cuboid", "clumod-1", "clumod-4"])
def test_exudyn_weighs_the_article_as_it_is_drawn(name: str, by_exudyn: dict[str, Modes]) -> None:
    drawn = drawn_inertia(built_in(name)).mass_matrix
    assert_allclose(by_exudyn[name].rigid_mass, drawn, rtol=0, atol=1e-12 * np.abs(drawn).max())


@pytest.mark.parametrize(("name", "bar"), [("cuboid", 1e-6), ("clumod-1", 1e-3), ("clumod-4", 1e-3)])
def test_dynamic_mass_agrees_with_the_beam_model(
    name: str, bar: float, by_exudyn: dict[str, Modes], by_us: dict[str, Modes]
) -> None:
    """Over all 561 lines and all entries, root of the mean square, each entry seen against the rigid body. Measured: 8e-4,
    nearly all of it at the peaks, where a frequency off by 5e-6 is 1 / (2 zeta) times as much.
    """
    size = np.sqrt(np.diag(by_us[name].rigid_mass))
    ours, exudyns = (modal(modes[name]).matrix / np.outer(size, size) for modes in (by_us, by_exudyn))
    assert np.linalg.norm(exudyns - ours) <= bar * np.linalg.norm(ours)


def test_dynamic_mass_from_modes_is_that_of_the_driven_matrices(driven: Driven) -> None:
    """One mesh, extrapolated to itself: all coordinates and joints against 30 modes and residual; all loses as steel does."""
    plan = articles.article_plan("clumod-1", elements=4)
    system, lines = linearise(plan, COUNT), [4.0, 9.0, 20.0, 32.0]
    loss = 0.006 * system.stiffness
    sum_of_modes = modal(extrapolated(system, system, loss, np.zeros(3), COUNT), lines).matrix
    solved = np.array([driven(system, loss, line) for line in lines])
    assert_allclose(sum_of_modes, solved, rtol=0, atol=1e-4 * np.abs(solved).max())


@pytest.mark.parametrize("shear_modulus", [1e4, 7.5e5, 1e8])
def test_two_faces_and_springs_bend_as_the_sandwich_theory_says(shear_modulus: float) -> None:
    """Loose, as it is, and stiff: between the first and the last the frequency of the blade doubles."""
    layer = replace(material("silicone"), youngs_modulus=2 * 1.49 * shear_modulus)
    section = sandwich(0.16, 0.005, 0.0005, STEEL, layer, ("bottom", "layer", "top"))
    nodes = np.linspace([0.0, 0.0, 0.0], [0.45, 0.0, 0.0], 17)
    member = Member(nodes=tuple(range(17)), section=section, z_axis=np.array([0.0, 0.0, 1.0]), bonded=frozenset({0}))
    foot = Body(node=0, inertia=BLOCK)
    carriers = (0, 0, *range(2, 18))
    plan = Plan(
        nodes=np.vstack([nodes[:1], nodes]),
        carriers=carriers,
        members=(replace(member, nodes=tuple(range(1, 18)), bonded=frozenset({1})),),
        bodies=(foot,),
    )
    ours = fixed_base_of(refined(plan, 2), 1).frequency
    assert_allclose(linear.modes_of_plan(plan, 1).frequency, ours, rtol=1e-3)


def test_load_cells_are_springs_in_exudyn_too() -> None:
    plan = articles.article_plan("fmd+clumod-1", elements=6, cells=articles.load_cells())
    ours = fixed_base_of(refined(plan, 4), 5).frequency
    assert_allclose(linear.modes_of_plan(plan, 5).frequency, ours, rtol=2e-4)


@pytest.mark.parametrize("member", [pytest.param("lower-1", marks=pytest.mark.proof), "upper-short"])
def test_a_joint_on_ports_acts_in_exudyn_as_in_our_frame(member: str, by_us: dict[str, Modes]) -> None:
    """A spring between the mast and a blade, solid or sandwich, that lifts a frequency of the band by half a per cent."""
    (z,) = (blade["z"] for blade in load("clumod")["blade"] if blade["name"] == member)
    ports, places = (Port(member="mast", at=1.2), Port(member=member, at=0.3)), np.array([[0.0, 0.0, 1.2], [0.0, 0.3, z]])
    relative = np.hstack(
        [side * rigid_transformation_6([0.0, 0.0, 1.0] - place) for side, place in zip((-1, 1), places, strict=True)]
    )
    joint = Joint(ports=ports, stiffness=relative.T @ np.diag([2e2, 2e2, 2e2, 2.0, 2.0, 2.0]) @ relative)
    ours = fixed_base(articles.structure("clumod-4", elements=24, joints=[joint]), 10).frequency
    assert np.max(ours / by_us["clumod-4"].frequency[:10]) > 1.005
    assert_allclose(linear.modes("clumod-4", 10, joints=[joint]).frequency, ours, rtol=5e-4)


def test_dynamic_mass_of_a_rigid_article_is_its_inertia() -> None:
    H = modal(linear.modes("fmd"), [4.0, 32.0]).matrix
    assert_allclose(H, np.array(2 * [drawn_inertia(built_in("fmd")).mass_matrix]), rtol=0, atol=1e-12)


def test_exudyn_keeps_standard_output_to_the_user(capfd: pytest.CaptureFixture[str]) -> None:
    linear.modes_of_plan(cantilever(3), 2)
    assert capfd.readouterr() == ("", "")


def test_what_exudyn_refuses_is_said_in_its_words_with_its_version(capfd: pytest.CaptureFixture[str]) -> None:
    bad = Section(**{**vars(BAR), "mass": -1.0})
    plan = replace(cantilever(2), members=(replace(cantilever(2).members[0], section=bad),))
    with pytest.raises(CheckFailed, match=rf"exudyn {exudyn_version()} failed when it should .*: \S") as caught:
        linearise(plan, 2)
    assert caught.value.evidence["said"]
    assert capfd.readouterr() == ("", "")


SHEARLESS = (replace(cantilever(2).members[0], section=replace(BAR, shear_y=float("inf"))),)
UNSTABLE = Ports(nodes=(0, 2), stiffness=-1e6 * np.kron([[1, -1], [-1, 1]], np.eye(6)), mass=np.zeros((12, 12)), part="spring")
GROUNDED = Ports(nodes=(2,), stiffness=1e9 * np.eye(6), mass=np.zeros((6, 6)), part="spring")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"members": SHEARLESS}, "shear stiffness"),
        ({"ports": (UNSTABLE,)}, "lowest squared frequency is -"),
        ({"ports": (GROUNDED,)}, "rigid motion of the base meets stiffness"),
    ],
)
def test_a_beam_without_shear_an_unstable_spring_and_one_to_the_ground_are_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(CheckFailed, match=said):
        linearise(replace(cantilever(2), **changes), 3)


def test_no_mode_at_all_and_an_unknown_article_are_refused_before_exudyn_starts() -> None:
    with pytest.raises(BadInput, match="`count`: at least one mode is needed, found 0"):
        linear.modes("clumod-1", 0)
    with pytest.raises(BadInput, match="no built-in article is called 'clumod-2'"):
        linear.modes("clumod-2")


@pytest.fixture(scope="module", params=["clumod-1", "clumod-4"])
def ours(request: pytest.FixtureRequest) -> Reduced:
    structure = articles.structure(request.param)
    return craig_bampton(fixed_base(structure, COUNT), structure.rigid)


def test_reduced_matrices_in_exudyn_have_our_frequencies_and_dynamic_mass(ours: Reduced, condensed: Callable[..., Array]) -> None:
    """Exudyn's modes summed up, against our modal coordinates condensed line by line."""
    system = linearised(ours.stiffness, ours.mass)
    assert_allclose((2 * np.pi * system.frequency) ** 2, np.diag(ours.stiffness)[6:], rtol=1e-6)
    exudyns = modal(extrapolated(None, system, ours.structural, np.zeros(3), COUNT), LINES).matrix
    here = condensed(ours, LINES)
    assert_allclose(exudyns, here, rtol=0, atol=1e-6 * np.abs(here).max())


def test_matrices_without_stiffness_or_of_different_size_are_refused_in_words() -> None:
    with pytest.raises(CheckFailed, match="lowest squared frequency is"):
        linearised(np.zeros((8, 8)), np.eye(8))
    with pytest.raises(CheckFailed, match=r"exudyn .* failed when it should take reduced matrices: \S"):
        linearised(np.eye(7), np.eye(8))


def fixed_base_of(plan: Plan, count: int) -> Modes:
    """Modes of `plan` by our own elements and eigen-solution."""
    return fixed_base(articles._structure(assemble(plan)), count)


def accelerated_by(load: Array) -> Array:
    """Acceleration (6,) of exudyn's free block from rest under `load` (6,), from its velocity after 0.1 ms."""
    duration = 1e-4
    with running("accelerate the block") as exudyn:
        from exudyn import itemInterface

        made = frame.build(exudyn, solid_block(), held=False)
        marker = made.system.AddMarker(itemInterface.MarkerNodeRigid(nodeNumber=0))
        made.system.AddLoad(itemInterface.LoadForceVector(markerNumber=marker, loadVector=load[:3].tolist()))
        made.system.AddLoad(itemInterface.LoadTorqueVector(markerNumber=marker, loadVector=load[3:].tolist()))
        made.system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.solution.file.write = False
        settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 10, duration
        made.system.SolveDynamic(settings)
        kinds = exudyn.OutputVariableType.Velocity, exudyn.OutputVariableType.AngularVelocity
        return np.concatenate([made.system.GetNodeOutput(0, kind) for kind in kinds]) / duration


def test_exudyn_and_we_agree_on_every_entry_of_the_tensor_and_the_order_of_six() -> None:
    body = to_exudyn(BLOCK)
    assert_allclose(body.Inertia(), BLOCK.tensor, rtol=1e-15)
    assert_allclose(body.InertiaCOM(), BLOCK.tensor_cog, rtol=0, atol=1e-15)
    assert_allclose(body.COM(), COG, rtol=1e-15)
    xx, yy, zz, xy, xz, yz = BLOCK.parameters[4:]
    assert_allclose(body.GetInertia6D(), [xx, yy, zz, yz, xz, xy], rtol=1e-15)


def test_exudyn_moves_and_turns_a_body_as_we_do() -> None:
    """Exudyn's own homogeneous transformation against ours."""
    HT = np.eye(4)
    HT[:3, :3], HT[:3, 3] = TURN, [0.2, 0.5, -0.4]
    expected = BLOCK.rotated(TURN).moved(HT[:3, 3])
    assert_allclose(from_exudyn(to_exudyn(BLOCK).Transformed(HT)).parameters, expected.parameters, rtol=0, atol=1e-14)


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.0), (0.3, -0.1, 0.6)])
def test_to_exudyn_and_back_changes_nothing(point: tuple[float, float, float]) -> None:
    there = BLOCK.about(point)
    back = from_exudyn(to_exudyn(there), point)
    assert_allclose(back.parameters, there.parameters, rtol=1e-14)
    assert_allclose(back.reference_point, point, rtol=0)


@pytest.mark.parametrize("moments", [[0.0, 0.3, 0.3], [0.1, 0.2, 0.3]])
def test_ideal_bodies_pass_without_a_word(moments: list[float], capfd: pytest.CaptureFixture[str]) -> None:
    """Rounding may put a lamina a hair outside of the triangle inequality, of which exudyn would warn on standard output."""
    for angle in np.linspace(0, 3, 20):
        to_exudyn(Inertia.from_cog(1.0, COG, np.diag(moments)).rotated(rotation_about("x", angle)))
    assert capfd.readouterr() == ("", "")


def test_what_no_body_has_is_refused_in_words_before_exudyn_sees_it(capfd: pytest.CaptureFixture[str]) -> None:
    impossible = Inertia.from_cog(1.0, COG, np.diag([0.1, 0.2, 0.5]))
    with pytest.raises(BadInput, match=r"model\.toml: `inertia`: no body has these parameters"):
        to_exudyn(impossible, "model.toml")
    assert capfd.readouterr() == ("", "")


def test_quiet_holds_back_and_gives_back(capfd: pytest.CaptureFixture[str]) -> None:
    with quiet() as exudyn:
        exudyn.Print("held back")
    exudyn.Print("heard again")
    assert capfd.readouterr().out.strip() == "heard again"


TIMES = 4
"""Runs of one kind; before Ctrl-C was kept, every second one ended as something else."""

CHILD = f"""
import signal, sys
import numpy as np
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation import rig
from fem.exudyn import driven_run, large_motion, rope_pendulum, rope_statics
from geometry.inertia import Inertia
from validation.cli.main import held_while_importing

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell makes children in the background deaf to it
block = Inertia.from_cog(7.0, [0.0, 0.0, 0.1], np.diag([0.3, 0.25, 0.1]))
t = np.arange(60 * 4096)[:, None] / 4096
push = np.array([1e-3, 0, 0, 0, 0, 0])
moves = [push * x for x in (1 - np.cos(9 * t), 9 * np.sin(9 * t), 81 * np.cos(9 * t))]
motion = BaseMotion(sampling_rate=4096, displacement=moves[0], velocity=moves[1], acceleration=moves[2], driven=60.0)
ropes = rope_statics.on_three_ropes(0.3, length=2.0, amplitude=0.1)
told = lambda share: print(f"at {{share}}", flush=True)
runs = {{
    "driven": lambda: driven_run.respond(rig.Rig(article=rig.rigid("block", block, {{}})), motion, progress=told),
    "large": lambda: large_motion.respond("cuboid", motion, elements=None, progress=told),
    "swing": lambda: rope_pendulum.swing(block, ropes, duration=600.0, progress=told),
}}
for _ in range({TIMES}):
    try:
        with held_while_importing():
            runs[sys.argv[1]]()
    except BaseException as reason:
        print("ended as", type(reason).__name__, reason, flush=True)
"""


@pytest.mark.parametrize("kind", ["driven", pytest.param("large", marks=pytest.mark.proof), "swing"])
def test_ctrl_c_from_another_process_always_ends_a_run_as_ctrl_c(kind: str) -> None:
    """Sent at some moment after the first, second, ... word of progress."""
    ended: list[str] = []
    with subprocess.Popen([sys.executable, "-c", CHILD, kind], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        heard = 0
        for line in child.stdout:
            if line.startswith("ended as"):
                ended.append(line.strip())
                heard = 0
                continue
            heard += 1
            if heard == 1 + len(ended):
                os.kill(child.pid, signal.SIGINT)
    assert ended == ["ended as KeyboardInterrupt"] * TIMES


@pytest.mark.usefixtures("keyboard")
def test_what_is_kept_is_raised_at_the_end_even_where_the_work_failed_and_the_handler_is_restored() -> None:
    before = signal.getsignal(signal.SIGINT)

    def fail() -> None:
        with kept() as found:
            assert found.reason is None
            signal.raise_signal(signal.SIGINT)
            assert isinstance(found.reason, KeyboardInterrupt)
            raise ValueError("the solver gave up")

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.usefixtures("keyboard")
def test_a_handler_that_raises_nothing_stays_in_charge() -> None:
    heard: list[int] = []
    signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    with kept() as found:
        signal.raise_signal(signal.SIGINT)
    assert heard == [signal.SIGINT]
    assert found.reason is None


def test_an_error_that_exudyn_made_of_ctrl_c_is_known() -> None:
    made = SystemError("returned a result with an exception set")
    assert not is_interruption(made)
    made.__context__ = KeyboardInterrupt()
    assert is_interruption(made)
    assert is_interruption(RuntimeError("in a user function: KeyboardInterrupt: <EMPTY MESSAGE>"))
