"""Findings made by hand, a campaign without recordings, and folders of campaigns: the face is tested without its driver."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from geometry import routes
from geometry.articles import built_in
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.frames import Pose
from geometry.inertia import Inertia
from geometry.sensors import Channel, ChannelTable, Place
from identification.campaign import Campaign, Excitation, Run
from identification.consistency import Finding
from identification.dynamic_mass import CrossMotion
from identification.elastic.model import ElasticTerms, dynamic_mass
from identification.request import Identified, Request, Tare
from identification.spectra.line_spectra import Spectra
from validation.identify.identify import DrawnBandStudy, DrawnResiduals, IdentificationFindings, UsedLines, reported

INPUTS = ("noise", "force-gain", "accelerometer-position", "tare")
FREQUENCY = np.linspace(4.0, 32.0, 141)
MOUNTED = Pose(position=np.array([0.0, 0.0, 0.045]))


def channels() -> ChannelTable:
    """Cells and pick-ups enough to be told apart by name; nothing is measured with them here."""
    x, y, z = np.eye(3)
    corners = [(0.13 * a, 0.13 * b, 0.0) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]

    def one(name: str, quantity: str, group: str, at: tuple[float, float, float], along: NDArray[np.float64]) -> Channel:
        return Channel(name=name, quantity=quantity, group=group, places=(Place(position=np.array(at), direction=along),))

    named = [(f"cover-z{k + 1}", "acceleration", "cover", at, z) for k, at in enumerate(corners)]
    named += [
        ("cover-x1", "acceleration", "cover", (0.2, 0.15, 0.03), x),
        ("cover-y1", "acceleration", "cover", (0.15, 0.2, 0.0), y),
    ]
    named += [
        (f"fmd-{axis}{k + 1}", "force", "fmd", at, d)
        for axis, d in zip("xyz", (x, y, z), strict=True)
        for k, at in enumerate(corners)
    ]
    return ChannelTable(channels=tuple(one(*each) for each in named))


def campaign(article: str, **changes: object) -> Campaign:
    """A campaign without recordings."""
    sweep = Excitation(kind="sine-sweep", figures={"start_hz": 4.0, "stop_hz": 32.0})
    runs = tuple(Run(name=axis, file=f"{axis}.h5", axis=axis, excitation=sweep) for axis in MOTIONS)
    made = Campaign(
        title=article, article=article, hardware="lab/1", table=channels(), runs=runs, mounting=MOUNTED, source=article
    )
    return replace(made, **changes)


@pytest.fixture
def make_campaign() -> Callable[..., Campaign]:
    return campaign


@pytest.fixture(scope="session")
def clumod() -> Inertia:
    """Clumod with one blade in its own frame."""
    return routes.inertia(built_in("clumod-1"))


@pytest.fixture(scope="session")
def terms() -> ElasticTerms:
    L = np.array([[0.1, 0.9, 0.0, -1.6, 0.0, 0.0], [0.0, 0.0, 1.6, 0.0, 0.02, 0.0], [2.6, 0.0, 0.0, 0.0, 2.9, 0.3]])
    f = np.array([16.0, 12.3, 11.6])
    return ElasticTerms(frequency=f, damping=np.diag(4 * np.pi * f * np.array([0.2, 0.004, 0.003])), participation=L)


def covariance(inertia: Inertia, share: float) -> NDArray[np.float64]:
    """Correlated, of the size of `share` of the parameters' scales."""
    rng = np.random.default_rng(5)
    A = np.eye(10) + 0.3 * rng.standard_normal((10, 10))
    size = share * np.array([inertia.mass, *3 * [10.0], *6 * [8.0]])
    return np.asarray(size[:, None] * (A @ A.T) * size)


def identified(way: str, inertia: Inertia, terms: ElasticTerms, share: float) -> Identified:
    rng = np.random.default_rng(7)
    weight = rng.dirichlet(np.full(len(INPUTS), 0.5))
    C = covariance(inertia, share)
    return Identified(
        way=way,
        inertia=inertia,
        covariance=C,
        band=(4.0, 32.0),
        elastic=terms,
        shares={name: np.full(10, part) for name, part in zip(INPUTS, weight, strict=True)},
        parts={name: part * C for name, part in zip(INPUTS, weight, strict=True)},
        gained={"mass_kg of scale.toml": np.linspace(4.0, 1.0, 10)},
        misfit=1.1,
        surprise=0.0 if way == "plain" else 31.0,
        tolerances=0 if way == "plain" else 40,
    )


@pytest.fixture(scope="session")
def found(clumod, terms) -> IdentificationFindings:
    """An identification of Clumod with one blade that came out as drawn, self-calibrated, and 1 % too heavy, plain."""
    true, fmd = clumod.placed(MOUNTED), routes.inertia(built_in("fmd"))
    results = tuple(
        reported(identified(way, true.scaled(factor), terms, share), MOUNTED)
        for way, factor, share in (("plain", 1.01, 3e-3), ("self-calibrated", 1.0, 1e-3))
    )
    H = DynamicMass(frequency=FREQUENCY, matrix=dynamic_mass((true + fmd).mass_matrix, terms, FREQUENCY))
    kept = np.where(np.abs(FREQUENCY - 12.3) < 0.3, 0.0, 1.0)
    start, stop = np.array([4.0, 6.0, 8.0]), np.array([16.0, 24.0, 32.0])
    study = np.tile(results[1].values, (3, 3, 1))
    study[1, 2] *= 1.002
    study[2, 0] = np.nan
    shared = np.abs(np.random.default_rng(1).standard_normal((6, len(FREQUENCY), 3))) * 1e-3
    stack = campaign("fmd+clumod-1")
    return IdentificationFindings(
        article="clumod-1",
        origin="article",
        request=Request(campaign=stack, tares=(Tare(campaign=campaign("fmd+disc+cuboid"), known=None),)),
        results=results,
        verdict={"m": "trustworthy", "mass_kg": "trustworthy", "cog_x_mm": "dominated by elasticity"},
        rigid=(true + fmd).mass_matrix,
        crossed=CrossMotion(
            quotient=1.01 * H.matrix,
            cross_motion=np.full(6, 0.031),
            diagonal=np.full(6, 0.0123),
            column=np.full(6, 0.45),
            text=tuple(f"{axis}: the quotient is off by 1 %" for axis in MOTIONS),
        ),
        lines=UsedLines(
            frequency=FREQUENCY,
            condition=np.where(kept > 0, 3.0, 180.0),
            limit=100.0,
            kept=kept,
            reasons=("12.1 to 12.5 Hz: condition number 180 exceeds 100",),
        ),
        dynamic_mass=H,
        spectra=Spectra(
            table=stack.table,
            frequency=FREQUENCY,
            values=np.zeros((6, len(FREQUENCY), len(stack.table))),
            noise=np.zeros((6, len(FREQUENCY), len(stack.table))),
            quality=np.full((6, len(FREQUENCY)), 0.999),
            runs=MOTIONS,
            axes=MOTIONS,
        ),
        residuals=DrawnResiduals(frequency=FREQUENCY, runs=MOTIONS, channels=("a", "b", "c"), share=shared),
        study=DrawnBandStudy(
            start=start, stop=stop, maps={"3 elastic terms": study, "no elastic terms": 1.03 * study}, chosen=(4.0, 32.0)
        ),
        checks=(
            Finding(name="symmetry", holds=True, value=0.4, text="the dynamic mass is symmetric"),
            Finding(name="channels", holds=False, value=8.0, text="it looks as if fmd-z1 has the wrong sign"),
        ),
        warnings=("the Cuboid's drawing is taken as it is",),
    )


@pytest.fixture
def result_file(found, tmp_path) -> Callable[..., Path]:
    """``result_file(**changes)``: what `massline identify --json` prints of `found`, in a file."""
    from validation.output import json_text, to_json

    def write(**changes: object) -> Path:
        path = tmp_path / "identify.json"
        path.write_text(json_text(to_json(replace(found, **changes))))
        return path

    return write
