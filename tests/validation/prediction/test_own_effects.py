"""A user's own effects and articles."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.sensors import ChannelTable
from identification.campaign import Campaign
from validation.effects import catalogue
from validation.estimation.fit import fit
from validation.estimation.problem import EFFECT, Problem
from validation.model import model_file
from validation.model.model import require_pair
from validation.prediction.dynamic_mass import dynamic_mass
from validation.prediction.mounting import drawn_inertia, mounted_article

BLADE = "fmd+clumod-1"
DAMPED, LOWPASS = "dashpot:mast-top", "force-lowpass:fmd-z2"


@pytest.fixture(scope="module", autouse=True)
def _own_effects(root) -> Iterator[None]:
    """Those of the example, for these tests alone."""
    kept = [dict(one) for one in (catalogue._found, catalogue._sources, catalogue._files)]
    catalogue.load(root / "examples" / "effects")
    yield
    for one, before in zip((catalogue._found, catalogue._sources, catalogue._files), kept, strict=True):
        one.clear()
        one.update(before)


def test_what_was_planted_is_fitted(faulty, predicted, added):
    """Of the structure; `examples/own_effect.py` does the same of a channel."""
    test = faulty(BLADE, f"{DAMPED}=60")
    without, of = (predicted(test, effects=effects) for effects in ((), added(f"{DAMPED}=3")))
    before, after = (fit(Problem(one).thinned(), (EFFECT,)) for one in (without, of))
    assert [one.name for one in after.parameters] == [DAMPED]
    assert after.converged
    assert after.parameters[0].value(float(after.offsets[0])) == pytest.approx(60.0, rel=0.01)
    assert after.chi2 < before.chi2 / 10
    assert after.log_evidence > before.log_evidence + 10


@pytest.mark.parametrize("effect", [f"{DAMPED}=40", f"{LOWPASS}=5e-4"])
def test_its_derivative_is_that_of_finite_differences(faulty, predicted, added, effect):
    (of,) = predicted(faulty(BLADE), effects=added(effect))
    name, lines = effect.partition("=")[0], np.array([0, 152, 240, 560])
    start = next(one.start for one in of.parameters if one.name == name)
    h = 1e-4 * start
    change = of.at({name: start}, lines).changes[name]
    up, down = (of.at({name: start + side * h}, lines, derivatives=False).rows for side in (1, -1))
    slope = ((up - down) / (2 * h))[..., list(change.channels), :]
    assert_allclose(np.broadcast_to(change.rows, slope.shape), slope, rtol=0, atol=1e-6 * np.max(np.abs(slope)))


def test_it_acts_wherever_its_place_exists_and_nowhere_else(faulty, predicted, added):
    (of,) = predicted(faulty("fmd+disc+cuboid"), kind="rigid", effects=added(f"{DAMPED}=40"))
    assert DAMPED not in of.at({DAMPED: 40.0}, np.array([0])).changes


SIZES = np.array([0.16, 0.07, 0.10])
DENSITY = 2700.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A block of 160 x 70 x 100 mm, its origin in the middle of its underside, drawn in STEP and described beside it."""
    import cadquery

    made = tmp_path_factory.mktemp("models")
    block = cadquery.Workplane().box(*(1e3 * SIZES), centered=(True, True, False))
    cadquery.exporters.export(block, str(made / "block.step"))
    (made / "article.toml").write_text(
        'format = 1\n[article]\nname = "block"\n[material.alloy]\ndensity = "2700 kg/m^3"\nyoungs_modulus = "70 GPa"\n'
        'poisson_ratio = "0.33"\n[[part]]\nname = "block"\nfile = "block.step"\nmaterial = "alloy"\n'
    )
    for kind in ("rigid", "own"):
        (made / f"{kind}.toml").write_text(
            f"format = 1\n[model]\narticle = 'fmd+block'\n[structure]\nkind = '{kind}'\nmodes = 6\ndamping_ratio = 0.01\n"
            "[structure.own]\n'fmd+block' = 'article.toml'\n"
        )
    return made


@pytest.fixture
def campaign() -> Campaign:
    seat = Pose(position=np.array([0.0, 0.0, 0.045]))
    return Campaign(title="", article="fmd+block", table=ChannelTable(channels=()), runs=(), mounting=seat)


def of_a_block() -> np.ndarray:
    """(6, 6) about the middle of the underside, in closed form."""
    m = DENSITY * float(np.prod(SIZES))
    x, y, z = SIZES
    about = m / 12 * np.array([y * y + 4 * z * z, x * x + 4 * z * z, x * x + y * y])
    M = np.diag([m, m, m, *about])
    M[0, 4] = M[4, 0] = m * z / 2
    M[1, 3] = M[3, 1] = -m * z / 2
    return M


def test_a_drawing_taken_for_rigid_is_its_closed_form_and_one_that_gives_a_solid_model(folder, campaign):
    model = model_file.read(folder / "rigid.toml")
    require_pair(model, [campaign])
    there = mounted_article(model, campaign)
    np.testing.assert_allclose(there.matrices.mass, of_a_block(), rtol=1e-6, atol=1e-6)  # OCC's exact integration
    np.testing.assert_allclose(drawn_inertia(model, "block").mass_matrix, of_a_block(), rtol=1e-6, atol=1e-6)
    there = mounted_article(model_file.read(folder / "own.toml"), campaign)
    assert there.matrices is not None
    H = dynamic_mass(there.matrices, np.array([20.0])).matrix[0]
    np.testing.assert_allclose(H, of_a_block(), atol=1e-4 * np.abs(of_a_block()).max())  # (20 Hz / 4.5 kHz)², far below its modes
    assert there.frequency[0] > 3000


def test_a_drawing_without_material_is_refused_by_its_file_and_one_written_anew_is_read_anew(folder, campaign, refreshed):
    model = replace(model_file.read(folder / "rigid.toml"), own={"fmd+block": str(folder / "block.step")})
    with pytest.raises(BadInput, match=r"block\.step: `material`: no material is given"):
        mounted_article(model, campaign)
    model = model_file.read(folder / "rigid.toml")
    before = mounted_article(model, campaign).matrices
    text = (folder / "article.toml").read_text()
    (folder / "article.toml").write_text(text.replace("2700", "5400"))
    refreshed(folder / "article.toml")
    after = mounted_article(model, campaign).matrices
    (folder / "article.toml").write_text(text)
    np.testing.assert_allclose(after.mass, 2 * before.mass, rtol=1e-12)


@pytest.fixture
def refreshed() -> Callable[[Path], None]:
    """Makes a file look written a second later, however coarse the clock of the file system is."""
    import os

    return lambda path: os.utime(path, ns=(path.stat().st_atime_ns, path.stat().st_mtime_ns + 10**9))
