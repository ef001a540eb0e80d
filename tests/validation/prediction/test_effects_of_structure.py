"""Effects on a structure: equations, derivatives and bounds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import rig as base_excitation_rig
from fem.base_excitation.rig import Rig
from fem.beam import articles
from fem.damping import Damping
from fem.dynamic_mass import direct
from fem.modes import fixed_base
from geometry.articles import built_in, locations
from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, rigid_transformation_6
from geometry.routes import inertia
from validation.effects.catalogue import FAMILIES, Named, of_parts, parse
from validation.effects.effect import Vocabulary
from validation.effects.stages import ChannelResponse, MountedDynamicMass
from validation.estimation.problem import DECLARED, PLAIN, Parameter
from validation.model.model import Added
from validation.prediction import dynamic_mass, effects
from validation.prediction import effects as prediction_effects
from validation.prediction import structure as prediction_structure
from validation.prediction.effects import Nuisances
from validation.prediction.tangents import with_damping_law
from validation.virtual_test import shaker
from validation.virtual_test.layout import ChainTruth
from validation.virtual_test.plan import Plan, changed_rig, exact
from validation.virtual_test.planted import planted

LINES = np.linspace(4.0, 32.0, 57)
RATIO = Damping(ratio=0.003)
FMD = "fmd"


@dataclass(frozen=True, eq=False, kw_only=True)
class Model:
    """An article on the FMD as a prediction knows it."""

    article: str
    of: Nuisances
    seat: Array
    cover: Array

    def parameters(self, effects: Sequence[Added]) -> tuple[Parameter, ...]:
        """Of the structure and of its effects."""
        left, _ = prediction_effects.opened(self.of.parameters, effects)
        return (*left, *prediction_effects.parameters(effects))

    def dynamic_mass(
        self,
        effects: Sequence[Added],
        offsets: Mapping[str, float] | None = None,
        lines: Array = LINES,
        amplitude: Array | None = None,
        *,
        derivatives: bool = True,
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """About F, of the FMD too, at `offsets`; by default where the sizes of `effects` are what they say."""
        if offsets is None:
            offsets = {one.name: one.start for one in self.parameters(effects)}
        acting = prediction_effects.at(effects, offsets)
        m, tangents = prediction_effects.structure(*self.of.at(offsets, derivatives=derivatives), acting, derivatives=derivatives)
        if laws := self.of.laws:
            nominal = self.of.nominal
            m, tangents = with_damping_law(m, tangents, nominal, offsets, derivatives=derivatives, laws=laws)
        answered = dynamic_mass.dynamic_mass(m, lines)
        mounted = MountedDynamicMass(
            frequency=lines,
            matrix=answered.matrix,
            seat=self.seat,
            cog=m.cog,
            amplitude=np.zeros(6) if amplitude is None else amplitude,
        )
        mounted, changes = prediction_effects.body(
            mounted, dynamic_mass.transfer_tangents(answered, tangents), acting, derivatives=derivatives
        )
        G = rigid_transformation_6(self.seat)
        return G.T @ mounted.matrix @ G + self.cover, {name: G.T @ change @ G for name, change in changes.items()}


def added(*texts: str) -> tuple[Added, ...]:
    return tuple(Added(named=parse(text)) for text in texts)


@cache
def model(article: str, damping: Damping | None = RATIO) -> Model:
    structure, whole, fmd = articles.structure(article), built_in(article), built_in(FMD)
    modes = fixed_base(structure, 30, damping=damping)
    made = prediction_structure.of_structure(
        structure, modes, locations(article), inertia(whole).cog, damping=damping, article=whole
    )
    losses = structure.loss_factors if damping is None else {}
    return Model(
        article=article,
        of=prediction_effects.nuisances(article, made, modes.frequency, losses, highest=20.0),
        seat=fmd.seat.position,
        cover=inertia(fmd).about(np.zeros(3)).mass_matrix,
    )


@cache
def rig(article: str, *effects: str, damping: Damping | None = RATIO) -> ComplexArray:
    """Dynamic mass of the changed rig of a virtual test about F, its load cells rigid."""
    named = [parse(text) for text in effects]
    on_parts = tuple(text for text, one in zip(effects, named, strict=True) if of_parts(one))
    changed = changed_rig(standing(article, on_parts, damping), planted(named))
    return base_excitation_rig.dynamic_mass(changed, LINES).matrix


@cache
def standing(article: str, on_parts: tuple[str, ...], damping: Damping | None) -> Rig:
    """What stands on the table, with effects on parts, which are in the structure before it is reduced."""
    plan = exact(Plan(article=f"{FMD}+{article}", seed=1, damping=damping))
    plan = replace(plan, effects=planted([parse(text) for text in on_parts]))
    return replace(shaker.set_up(plan, ChainTruth()).rig, cells=())


def apart(found: ComplexArray, truth: ComplexArray, size: ComplexArray | None = None) -> float:
    """Largest difference at any line, each entry in units of what the diagonals of `size` reach in the band."""
    reached = np.sqrt(np.abs(np.einsum("nii->ni", truth if size is None else size)).max(axis=0))
    return float(np.abs((found - truth) / np.outer(reached, reached)).max())


RESONATOR = "m:0.05,f:21,zeta:0.01"

PLANTED = {
    "point-mass:mast-top=0.5": 2e-3,
    "point-mass:hub-2=-0.3": 2e-3,
    "point-mass:flange=1": 1e-6,
    "rigid-inertia:m=1": 1e-9,
    "rigid-inertia:mx=0.2": 1e-9,
    "rigid-inertia:Ixx=0.2": 1e-9,
    "rigid-inertia:Ixy=-0.05": 1e-9,
    "joint-compliance:rotation=1e-6": 1e-5,
    "joint-compliance:lateral=1e-8": 1e-5,
    "joint-compliance:vertical=1e-8": 1e-5,
    "joint-compliance:torsion=1e-6": 1e-5,
    f"appendage:z={RESONATOR}": 1e-9,
    "appendage:x=m:0.05,f:9,zeta:0.01": 1e-9,
    f"absorber:mast-top={RESONATOR}": 2e-4,
    "slosh:mast-top=m:0.5,f:6,zeta:0.02": 2e-4,
    "cable:mast-top=1000": 3e-4,
    "cable:mast-top:lateral=1000": 3e-4,
    "cable:hub-3:vertical=5000": 1e-4,
    "orientation:z=0.05": 1e-5,
    "mounting-offset:x=0.002": 1e-5,
    "mounting-offset:y=-0.003": 1e-5,
}
"""How far model and rig may differ in what an effect changes, as a share of it. The rig lacks static answers to forces at places
and damps its own modes anew; where only the rigid part or the dynamic mass itself is changed, the two are one to rounding or to
what the reductions differ in."""

OF_PARTS = {
    "modulus:mast=0.05": 0.02,
    "modulus:lower-1=-0.1": 0.02,
    "structural-damping:mast=0.01": 0.03,
    "modulus:upper-short=0.05": 0.05,
    "layer-damping:upper-short=0.05": 0.05,
}
"""The same with the loss factors of the parts: a rig that answers in time has viscous damping in their place. The
nearer oracle is the structure itself, changed and solved directly."""

ON_BLOCK = {"mast-top": "top-1", "hub-2": "top-2", "hub-3": "top-3", "flange": "disc"}
"""Places of the Cuboid on the disc, for those of Clumod."""


def on(article: str, text: str) -> str:
    """The effect `text`, at a place that `article` has."""
    for place, other in ON_BLOCK.items() if article == "disc+cuboid" else ():
        text = text.replace(f":{place}", f":{other}")
    return text


@pytest.mark.parametrize("text", PLANTED)
@pytest.mark.parametrize("article", ["clumod-1", "clumod-4", "disc+cuboid"])
def test_a_planted_effect_is_the_predicted_one(article, text):
    effect = on(article, text)
    _require_same(article, effect, RATIO, PLANTED[text])


@pytest.mark.parametrize("text", OF_PARTS)
def test_a_planted_effect_on_a_part_is_the_predicted_one(text):
    _require_same("clumod-4", text, None, OF_PARTS[text])


@pytest.mark.parametrize(("article", "text"), [("clumod-1", "modulus:lower-1=-0.1"), ("clumod-4", "modulus:mast=0.05")])
def test_a_planted_modulus_leaves_stated_ratios_as_they_are(article, text):
    _require_same(article, text, RATIO, 2e-3)


def _require_same(article: str, effect: str, damping: Damping | None, share: float) -> None:
    """Sign, size and place: what changes is the same but for `share` of it, and not at all the same turned round."""
    before, after = rig(article, damping=damping), rig(article, effect, damping=damping)
    nominal, _ = model(article, damping).dynamic_mass(())
    changed, _ = model(article, damping).dynamic_mass(added(effect))
    size = apart(after, before)
    assert apart(changed - nominal, after - before, before) < share * size
    assert apart(nominal - changed, after - before, before) > size


@pytest.mark.parametrize("article", ["clumod-1", "clumod-4", "disc+cuboid"])
def test_nothing_planted_is_nothing_predicted(article):
    assert apart(model(article).dynamic_mass(())[0], rig(article)) < 1e-6


@pytest.mark.parametrize(("part", "eta"), [("mast", 0.01), ("upper-short", 0.02), ("upper-short-silicone", 0.1)])
def test_a_lossier_part_is_what_the_lossier_structure_is(part, eta):
    structure = articles.structure("clumod-4")
    losses = {name: old + eta * (prediction_structure.sheet(name) == part) for name, old in structure.loss_factors.items()}
    truth = direct(replace(structure, loss_factors=losses), LINES).matrix
    layer = part.endswith("-silicone")
    name = f"layer-damping:{part.removesuffix('-silicone')}" if layer else f"structural-damping:{part}"
    m, _ = prediction_effects.structure(model("clumod-4", None).of.nominal, {}, added(f"{name}={eta}"))
    assert apart(dynamic_mass.dynamic_mass(m, LINES).matrix, truth) < 1e-5


SEVERAL = (
    "modulus:mast=0.05",
    "structural-damping:mast=0.01",
    "point-mass:mast-top=0.5",
    "cable:hub-3:vertical=5000",
    "absorber:mast-top=m:0.2,f:11,zeta:0.02",
    "slosh:hub-1=m:0.3,f:9,zeta:0.01",
    "rigid-inertia:Ixx=0.2",
    "appendage:x=m:0.05,f:9,zeta:0.01",
    "joint-compliance:rotation=1e-6",
    "orientation:z=0.05",
    "mounting-offset:y=-0.003",
    "friction:flange:x=3",
)
"""In the order in which a model might hold them, so that derivatives pass equations of every kind."""

AT = np.array([5.0, 8.7, 11.3, 21.0])
DRIVEN = np.array([2.5, 0.0, 0.0, 0.0, 3.0, 0.0])


def test_derivatives_of_a_whole_model_are_its_differences():
    of, effects = model("clumod-1", None), added(*SEVERAL)
    parameters = of.parameters(effects)
    offsets = {one.name: one.start + 0.3 * one.tolerance * (one.kind != "effect") for one in parameters}
    _, found = of.dynamic_mass(effects, offsets, AT, DRIVEN)
    assert set(found) == {one.name for one in parameters}
    for one in parameters:
        step = 1e-5 * one.tolerance
        above, below = (
            of.dynamic_mass(effects, {**offsets, one.name: offsets[one.name] + side * step}, AT, DRIVEN, derivatives=False)[0]
            for side in (1, -1)
        )
        difference = (above - below) / (2 * step)
        rounding = 1e-13 * np.abs(above).max() / step
        np.testing.assert_allclose(
            found[one.name], difference, rtol=0, atol=1e-5 * np.abs(difference).max() + rounding, err_msg=one.name
        )


def test_fixed_effects_act_and_are_no_parameters_and_opened_ones_leave_their_tolerance():
    of, free = model("clumod-1"), added("point-mass:mast-top=0.5")
    fixed = tuple(replace(one, fixed=True) for one in free)
    assert {one.name for one in of.parameters(free)} - {one.name for one in of.parameters(fixed)} == {"point-mass:mast-top"}
    H, changes = of.dynamic_mass(fixed)
    np.testing.assert_array_equal(H, of.dynamic_mass(free)[0])
    assert "point-mass:mast-top" not in changes
    of, effects = model("clumod-1"), added("modulus:mast=0.05")
    (one,) = (parameter for parameter in of.parameters(effects) if parameter.name == "modulus:mast")
    assert (one.kind, one.tolerance) == ("effect", FAMILIES["modulus"].sizes[0].plausible)
    np.testing.assert_allclose(one.value(one.start), 0.05, rtol=1e-12)
    left, known = prediction_effects.opened(of.of.parameters, [replace(effects[0], fixed=True)])
    assert "modulus:mast" not in {parameter.name for parameter in left}
    np.testing.assert_allclose(known["modulus:mast"], np.log(1.05))


def test_an_effect_at_a_place_that_is_not_there_changes_nothing():
    of = model("clumod-1")
    effects = (Added(named=Named(family="point-mass", targets=("lower-2+",), values={"": 1.0})),)
    m, changes = prediction_effects.structure(of.of.nominal, {}, effects)
    assert m is of.of.nominal
    assert not changes


def test_channels_carry_derivatives_through_and_add_their_own():
    """A gain written as an equation: rows and earlier derivatives are multiplied, its own derivative is the row."""
    generator = np.random.default_rng(4)
    rows, before = (generator.standard_normal((3, 2, 6)) + 1j * generator.standard_normal((3, 2, 6)) for _ in range(2))
    reading = ChannelResponse(frequency=AT[:3], channels=("fmd-z1", "fmd-z2"), rows=rows)
    (polarity,) = added("polarity:fmd-z2")
    after, changes = prediction_effects.channels(reading, {"one": before}, [polarity])
    sign = np.array([1.0, -1.0])[:, None]
    np.testing.assert_allclose(after.rows, sign * rows)
    np.testing.assert_allclose(changes["one"], sign * before)


WORDS = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)


@pytest.mark.parametrize(
    "text",
    [
        "structural-damping:mast=0.02",
        "joint-compliance:rotation=1e-6",
        "appendage:z=m:0.05,f:21,zeta:0.01",
        "point-mass:flange=0.4",
        "friction:flange:x=3",
    ],
)
def test_bounds_are_those_of_the_family_and_hold_no_effect(text):
    named = parse(text, WORDS)
    sizes = {effects.name(named, size.key): size for size in named.sizes}
    found = effects.parameters((Added(named=named),))
    assert found
    for one in found:
        size = sizes[one.name]
        low, high = (size.low, size.high) if size.logarithmic else (min(size.low, size.null), max(size.high, size.null))
        assert_allclose([one.value(one.low), one.value(one.high)], [low, high], rtol=1e-12)
        assert one.low < one.start < one.high
        assert size.logarithmic or one.low <= 0.0 <= one.high


def test_a_tolerance_that_becomes_an_effect_gets_the_bounds_of_its_family():
    declared = Parameter(
        name="modulus:mast", unit="1", tolerance=0.025, kind=DECLARED, nominal=1.0, logarithmic=True, above=-1.0, within=0.0625
    )
    (one,), _ = effects.opened((declared,), (Added(named=parse("modulus:mast=-0.12", WORDS)),))
    low, high = one.bounds(plain=True)
    assert_allclose([one.value(low), one.value(high)], [-0.999, 9.0], rtol=1e-12)
    assert declared.bounds(plain=True) == (-0.0625, 0.0625)
    assert declared.bounds(plain=False) == (-np.inf, np.inf)
    assert one.kind in PLAIN


def test_an_equation_is_asked_again_by_parameters_of_those_parts_alone_that_it_reads(monkeypatch):
    of, asked, changed = model("clumod-1", None).of, list[str](), prediction_effects._changed
    matrices, tangents = of.at({})
    assert sum(bool(one.parts) or one.lossier is not None for one in tangents.values()) == 6

    def counted(named, stage):
        asked.append(named.family)
        return changed(named, stage)

    monkeypatch.setattr(prediction_effects, "_changed", counted)
    effects = added("absorber:hub-1=m:0.2,f:15,zeta:0.02", "structural-damping:mast=0.05")
    _, found = prediction_effects.structure(matrices, tangents, effects)
    assert asked.count("absorber") == 1 + 2 * 3  # by itself, and to both sides of its three sizes
    _, alone = prediction_effects.structure(matrices, tangents, effects[1:])
    np.testing.assert_allclose(found["modulus:mast"].structural, alone["modulus:mast"].structural, rtol=1e-12)
