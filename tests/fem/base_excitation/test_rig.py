"""A linear rig answers as closed forms and the frequency domain say; its reduced bodies as their structure; what is refused."""

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem import dynamic_mass
from fem.base_excitation import response, rig
from fem.base_excitation import response as base_excitation_response
from fem.base_excitation import rig as base_excitation_rig
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response
from fem.base_excitation.rig import SOFTEST, STIFFEST, Flange, FlexibleBody, Friction, LoadCell, Rig, Strut, require_usable
from fem.beam import articles
from fem.damping import Damping
from fem.modes import Modes, fixed_base
from fem.structure import Structure, rigid_motion
from geometry.errors import BadInput, CheckFailed
from geometry.frames import rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia

RATE = 8192.0

RINGS = {"clumod-1": 8.0, "clumod-4": 20.0}
"""[s] until 3 % damping has taken what rings to 1e-6 of a spectrum."""

Burst = Callable[..., BaseMotion]
Mounted = Callable[..., Rig]
Clumod = Callable[[str], FlexibleBody]


def spectra(response: Response, low: float = 4.0, high: float = 32.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines in the band, and the full-record transform of table and load at them, zero-padded."""
    n = 2 ** int(np.ceil(np.log2(len(response.table))))
    lines = np.fft.rfftfreq(n, 1 / response.sampling_rate)
    band = (lines >= low) & (lines <= high)
    table, load = (np.array([np.fft.rfft(channel, n)[band] for channel in x.T]).T for x in (response.table, response.load))
    return lines[band], table, load


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("axis", range(6))
def test_a_rigid_block_is_loaded_by_plus_its_mass_times_acceleration(
    rigid_block: FlexibleBody, burst: Burst, axis: int, sign: float
) -> None:
    motion = burst(1024.0, sign * np.eye(6)[axis])
    response = base_excitation_response.respond(Rig(article=rigid_block), motion)
    assert_allclose(response.load, motion.acceleration @ rigid_block.reduced.mass, rtol=1e-12, atol=1e-14)
    assert response.load[:, axis] @ motion.acceleration[:, axis] > 0
    assert_allclose(response.table, motion.acceleration)
    assert_allclose(response.cover, motion.acceleration)
    assert response.cells.shape == (len(motion.time), 0, 3)


def test_a_block_on_a_cover_plate_counts_from_f(rigid_block: FlexibleBody, burst: Burst) -> None:
    cover = Inertia.from_cog(20.0, [0.01, 0.0, 0.02], np.diag([0.3, 0.3, 0.5]))
    rig = Rig(article=rigid_block, cover=cover, seat=np.array([0.01, -0.02, 0.0445]))
    motion = burst(1024.0, np.array([1, -2, 3, 4, 5, -6.0]))
    whole = cover + Inertia.from_mass_matrix(rigid_block.reduced.mass).moved(rig.seat)
    assert_allclose(
        base_excitation_response.respond(rig, motion).load, motion.acceleration @ whole.mass_matrix, rtol=1e-11, atol=1e-11
    )


def test_a_place_of_a_rigid_block_moves_as_a_rigid_body_does(rigid_block: FlexibleBody, burst: Burst) -> None:
    rig = Rig(article=rigid_block, seat=np.array([0.0, 0.0, 0.1]))
    motion = burst(1024.0, np.array([1, -2, 3, 4, 5, -6.0]))
    expected = motion.acceleration @ rigid_transformation([0.1, 0.05, 0.5]).T
    assert_allclose(base_excitation_response.respond(rig, motion).places["top"], expected, atol=1e-13)


def test_the_cells_together_carry_the_load(clumod: Clumod, mounted: Mounted, burst: Burst) -> None:
    rig = mounted(clumod("clumod-4"))
    response = base_excitation_response.respond(rig, burst(RATE, np.array([1, -2, 3, 4, 5, -6.0]), 1.0))
    resultant = sum(
        force @ rigid_transformation(cell.position)
        for cell, force in zip(rig.cells, np.moveaxis(response.cells, 1, 0), strict=True)
    )
    assert_allclose(resultant, response.load, atol=1e-9 * np.abs(response.load).max())  # cells of 1e9 N/m stretch nanometres


def test_a_mass_on_one_set_of_cells_swings_as_one_degree_of_freedom(burst: Burst) -> None:
    mass, k, c = 10.0, 4e5, 60.0
    ball = base_excitation_rig.rigid("ball", Inertia.from_cog(mass, [0, 0, 0], np.diag([0.1, 0.1, 0.1])))
    cells = [LoadCell(position=[x, y, 0.0], stiffness=[k / 4] * 3, damping=[c / 4] * 3) for x in (0.1, -0.1) for y in (0.1, -0.1)]
    response = base_excitation_response.respond(Rig(article=ball, cells=tuple(cells)), burst(RATE, np.eye(6)[2], 6.0))
    lines, table, load = spectra(response)
    omega = 2 * np.pi * lines
    blocked = mass * (k + 1j * omega * c) / (k + 1j * omega * c - omega**2 * mass)
    assert_allclose(load[:, 2] / table[:, 2], blocked, rtol=1e-6)


def test_cover_plate_and_cells_follow_from_the_coordinates(clumod: Clumod, mounted: Mounted, burst: Burst) -> None:
    rig = mounted(clumod("clumod-1"), softer=1e4)
    motion = burst(RATE, np.array([1, -2, 3, 4, 5, -6.0]), 0.5)
    response = base_excitation_response.respond(rig, motion, keep_coordinates=True)
    moved = response.coordinates[:, :6]
    assert response.coordinates.shape[1] == 6 + 2 + len(rig.article.reduced.mass) - 6
    rate = np.gradient(moved, axis=0) * RATE
    second = np.gradient(rate, axis=0)[100:-100] * RATE
    # Differences of second order at 8192 Hz: of what moves below 200 Hz they lack 1 %.
    off = np.abs(second + motion.acceleration[100:-100] - response.cover[100:-100]).max(axis=0)
    assert (off < 0.02 * np.abs(response.cover).max(axis=0)).all()
    cell, G = rig.cells[1], rigid_transformation(rig.cells[1].position)
    force = -(moved @ G.T * cell.stiffness + rate @ G.T * cell.damping)
    assert_allclose(force[1:-1], response.cells[1:-1, 1], atol=0.01 * np.abs(response.cells).max())


def test_a_flange_that_does_not_give_is_none(clumod: Clumod, mounted: Mounted, burst: Burst) -> None:
    rig, motion = mounted(clumod("clumod-1")), burst(RATE, np.ones(6), 0.5)
    stiff, none = (
        base_excitation_response.respond(replace(rig, flange=flange), motion).load
        for flange in (Flange(compliance=np.zeros(6)), None)
    )
    assert_allclose(stiff, none, atol=1e-12 * np.abs(none).max())


def test_compliance_of_the_flange_adds_to_the_static_answer(rigid_block: FlexibleBody) -> None:
    """H = M + omega² M D M / (1 + i omega t) to the second order: D gives way under M at the article's origin."""
    D, lines, damping_time = np.diag([1e-8, 2e-8, 3e-8, 1e-7, 2e-7, 3e-7]), np.array([1.0, 2.0]), 0.05
    rig = Rig(article=rigid_block, flange=Flange(compliance=np.diag(D), damping_time=damping_time))
    M = rigid_block.reduced.mass
    extra = base_excitation_rig.dynamic_mass(rig, lines).matrix - M
    omega = 2 * np.pi * lines[:, None, None]
    assert_allclose(extra, omega**2 * (M @ D @ M) / (1 + 1j * omega * damping_time), rtol=1e-4, atol=1e-5 * np.abs(extra).max())


def test_a_cable_to_the_ground_pulls_with_the_tables_own_displacement(rigid_block: FlexibleBody, burst: Burst) -> None:
    strut = Strut(place="top", stiffness=np.array([2e3, 0, 5e2]), damping=np.array([0, 30.0, 0]))
    motion = burst(1024.0, np.array([1, -2, 3, 4, 5, -6.0]))
    G = rigid_transformation([0.1, 0.05, 0.4])
    held = (motion.displacement @ G.T * strut.stiffness + motion.velocity @ G.T * strut.damping) @ G
    response = base_excitation_response.respond(Rig(article=rigid_block, struts=(strut,)), motion)
    assert_allclose(response.load, motion.acceleration @ rigid_block.reduced.mass + held, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("to", ["ground", "table"])
def test_a_rig_with_struts_answers_as_its_dynamic_mass(clumod: Clumod, mounted: Mounted, burst: Burst, to: str) -> None:
    strut = Strut(place="top", to=to, stiffness=np.array([3e3, 1e3, 1e4]), damping=np.array([20.0, 10, 30]))
    rig = replace(mounted(clumod("clumod-1")), struts=(strut,))
    lines, table, load = spectra(base_excitation_response.respond(rig, burst(RATE, np.array([1, 0, 0, 0, 2.0, 0]), 6.0)))
    some = slice(None, None, 5)
    expected = np.einsum("fij,fj->fi", base_excitation_rig.dynamic_mass(rig, lines[some]).matrix, table[some])
    assert_allclose(load[some], expected, atol=1e-5 * np.abs(expected).max())


def test_a_strut_to_the_table_is_not_felt_by_what_moves_as_one(rigid_block: FlexibleBody, burst: Burst) -> None:
    strut = Strut(place="top", to="table", stiffness=np.full(3, 1e5), damping=np.full(3, 1e2))
    motion = burst(1024.0, np.array([1, -2, 3, 4, 5, -6.0]))
    plain, strutted = (base_excitation_response.respond(Rig(article=rigid_block, struts=s), motion).load for s in ((), (strut,)))
    assert_allclose(strutted, plain)


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("name", ["clumod-1", pytest.param("clumod-4", marks=pytest.mark.proof)])
def test_spectra_of_a_burst_give_the_dynamic_mass(clumod: Clumod, burst: Burst, name: str, axis: int) -> None:
    """0.01 % off resonance and 0.05 % at resonance are asked for; cut at 12 s, clumod-4 would leave 4e-6 in the spectra."""
    rig = Rig(article=clumod(name))
    lines, table, load = spectra(base_excitation_response.respond(rig, burst(RATE, np.eye(6)[axis], RINGS[name])))
    assert column_error(rig, lines, load / table[:, [axis]], axis) < 5e-7


@pytest.mark.parametrize("axis", [0, 2, 4])
@pytest.mark.parametrize("name", ["clumod-1", pytest.param("clumod-4", marks=pytest.mark.proof)])
def test_cells_and_flange_change_nothing_about_that(clumod: Clumod, mounted: Mounted, burst: Burst, name: str, axis: int) -> None:
    rig = mounted(clumod(name))
    lines, table, load = spectra(base_excitation_response.respond(rig, burst(RATE, np.eye(6)[axis], RINGS[name])))
    assert column_error(rig, lines, load / table[:, [axis]], axis) < 5e-6


def column_error(rig: Rig, lines: np.ndarray, column: np.ndarray, axis: int) -> float:
    """Greatest difference at every fifth line as a share of the column there, rows scaled by the root of their inertia."""
    scale = 1 / np.sqrt(np.diag(base_excitation_rig.matrices(rig).mass)[:6])
    truth = base_excitation_rig.dynamic_mass(rig, lines[::5]).matrix[:, :, axis]
    return float(
        (np.abs(column[::5] - truth) @ np.diag(scale)).max(axis=1).__truediv__((np.abs(truth) * scale).max(axis=1)).max()
    )


def test_a_seat_moves_the_reference_point_to_f(clumod: Clumod, condensed: Callable[..., np.ndarray]) -> None:
    article, lines, seat = clumod("clumod-1"), np.array([5.0, 12.3]), np.array([0.1, -0.2, 0.3])
    T = rigid_transformation_6(seat)
    expected = T.T @ condensed(article.reduced, lines) @ T
    assert_allclose(
        base_excitation_rig.dynamic_mass(Rig(article=article, seat=seat), lines).matrix, expected, rtol=1e-9, atol=1e-10
    )


@pytest.mark.parametrize(("rate", "where"), [(1000.0, "beyond half the sampling rate"), (4096.0, "sampled too coarsely")])
def test_a_rate_too_coarse_for_a_kept_mode_is_refused_with_the_one_needed(
    clumod: Clumod, burst: Burst, rate: float, where: str
) -> None:
    article = clumod("clumod-1")
    with pytest.raises(BadInput, match=f"`sampling_rate`.*{where}.*Simulate at {np.ceil(8 * article.kept.max()):.0f} Hz"):
        base_excitation_response.respond(Rig(article=article), burst(rate, np.ones(6), 0.1))


def test_friction_and_preload_are_sent_to_exudyn(rigid_block: FlexibleBody, mounted: Mounted, burst: Burst) -> None:
    motion = burst(1024.0, np.ones(6), 0.1)
    with pytest.raises(BadInput, match=r"friction is not linear.*exudyn"):
        base_excitation_response.respond(Rig(article=rigid_block, frictions=(Friction(axis="x", slip_force=10.0),)), motion)
    with pytest.raises(BadInput, match=r"lift off.*exudyn"):
        base_excitation_response.respond(mounted(rigid_block, preload=1e4), motion)


def test_a_response_says_how_it_was_found(clumod: Clumod, burst: Burst) -> None:
    told: list[float] = []
    response = base_excitation_response.respond(
        Rig(article=clumod("clumod-1")), burst(RATE, np.ones(6), 0.2), progress=told.append
    )
    settings = json.loads(json.dumps(dict(response.settings)))
    assert settings["route"] == "recursion"
    assert (settings["modes"], settings["sampling_rate_hz"]) == (30, RATE)
    assert told[-1] == 1.0
    (warning,) = response.warnings
    assert "s are needed" in warning


def test_a_response_that_grows_beyond_all_numbers_is_lost_with_channel_and_time(
    clumod: Clumod, burst: Burst, capfd: pytest.CaptureFixture[str]
) -> None:
    """A damping ratio of -1.5 grows by exp(0.38 omega t) at least: beyond 1e100 within seconds, and nothing is printed."""
    article = clumod("clumod-1")
    fed = replace(article, reduced=replace(article.reduced, viscous=-50 * article.reduced.viscous))
    with pytest.raises(CheckFailed, match=r"recursion lost the rig at [\d.]+ s: its .* grown beyond 1e\+100") as lost:
        base_excitation_response.respond(Rig(article=fed), burst(RATE, np.eye(6)[0]))
    assert lost.value.evidence["route"] == "recursion"
    assert str(lost.value.evidence["channel"]).startswith(("load ", "acceleration "))
    assert 0 < float(str(lost.value.evidence["time"])) < 5.6
    assert len(str(lost.value)) < 300
    assert capfd.readouterr() == ("", "")


LINES = np.linspace(4.0, 32.0, 281)
RATIO = Damping(ratio=0.003)


@pytest.fixture(scope="module")
def four() -> Structure:
    return articles.structure("clumod-4")


@pytest.fixture(scope="module")
def modes(four: Structure) -> Modes:
    return fixed_base(four, 30, damping=RATIO)


def error(H: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """At every line, the largest difference as a share of the largest entry, axes scaled by the root of their inertia."""
    scale = np.sqrt(np.abs(truth[0].diagonal()))
    scale = np.outer(scale, scale)
    return (np.abs(H - truth) / scale).max(axis=(1, 2)) / (np.abs(truth) / scale).max(axis=(1, 2))


Condensed = Callable[[FlexibleBody, np.ndarray], np.ndarray]


@pytest.fixture(scope="module")
def dynamic_mass_of(condensed: Callable[..., np.ndarray]) -> Condensed:
    """``dynamic_mass_of(body, lines)``, of the matrices that it has on its base."""
    return lambda made, lines=LINES: condensed(made.reduced, lines)


def viscous_alone(modes: Modes) -> Modes:
    """`modes` as they answer in time."""
    _, C = rig.viscous(modes)
    return replace(modes, viscous=C, structural=np.zeros_like(C), condensed=None)


def test_static_coordinates_beat_the_residual_against_the_direct_solution(
    four: Structure, modes: Modes, dynamic_mass_of: Condensed
) -> None:
    truth = dynamic_mass.direct(four, LINES, RATIO, modes=modes).matrix
    mine = error(dynamic_mass_of(rig.flexible("c", four, modes)), truth).max()
    assert mine < error(dynamic_mass.modal(modes, LINES).matrix, truth).max() / 3
    assert mine < 2e-5


def test_what_is_left_out_grows_with_the_sixth_power_of_the_frequency(four: Structure, dynamic_mass_of: Condensed) -> None:
    lines = np.array([8.0, 16.0])
    few = fixed_base(four, 11, damping=Damping())
    truth = dynamic_mass.direct(four, lines, Damping()).matrix
    left = np.abs(dynamic_mass_of(rig.flexible("c", four, few), lines) - truth).max(axis=(1, 2))
    assert_allclose(np.log2(left[1] / left[0]), 6.0, atol=0.4)  # the next mode, at 38 Hz, is not infinitely far


def test_structural_damping_made_viscous_costs_what_is_said(four: Structure, dynamic_mass_of: Condensed) -> None:
    lossy = fixed_base(four, 30)
    truth = dynamic_mass.direct(four, LINES).matrix
    assert error(dynamic_mass_of(rig.flexible("c", four, lossy)), truth).max() < 0.01
    # Without the condensation of the truncated modes it is twice as much.
    assert error(dynamic_mass.modal(viscous_alone(replace(lossy, condensed=None)), LINES).matrix, truth).max() > 0.015


def test_modal_data_alone_answer_as_modes_with_their_residual(modes: Modes, dynamic_mass_of: Condensed) -> None:
    made = rig.of_modal_data("own", modes)
    assert_allclose(error(dynamic_mass_of(made), dynamic_mass.modal(modes, LINES).matrix), 0, atol=2e-4)
    low = np.array([0.5, 1.0])  # where R is all that the carriers are
    assert error(dynamic_mass_of(made, low), dynamic_mass.modal(modes, low).matrix).max() < 1e-9
    assert np.linalg.eigvalsh(made.reduced.mass).min() > 0
    assert np.sqrt(made.reduced.stiffness.diagonal()[36:].min()) / (2 * np.pi) > 2 * modes.frequency[-1]


def test_modal_data_about_another_point_is_moved_to_the_origin(modes: Modes, dynamic_mass_of: Condensed) -> None:
    T = rigid_transformation_6([0.1, -0.2, 0.3]).T
    elsewhere = replace(
        modes,
        participation=np.linalg.solve(T, modes.participation),
        rigid_mass=np.linalg.solve(T, np.linalg.solve(T, modes.rigid_mass).T),
        residual=np.linalg.solve(T, np.linalg.solve(T, modes.residual).T),
        reference_point=[0.1, -0.2, 0.3],
    )
    here, there = (dynamic_mass_of(rig.of_modal_data("own", m)) for m in (modes, elsewhere))
    assert_allclose(there, here, atol=1e-8 * np.abs(here).max())  # the carriers' directions depend on the units


def test_a_body_without_residual_needs_no_carriers(four: Structure, modes: Modes) -> None:
    bare = replace(modes, residual=np.zeros((6, 6)))
    assert rig.of_modal_data("own", bare).reduced.mass.shape == (36, 36)


def test_modes_that_move_more_mass_than_there_is_are_refused(modes: Modes) -> None:
    with pytest.raises(BadInput, match=r"`participation`: its modes must not move more mass"):
        rig.of_modal_data("own", replace(modes, participation=3 * modes.participation))


def test_an_inertia_that_no_body_has_is_refused() -> None:
    with pytest.raises(BadInput, match="body block"):
        rig.rigid("block", Inertia.from_cog(-3.0, [0.0, 0.0, 0.0], np.diag([0.4, 0.5, 0.6])))


def test_places_move_with_the_base_and_with_the_shapes(four: Structure, modes: Modes) -> None:
    made = rig.flexible("c", four, modes, places={"flange": [0.1, 0.0, 0.0], "top": [0.0, 0.0, 1.6]})
    assert_allclose(made.places["flange"][:, 6:], 0.0)
    assert_allclose(made.places["flange"][:, 5], [0.0, 0.1, 0.0], atol=1e-15)
    top = int(np.argmax(four.points[:, 2]))
    assert_allclose(made.places["top"][:, 6:36], modes.shapes[four.translations[top]])
    assert_allclose(made.places["top"][:, :6], four.rigid[four.translations[top]])


def test_a_place_off_the_structure_is_refused(four: Structure, modes: Modes) -> None:
    with pytest.raises(BadInput, match=r"`places.nowhere`.*nearest is .* mm away"):
        rig.flexible("c", four, modes, places={"nowhere": [0.0, 0.0, 3.0]})


def test_modes_without_shapes_are_refused(four: Structure, modes: Modes) -> None:
    with pytest.raises(BadInput, match="`modes`: shapes on all 402"):
        rig.flexible("c", four, replace(modes, shapes=np.zeros((0, 30))))


def test_a_solid_about_another_point_is_reduced_about_the_articles_origin(
    block: Callable[..., Structure], dynamic_mass_of: Condensed
) -> None:
    """A column of point masses and springs, whose base is not where its reference point is."""
    column, point = block(2, 2, 4), np.array([0.3, -0.2, 0.1])
    points = column.points
    elsewhere = replace(column, reference_point=point, rigid=translations(points, point))
    modes = fixed_base(elsewhere, 4, damping=Damping())
    made = rig.flexible("column", elsewhere, modes, places={"corner": points[-1]})
    lines = np.array([0.0, 0.2, 0.4]) * modes.frequency[0]
    expected = dynamic_mass.direct(elsewhere, lines, Damping()).about(np.zeros(3)).matrix
    # Four of 36 modes and six static answers leave out what grows with the sixth power.
    assert_allclose(dynamic_mass_of(made, lines), expected, atol=1e-6 * np.abs(expected).max())
    assert_allclose(made.reduced.basis[:, :6], translations(points, np.zeros(3)), atol=1e-15)
    assert_allclose(made.places["corner"], made.reduced.basis[-3:], atol=1e-15)


def translations(points: np.ndarray, reference_point: np.ndarray) -> np.ndarray:
    return rigid_motion(points, reference_point).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)


CORNERS = np.array([[0.1, 0.1, 0], [-0.1, 0.1, 0], [-0.1, -0.1, 0], [0.1, -0.1, 0]])
STIFF = np.full(3, 1e8)


def cells(places: np.ndarray = CORNERS, **last: Any) -> tuple[LoadCell, ...]:
    made = [LoadCell(position=place, stiffness=STIFF) for place in places]
    return (*made[:-1], replace(made[-1], **last))


def test_a_rig_that_can_be_built_is_handed_back(mounted: Callable[..., Rig], rigid_block: FlexibleBody) -> None:
    rig = replace(mounted(rigid_block, preload=1e4), struts=(Strut(place="top", stiffness=STIFF),))
    rig = replace(rig, frictions=(Friction(axis="y", slip_force=5.0),))
    assert require_usable(rig) is rig


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "a cell without stiffness": (
        {"cells": cells(stiffness=[1e8, 0, 1e8])},
        r"`cells.4.stiffness`.*above zero, found 0 N/m along y",
    ),
    "a cell that drives": ({"cells": cells(damping=[0, 0, -1.0])}, r"`cells.4.damping`.*found -1 N s/m along z"),
    "a negative preload": ({"cells": cells(preload=-200.0)}, r"`cells.4.preload`.*above zero, found -200 N"),
    "a preload of nothing": ({"cells": cells(preload=0.0)}, r"`cells.4.preload`.*above zero, found 0 N"),
    "cells in one line": ({"cells": cells(CORNERS[[0, 2]])}, r"`cells`.*hold the cover plate.*found 2"),
    "one cell in the middle": ({"cells": cells(np.zeros((1, 3)))}, r"`cells`.*hold the cover plate.*found 1"),
    "a negative compliance": ({"flange": Flange(compliance=[0, 0, -1e-9, 0, 0, 0])}, r"`flange.compliance`.*found -1e-09"),
    "a flange that drives": ({"flange": Flange(compliance=np.zeros(6), damping_time=-1.0)}, r"`flange.damping_time`.*-1 s"),
    "a joint that holds nothing": ({"flange": Flange(compliance=[0, 0, 0, 0, 1e9, 0])}, r"`flange.compl.*for beta, found 1e\+09"),
    "a joint as good as rigid": ({"flange": Flange(compliance=[1e-30, 0, 0, 0, 0, 0])}, r"`flange.compl.*for x, found 1e-30"),
    "a joint in tar": (
        {"flange": Flange(compliance=[0, 0, 0, 1e-6, 0, 0], damping_time=1e9)},
        r"`flange.damping_time`.*for alpha, found 1e\+09",
    ),
    "a cell of rubber": ({"cells": cells(stiffness=[1e8, 1e8, 1e-9])}, r"`cells.4.stiffness`.*along z, found 1e-09"),
    "a cell as good as rigid": ({"cells": cells(stiffness=[1e20, 1e8, 1e8])}, r"`cells.4.stiffness`.*along x, found 1e\+20"),
    "a cell in tar": ({"cells": cells(damping=[0, 1e30, 0])}, r"`cells.4.damping`.*along y, found 1e\+30"),
    "a strut as good as rigid": ({"struts": (Strut(place="top", stiffness=[1e30] * 3),)}, r"`struts.stiffness`.*found 1e\+30"),
    "a strut in tar": ({"struts": (Strut(place="top", damping=[1e30] * 3),)}, r"`struts.damping`.*found 1e\+30"),
    "a loose part of many tons": ({"frictions": (Friction(axis="x", slip_force=5.0, mass=1e6),)}, r"`frictions.mass`"),
    "a strut nowhere": ({"struts": (Strut(place="tpo"),)}, r"`struts.place`.*block has no place 'tpo'.*top"),
    "a strut to the moon": ({"struts": (Strut(place="top", to="moon"),)}, r"`struts.to`.*'moon'"),
    "a strut that pushes": ({"struts": (Strut(place="top", stiffness=-STIFF),)}, r"`struts.stiffness`.*found -1e\+08"),
    "a strut that drives": ({"struts": (Strut(place="top", damping=-STIFF),)}, r"`struts.damping`.*found -1e\+08"),
    "friction along z": ({"frictions": (Friction(axis="z", slip_force=5.0),)}, r"`frictions.axis`.*'z'"),
    "friction that slips at nothing": ({"frictions": (Friction(axis="x", slip_force=0.0),)}, r"`frictions.slip_force`"),
    "friction without mass": ({"frictions": (Friction(axis="x", slip_force=5.0, mass=-2.0),)}, r"`frictions.mass`.*-2 kg"),
}


@pytest.mark.parametrize(("changes", "message"), REFUSED.values(), ids=list(REFUSED))
def test_what_nobody_can_build_is_refused(rigid_block: FlexibleBody, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        require_usable(replace(Rig(article=rigid_block), **changes))


def test_structural_damping_has_no_place_in_time(rigid_block: FlexibleBody) -> None:
    lossy = replace(rigid_block, reduced=replace(rigid_block.reduced, structural=np.eye(6)))
    with pytest.raises(BadInput, match=r"`article.reduced`.*must be viscous"):
        require_usable(Rig(article=lossy))


def test_a_joint_as_stiff_as_may_be_hides_nothing_of_the_article(clumod: Clumod, burst: Burst) -> None:
    """The response is that on a rigid joint; what is left is the recursion's own (omega h)² / 12 in a joint that only follows."""
    article, motion = clumod("clumod-1"), burst(8192.0, np.ones(6), 0.2)
    stiffest = Flange(compliance=1.01 / (STIFFEST * np.diag(article.reduced.mass)[:6]), damping_time=1e-7)
    found, rigid = (response.respond(Rig(article=article, flange=flange), motion).load for flange in (stiffest, None))
    assert_allclose(found, rigid, rtol=0, atol=1e-4 * np.abs(rigid).max())


def test_a_joint_as_soft_as_may_be_leaves_the_article_where_it_is(rigid_block: FlexibleBody, burst: Burst) -> None:
    compliance = 0.99 / (SOFTEST * np.diag(rigid_block.reduced.mass)[:6])
    motion = burst(1024.0, np.eye(6)[0], 0.2)
    load = response.respond(Rig(article=rigid_block, flange=Flange(compliance=compliance)), motion).load
    assert np.abs(load[:, 0]).max() < 1e-4 * rigid_block.reduced.mass[0, 0] * np.abs(motion.acceleration).max()
