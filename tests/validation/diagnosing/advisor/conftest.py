"""A rigid Cuboid on the FMD, measured at few lines: readings by the model itself, an effect in it, and noise that is known."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.frames import Pose
from identification.campaign import Campaign, Recording, Run
from validation.diagnose.diagnosis import Candidate
from validation.effects.catalogue import parse
from validation.estimation.fit import FLOOR, direct, fitted
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import FITTED
from validation.model.model import RIGID, Added, Model
from validation.prediction.series import SeriesPrediction, predictions
from validation.study import Study
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import NOISE, Plan
from validation.virtual_test.shaker import middles_of_cells

LINES = np.linspace(4.0, 32.0, 15)
SEAT = Pose(position=np.array([0.0, 0.0, 0.0445]))
NOISY = {"acceleration": 1e-3, "force": 0.05}

Measure = Callable[..., SeriesPrediction]
MakeBench = Callable[..., Study]
Explain = Callable[..., Candidate]


def model() -> Model:
    return Model(source="tests", title="tests", article="fmd+cuboid", kind=RIGID, cell_stiffness=np.array([4e8, 4e8, 2e9]))


def campaign(article: str, turned: np.ndarray | None = None) -> Campaign:
    """Six sweeps of one axis each, which nobody has read yet."""
    table = mavis(middles_of_cells(Plan(article="fmd")), NOISE).table
    names = tuple(one.name for one in table.channels)
    unread = np.ones((len(LINES), len(names)), dtype=np.complex128)
    pose = SEAT if turned is None else replace(SEAT, rotation=turned)
    return Campaign(
        title=article,
        article=article,
        hardware="one",
        table=table,
        runs=tuple(Run(name=axis, file=f"{axis}.h5", axis=axis) for axis in MOTIONS),
        recordings={axis: Recording(names=names, values=unread, frequency=LINES) for axis in MOTIONS},
        mounting=pose if article != "fmd" else None,
    )


def inputs() -> np.ndarray:
    """(r, n, 6): every run drives its own axis, and the others by a hundredth."""
    levels = np.array([LEVELS[axis] for axis in MOTIONS])
    cross = 0.01 * np.ones((6, 6)) + np.eye(6)
    return np.asarray(np.broadcast_to((cross * levels)[:, None, :], (6, len(LINES), 6)), dtype=np.complex128)


@pytest.fixture(scope="session")
def measure() -> Measure:
    """``measure(article, effects, seed, turned)``: the campaign with what its channels read; without a seed free of noise."""

    def make(
        article: str, effects: Sequence[Added] = (), seed: int | None = None, turned: np.ndarray | None = None
    ) -> SeriesPrediction:
        of = model()
        (made,) = predictions(of, [campaign(article, turned)], lines=LINES)
        rows = made.with_effects(effects).at({one.name: one.start for one in made.with_effects(effects).parameters}).rows
        values = np.einsum("nck,rnk->rnc", rows, inputs())
        quantity = {one.name: one.quantity for one in made.tested.campaign.table.channels}
        noise = np.broadcast_to([NOISY[quantity[name]] for name in made.measured.channels], values.shape)
        if seed is not None:
            rng = np.random.default_rng(seed)
            spread = noise / np.sqrt(2)
            values = values + spread * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape))
        read = replace(made.measured, values=values, noise=np.array(noise))
        return replace(made, tested=replace(made.tested, measured=read))

    return make


def added(text: str) -> Added:
    return Added(named=parse(text))


@pytest.fixture(scope="session")
def bench(measure: Measure) -> MakeBench:
    """``bench(planted, article, ...)``: the data of these articles with an effect planted in them."""

    def make(planted: str, *articles: str, seed: int = 3) -> Study:
        made = [measure(one, (added(planted),) if planted else (), seed) for one in articles]
        read = [replace(one.measured, name=name) for one, name in zip(made, articles, strict=True)]
        called = [replace(one, tested=replace(one.tested, measured=of)) for one, of in zip(made, read, strict=True)]
        return Study(model=model(), campaigns=tuple(one.tested.campaign for one in called), made=tuple(called))

    return make


@pytest.fixture(scope="session")
def explained() -> Explain:
    """``explained(bench, text)``: the fit of all tolerances and of the effect that `text` names."""

    def make(of: Study, text: str) -> Candidate:
        effects = (added(text),) if text else ()
        problem = of.problem(effects)
        cost = cost_of(problem, problem.free(FITTED), FLOOR)
        found = fitted(direct(cost, problem.start, lambda share: None))  # the planted size is near enough
        return Candidate(effects=effects, fit=found, problem=problem)

    return make
