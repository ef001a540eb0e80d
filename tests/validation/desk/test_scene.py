"""What stands on the shaker, in 3-D: where sensors sit, what bodies there are, how a mode moves them."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.app import opening, scene3d, session
from validation.app.kept import Compared
from validation.app.opening import EXAMPLES, faults
from validation.app.session import Session, begun
from validation.compare.compare import modes_of

MAST = "fmd+clumod-1"


@pytest.fixture(scope="module")
def desk(mast, tmp_path_factory) -> Session:
    return begun(tmp_path_factory.mktemp("desks") / "scene", mast.model, mast.data)


@pytest.fixture(scope="module")
def found(desk) -> Compared:
    """As much of a comparison as shapes ask for, of the model as drawn."""
    ready = desk.study()
    start = ready.whole().start
    modes = tuple(modes_of(one, start) for one in ready.predictions)
    loads = ({},) * len(modes)
    named = [one.measured.name for one in ready.made]

    class Known(Compared):
        @property
        def campaigns(self) -> tuple[str, ...]:
            return tuple(named)

    return Known(summary={}, maps=(), modes=modes, offsets=start, loads=loads)


def test_sensors_stand_where_the_campaign_says_and_one_that_is_none_is_refused(desk):
    shown = scene3d.scene(desk, MAST)
    described = scene3d.the_campaign(desk, MAST)
    first = next(one for one in described.table.channels if one.name == "table-z1")
    sensor = next(one for one in shown.sensors if one.name == "table-z1")
    assert_allclose(sensor.position, np.asarray(first.places[0].position) - described.table.origin)
    assert len([one for one in shown.sensors if one.name == "fmd-x12"]) == 2  # a sum of two cells
    assert {one.group for one in shown.sensors} == {"table", "cover", "fmd"}
    assert {"mast", "lower-1"} <= {one.name.rpartition("/")[2] for one in shown.bodies}
    assert shown.title == described.title
    with pytest.raises(BadInput, match="Known are"):
        scene3d.scene(desk, "fmd+clumod-2")


def test_the_nearest_mode_is_told_in_octaves_its_shape_moves_the_mast_and_leaves_its_foot(found, desk):
    frequencies = [one.frequency for one in found.modes_of(MAST)]
    number = scene3d.nearest(found, MAST, 1.02 * frequencies[1])
    assert number == 1
    assert scene3d.nearest(found, MAST, 1e-3) == 0
    for number in (-1, 99):
        with pytest.raises(BadInput, match="found"):
            scene3d.shape(desk, found, MAST, number)
    one = scene3d.shape(desk, found, MAST, 0)
    assert one.frequency == found.modes_of(MAST)[0].frequency
    sizes = {body.name: body.size.max() for body in one.bodies}
    assert sizes["flange"] < 1e-6 * max(sizes.values())
    assert max(sizes, key=lambda name: sizes[name]) in ("lower-1", "mast")
    reach = one.scale * max(sizes.values())
    assert 0.01 < reach < 0.5  # [m] that are drawn of a mast of some two metres
    assert min(body.vertices[:, 2].min() for body in one.bodies) > 0.04  # it stands on the cover plate


def test_the_mode_that_is_drawn_is_that_of_the_model_as_it_stands(desk, found):
    """With the mast five times as stiff the first mode is one of the blade, and moves the mast less."""
    drawn = scene3d.shape(desk, found, MAST, 0)
    stiff = replace(found, offsets={**found.offsets, "modulus:mast": float(np.log(5.0))})
    other = scene3d.shape(desk, stiff, MAST, 0)

    def share(of):
        moved = {body.name: body.size.max() for body in of.bodies}
        return float(moved["mast"] / moved["lower-1"])

    assert share(other) < 0.7 * share(drawn)


@pytest.mark.parametrize(
    "name", [pytest.param(one.name, marks=[pytest.mark.proof] * (len(one.articles) > 1)) for one in EXAMPLES]
)
def test_every_example_opens(tmp_path, monkeypatch, name):
    """Swept sixteen times as fast, which its story does not survive, but its files do."""
    slow = next(one for one in EXAMPLES if one.name == name)
    quick = replace(slow, octaves_per_minute=240.0, driven=(8.0, 16.0), rate=256.0)
    monkeypatch.setattr(opening, "EXAMPLES", (quick,))
    heard: list[float] = []
    made = opening.made(name, lambda what, share: heard.append(share))
    assert heard[-1] == 1.0
    assert opening.made(name, lambda what, share: heard.append(-1)) == made
    assert heard[-1] == 1.0  # nothing was simulated again
    assert not any(one.grave for one in faults(made.model, made.data))
    desk = begun(tmp_path / "d", made.model, made.data, hold_out=made.hold_out, band=made.band, title=made.title)
    assert session.opened(desk.folder).title == slow.title
    assert not any("truth" in path for path in made.data)


def test_examples_do_not_say_what_is_hidden_and_one_that_is_none_is_refused():
    for one in EXAMPLES:
        for effect in one.effects:
            assert effect.split("=")[0] not in one.title + one.words
    with pytest.raises(BadInput, match="block"):
        opening.made("blok")
