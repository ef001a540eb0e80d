"""Commands about campaigns: plan one, check it, identify mass, centre of gravity and inertia from it."""

from pathlib import Path
from typing import Any

import click
from click import argument, command, option

from geometry import toml_file
from geometry.errors import BadInput
from validation.cli import options


@command("identify")
@argument("campaign", metavar="CAMPAIGN")
@option(
    "--tare",
    "tares",
    multiple=True,
    metavar="CAMPAIGN",
    help="A campaign of a known article on the same hardware, from which the FMD is learnt. May be repeated.",
)
@option(
    "--known",
    multiple=True,
    metavar="ARTICLE",
    help="What stands on the FMD in the tare, for each tare; its drawing gives its inertia.  [default: what the tare says it is]",
)
@option(
    "--known-tolerance",
    default="0.03 %",
    show_default=True,
    metavar="SHARE",
    help="How well that inertia is known, one standard deviation; more where bolts and holes are not as drawn.",
)
@option(
    "--classical",
    multiple=True,
    metavar="FILE",
    help="A weighing, CoG, pendulum or results file about the article, taken as data with its tolerance. May be repeated.",
)
@option("--band", nargs=2, type=float, metavar="LO HI", help="Frequencies [Hz] to use.  [default: the campaign's]")
@option(
    "--spectra", type=click.Choice(options.METHODS), default=options.METHODS[0], show_default=True, help="How spectra are made."
)
@option("--modes", default="auto", show_default=True, metavar="N", help="Elastic terms; 0 takes the article for rigid.")
@option("--condition-limit", type=float, default=100.0, show_default=True, metavar="X", help="Leave out lines conditioned worse.")
@option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="KEY=VALUE",
    help='Your own tolerance of the measurement chain, one standard deviation: gain="0.2 %", position="0.3 mm", angle, delay, '
    "table_gain, cell_stiffness, crosstalk, fmd_inertia. May be repeated.",
)
@option("--cell-stiffness", nargs=3, type=float, metavar="KX KY KZ", help="Stiffness [N/m] of one load cell, where it is known.")
@option("--fmd", metavar="FILE", help="What is known beforehand of the FMD's moving part: a result file about fmd.")
@option("--any-hardware", is_flag=True, help="Allow a tare of different hardware, say so, and take no FMD off.")
@option("--robust", is_flag=True, help="Limit what single lines may say in the plain fit.")
@option("--study/--no-study", default=True, show_default=True, help="The result over start and stop frequency.")
@option("--plot", is_flag=True, help="Also draw condition, dynamic mass, stability, residuals and shares, under out/.")
@option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Write identify.json and the pictures into DIR.")
@options.JSON
@options.FRAME
@click.pass_context
def identify_command(ctx: click.Context, /, plot: bool, out: Path | None, as_json: bool, frame: str | None, **given: Any) -> None:
    """Mass, CoG, moments and products of inertia of the article of CAMPAIGN, with 95 % intervals and a verdict on each.

    CAMPAIGN may be TEST.toml or a universal file, response functions of a free or softly hung body with at least six references
    and coordinates of all points, or a model with such a [[test]]: the mass line and a joint fit then stand side by side.

    Plain results (Eqs. 6 to 11, then 1 and 4) and self-calibrated ones, in which every tolerance of sensors and load cells is
    estimated over article and tare, stand side by side; docs/identification.md says how to read them. Without --tare the FMD's
    moving part is in the result.

    Exit code 0 when it is done, whatever the verdicts; 1 when no body can have what comes out; 2 when the input cannot be used.
    """
    from validation.identify.request import IdentifyOptions
    from validation.output import require_folder
    from validation.report.identify import answer, answer_of_test

    given["campaign"] = toml_file.described_in(given["campaign"])
    if Path(given["campaign"]).is_file():
        typed = click.core.ParameterSource.COMMANDLINE
        names = [name for name in ctx.params if ctx.get_parameter_source(name) is typed]
        if other := sorted(set(names) - {"campaign", "band", "as_json"}):
            raise BadInput(f"--{other[0].replace('_', '-')}", "", "has no meaning for response functions", "Leave it out")
        answer_of_test(given["campaign"], given["band"] or None, as_json=as_json)
        return
    if out is not None:
        require_folder(out, "--out")
    folder = out if out is not None else Path("out") if plot else None
    answer(IdentifyOptions(**given), frame, as_json=as_json, folder=folder, keep=out is not None)


@command("check")
@argument("campaign")
@options.JSON
@option("--view", is_flag=True, help="Also draw pick-ups and load cells on the article, under out/.")
@option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Also write what was measured with its 95 % intervals: dynamic mass of a campaign, response functions of a test, as "
    ".csv, .unv, .uff, .h5 or .mat.",
)
@click.pass_context
def check_command(ctx: click.Context, campaign: str, as_json: bool, view: bool, out: Path | None) -> None:
    """What the folder CAMPAIGN holds: channels, runs, levels, noise, which motions and forces can be told. And all that is wrong.

    CAMPAIGN may be the TOML file of a test of any structure, too, or its folder, a model with its [[test]], or a universal file
    of response functions or modes: what is in it, and the table by which a model reads it.

    Exit code 0 when nothing is wrong, 1 when the data can be used but there are warnings to read, 2 when they cannot be used as
    they are.
    """
    from validation.cli.main import BAD_INPUT, FAILED_CHECK
    from validation.identify.check import summary
    from validation.output import print_answer, require_ending, shown, to_json, wrote
    from validation.report import campaign as answer
    from validation.report.document import page

    if out is not None:
        require_ending(out, answer.FUNCTIONS, "what was measured", "out/H.unv")
    campaign = toml_file.described_in(campaign)
    path, described = Path(campaign), campaign.lower().endswith(".toml")
    if described or path.is_file():  # what a folder holds is said without models, half of what there is to import
        from identification import test_file
        from validation.study import tests_in

        if (tests := tests_in(path)) is not None:
            if view:
                raise BadInput("--view", "", "a test has no drawing of sensors", "Leave it out")
            answer.show_tests(campaign, tests, as_json=as_json, out=out)
            if not described and not as_json:
                tables = [test_file.text(test_file.table_of(one, path.name)) for one in tests]
                click.echo("\n\n".join(("\nA model reads it by", *tables)))
            if any(one.warnings for one in tests):
                ctx.exit(FAILED_CHECK)
            return
    with shown(f"reading {campaign}", quiet=as_json):
        found = summary(campaign)
    if found.campaign is None and len(found.problems) == 1:
        raise found.problems[0]
    verdict, *said = answer.notes(found)
    shown_page = page(answer.title(found), answer.grids(found), said, opening=(verdict,))
    print_answer(lambda: to_json(found), lambda: shown_page, as_json=as_json)
    if view and found.campaign is not None:
        from validation.report.scenes.setups import sensor_map

        with shown(f"sensor map of {campaign}", quiet=as_json):
            path = sensor_map(found.campaign, Path("out"))
        wrote(path)
    if out is not None and found.campaign is not None and found.usable:
        with shown(f"dynamic mass of {campaign}", quiet=as_json):
            answer.write_dynamic_mass(out, found.campaign)
        wrote(out)
    if not found.usable:
        ctx.exit(BAD_INPUT)
    if found.warnings:
        ctx.exit(FAILED_CHECK)


@command("pretest")
@argument("article")
@options.JSON
@option("--tare", default="fmd+disc+cuboid", show_default=True, metavar="ARTICLE", help="Of known inertia, or none.")
@option("--sensors", type=click.Path(path_type=Path), metavar="CAMPAIGN", help="Channels of a campaign.toml of your own.")
@option("--pattern", default="sweep", show_default=True, metavar="PATTERN", help="sweep, diagonal or multi.")
@option("--runs", type=int, metavar="N", help="12 sweeps instead of 6, the others a quarter period later.")
@option("--level", type=float, default=1.0, show_default=True, metavar="L", help="Factor on the nominal level.")
@option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@option("--octaves-per-minute", type=float, default=2.0, show_default=True, metavar="RATE", help="Rate of the sweeps.")
@option("--cross", type=float, default=0.03, show_default=True, metavar="SHARE", help="Cross motion of the table.")
@option("--seed", type=int, default=0, show_default=True, metavar="N", help="Of the cross motion.")
@option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="KEY=VALUE",
    help="Of the laboratory, one standard deviation: gain=0.2%, angle=0.2deg. May be repeated.",
)
@option("--noise", default="1", show_default=True, metavar="FACTOR", help="On the noise of the channels, or off.")
@option("--damping", "damping_ratio", type=float, metavar="RATIO", help="Of every mode, instead of the model's own.")
@option("--condition-limit", type=float, default=100.0, show_default=True, metavar="C", help="Above it a line is of no use.")
@option("--rigid", "rigid_percent", type=float, default=1.0, show_default=True, metavar="PERCENT", help="Elastic motion allowed.")
@option("--lost/--no-lost", default=True, show_default=True, help="Leave out every channel in turn.")
@option("--plot", is_flag=True, help="Draw it, under out/.")
@option("--out", type=click.Path(path_type=Path), metavar="DIR", help="A folder for the JSON and the pictures.")
@options.SET
def pretest_command(article: str, as_json: bool, plot: bool, out: Path | None, **given: Any) -> None:
    """Say what six sweeps of ARTICLE on the force measurement device would tell, before anything is mounted.

    ARTICLE is a stack of built-in parts, such as clumod-1 or fmd+clumod-1. Condition number of the planned base motions, expected
    95 % intervals of mass, CoG and inertia by both ways of identification, what dominates them, what the loss of each
    channel costs, and where on the article a pick-up moves with the base.
    """
    from validation.identify.pretest import question
    from validation.report.pretest import answer

    answer(question(article=article, **given), as_json=as_json, plot=plot, out=out)


@command("laboratory")
@argument("campaigns", nargs=-1, required=True, metavar="CAMPAIGN ...")
@option("--model", metavar="FILE", help="What is known of the laboratory: a model file.  [default: the drawings]")
@option(
    "--class",
    "tolerance_class",
    metavar="CLASS",
    help="What its tolerances are before it learns: calibrated or as-delivered.  [default: as-delivered, or what FILE says]",
)
@option("--out", type=click.Path(path_type=Path), metavar="FILE", help="Write the file that a model file names.")
@options.JSON
def laboratory_command(
    campaigns: tuple[str, ...], model: str | None, tolerance_class: str | None, out: Path | None, as_json: bool
) -> None:
    """What a laboratory learns of itself from campaigns of known bodies, repeated mountings best.

    Gains, delays, places and angles of pick-ups, the FMD and its cells are common to all campaigns; how an article stands is new
    with each. Every campaign is left out in turn, and what was learnt from the others is held against it. `learnt = "FILE"` in
    [laboratory] of a model file makes use of it; docs/laboratories.md shows the way.

    Exit code 0 when it is done; 1 when a fit does not converge; 2 when the input cannot be used.
    """
    from validation.report.laboratory import answer

    answer(campaigns, model, tolerance_class, out, as_json=as_json)
