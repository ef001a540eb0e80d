"""What `massline identify` refuses, each before anything is computed: the option or file, what was found, what to do."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from geometry.errors import BadInput
from geometry.sensors import Tolerances
from identification import campaign_file
from identification.campaign import Campaign
from validation.identify.request import IdentifyOptions, ready
from validation.model.setups import takes_fmd_off


@pytest.fixture(scope="module")
def folders(own_campaign, tmp_path_factory) -> dict[str, str]:
    """A campaign on a rigid block that passes for Clumod, tares of the same and of another hardware, one without mounting."""
    made: Campaign = own_campaign["campaign"]()
    place = tmp_path_factory.mktemp("series")
    written = {
        "article": replace(made, article="fmd+clumod-1"),
        "tare": made,
        "bare": replace(made, article="fmd"),
        "other": replace(made, hardware="lab/2"),
        "unstated": replace(made, hardware=""),
        "unmounted": replace(made, mounting=None),
        "strange": replace(made, article="fmd+mystery"),
    }
    for name, campaign in written.items():
        campaign_file.write(place / name, campaign)
    return {name: str(place / name) for name in written}


REFUSED = [
    ({"modes": "many"}, "--modes", "found 'many'"),
    ({"modes": "-1"}, "--modes", "from 0 to 40"),
    ({"modes": "41"}, "--modes", "found '41'"),
    ({"band": (10.0, 5.0)}, "--band", "the lower one first"),
    ({"band": (0.0, 5.0)}, "--band", "above 0 Hz"),
    ({"band": (40.0, 60.0)}, "--band", "is not driven"),
    ({"band": (10.0, 10.1), "study": False}, "--band", "holds only 2 of the lines"),
    ({"condition_limit": 0.5}, "--condition-limit", "above 1"),
    ({"condition_limit": float("nan")}, "--condition-limit", "above 1"),
    ({"cell_stiffness": (1e8, 0.0, 1e8)}, "--cell-stiffness", "above 0 N/m"),
    ({"tolerances": ("gian=1 %",)}, "--tolerance", "Did you mean gain"),
    ({"tolerances": ("gain",)}, "--tolerance", "KEY=VALUE"),
    ({"tolerances": ("position=1 kg",)}, "--tolerance", "length"),
    ({"known": ("disc+cuboid",)}, "--known", "there is no tare"),
    ({"tares": ("tare",), "known": ("disc", "cuboid")}, "--known", "found 2"),
    ({"tares": ("tare",), "known": ("clumod-4",)}, "--known", "is not what stands on the FMD"),
    ({"tares": ("tare",), "known": ("disc+cubiod",)}, "--known", "Did you mean disc+cuboid"),
    ({"tares": ("article",)}, "--tare", "is the campaign itself"),
    ({"tares": ("tare",), "known_tolerance": "2"}, "--known-tolerance", "above 0 and below 1 is expected, found 2"),
    ({"tares": ("tare",), "known_tolerance": "little"}, "--known-tolerance", "little"),
    ({"tares": ("strange",)}, "campaign.toml", "no built-in article is called 'mystery'"),
    ({"tares": ("other",)}, "campaign.toml", "another FMD"),
    ({"tares": ("nowhere",)}, "nowhere", ""),
    ({"classical": ("nothing.toml",)}, "nothing.toml", ""),
    ({"classical": ("clumod-4-weighing",), "tares": ("tare",)}, "clumod-4-weighing", "it is about clumod-4"),
    ({"fmd": "nothing.toml"}, "nothing.toml", ""),
]


@pytest.mark.parametrize(("changes", "source", "words"), REFUSED, ids=lambda value: str(value) if isinstance(value, dict) else "")
def test_what_cannot_be_used_is_refused_by_name(changes, source, words, folders):
    given = {key: tuple(folders.get(v, v) for v in value) if key == "tares" else value for key, value in changes.items()}
    with pytest.raises(BadInput) as refused:
        ready(IdentifyOptions(campaign=folders["article"], **given))
    assert source in refused.value.source
    assert words in str(refused.value)
    assert refused.value.remedy


def test_the_known_article_is_by_default_what_the_tare_says_and_how_well_can_be_said(folders):
    asked = IdentifyOptions(campaign=folders["article"], tares=(folders["tare"],))
    by_default, by_name = ready(asked), ready(replace(asked, known=("disc+cuboid",)))
    known = [one.request.tares[0].known for one in (by_default, by_name)]
    np.testing.assert_array_equal(known[0].parameters, known[1].parameters)
    assert not by_default.warnings
    usual, poor = (
        ready(IdentifyOptions(campaign=folders["article"], tares=(folders["tare"],), **said)).request.tares[0].relative_sd
        for said in ({}, {"known_tolerance": "0.5 %"})
    )
    assert (usual, poor) == (3e-4, 5e-3)


@pytest.mark.parametrize(
    ("tare", "taken"), [("tare", True), ("unstated", True), ("other", False), (None, False)], ids=lambda value: str(value)
)
def test_only_a_tare_of_the_same_hardware_takes_the_fmd_off(tare, taken, folders):
    tares = () if tare is None else (folders[tare],)
    assert takes_fmd_off(ready(IdentifyOptions(campaign=folders["article"], tares=tares, any_hardware=True)).request) == taken


def test_a_band_that_reaches_beyond_the_sweeps_is_said(folders):
    (said,) = ready(IdentifyOptions(campaign=folders["article"], band=(2.0, 20.0))).warnings
    assert "drive 4 to 32 Hz only" in said


def test_tolerances_and_stiffness_arrive_in_si_and_a_weighing_of_the_article_alone_needs_a_tare(folders, root):
    asked = IdentifyOptions(
        campaign=folders["article"], tolerances=("gain=0.2 %", "position=0.3 mm", "delay=5 us"), cell_stiffness=(1e8, 1e8, 4e8)
    )
    request = ready(asked).request
    wanted = replace(Tolerances(), gain=0.002, position=0.3e-3, delay=5e-6)
    assert asdict(request.tolerances) == pytest.approx(asdict(wanted), rel=1e-12)
    assert request.cell_stiffness.tolist() == [1e8, 1e8, 4e8]
    assert request.modes is None
    weighing = str(root / "examples" / "clumod-1-weighing.toml")
    (fact,) = ready(IdentifyOptions(campaign=folders["article"], tares=(folders["tare"],), classical=(weighing,))).request.facts
    assert fact.value == pytest.approx(32.955, abs=0.001)
    with pytest.raises(BadInput, match="A tare takes the FMD off"):
        ready(IdentifyOptions(campaign=folders["article"], classical=(weighing,)))


def test_an_fmd_that_is_known_beforehand_comes_from_a_result_file(folders, tmp_path):
    path = tmp_path / "fmd.toml"
    path.write_text(
        'format = 1\narticle = "fmd"\n[inertia]\nmass = "18.08 kg"\ncog = ["0 mm", "0 mm", "24.4 mm"]\n'
        'moments = ["0.253 kg m^2", "0.253 kg m^2", "0.4997 kg m^2"]\n'
    )
    request = ready(IdentifyOptions(campaign=folders["article"], fmd=str(path))).request
    np.testing.assert_allclose([request.fmd.mass, request.fmd.cog[2]], [18.08, 0.0244], rtol=1e-12)
    assert takes_fmd_off(request)


def test_progress_names_the_campaign_that_is_read(folders):
    heard: list[tuple[str, float]] = []
    ready(
        IdentifyOptions(campaign=folders["article"], tares=(folders["tare"],)), lambda words, share: heard.append((words, share))
    )
    assert [words for words, share in heard if share == 1.0] == [folders["article"], folders["tare"]]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--nonsense",), "No such option"),
        (("--spectra", "welch"), "welch"),
        (("--frame", "sideways"), "--frame"),
        (("--tare", "nowhere"), "nowhere"),
        (("--out", "no/such/place/at/all/../../../../../../../../proc/x"), "--out"),
    ],
)
def test_the_command_ends_with_2_and_one_sentence(options, words, folders, refused):
    assert words in refused("identify", folders["article"], *options)
