"""What tests of predictions share: fast virtual tests, the model of their laboratory, and the truth as offsets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from fem.damping import Damping
from fem.structure import Structure, place_rows
from geometry.frames import Array
from geometry.inertia import PARAMETERS
from validation.effects.catalogue import parse_all
from validation.model.model import Added, Model
from validation.prediction.series import SeriesPrediction, predictions
from validation.prediction.structure import ReducedStructure, by_itself
from validation.virtual_test.plan import Plan, Scatter, exact
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import VirtualTest, simulate

RATIO = 0.05
STIFFNESS = (4e8, 4e8, 2e9)
"""[N/m] of the cells of the built-in FMD, on which virtual tests stand."""

Tested = Callable[..., VirtualTest]
Predict = Callable[..., tuple[SeriesPrediction, ...]]


@pytest.fixture(scope="session")
def plan() -> Callable[..., Plan]:
    """``plan(**changes)``: one blade, well damped in modes, in very fast sweeps without noise."""
    common: dict[str, Any] = {
        "article": "fmd+clumod-1",
        "seed": 11,
        "damping": Damping(ratio=RATIO),
        "scatter": Scatter(damping=0.0),
    }
    fast: dict[str, Any] = {"octaves_per_minute": 60.0, "quiet": 0.3, "noise_rms": {}, "mains": {}}
    return lambda **changes: Plan(**{**common, **fast, **changes})


@pytest.fixture(scope="session")
def ordinary(plan) -> Tested:
    """``ordinary(article, model)``: a laboratory of ordinary tolerances, each once."""
    return cache(lambda article, model: simulate(plan(article=article, model=model)))


@pytest.fixture(scope="session")
def faulty(plan) -> Tested:
    """``faulty(article, effect, ...)``: a laboratory that knows everything but these effects, each once."""
    return cache(lambda article, *effects: simulate(exact(plan(article=article, effects=planted(parse_all(effects))))))


@pytest.fixture(scope="session")
def model() -> Callable[..., Model]:
    """``model(**changes)``: of the laboratory in which virtual tests are made."""
    common: dict[str, Any] = {"source": "model.toml", "title": "a virtual laboratory", "article": "fmd+clumod-1"}
    known: dict[str, Any] = {"cell_stiffness": np.array(STIFFNESS), "damping_ratio": RATIO}
    return lambda **changes: Model(**{**common, **known, **changes})


@pytest.fixture(scope="session")
def added() -> Callable[..., tuple[Added, ...]]:
    """``added("force-gain:fmd-z2=0.08", ...)``: as effects of a model."""
    return lambda *texts, fixed=False: tuple(Added(named=one, fixed=fixed) for one in parse_all(texts))


@pytest.fixture(scope="session")
def predicted(model) -> Predict:
    """``predicted(test, ..., **changes of the model)``"""
    return lambda *tests, **changes: predictions(model(**changes), [test.campaign for test in tests])


@pytest.fixture(scope="session")
def at_truth() -> Callable[[SeriesPrediction, VirtualTest], dict[str, float]]:
    """``at_truth(prediction, test)``: offsets of everything that was drawn."""

    def made(of: SeriesPrediction, test: VirtualTest) -> dict[str, float]:
        known: Mapping[str, float] = test.truth["tolerances"]
        by_name = {one.name: one for one in of.parameters}
        fmd = {f"fmd:{name}": test.truth["fmd"]["parameters"][name] for name in PARAMETERS}
        return {name: by_name[name].offset(value) for name, value in {**known, **fmd}.items() if name in by_name}

    return made


@pytest.fixture(scope="session")
def unexplained() -> Callable[..., dict[str, float]]:
    """``unexplained(prediction, offsets)``: by group of channels the largest rms, as a share of a channel's own, of what no base
    motion explains."""

    def made(
        of: SeriesPrediction, offsets: Mapping[str, float], groups: Sequence[str] = ("cover", "table", "fmd")
    ) -> dict[str, float]:
        y = of.measured.values
        level = np.sqrt(np.mean(np.abs(y) ** 2, axis=(0, 1)))
        rows = np.broadcast_to(of.at(offsets, derivatives=False).rows / level[:, None], (*y.shape, 6))
        Q, _ = np.linalg.qr(rows)
        left = y / level - np.einsum("rnck,rnak,rna->rnc", Q, Q.conj(), y / level)
        rms = np.sqrt(np.mean(np.abs(left) ** 2, axis=(0, 1)))
        names = np.array(of.measured.channels)
        return {group: float(rms[np.char.startswith(names, group)].max()) for group in groups}

    return made


@pytest.fixture(scope="session")
def held() -> Callable[..., ReducedStructure]:
    """``held(structure, places)``: with its base held still, made ready at its `places`, each (3,) [m], for tests up to 40 Hz."""

    def made(structure: Structure, places: Mapping[str, Array]) -> ReducedStructure:
        rows = place_rows(structure, np.array(list(places.values())))
        return by_itself(replace(structure, places=dict(zip(places, rows, strict=True))), 40.0)

    return made
