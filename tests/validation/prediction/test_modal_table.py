"""The prediction of a table of modes: against closed forms, against differences, and on tables with a planted effect."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point, Tolerances
from identification.modal_table import SOUND_SHAPE, ModalTable, mac, paired
from validation.compare import correlation
from validation.diagnose.candidate_fits import SCATTER, goodness_of_fit
from validation.effects.catalogue import Named
from validation.effects.stages import Matrices
from validation.estimation.evaluate import evaluate
from validation.estimation.fit import FLOOR, fit
from validation.estimation.likelihood import observed, residual
from validation.estimation.problem import FITTED, Problem
from validation.estimation.verdicts import due_misfit, misfit
from validation.model.model import Added, StructureTolerances
from validation.prediction import effects as prediction_effects
from validation.prediction import modal_table
from validation.prediction.effects import Nuisances

COUNT, M, K, ETA = 6, 2.0, 5e4, 0.01
NAMES = tuple(f"mass-{k + 1}" for k in range(COUNT))

NO_SHAPES = {"shapes": None, "shapes_deviation": None}


def chain(mass: float = M, ends: tuple[float, float] = (1.0, 1.0), point: tuple[int, float] = (0, 0.0)) -> Nuisances:
    """Equal masses on equal springs between two walls, in physical coordinates; `ends` scale the springs to the walls."""
    middle = _between()
    left, right = np.zeros((COUNT, COUNT)), np.zeros((COUNT, COUNT))
    left[0, 0], right[-1, -1] = K * ends[0], K * ends[1]
    own = mass * np.eye(COUNT)
    own[point[0], point[0]] += point[1]
    stiffness = middle + left + right
    rows = {name: np.vstack([row, np.zeros((2, COUNT))]) for name, row in zip(NAMES, np.eye(COUNT), strict=True)}
    made = Matrices(
        base=0,
        mass=own,
        stiffness=stiffness,
        viscous=1e-4 * stiffness,
        structural=ETA * stiffness,
        places=rows,
        parts={"springs": middle, "left": left, "right": right},
    )
    known = StructureTolerances(modulus=0.05, damping=0.3, damping_law=0.0, frequency=0.0, mode_coupling=0.0, mode_damping=0.0)
    return prediction_effects.nuisances("chain", made, np.ones(1), dict.fromkeys(made.parts, ETA), known)


def _between() -> Array:
    drift = np.diff(np.eye(COUNT), axis=0)
    return np.asarray(K * drift.T @ drift)


def table(of: Nuisances, count: int = 4, **options: object) -> ModalTable:
    """What a test would have read of `of`, without noise."""
    modes = modal_table.real_modes(of.nominal)
    f = modes.frequency[:count]
    given: dict[str, object] = {
        "source": "table.toml",
        "title": "table",
        "article": "chain",
        "frequency": f,
        "frequency_deviation": 0.002 * f,
        "sensors": tuple(Point(place=name) for name in NAMES),
        "shapes": modes.shapes[:, :count].T,
        "shapes_deviation": np.full((count, COUNT), 0.01),
    }
    return ModalTable(**{**given, **options})  # type: ignore[arg-type]


def added(identifier: str, value: float) -> Added:
    family, *targets = identifier.split(":")
    return Added(named=Named(family=family, targets=tuple(targets), values={"": value}))


def test_frequencies_and_shapes_of_a_chain_are_those_of_the_closed_form() -> None:
    of = chain()
    frequencies, shapes = modal_table.of(of, table(of))
    angle = np.arange(1, 5) * np.pi / (COUNT + 1)  # of the modes of a chain between walls
    exact = 2 * np.sqrt(K / M) * np.sin(angle / 2) / (2 * np.pi)
    assert_allclose(frequencies.at({}).rows[:, 0, 0, 0], exact, rtol=1e-12)
    sines = np.sin(np.outer(angle, np.arange(1, COUNT + 1)))
    assert_allclose(np.diag(mac(shapes.at({}).rows[:, 0, :, 0], sines)), 1.0, rtol=1e-12)


@pytest.mark.parametrize(("options", "most"), [pytest.param({}, 0.2, marks=pytest.mark.proof), (NO_SHAPES, 0.8)])
def test_chi2_of_sound_tables_is_what_noise_makes_of_it_beside_tolerances(options: dict[str, None], most: float) -> None:
    of, rng, pairs, sound = chain(), np.random.default_rng(22), [], []
    made = modal_table.of(of, table(of, **options))
    for _ in range(40):
        there = {one.name: one.tolerance * rng.standard_normal() for part in made for one in part.parameters}
        drawn = []
        for part in made:
            data = part.measured
            sd = data.noise if data.read is None else data.read
            values = part.at(there).rows[..., 0] + sd * rng.standard_normal(sd.shape)
            drawn.append(replace(part, measured=replace(data, values=values)))
        problem = Problem(tuple(drawn))
        found = fit(problem, FITTED)
        pairs.append((misfit(found), due_misfit(found, problem)))
        sound.append(goodness_of_fit(found, problem))
    mean, due = np.mean(pairs, axis=0)
    assert (
        mean < most
    )  # shapes may be off by a tenth and were read to a hundredth; a few frequencies are told by as many tolerances
    assert_allclose(mean, due, rtol=0.25)
    # And a fit counts as sound up to three times the scatter of what is left, which of few frequencies is less than of many lines
    assert sum(one.misfit > one.limit for one in sound) <= 1
    count, share = found.degrees_of_freedom, due_misfit(found, problem, as_read=False)
    assert sound[-1].limit < (share + 1e-9) * (1 + SCATTER * np.sqrt(2 / (share * count))) * (1 + 1e-9)


def test_the_damping_ratio_is_half_the_loss_factor_and_the_viscous_share() -> None:
    of = chain()
    f = modal_table.real_modes(of.nominal).frequency[:4]
    damped = table(of, damping_ratio=np.full(4, 0.01), damping_deviation=np.full(4, 0.001))
    frequencies, _ = modal_table.of(of, damped)
    assert frequencies.measured.channels == ("frequency", "damping")
    exact = ETA / 2 + 1e-4 * 2 * np.pi * f / 2
    assert_allclose(frequencies.at({}).rows[:, 0, 1, 0], exact, rtol=1e-10)


EFFECTS = (added("point-mass:mass-3", 0.2), added("structural-damping:springs", 0.005), added("accelerometer-gain:mass-2", 0.1))


def test_every_derivative_is_that_of_differences() -> None:
    of = chain(ends=(0.7, 1.2))
    damped = table(of, damping_ratio=np.full(4, 0.01), damping_deviation=np.full(4, 0.001))
    for test in modal_table.of(chain(), damped):
        model = test.with_effects(EFFECTS)
        at = {one.name: one.start + 0.1 * one.tolerance for one in model.parameters}
        exact = model.at(at)
        assert set(exact.changes) == set(at)
        for name, change in exact.changes.items():
            step = 1e-5
            above, below = (model.at({**at, name: at[name] + side * step}, derivatives=False).rows for side in (1, -1))
            found = np.zeros(exact.rows.shape, dtype=np.complex128)
            found[:, :, change.channels] = change.rows
            # Of every channel by its own level, and rounding of the shapes: the step's second power times the third derivative
            for c in range(found.shape[2]):
                difference = ((above - below) / (2 * step))[:, :, c]
                level = np.abs(exact.rows[:, :, c]).max()
                assert_allclose(found[:, :, c], difference, rtol=1e-5, atol=2e-7 * level, err_msg=f"{name} {c}")


def test_derivatives_that_nobody_asks_for_are_left_out() -> None:
    (frequencies, _) = modal_table.of(chain(), table(chain()))
    assert set(frequencies.at({}, derivatives={"modulus:left"}).changes) == {"modulus:left"}
    assert not frequencies.at({}, derivatives=False).changes


def test_modes_that_have_changed_places_are_found_by_their_shapes() -> None:
    of = chain()
    known = table(of, count=3)
    turned = replace(known, shapes=np.asarray(known.shapes)[[1, 0, 2]])
    assert modal_table.partners(modal_table.real_modes(of.nominal), known) == (0, 1, 2)
    close = replace(turned, frequency=np.array([6.0, 6.5, 30.0]), frequency_deviation=np.ones(3))
    assert modal_table.partners(modal_table.real_modes(of.nominal), close)[:2] == (1, 0)


@pytest.mark.parametrize(("factor", "unit"), [(2 * np.pi, "rad/s"), (60.0, "cycles per minute"), (1e-3, "kHz"), (4.0, "")])
def test_frequencies_in_another_unit_are_refused_by_its_name(factor: float, unit: str) -> None:
    """They were fitted: a part without any stiffness, and nothing known after minutes."""
    known = table(chain(), count=3)
    other = replace(known, frequency=1.02 * factor * known.frequency)
    if unit:
        with pytest.raises(BadInput, match=rf"all 3 within .* they look like {unit}. Write them in hertz"):
            modal_table.of(chain(), other)
    else:
        modal_table.of(chain(), other)


def test_a_sensor_with_a_wrong_sign_pairs_modes_as_it_reads_them() -> None:
    of = chain()
    known = table(of, count=4)
    turned = np.array(known.shapes)
    turned[:, 0] *= -1
    modes, close = modal_table.real_modes(of.nominal), np.array([10.0, 10.1, 10.2, 10.3])  # shapes alone tell them
    inverted = replace(known, shapes=turned, frequency=close)
    effect = Added(named=Named(family="polarity", targets=(known.sensors[0].name,), values={}), fixed=True)
    straight = modal_table.partners(modes, replace(known, frequency=close))
    assert modal_table.partners(modes, inverted, [effect]) == straight
    assert modal_table.partners(modes, inverted) != straight


def test_without_shapes_pairs_keep_the_order_and_a_mode_that_was_not_measured_is_passed_over() -> None:
    assert paired([10.0, 20.0, 30.0], [11.0, 15.0, 21.0, 33.0]) == (0, 2, 3)
    assert paired([10.0, 20.0, 30.0], [10.0, 29.0]) == (0, -1, 1)


def test_a_free_structure_keeps_the_motions_of_a_body_out_of_the_table() -> None:
    drift = np.diff(np.eye(3), axis=0)
    K = 1e4 * drift.T @ drift
    made = Matrices(base=0, mass=np.eye(3), stiffness=K, viscous=np.zeros((3, 3)), structural=np.zeros((3, 3)))
    free = ModalTable(
        source="t",
        title="t",
        article="rod",
        frequency=[15.0, 27.0],
        frequency_deviation=[0.1, 0.1],  # type: ignore[arg-type]
    )
    assert modal_table.partners(modal_table.real_modes(made), free) == (1, 2)


def test_the_factor_of_a_shape_and_its_sign_say_nothing() -> None:
    of = chain()
    softer = chain(ends=(0.5, 1.0))
    once = table(softer)
    factors = np.array([[3.0], [-0.2], [1e-3], [-50.0]])
    again = replace(once, shapes=factors * once.shapes, shapes_deviation=np.abs(factors) * once.shapes_deviation)
    left = []
    for one in (modal_table.of(of, each)[1] for each in (once, again)):
        lines = np.arange(len(one.measured.frequency))
        left.append(np.abs(residual(observed(one.measured, lines), one.at({}, lines, derivatives=False), FLOOR)))
    assert left[0].max() > 1
    assert_allclose(*left, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("complex_shapes", [False, True])
def test_a_soft_support_is_found_from_a_table_with_noise(complex_shapes: bool) -> None:
    rng, truth = np.random.default_rng(5), 0.7
    exact = table(chain(ends=(truth, 1.0)))
    turned = np.exp(1j * rng.uniform(0, 6, (4, 1))) if complex_shapes else 1.0
    deviation = np.hypot(0.01, SOUND_SHAPE * np.abs(exact.shapes).max(axis=1, keepdims=True))
    shapes = exact.shapes * turned + deviation * rng.standard_normal((4, COUNT))
    f = exact.frequency * (1 + 0.002 * rng.standard_normal(4))
    measured = replace(exact, shapes=shapes, frequency=f, gain=0.001)
    models = tuple(one.with_effects([added("modulus:left", 0.0)]) for one in modal_table.of(chain(), measured))
    problem = Problem(models)
    found = fit(problem, FITTED)
    at = [one.name for one in found.parameters].index("modulus:left")
    value, sd = found.parameters[at].value(found.offsets[at]), np.sqrt(found.covariance[at, at])
    assert value == pytest.approx(truth - 1, abs=4 * sd * truth)
    assert sd < 0.05
    # 4 frequencies and 4 shapes of 6 components less a factor each: real numbers are counted once, complex ones twice
    assert 0.2 < found.chi2 / found.degrees_of_freedom < 2.0
    whole = evaluate(problem)
    assert whole.plain.percent < whole.nominal.percent


def test_a_run_that_is_left_out_takes_its_mode_along_and_not_its_partner() -> None:
    of = chain()
    frequencies, shapes = modal_table.of(of, table(of))
    for test in (frequencies, shapes):
        alone = test.on(("mode 3",))
        assert alone.measured.runs == ("mode 3",)
        assert_allclose(np.abs(alone.at({}).rows[0]), np.abs(test.at({}).rows[2]), rtol=1e-12)


def test_beside_a_test_before_a_model_that_is_off_everywhere_misses_only_what_has_changed_since() -> None:
    of, sound, changed = chain(), table(chain(), **NO_SHAPES), table(chain(ends=(0.6, 1.0)), **NO_SHAPES)
    off = np.array([1.15, 0.93, 1.1, 0.88])  # what this model does not know of the article
    sd, read = sound.frequency_deviation, off * sound.frequency
    before = np.stack([read, sd], axis=1)
    asked = [replace(one, frequency=off * one.frequency, frequency_deviation=sd, before=before) for one in (sound, changed)]
    for one, frequency in zip(asked, (sound.frequency, changed.frequency), strict=True):
        (test,) = modal_table.of(of, one)
        assert_allclose(test.measured.values[:, 0, 0].real, frequency, rtol=1e-12)
        assert_allclose(test.at({}).rows[:, 0, 0, 0].real, sound.frequency, rtol=1e-12)
        # Known no better than both tests, and a change no better than the model is right; shown as what was read
        share = one.frequency / read
        known = np.hypot(1, share) * sd / read
        told = np.sqrt(np.mean((1 / off - 1) ** 2)) * (share - 1)
        assert_allclose(test.measured.noise[:, 0, 0] / sound.frequency, np.hypot(known, told), rtol=1e-12)
        pairs = correlation.modal(test, {}).pairs
        assert_allclose([pair.measured_hz for pair in pairs], one.frequency, rtol=1e-12)
        assert_allclose([pair.model_hz for pair in pairs], read, rtol=1e-12)
        assert "how the frequencies have changed" in test.remarks[-1]


def test_modes_that_cross_in_a_model_beside_a_test_before_keep_their_partners() -> None:
    of, sound = chain(), table(chain(), **NO_SHAPES)
    f = sound.frequency
    # The first mode rose so far that, seen from the model, it stands above the second
    rose = replace(sound, frequency=f * [2.2, 1.0, 1.0, 1.0], before=np.stack([f, sound.frequency_deviation], axis=1))
    (test,) = modal_table.of(of, rose)
    assert [pair.model for pair in correlation.modal(test, {}).pairs] == [1, 2, 3, 4]


def test_of_an_article_that_is_asked_how_it_has_changed_a_tenth_of_its_tolerances_is_open_and_all_of_its_losses() -> None:
    of = chain()
    both = [{one.name: one.tolerance for one in each.parameters} for each in (of, replace(of, unchanged=True))]
    assert both[1]["modulus:left"] == pytest.approx(0.1 * both[0]["modulus:left"])
    assert both[1]["loss:left"] == both[0]["loss:left"] > 0


def test_a_place_or_a_mode_that_the_model_has_not_is_refused_in_words() -> None:
    of = chain()
    with pytest.raises(BadInput, match="attic"):
        modal_table.of(of, replace(table(of), sensors=(Point(place="attic"), *(Point(place=n) for n in NAMES[1:]))))
    with pytest.raises(BadInput, match="6 modes, and the table 7"):
        modal_table.of(of, table(of, frequency=np.arange(1.0, 8), frequency_deviation=np.ones(7), **NO_SHAPES))


def test_effects_that_reach_nothing_of_a_table_leave_it_as_it_is() -> None:
    known = added("modulus:left", 0.1)
    elsewhere = [added("mounting-offset:x", 0.01), added("point-mass:attic", 0.01), added("accelerometer-gain:attic", 0.1)]
    for test in modal_table.of(chain(), table(chain())):
        assert test.with_effects([*elsewhere, known]).effects == (known,)


def test_sensors_that_a_mode_moves_across_see_what_they_are_turned_by():
    of, known = chain(), Tolerances(angle=0.01)
    across = {name: rows[[1, 0, 2]] + 1e-4 * rows for name, rows in of.nominal.places.items()}
    turned = replace(of, nominal=replace(of.nominal, places=across))
    for structure, wide in ((of, False), (turned, True)):
        exact, shapes = (
            modal_table.of(structure, table(of), tolerances)[1].measured.noise for tolerances in (Tolerances().scaled(0.0), known)
        )
        assert (shapes > 0.5 * np.abs(modal_table.of(of, table(of))[1].measured.values.real)).all() == wide
        assert (shapes == exact).all() != wide


def test_frequencies_and_shapes_ask_the_modes_of_a_mass_somewhere_once(monkeypatch: pytest.MonkeyPatch) -> None:
    nominal, asked = chain(), []
    made = modal_table.of(nominal, table(nominal))
    read = [one.finite({}, np.array([0])) for one in made]
    solved = modal_table.real_pairs
    monkeypatch.setattr(modal_table, "real_pairs", lambda *matrices: asked.append(matrices) or solved(*matrices))
    row = nominal.nominal.places["mass-3"]
    found = [one(row)(np.full(3, 0.5), np.zeros(3)) for one in read]
    assert len(asked) == 1
    other = modal_table.of(chain(point=(2, 0.5)), table(nominal))
    for one, due in zip(found, other, strict=True):
        assert_allclose(one, due.at({}).rows, rtol=1e-9)


@pytest.mark.parametrize("case", ["grounded", "free", "with a place without mass"])
@pytest.mark.parametrize("count", [12, 60])
@pytest.mark.parametrize(("mass", "spring"), [(0.5, 0.0), (-1.5, 0.0), (20.0, 0.0), (0.0, 1e3), (0.0, 1e6)])
def test_modes_with_a_load_are_those_of_the_matrices_with_it_to_a_ten_thousandth_of_what_it_changes(
    case: str, mass: float, spring: float, count: int
) -> None:
    n, alone = 60, np.eye(60)
    whole = n * K * np.diff(alone, axis=0).T @ np.diff(alone, axis=0) + (0.0 if case == "free" else n * K * np.diag(alone[0]))
    weight = np.full(n, M / 10)
    weight[37] = 0.0 if case == "with a place without mass" else M / 10
    at, zeros = (37 if case == "with a place without mass" else 41), np.zeros((n, n))
    matrices = Matrices(base=0, mass=np.diag(weight), stiffness=whole, viscous=zeros, structural=zeros, places={})
    bare, row = modal_table.real_modes(matrices), np.vstack([alone[at], np.zeros((2, n))])
    bare = replace(bare, squares=np.where(np.abs(bare.squares) < 1e-3, 0.0, bare.squares))  # a free body may have none at all
    loaded = bare.loaded(row, count)(np.full(3, mass), np.full(3, spring))
    due = modal_table.real_modes(
        replace(matrices, mass=np.diag(weight + mass * alone[at]), stiffness=whole + spring * np.diag(alone[at]))
    )
    few = slice(1, 6)
    change = np.linalg.norm(due.squares[few] - bare.squares[few])
    assert np.linalg.norm(loaded.squares[few] - due.squares[few]) < 1e-4 * change
    assert (np.diag(mac(loaded.shapes[:, few].T, due.shapes[:, few].T)) > 1 - 1e-6).all()


def test_a_mass_where_a_table_has_few_modes_of_many_is_read_as_the_modes_between_and_beyond_them_have_it() -> None:
    n, few, alone, zeros = 60, [0, 13], np.eye(60), np.zeros((60, 60))
    stiffness = n * K * (np.diff(alone, axis=0).T @ np.diff(alone, axis=0) + np.diag(alone[0]))
    at = {name: np.vstack([alone[9 * k + 4], np.zeros((2, n))]) for k, name in enumerate(NAMES)}
    made = Matrices(base=0, mass=M / 10 * alone, stiffness=stiffness, viscous=zeros, structural=zeros, places=at)
    known = StructureTolerances(damping_law=0.0, mode_coupling=0.0, mode_damping=0.0)
    nominal = prediction_effects.nuisances("chain", made, np.ones(1), {}, known)
    modes = modal_table.real_modes(nominal.nominal)
    shapes, f = modes.shapes[[9 * k + 4 for k in range(COUNT)]][:, few].T, modes.frequency[few]
    frequencies, _ = modal_table.of(nominal, table(nominal, 2, frequency=f, frequency_deviation=0.002 * f, shapes=shapes))

    found = frequencies.finite({}, np.array([0]))(at["mass-3"])(np.full(3, 0.5), np.zeros(3)).ravel().real
    heavier = modal_table.real_modes(replace(made, mass=made.mass + 0.5 * at["mass-3"].T @ at["mass-3"]))
    assert_allclose(found - f, heavier.frequency[few] - f, rtol=1e-3)


def test_a_table_without_damping_asks_no_derivative_by_losses_for_they_change_nothing_that_it_has() -> None:
    nominal = chain()
    bare = replace(table(nominal), damping_ratio=None, damping_deviation=None)
    for one in modal_table.of(nominal, bare):
        names = frozenset(parameter.name for parameter in one.parameters)
        whole, few = (set(one.at({}, derivatives=wanted).changes) for wanted in (True, names))
        assert {name for name in whole if one.at({}).changes[name].rows.any()} <= few
        assert any(name.startswith("loss:") for name in names - few)
