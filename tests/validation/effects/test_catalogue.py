"""Every family of the catalogue is whole: what it says, what it changes, and that it changes nothing where it is not."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.chain import chain
from validation.effects import catalogue, effect, own
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.families import opened
from validation.virtual_test.plan import Plan, exact
from validation.virtual_test.simulate import laboratory

SOFT = 3.0
"""What a fault must be beyond the tolerance at least, by standard deviations, to be a fault."""

EVERY = list(FAMILIES.values())
OF_TESTS = {family.name for family in EVERY if family.name in catalogue.OF_TESTS or effect.DRIVE in family.targets}
"""What tests of any structure have and no base that moves; tests/validation/prediction/test_points.py opens them."""
OPENED = [family for family in EVERY if family.stage == effect.OPENED and family.name not in OF_TESTS]
IN_CHAIN = [family for family in OPENED if not set(family.targets) & set(catalogue.LOCAL)]
WITH_EQUATION = [family for family in EVERY if family.change is not None]


def by_name(family: effect.Family) -> str:
    return family.name


def test_no_effect_of_the_folder_is_forgotten() -> None:
    """The catalogue takes those of its `ORDER`; a table of opened.toml or a file beside it would be none, without a word."""
    files = {path.stem.replace("_", "-") for path in Path(opened.__file__).parent.glob("*.py") if not path.name.startswith("_")}
    assert files - {"opened"} | opened.FAMILIES.keys() == {*catalogue.ORDER}
    assert not (files & opened.FAMILIES.keys())


@pytest.fixture(scope="module")
def table():
    """The paper's 22 channels."""
    return laboratory(exact(Plan(article="fmd+cuboid"))).layout.table


@pytest.fixture(scope="module")
def words() -> effect.Vocabulary:
    return effect.Vocabulary(places=())


def targets_of(family: effect.Family, words: effect.Vocabulary) -> list[tuple[str, ...]]:
    return list(product(*(words.legal(kind) or () for kind in family.targets)))


@pytest.mark.parametrize("family", EVERY, ids=by_name)
def test_a_family_says_all_that_a_reader_needs(family):
    for field in own.WORDS:
        assert getattr(family, field).strip(), f"{family.name}: {field}"
    assert family.mistaken_for
    ids = {one.partition(":")[0] for one in family.mistaken_for if " " not in one}  # the others say it in words
    assert ids
    assert ids <= set(FAMILIES) - {family.name}
    assert family.sentence.endswith(".")
    assert "{target" in family.sentence or not family.targets


@pytest.mark.parametrize("family", EVERY, ids=by_name)
def test_sizes_are_sane(family):
    fitted = [size for size in family.sizes if size.plausible]
    assert fitted or family.side in (effect.MISTAKE, "processing")
    for size in family.sizes:
        assert size.unit
        assert size.low < size.high
        assert size.null <= size.high or size.null == np.inf
        assert size.logarithmic or size.plausible <= size.high - size.low
        assert family.tolerance == 0 or size.plausible >= SOFT * family.tolerance


@pytest.mark.parametrize("family", WITH_EQUATION, ids=by_name)
def test_an_equation_changes_nothing_without_its_effect_and_something_with_it(family):
    catalogue.require_usable(family, family.name)
    example = parse(family.example.split(", or ")[0])
    before = own.trials()[family.stage]
    changed = family.change(before, example.targets, _within(family, example.values))
    assert not own.unchanged(before, changed)
    assert own.unchanged(before, before)


def _within(family: effect.Family, values):
    """An example that can be seen: cells of the stages to try on are pulled by a newton or two, not by 500."""
    return {**values, "": 0.5} if family.name == "gap" else values


@pytest.mark.parametrize("family", [one for one in WITH_EQUATION if one.stage == effect.CHANNEL_STAGE], ids=by_name)
def test_equations_of_channels_add(family):
    example, reading = parse(family.example.split(", or ")[0]), own.trials()[effect.CHANNEL_STAGE]
    values = _within(family, example.values)
    other = np.roll(reading.rows, 1, axis=0)
    one, two, both = (
        family.change(replace(reading, rows=rows), example.targets, values).rows
        for rows in (reading.rows, other, reading.rows + other)
    )
    assert_allclose(both, one + two, rtol=0, atol=1e-12 * np.max(np.abs(both)))


@pytest.mark.parametrize("family", IN_CHAIN, ids=by_name)
def test_what_is_opened_is_a_parameter_of_the_chain_for_every_target(family, table, words):
    """`accelerometer-position` along a pick-up's own axis, and `-misalignment` about it, change nothing and are none."""
    blind = (
        {f"{family.name}:{c}:{c.split('-')[1][0]}" for c in (*effect.TABLE, *effect.COVER)} if "axis" in family.targets else set()
    )
    wanted = {":".join((family.name, *targets)) for targets in targets_of(family, words)}
    known = {one.name: one for one in chain(table, overrides={family.name: family.sizes[0].plausible}).parameters}
    found = {name for name in known if name.partition(":")[0] == family.name}
    assert found == wanted - (blind if family.name.startswith("accelerometer-") else set())
    assert {known[name].unit for name in found} == {size.unit for size in family.sizes}
    assert all(known[name].value(0.0) == family.sizes[0].null for name in found)


@pytest.mark.parametrize("family", IN_CHAIN, ids=by_name)
def test_an_opened_parameter_gets_wider_than_its_tolerance_which_is_that_of_the_chain(family, table):
    stated, assumed = (
        {one.tolerance for one in chain(table, stiffness=stiffness).parameters if one.family == family.name}
        for stiffness in (np.array([4e8, 4e8, 2e9]), None)
    )
    assert all(family.sizes[0].plausible > tolerance for tolerance in stated | assumed)
    assert family.tolerance in (stated or {0.0})


def test_what_depends_on_the_level_is_known_and_every_family_is_asked_for_more_than_chance():
    assert {name for name, family in FAMILIES.items() if family.side == effect.AMPLITUDE} == {"friction", "gap", "saturation"}
    assert len((*effect.TABLE, *effect.COVER, *effect.FMD)) == 22
    assert len(effect.FIXED["cell and axis"]) == 12
    assert set(effect.WORTH_OF) <= set(FAMILIES)
    assert all(3.0 < effect.evidence_threshold(family) < 30.0 for family in FAMILIES)  # above 20 to 1
    assert (
        effect.evidence_threshold("modulus")
        < effect.evidence_threshold("force-gain")
        < effect.evidence_threshold("cell-stiffness")
        < effect.evidence_threshold("structural-damping")
    )
    assert (
        effect.EVIDENCE_THRESHOLD < effect.evidence_threshold("layer-damping") < effect.evidence_threshold("structural-damping")
    )
    assert effect.evidence_threshold("an-effect-of-somebody") == effect.EVIDENCE_THRESHOLD
