"""Masses and inertias that leave no body are refused before anything is fitted, and those that leave one are not."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from geometry.errors import BadInput
from geometry.sensors import ChannelTable
from identification.campaign import Campaign
from validation.cli import main
from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary
from validation.model.model import Added, Model
from validation.prediction.classical_facts import require_bodies
from validation.prediction.structure import drawn_inertia
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import Plan
from validation.virtual_test.shaker import middles_of_cells

ANY = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)

MakeCampaign = Callable[[str], Campaign]


@pytest.fixture(scope="module")
def table() -> ChannelTable:
    return mavis(middles_of_cells(Plan(article="fmd+cuboid")), {}).table


@pytest.fixture
def campaign(table: ChannelTable) -> MakeCampaign:
    return lambda article: Campaign(article=article, title="", table=table, runs=(), source="one", gravity=9.81)


def model(*effects: str, fixed: bool = False, **changes: Any) -> Model:
    added = tuple(Added(named=parse(text, ANY), fixed=fixed) for text in effects)
    return Model(**{"source": "lab.toml", "title": "", "article": "fmd+cuboid", "effects": added, **changes})


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("kind", ["rigid", "beam"])
@pytest.mark.parametrize(
    ("effects", "words"),
    [
        (("rigid-inertia:m=-100",), "the mass must be positive, found -"),
        (("rigid-inertia:Ixx=-50",), "break the triangle inequality"),
        (("rigid-inertia:Ixy=5",), "break the triangle inequality"),
        (("point-mass:top=-90",), "the mass must be positive"),
    ],
)
def test_what_leaves_no_body_is_refused_by_name_with_what_results(
    effects: tuple[str, ...], words: str, kind: str, fixed: bool, campaign: MakeCampaign
) -> None:
    with pytest.raises(BadInput) as caught:
        require_bodies(model(*effects, kind=kind, fixed=fixed), [campaign("fmd"), campaign("fmd+cuboid")])
    assert caught.value.field == f"effect {effects[0].partition('=')[0]}"
    assert "no body is left of fmd+cuboid" in caught.value.problem
    assert words in caught.value.problem


def test_effects_are_judged_together(campaign: MakeCampaign) -> None:
    longer = ("rigid-inertia:Ixx=2", "rigid-inertia:Iyy=2")
    require_bodies(model(*longer, kind="rigid"), [campaign("fmd+cuboid")])
    for one in longer:
        with pytest.raises(BadInput, match="triangle inequality"):
            require_bodies(model(one, kind="rigid"), [campaign("fmd+cuboid")])


@pytest.mark.parametrize(
    "effects",
    [
        ("force-gain:fmd-z2=0.08",),
        ("rigid-inertia:m=-0.1",),
        ("point-mass:mast-top=-0.2",),  # nothing of the Cuboid is there
    ],
)
def test_what_leaves_a_body_passes(effects: tuple[str, ...], campaign: MakeCampaign) -> None:
    require_bodies(model(*effects, kind="rigid"), [campaign("fmd"), campaign("fmd+cuboid")])


def test_the_limit_is_the_mass_of_the_article(campaign: MakeCampaign) -> None:
    of = drawn_inertia(model(kind="rigid"), "cuboid")
    # what is taken away at the centre of gravity leaves the moments about it
    require_bodies(model(f"rigid-inertia:m={-0.999 * of.mass!r}", kind="rigid"), [campaign("fmd+cuboid")])
    with pytest.raises(BadInput):
        require_bodies(model(f"rigid-inertia:m={np.nextafter(-of.mass, -1e9)!r}", kind="rigid"), [campaign("fmd+cuboid")])


def test_warnings_of_the_arithmetic_never_reach_the_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def overflows(arguments: list[str] | None = None) -> int:
        warnings.warn("overflow encountered in exp", RuntimeWarning, stacklevel=1)
        return main.DONE

    monkeypatch.setattr(main, "run", overflows)
    monkeypatch.setattr("sys.warnoptions", [])
    with pytest.raises(SystemExit) as left:
        main.main([])
    assert left.value.code == main.DONE
    assert capsys.readouterr().err == ""
