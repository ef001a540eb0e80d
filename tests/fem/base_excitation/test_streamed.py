"""A run answered block by block is the run answered whole."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import response as base_excitation_response
from fem.base_excitation.patterns import Sweep, drawn
from fem.base_excitation.response import Channels, accelerations, cell_forces, decimated_channels, joined, stacked
from fem.base_excitation.rig import FlexibleBody, LoadCell, Rig, RigStructure, Strut, rigid
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia

RATE = 8192.0
SWEEP = Sweep(axis="beta", rate=120.0, delay=0.1)


def wanted(structure: RigStructure) -> Channels:
    return stacked([accelerations(structure.cover, "cover"), cell_forces(structure)])


def collected(rig: Rig, **options: object) -> tuple[np.ndarray, np.ndarray]:
    """Motion (3, n, 6) and values (n, o) of the whole run."""
    pieces = list(base_excitation_response.streamed(rig, SWEEP, RATE, wanted, cross=drawn(np.random.default_rng(0)), **options))
    motion = np.concatenate([piece.motion for piece in pieces], axis=2).transpose(0, 2, 1)
    return motion, np.hstack([piece.values for piece in pieces]).T


@pytest.mark.parametrize("grounded", [False, True])
def test_a_streamed_run_is_the_whole_run(
    grounded: bool, mounted: Callable[..., Rig], clumod: Callable[[str], FlexibleBody]
) -> None:
    rig = mounted(clumod("clumod-1"))
    if grounded:
        rig = Rig(article=rig.article, cover=rig.cover, seat=rig.seat, cells=rig.cells, struts=(cable(),))
    motion, values = collected(rig, quiet=0.2)
    whole = SWEEP.motion(RATE, ring_down=len(values) / RATE - 1.0, cross=drawn(np.random.default_rng(0)))
    n = min(len(values), len(whole.time))
    for found, expected in zip(motion, (whole.displacement, whole.velocity, whole.acceleration), strict=True):
        assert_allclose(found[:n], expected[:n], rtol=0, atol=1e-10 * np.abs(expected).max())
    response = base_excitation_response.respond(rig, whole)
    for found, expected in ((values[:, :6], response.cover), (values[:, 6:], response.cells.reshape(len(response.cells), -1))):
        assert_allclose(found[:n], expected[:n], rtol=0, atol=1e-10 * np.abs(expected).max())


def cable() -> Strut:
    return Strut(place="top", stiffness=np.full(3, 1e3), damping=np.full(3, 5.0))


def test_the_record_ends_when_the_ringing_has_fallen_to_its_share(
    mounted: Callable[..., Rig], clumod: Callable[[str], FlexibleBody]
) -> None:
    """A hundredth of the share takes ln(100) / (zeta omega) more of the slowest mode that rings; what is left is below it."""
    rig = mounted(clumod("clumod-1"))
    lengths = []
    for share in (1e-3, 1e-5):
        _, values = collected(rig, share=share)
        lengths.append(len(values) / RATE)
        assert np.abs(values[-200:, 6:]).max() < 3 * share * np.abs(values[:, 6:]).max()
    slowest = 0.03 * 2 * np.pi * rig.article.kept[0]
    assert 0.5 < (lengths[1] - lengths[0]) * slowest / np.log(100) < 1.3


def test_what_never_stops_ringing_is_refused(clumod: Callable[[str], FlexibleBody], mounted: Callable[..., Rig]) -> None:
    inertia = Inertia.from_cog(20.0, [0, 0, 0.2], np.eye(3))
    cells = tuple(LoadCell(position=np.array([x, y, 0.0]), stiffness=np.full(3, 1e5)) for x in (0.1, -0.1) for y in (0.1, -0.1))
    undamped = Rig(article=rigid("block", inertia), cover=inertia, cells=cells)
    with pytest.raises(CheckFailed, match="Give it damping"):
        collected(undamped)


def test_a_rate_too_coarse_for_the_sweep_or_for_a_mode_is_refused(
    mounted: Callable[..., Rig], clumod: Callable[[str], FlexibleBody]
) -> None:
    rig = mounted(clumod("clumod-1"))
    for rate, said in ((60.0, "twice the highest frequency driven"), (600.0, "highest kept mode")):
        with pytest.raises(BadInput, match=said):
            next(base_excitation_response.streamed(rig, SWEEP, rate, wanted))


@pytest.mark.parametrize("delay", [0.0, 20e-6, -33e-6, 1.3e-3, 0.05])
def test_a_delay_is_that_of_the_closed_form(delay: float) -> None:
    time = np.arange(4 * 8460) / 8460

    def signal(t: np.ndarray) -> np.ndarray:
        return np.exp(-(((t - 2) / 0.3) ** 2)) * np.cos(2 * np.pi * 30 * t)

    found = decimated_channels(signal(time)[:, None], 8460.0, 564.0, delay)[:, 0]
    assert_allclose(found, signal(np.arange(len(found)) / 564 - delay), rtol=0, atol=2e-7)  # ripple of the filter: 1e-6 at most


def test_delays_change_nothing_but_the_phase_between_channels() -> None:
    """The filter is the same, so its ripple cancels in a ratio: what is left of a delay is exp(-i w tau), to rounding."""
    rng, delays = np.random.default_rng(1), np.array([0.0, 17e-6, -2.4e-4, 3.1e-3])
    time = np.arange(6 * 8460) / 8460
    shape = np.exp(-(((time - 3) / 0.4) ** 2)) * sum(np.cos(2 * np.pi * f * time + rng.uniform(0, 6)) for f in (7, 19, 31))
    found = decimated_channels(np.tile(shape[:, None], (1, 4)), 8460.0, 564.0, delays)
    lines = np.array([7.0, 19.0, 31.0])
    spectra = np.exp(-2j * np.pi * np.outer(lines, np.arange(len(found)) / 564)) @ found
    assert_allclose(spectra / spectra[:, :1], np.exp(-2j * np.pi * np.outer(lines, delays)), rtol=0, atol=1e-10)


def test_how_a_record_is_cut_into_blocks_leaves_no_trace() -> None:
    rng, late = np.random.default_rng(2), np.array([0.0, 0.3, -7.9])
    whole = rng.standard_normal((3, 5000))
    expected = joined([whole], 15, late)
    for cuts in ([1, 2, 3], [700, 701, 4999], list(range(1, 5000, 97))):
        assert_allclose(joined(np.split(whole, cuts, axis=1), 15, late), expected, rtol=0, atol=1e-12)
