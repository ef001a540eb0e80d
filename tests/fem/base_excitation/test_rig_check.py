"""A rig that nobody can build is refused, and the message says what of it."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import response
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import SOFTEST, STIFFEST, Flange, FlexibleBody, Friction, LoadCell, Rig, Strut, require_usable
from geometry.errors import BadInput

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


def test_a_joint_as_stiff_as_may_be_hides_nothing_of_the_article(
    clumod: Callable[[str], FlexibleBody], burst: Callable[..., BaseMotion]
) -> None:
    """The response is that on a rigid joint; what is left is the recursion's own (omega h)² / 12 in a joint that only follows."""
    article, motion = clumod("clumod-1"), burst(8192.0, np.ones(6), 0.2)
    stiffest = Flange(compliance=1.01 / (STIFFEST * np.diag(article.reduced.mass)[:6]), damping_time=1e-7)
    found, rigid = (response.respond(Rig(article=article, flange=flange), motion).load for flange in (stiffest, None))
    assert_allclose(found, rigid, rtol=0, atol=1e-4 * np.abs(rigid).max())


def test_a_joint_as_soft_as_may_be_leaves_the_article_where_it_is(
    rigid_block: FlexibleBody, burst: Callable[..., BaseMotion]
) -> None:
    compliance = 0.99 / (SOFTEST * np.diag(rigid_block.reduced.mass)[:6])
    motion = burst(1024.0, np.eye(6)[0], 0.2)
    load = response.respond(Rig(article=rigid_block, flange=Flange(compliance=compliance)), motion).load
    assert np.abs(load[:, 0]).max() < 1e-4 * rigid_block.reduced.mass[0, 0] * np.abs(motion.acceleration).max()
