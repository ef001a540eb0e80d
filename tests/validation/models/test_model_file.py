"""The model file: what is written is read back, what cannot be meant is refused by name, and an edit leaves the rest alone."""

import re
from dataclasses import asdict, fields, replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geometry.errors import BadInput
from geometry.inertia import Inertia
from geometry.sensors import Tolerances
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import Vocabulary
from validation.model import model_file
from validation.model.model import Added, Model, Requirement, StructureTolerances

SMALLEST = 'format = 1\n[model]\narticle = "fmd+clumod-1"\n'

BY_HAND = """\
# Our laboratory, spring campaign
format = 1            # the only one there is

[model]
title = "by hand"
article = "fmd+clumod-1"

[laboratory.fmd]
mass_kg = 18.08       # weighed
cog_mm = [0, 0, 24.4]
moi_cog_kgm2 = [0.2528, 0.2528, 0.4997]

# --- what we found -------------------------------------------

# the cell that was dropped
[[effect]]
id = "force-gain:fmd-z2"
value = 0.08          # by fit
# sd is not known yet

# a loose cover, perhaps
[[effect]]             # second
id = 'appendage:z'
value = { m = 0.05, f = 21, zeta = 0.01 }   # resonator
sd = { m = 0.01 }
fixed = true
# nothing follows
"""


def added(text: str, **deviation: float) -> Added:
    return Added(named=parse(text), deviation={key.strip("_"): sd for key, sd in deviation.items()})


def everything() -> Model:
    return Model(
        source="m.toml",
        title='Two "blades", ünd mehr',
        article="fmd+clumod-4",
        hardware="fmd-A/sensors-2002",
        gravity=9.80665,
        fmd=Inertia.from_cog(18.08, [0.0003, -0.0002, 0.0244], np.diag([0.2528, 0.2530, 0.4997])),
        fmd_tolerance=0.03,
        cell_stiffness=np.array([1e8, 1.1e8, 4e8]),
        tolerances=Tolerances(gain=0.002, position=0.3e-3, angle=radians(0.2), delay=1e-5, fmd_inertia=0.03),
        kind="rigid",
        modes=12,
        changes={"clumod.mast.outer_diameter_mm": 60.1, "clumod.blade.lower-1.length_mm": 500.5},
        damping_ratio=0.0035,
        structure=StructureTolerances(modulus=0.01, damping=0.2),
        effects=(
            added("force-gain:fmd-z2=0.08", _=0.003),
            added("appendage:z=m:0.05,f:21,zeta:0.01", m=0.01, f=0.1),
            added("friction:flange:x=3,mass:2.5", _=0.5, mass=0.1),
            Added(named=parse("polarity:fmd-z1"), fixed=True),
        ),
        revision="B",
        requirements=(
            Requirement(quantity="mass", low=32.0, high=33.3, clause="ICD 4.2"),
            Requirement(quantity="cog_z", high=0.603),
        ),
    )


def test_three_lines_are_a_model():
    model = model_file.of_text(SMALLEST, "m.toml")
    assert (model.article, model.kind, model.effects, model.fmd) == ("fmd+clumod-1", "beam", (), None)
    assert (model.tolerances, model.structure) == (Tolerances(), StructureTolerances())


def test_what_is_written_is_read_back_to_the_last_bit():
    model = everything()
    again = model_file.of_text(model_file.text(model), "m.toml")
    for name in (
        "title",
        "article",
        "hardware",
        "gravity",
        "fmd_tolerance",
        "tolerances",
        "kind",
        "modes",
        "damping_ratio",
        "revision",
    ):
        assert getattr(again, name) == getattr(model, name), name
    assert again.structure == model.structure
    assert again.changes == model.changes
    assert list(map(asdict, again.requirements)) == list(map(asdict, model.requirements))
    assert model.cell_stiffness is not None
    np.testing.assert_array_equal(again.fmd.parameters, model.fmd.parameters)
    np.testing.assert_array_equal(again.cell_stiffness, model.cell_stiffness)
    kept = [(one.named.id, dict(one.named.values), dict(one.deviation), one.fixed) for one in again.effects]
    assert kept == [(one.named.id, dict(one.named.values), dict(one.deviation), one.fixed) for one in model.effects]
    assert model_file.text(again) == model_file.text(model)


def test_every_tolerance_has_its_key_in_the_file():
    """A field added to `Tolerances` or `StructureTolerances` must find its way into the file."""
    strange = {one.name: 0.5 * getattr(Tolerances(), one.name) for one in fields(Tolerances)}
    halves = {one.name: 0.5 * getattr(StructureTolerances(), one.name) for one in fields(StructureTolerances)}
    model = Model(
        source="m.toml",
        title="",
        article="fmd",
        fmd_tolerance=strange["fmd_inertia"],
        tolerances=Tolerances(**strange),
        structure=StructureTolerances(**halves),
    )
    again = model_file.of_text(model_file.text(model), "m.toml")
    assert (again.tolerances, again.structure) == (model.tolerances, model.structure)


@settings(max_examples=60, deadline=None)
@given(
    mass=st.floats(0.1, 1e3),
    cog=st.lists(st.floats(-300.0, 300.0), min_size=3, max_size=3),
    position=st.floats(0.0, 50.0),
    angle=st.floats(0.0, 20.0),
)
def test_figures_of_a_file_survive_reading_and_writing(mass, cog, position, angle):
    moment = 0.01 * mass
    text = SMALLEST + (
        f"[laboratory.fmd]\nmass_kg = {mass!r}\ncog_mm = {cog!r}\nmoi_cog_kgm2 = [{moment!r}, {moment!r}, {moment!r}]\n"
        f"[tolerances]\nposition_mm = {position!r}\nangle_deg = {angle!r}\n"
    )
    model = model_file.of_text(text, "m.toml")
    again = model_file.of_text(model_file.text(model), "m.toml")
    np.testing.assert_array_equal(again.fmd.parameters, model.fmd.parameters)
    assert again.tolerances == model.tolerances


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_the_example_of_every_family_can_stand_in_a_model(family):
    example = FAMILIES[family].example.partition(", or ")[0]
    model = Model(source="m.toml", title="", article="fmd+clumod-4", effects=(added(example),))
    again = model_file.of_text(model_file.text(model), "m.toml").effects[0].named
    assert (again.id, dict(again.values)) == (parse(example).id, dict(parse(example).values))


def test_dimensions_may_be_written_as_tables():
    flat = model_file.of_text(SMALLEST + '[structure.dimensions]\n"clumod.mast.outer_diameter_mm" = 60\n', "m.toml")
    deep = model_file.of_text(SMALLEST + "[structure.dimensions.clumod.mast]\nouter_diameter_mm = 60.0\n", "m.toml")
    assert flat.changes == deep.changes == {"clumod.mast.outer_diameter_mm": 60.0}


@pytest.mark.parametrize(
    ("text", "field", "says"),
    [
        ("format = 2\n[model]\narticle = 'fmd'", "format", "must be 1, found 2"),
        ("format = 1\n[campaign]\ntitle = 'x'", "model", "this is a campaign.toml, where a model file is needed"),
        ("format = 1\n[fe_model]\nkind = 'mesh'", "model", "massline model lab.toml --test TEST"),
        ("format = 1\n[modell]\narticle = 'fmd'", "model", "Did you mean modell"),
        ("format = 1\n[model]\ntitle = 'x'", "model.article", "the set-up is missing"),
        ("format = 1\n[model]\narticle = 'fmd+clumod-2'", "model.article", "no built-in article is called 'clumod-2'"),
        ("format = 1\n[model]\narticle = 3", "model.article", "a text is expected, found 3"),
        (SMALLEST + "artikel = 'x'", "model.artikel", "Did you mean article"),
        (SMALLEST + "[[requirement]]\nquantity = 'weight'\nmax = '3 kg'", "requirement[1].quantity", "found 'weight'"),
        (SMALLEST + "[[requirement]]\nquantity = 'mass'", "requirement[1].min", "neither min nor max"),
        (SMALLEST + "[[requirement]]\nquantity = 'mass'\nmax = '3 mm'", "requirement[1].max", "mm"),
        (SMALLEST + "[[requirement]]\nquantity = 'mass'\nmin = '4 kg'\nmax = '3 kg'", "requirement[1].min", "above max"),
        (SMALLEST + "[labratory]", "labratory", "Did you mean laboratory"),
        (SMALLEST + "[laboratory]\ngravity = 9.81", "laboratory.gravity", "Did you mean gravity_m_s2"),
        (SMALLEST + "[laboratory]\ngravity_m_s2 = '9.81'", "laboratory.gravity_m_s2", "a number is expected"),
        (SMALLEST + "[laboratory]\ngravity_m_s2 = 981", "laboratory.gravity_m_s2", "must be from 0 to 30, found 981"),
        (SMALLEST + "[laboratory]\nfmd = 3", "laboratory.fmd", "a table is expected"),
        (SMALLEST + "[laboratory]\ncell_stiffness_N_m = [1e8, 1e8]", "laboratory.cell_stiffness_N_m", "three numbers"),
        (SMALLEST + "[laboratory]\ncell_stiffness_N_m = [1e8, 0, 1e8]", "laboratory.cell_stiffness_N_m", "found 0"),
        (SMALLEST + "[laboratory.fmd]\nmass_kg = -1", "laboratory.fmd.mass_kg", "must be above 0"),
        (SMALLEST + "[laboratory.fmd]\nmass_kg = 18", "laboratory.fmd.cog_mm", "is missing"),
        (SMALLEST + "[laboratory.fmd]\ninertia = 'drawn'", "laboratory.fmd.inertia", "Did you mean drawing"),
        (SMALLEST + "[laboratory.fmd]\ninertia = 'drawing'\nmass_kg = 18", "laboratory.fmd.inertia", "mass_kg is stated"),
        (
            SMALLEST + "[laboratory.fmd]\nmass_kg = 18\ncog_mm = [0,0,0]\nmoi_cog_kgm2 = [0.1, 0.1, 0.5]",
            "laboratory.fmd.moi_cog_kgm2",
            "no body has this inertia",
        ),
        (SMALLEST + "[laboratory.fmd]\ntolerance = nan", "laboratory.fmd.tolerance", "must be from 0 to 1, found nan"),
        (SMALLEST + "[tolerances]\nposition = 0.5", "tolerances.position", "Did you mean position_mm"),
        (SMALLEST + "[tolerances]\ndelay_s = 20", "tolerances.delay_s", "must be from 0 to 0.01, found 20"),
        (SMALLEST + "[tolerances]\ngain = -0.1", "tolerances.gain", "must be from 0"),
        (SMALLEST + "[structure]\nkind = 'beams'", "structure.kind", "Did you mean beam"),
        (SMALLEST + "[structure]\nkind = 'own'", "model.article", "has no model of its own"),
        (SMALLEST + "[structure]\nmodes = 0", "structure.modes", "1 or more"),
        (SMALLEST + "[structure]\nmodes = 501", "structure.modes", "between 1 and 500"),
        (SMALLEST + "[structure]\nmodes = 3.5", "structure.modes", "a whole number"),
        (SMALLEST + "[structure]\ndamping_ratio = 1.5", "structure.damping_ratio", "must be from 0 to 0.99"),
        (SMALLEST + "[structure.dimensions]\n'clumodd.mast.top_mm' = 3", "structure.dimensions.clumodd.mast.top_mm", "clumod?"),
        (SMALLEST + "[structure.dimensions]\n'clumod.mast.tip' = 3", "structure.dimensions.clumod.mast.tip", "no 'tip' here"),
        (SMALLEST + "[structure.dimensions]\n'fmd.load_cell.moving_fraction' = 3", "structure.dimensions.fmd", "between 0 and 1"),
        (SMALLEST + "[structure.own]\n'fmd+mine' = 'mine.h5'", "structure.own.fmd+mine", "there is no file"),
        (SMALLEST + "[structure.own]\n'fmd+mine' = ''", "structure.own.fmd+mine", "a path is missing"),
        (SMALLEST + "[structure.tolerances]\nmoduli = 0.1", "structure.tolerances.moduli", "Did you mean modulus"),
        (SMALLEST + "[structure.tolerances]\nmodulus = 25", "structure.tolerances.modulus", "must be from 0 to 10, found 25"),
        (SMALLEST + "[effect]\nid = 'polarity:fmd-z1'", "effect", "[[effect]]"),
        (SMALLEST + "[[effect]]\nvalue = 3", "effect[1].id", "is missing"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1=0.1'", "effect[1].id", "an id without its value is expected"),
        (SMALLEST + "[[effect]]\nid = 'force-gian:fmd-z1'\nvalue = 0.1", "effect[1].id, force-gian:fmd-z1", "mean force-gain"),
        (SMALLEST + "[[effect]]\nid = 'modulus:masst'\nvalue = 0.1", "effect[1]", "Did you mean mast"),
        (SMALLEST + "[[effect]]\nid = 'point-mass:mast-tip'\nvalue = 0.1", "effect[1]", "Did you mean mast-top"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'", "effect[1]", "its value [1] is missing"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = 80", "effect[1]", "must be between -0.9 and 9, found 80"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = true", "effect[1].value", "a number is expected, found True"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = {gain = 0.1}", "effect[1]", "found 'gain:0.1'"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = [0.1]", "effect[1].value", "a number is expected"),
        (SMALLEST + "[[effect]]\nid = 'appendage:z'\nvalue = {m = 0.1, f = 21}", "effect[1]", "its zeta [1] is missing"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = 0.1\nsd = {m = 1}", "effect[1].sd", "found 'm:1.0'"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = 0.1\nsd = -1", "effect[1].sd", "must be from 0"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = 0.1\nsd = 'x'", "effect[1].sd", "a number is expected"),
        (SMALLEST + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = 0.1\nfixed = 1", "effect[1].fixed", "true or false"),
        (SMALLEST + "[[effect]]\nid = 'polarity:a'\n[[effect]]\nid = 'polarity:a'", "effect[2].id", "stands there twice"),
    ],
)
def test_what_cannot_be_meant_is_refused_by_name(text, field, says):
    with pytest.raises(BadInput, match=re.escape(says)) as refused:
        model_file.of_text(text, "lab.toml")
    assert refused.value.source == "lab.toml"
    assert refused.value.field.startswith(field)


def test_a_file_that_is_not_there_says_how_to_get_one(tmp_path):
    with pytest.raises(BadInput, match=r"there is no such file\. Write one with `massline model ARTICLE"):
        model_file.read(tmp_path / "none.toml")


def test_an_own_model_is_found_from_the_folder_of_the_file_and_of_no_known_kind_refused(tmp_path):
    (tmp_path / "mine.h5").touch()
    path = tmp_path / "lab.toml"
    path.write_text(
        'format = 1\n[model]\narticle = "fmd+mine"\n[structure]\nkind = "own"\n[structure.own]\n"fmd+mine" = "mine.h5"\n'
        '[[effect]]\nid = "point-mass:antenna"\nvalue = 0.3\n[[effect]]\nid = "modulus:boom"\nvalue = 0.1\n'
    )
    model = model_file.read(path)
    assert model.own == {"fmd+mine": str(tmp_path / "mine.h5")}
    assert [one.named.target for one in model.effects] == ["antenna", "boom"]
    assert '"fmd+mine" = "mine.h5"' in model_file.text(model)
    (tmp_path / "mine.xyz").touch()
    text = SMALLEST + f"[structure.own]\n'fmd+mine' = '{tmp_path}/mine.xyz'\n"
    with pytest.raises(BadInput, match=r"`structure.own.fmd\+mine`: a file that ends in .xyz cannot be read"):
        model_file.of_text(text, "lab.toml")


def test_a_new_effect_comes_last_and_a_new_value_leaves_comments_and_order_that_of_a_resonator_too():
    edited = model_file.with_effect(BY_HAND, added("unit:cover-z3=g"))
    assert edited.startswith(BY_HAND)
    assert [one.named.id for one in model_file.of_text(edited, "m").effects][-1] == "unit:cover-z3"
    edited = model_file.with_effect(BY_HAND, added("force-gain:fmd-z2=0.0785", _=0.0021))
    before, after = BY_HAND.splitlines(), edited.splitlines()
    assert [line for line in after if line not in before] == ["value = 0.0785          # by fit", "sd = 0.0021"]
    assert [line for line in before if line not in after] == ["value = 0.08          # by fit"]
    assert [line for line in after if line in before] == [line for line in before if line in after]
    new = added("appendage:z=m:0.06,f:22,zeta:0.02", m=0.001, f=0.2)
    edited = model_file.with_effect(BY_HAND, new)
    assert "value = { m = 0.06, f = 22.0, zeta = 0.02 }   # resonator" in edited
    assert "sd = { m = 0.001, f = 0.2 }" in edited
    assert "fixed = false" in edited
    assert "[[effect]]             # second" in edited
    assert edited.endswith("# nothing follows\n")


def test_effects_one_by_one_are_those_of_the_whole_text():
    whole, text = everything(), model_file.text(replace(everything(), effects=()))
    for one in whole.effects:
        text = model_file.with_effect(text, one)
    assert text == model_file.text(whole)


def test_what_an_edit_could_damage_is_refused():
    text = "effect = [{id = 'polarity:a'}]\n" + SMALLEST
    with pytest.raises(BadInput, match="Write each as a table of its own"):
        model_file.with_effect(text, added("polarity:fmd-z1"))
    # The very lines of the effect stand in the title first
    trap = (
        SMALLEST.replace("[model]", "[model]\ntitle = '''\n[[effect]]\nid = \"polarity:a\"\n'''")
        + '[[effect]]\nid = "polarity:a"\n'
    )
    with pytest.raises(BadInput, match="Write each as a table of its own"):
        model_file.with_effect(trap, Added(named=parse("polarity:a", Vocabulary(accelerometers=("a",))), fixed=True))


def test_a_place_that_an_article_has_not_is_said_and_no_layout_blamed():
    elsewhere = Added(named=parse("point-mass:masttop=0.2", Vocabulary(places=("masttop",))))
    with pytest.raises(BadInput, match=r"no place is called 'masttop'\. Did you mean mast-top\?"):
        model_file.with_effect('format = 1\nmodel = { article = "fmd+clumod-1" }\n', elsewhere)


def test_a_text_of_several_lines_and_tables_between_effects_stay():
    title, between = 'title = """\n[[effect]]\n"""', "[[effect]]\nid = 'polarity:a'\n\n[tolerances]  # ours\ngain = 0.01\n"
    text = SMALLEST.replace("[model]", f"[model]\n{title}") + between + "[[effect]]\nid = 'force-gain:fmd-z1'\nvalue = 0.1\n"
    assert model_file.with_effect(text, added("force-gain:fmd-z1=0.25")) == text.replace("value = 0.1", "value = 0.25")


def test_line_ends_of_another_system_stay_and_a_layout_of_several_lines_is_rewritten_whole():
    text = BY_HAND.replace("\n", "\r\n")
    edited = model_file.with_effect(text, added("force-gain:fmd-z2=0.0785"))
    assert edited == text.replace("value = 0.08 ", "value = 0.0785 ")
    text = SMALLEST + "[[effect]]\nid = 'appendage:z'  # ours\n[effect.value]\nm = 0.1\nf = 20.0\nzeta = 0.01\n"
    edited = model_file.with_effect(text, added("appendage:z=m:0.2,f:20,zeta:0.01"))
    assert model_file.of_text(edited, "m").effects[0].named.values["m"] == 0.2


def test_a_study_of_a_structure_that_has_a_title_keeps_it(tmp_path: Path) -> None:
    (tmp_path / "tower.toml").write_text(
        'format = 1\nmodel = { title = "Two blocks on rulers", article = "tower" }\n[fe_model]\nkind = "frame"\n'
        'fixed = ["foot"]\n'
        'nodes = { foot = "0 mm", block = "50 mm" }\nmembers = { ruler = ["foot", "block"] }\nmaterial = "steel"\n'
        'section = { width = "25 mm", thickness = "1 mm", across = "x" }\nmasses = { block = "100 g" }\n'
    )
    for name, more in (("before", ""), ("after", 'before = "before.toml"\n')):
        table = 'format = 1\nkind = "modal-table"\narticle = "tower"\nfrequencies = ["20 +/- 0.1 Hz"]\n'
        (tmp_path / f"{name}.toml").write_text(table + more)
    study = tmp_path / "study.toml"
    text = model_file.study_text(str(tmp_path / "tower.toml"), [str(tmp_path / "after.toml")], study)
    study.write_text(text)
    assert model_file.read(study).title == "Two blocks on rulers"
    assert model_file.read(study).tests[0]["before"] == "before.toml"
