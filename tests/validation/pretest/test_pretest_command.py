"""`massline pretest`: what is printed, what a program reads, what is drawn, and what is refused."""

import pytest

from validation.report import pretest


def test_the_page_says_intervals_causes_channels_and_places(tared):
    text = pretest.PretestPage(found=tared).document().text(150)
    for said in (
        "Pretest of fmd+disc+cuboid: 6 runs",
        "self-calibrated",
        "and without tare",
        "dominated by",
        "without",
        "no resultants: what its cells carry is not seen",
        "pick-up at",
        "Condition number of the base motions: median 1.",
        "0 of 121 lines above the limit of 100",
        "the whole band",
    ):
        assert said in text
    assert "nan" not in text


def test_the_pictures_are_drawn(tared, tmp_path, renderer):
    paths = pretest.PretestPage(found=tared).draw(tmp_path)
    assert [path.name for path in paths] == [f"pretest-fmd+disc+cuboid{end}.png" for end in ("", "-shares", "-places")]
    assert all(path.stat().st_size > 20_000 for path in paths)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("clumod-7",), "clumod"),
        (("disc+cuboid", "--tare", "fmd+disc+cuboid"), "the tare is the article itself"),
        (("clumod-1", "--tare", "cubiod"), "cuboid"),
        (("clumod-1", "--tolerance", "gian=1%"), "gain"),
        (("clumod-1", "--tolerance", "gain=-1%"), "gain"),
        (("clumod-1", "--rigid", "0"), "--rigid"),
        (("clumod-1", "--condition-limit", "0.5"), "--condition-limit"),
        (("clumod-1", "--pattern", "spiral"), "--pattern"),
        (("clumod-1", "--runs", "7"), "--runs"),
        (("clumod-1", "--band", "9", "6"), "found 9 to 6"),
        (("clumod-1", "--level", "0"), "--levels"),
        (("clumod-1", "--noise", "loud"), "--noise"),
        (("clumod-1", "--sensors", "nowhere"), "nowhere"),
        (("clumod-1", "--damping", "-1"), "damping"),
    ],
)
def test_what_cannot_be_planned_is_refused_in_words(refused, arguments, said):
    assert said in refused("pretest", *arguments)


def test_sensors_that_tell_no_base_motion_are_refused(refused, root, tmp_path):
    import runpy
    from dataclasses import replace

    from identification import campaign_file

    made = runpy.run_path(str(root / "examples" / "own_campaign.py"))["campaign"]()
    kept = [k for k, name in enumerate(made.table.names) if not name.startswith(("cover-x", "table-x"))]
    recordings = {
        name: replace(one, names=made.table.subset(kept).names, values=one.values[:, kept])
        for name, one in made.recordings.items()
    }
    campaign_file.write(tmp_path / "few", replace(made, table=made.table.subset(kept), recordings=recordings))
    assert "x" in refused("pretest", "clumod-1", "--sensors", str(tmp_path / "few"))
