"""Commands that predict: modes, dynamic mass, base excitation, virtual tests, the rope pendulum, and their verification."""

from functools import partial
from pathlib import Path
from typing import Any

import click
from click import argument, command, option

from geometry.errors import BadInput, CheckFailed
from validation.cli import options
from validation.verification.check import FAMILIES


@command("modes")
@argument("article")
@options.JSON
@options.flexible
@option("--against", metavar="MODEL", help="Set another model of the same article beside it: frequencies, MAC, masses.")
@option("--count", type=int, default=20, show_default=True, metavar="N", help="How many modes.")
@option("--shapes", is_flag=True, help="Also draw the first 11 modes on one sheet under out/.")
@option("--mode", "moving", type=int, metavar="N", help="Also write mode N moving: a GIF and an animated glTF under out/.")
def modes_command(
    article: str,
    as_json: bool,
    model: str | None,
    against: str | None,
    count: int,
    shapes: bool,
    moving: int | None,
    **asked: Any,
) -> None:
    """Eigenfrequencies of ARTICLE with its base held, damping, effective masses about its origin, and what moves in each mode.

    ARTICLE is a built-in part or a stack of them (clumod-4, fmd+clumod-1), a STEP file or article.toml of your own (solid
    model), or your own FE model (.h5, .npz, .op4 ... or its .toml), which may stand beside a built-in one too: --against FILE.
    """
    from validation.flexible.model import chosen, flexible, require_model, require_used
    from validation.output import shown, wrote
    from validation.report.flexible import print_modes, require_drawable

    models = chosen(article, model, against)
    names = [require_model(article, m, option) for m, option in zip(models, ("--model", "--against"), strict=False)]
    question = options.flexible_asked(count=count, counted="--count", **asked)
    require_used(article, names, question)
    if shapes or moving is not None:
        require_drawable(article, names[0], moving, count)
    found = []
    for name, which in zip(names, models, strict=True):
        with shown(f"modes of {article}, {name} model", quiet=as_json):
            found.append(flexible(article, which, question))
    print_modes(found[0], found[1] if len(found) == 2 else None, as_json=as_json)
    if shapes or moving is not None:
        from validation.report.flexible import draw_moving, draw_sheet

        folder = Path("out")
        with shown(f"shapes of {article}", quiet=as_json):
            written = [draw_sheet(found[0], folder)] if shapes else []
            written += draw_moving(found[0], moving, folder) if moving is not None else []
        wrote(*written)


# `massline dynamic-mass`: the blocked 6x6 dynamic mass of an article over frequency.


@command("dynamic-mass")
@argument("article")
@options.JSON
@options.flexible
@option("--against", metavar="MODEL", help="Set another model of the same article beside it.")
@option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@option("--step", type=float, default=0.05, show_default=True, metavar="HZ", help="Distance of two lines.")
@option("--modes", "count", type=int, default=30, show_default=True, metavar="N", help="How many modes to keep.")
@option("--about", default="article", show_default=True, metavar="POINT", help='F, article (its origin) or a point, "0 0 45 mm".')
@option("--plot", is_flag=True, help="Also draw diagonal and full 6x6 grid under out/.")
@option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Also write all entries, to .csv, .npz, .unv, .uff, .h5 or .mat.",
)
def dynamic_mass_command(
    article: str,
    as_json: bool,
    model: str | None,
    against: str | None,
    band: tuple[float, float],
    step: float,
    count: int,
    about: str,
    plot: bool,
    out: Path | None,
    **asked: Any,
) -> None:
    """The blocked dynamic mass of ARTICLE: loads of the table on it for unit base acceleration, all six axes prescribed.

    A rigid body has the flat line of its mass matrix; flexible ones leave it at their resonances.
    """
    from validation.flexible.dynamic_mass import DynamicMassOptions, curves
    from validation.flexible.model import chosen
    from validation.output import wrote
    from validation.report import flexible
    from validation.report.flexible import report

    if out is not None:
        flexible.require_ending(out)
    question = DynamicMassOptions(
        article=article,
        models=chosen(article, model, against),
        band=band,
        step=step,
        about=about,
        asked=options.flexible_asked(count=count, counted="--modes", **asked),
    )
    found = curves(question, quiet=as_json)
    for warning in found.warnings:
        click.echo(f"massline: {warning}.", err=True)
    report(found, as_json=as_json)
    if out is not None:
        flexible.write(out, found.masses[0], article)
        wrote(out)
    if plot:
        from validation.report.flexible import draw

        wrote(*draw(found, Path("out")))


@command("excite")
@argument("article")
@options.JSON
@options.flexible
@option("--axis", "axes", multiple=True, metavar="AXIS", help="x, y, z, alpha, beta or gamma. May be repeated.  [default: x]")
@option("--all", "every", is_flag=True, help="All six axes, a run each.")
@option("--pattern", default="sweep", show_default=True, metavar="PATTERN", help="sweep, random, burst or multi.")
@option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@option("--octaves-per-minute", type=float, default=2.0, show_default=True, metavar="RATE", help="Rate of a sweep.")
@option("--duration", metavar="TIME", help='Of random (90 s) and burst (4 s), for example "30 s".')
@option("--level", type=float, default=1.0, show_default=True, metavar="FACTOR", help="On the nominal level of each axis.")
@option("--cross", type=float, default=0.03, show_default=True, metavar="SHARE", help="Cross motion of the table.")
@option("--seed", type=int, default=0, show_default=True, metavar="N", help="Of cross motion, noise and bursts.")
@option("--ring-down", default="auto", show_default=True, metavar="TIME", help='Record after the drive: auto, or "5 s".')
@option("--route", metavar="ROUTE", help="linear, exudyn or large (a base that really turns).  [default: what the rig needs]")
@option("--rate", type=float, default=1024.0, show_default=True, metavar="HZ", help="Sampling rate of the result.")
@option("--modes", "count", type=int, metavar="N", help="How many modes to keep.  [default: 30, of those that the step follows]")
@option("--preload", multiple=True, metavar="FORCE", help='Of the cells, which then lift off: "2 kN", or "3=500 N" for one.')
@option("--flange", multiple=True, metavar="KEY=VALUE", help="Compliance: lateral, vertical, rotation, torsion=1e-6.")
@option("--friction", multiple=True, metavar="AXIS=N", help="A loose part on the flange: x=3 N, or x=3,mass:2.")
@option("--cable", multiple=True, metavar="LOC=K", help="Spring to the ground: mast-top=1000, mast-top:lateral=1000 N/m.")
@option("--damper", multiple=True, metavar="LOC=C", help="Damper to the table: mast-top=20 N s/m.")
@option("--out", type=click.Path(path_type=Path), metavar="FILE", help="Also write signals: .uff, .h5, .csv, .mat or .npz.")
@option("--plot", is_flag=True, help="Also draw loads over time and over frequency under out/.")
@option("--animate", is_flag=True, help="Also draw the article passing its largest resonance, a GIF under out/.")
def excite_command(
    article: str, as_json: bool, model: str | None, out: Path | None, plot: bool, animate: bool, **given: Any
) -> None:
    """Drive the base of ARTICLE in time, and record the loads of the table on it, its load cells and its resonances.

    ARTICLE is a built-in part or a stack of them (clumod-1, fmd+clumod-1), a STEP file of your own (--model solid) or your own FE
    model (.h5, .npz, .op4 ... or its .toml). Nominal levels are 2.5 m/s² along x, y, z, 3 rad/s² about x, y and 6 rad/s² about z.
    """
    from geometry.toml_file import one_of
    from validation.excite.question import ROUTES, ExciteOptions, attached, drive, require_rate
    from validation.report.excite import Wanted, excite

    if given["route"] is not None:
        one_of(given["route"], ROUTES, source="--route", where="")
    require_rate(given["rate"])
    count = given["count"]
    driven = ("axes", "every", "pattern", "band", "octaves_per_minute", "duration", "level", "cross", "seed", "ring_down")
    fastened = ("cells", "preload", "flange", "friction", "cable", "damper")
    made = ("damping_ratio", "size", "joints", "settings", "unit", "material")
    question = ExciteOptions(
        article=article,
        model=model,
        asked=options.flexible_asked(
            count=30 if count is None else count, counted="--modes", cells=False, **{name: given[name] for name in made}
        ),
        attached=attached(**{name: given[name] for name in fastened}),
        drive=drive(**{name: given[name] for name in driven}),
        route=given["route"],
        rate=given["rate"],
        every_mode=count is not None,
    )
    excite(question, Wanted(out=out, plot=plot, animate=animate, as_json=as_json))


@command("simulate")
@argument("articles", nargs=-1, required=True, metavar="ARTICLE ...")
@options.JSON
@option("--out", type=click.Path(path_type=Path), required=True, metavar="DIR", help="The new campaign folder.")
@option(
    "--effect", "effects", multiple=True, metavar="ID=VALUE", help="Plant an effect: force-gain:fmd-z2=0.08, polarity:fmd-z1."
)
@option(
    "--list-effects",
    is_flag=True,
    expose_value=False,
    callback=lambda ctx, _, asked: _list(ctx, asked),
    help="List the effects that can be planted, and stop.",
)
@options.effects_from
@option("--seed", type=int, default=0, show_default=True, metavar="N", help="Of all that is drawn; one seed is one laboratory.")
@option(
    "--levels", default="1", show_default=True, metavar="L,L", help="Factors on the nominal level: 1,0.5 drives all runs twice."
)
@option(
    "--sealed",
    type=click.Path(path_type=Path),
    metavar="PATH",
    help="Where the truth goes, instead of beside DIR; nothing of it is shown.",
)
@option(
    "--pattern",
    default="sweep",
    show_default=True,
    metavar="PATTERN",
    help="sweep, diagonal (and six of two axes at once) or multi (six at once).",
)
@option("--runs", type=int, metavar="N", help="12 sweeps instead of 6, the others a quarter period later.")
@option("--axis", default="", metavar="AXIS", help="x, y or z: a single-axis shaker, one pilot and --response are all it has.")
@option("--band", nargs=2, type=float, default=(4.0, 32.0), show_default=True, metavar="LO HI", help="Frequencies [Hz].")
@option("--octaves-per-minute", type=float, default=2.0, show_default=True, metavar="RATE", help="Rate of the sweeps.")
@option("--cross", type=float, default=0.03, show_default=True, metavar="SHARE", help="Cross motion of the table.")
@option(
    "--tolerances",
    default="1",
    show_default=True,
    metavar="FACTOR",
    help="On the ordinary tolerances of laboratory and structure, or off.",
)
@option("--noise", default="1", show_default=True, metavar="FACTOR", help="On the ordinary noise of the channels, or off.")
@option("--mains", default="1", show_default=True, metavar="FACTOR", help="On the ordinary hum of the mains, or off.")
@option("--model", default="beam", show_default=True, metavar="MODEL", help="beam, or rigid for an article that does not give.")
@option(
    "--damping", "damping_ratio", type=float, metavar="RATIO", help="Damping ratio of every mode, instead of the model's own."
)
@option("--rate", type=float, default=564.0, show_default=True, metavar="HZ", help="Sampling rate of the records.")
@option("--format", "form", default="h5", show_default=True, metavar="FORMAT", help="Of the signal files: h5, uff, csv or mat.")
@option(
    "--unit", "units", multiple=True, metavar="UNIT", help="Of the signal files where it is not SI: g, kN ... May be repeated."
)
@options.SET
@option(
    "--test",
    "kind",
    metavar="KIND",
    help="Of MODEL.toml: hammer, shaker, functions, modes, base or base-forces.  [default: hammer]",
)
@option("--drive", "drives", multiple=True, metavar="PLACE:AXIS", help="Of MODEL.toml, where the force acts. Repeatable.")
@option(
    "--response",
    "responses",
    multiple=True,
    metavar="PLACE:AXIS",
    help="What is read of MODEL.toml, or on ARTICLE beside the 22 channels. Repeatable.",
)
@option("--block", type=float, metavar="S", help="Of MODEL.toml, length of a block.  [default: until all has rung down]")
@click.pass_context
def simulate_command(ctx: click.Context, /, articles: tuple[str, ...], out: Path, as_json: bool, **given: Any) -> None:
    """Simulate ARTICLE on the multi-axis shaker, as six sweeps would have recorded it: 22 channels, tolerances, noise, hum.

    ARTICLE is a stack on the force measurement device, such as fmd+disc+cuboid or fmd+clumod-1. Several are a series that
    shares FMD and sensors, a folder each below DIR; so are tests of one seed. The truth goes beside a campaign, DIR.truth.json.

    `massline simulate MODEL.toml` strikes, shakes or tabulates the structure of a model file instead, or moves its base, with
    --test. Points and band are the first [[test]]'s where nothing is said. `compare` reads DIR/test.toml, and of a base DIR.
    """
    from validation.report.excite import simulate, simulate_structure
    from validation.virtual_test.simulate import question

    of_structure = {name: given.pop(name) for name in ("kind", "drives", "responses", "block")}
    stated = {
        name for name in (*given, *of_structure) if ctx.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE
    }
    if len(articles) == 1 and articles[0].lower().endswith(".toml"):
        both = ("effects", "seed", "sealed", "noise", "tolerances", "band", "axis", "cross")
        if other := sorted(stated - {*both, *of_structure}):
            problem = "is an option of a test of ARTICLE, and none of that of a structure"
            raise BadInput(f"--{other[0].replace('_', '-')}", "", problem, "Leave it out")
        common = {name: given[name] for name in both} | {name: None for name in ("band", "cross") if name not in stated}
        simulate_structure(articles[0], out, as_json=as_json, **common, **of_structure)
        return
    given["responses"] = of_structure.pop("responses")
    if other := sorted(stated & of_structure.keys()):
        problem = "is an option of the test of a structure, and ARTICLE stands on the multi-axis shaker"
        raise BadInput(f"--{other[0]}", "", problem, "Name a model file, or leave it out")
    simulate(question(articles=articles, out=out, **given), as_json=as_json)


def _list(ctx: click.Context, asked: bool) -> None:
    """Answer ``--list-effects`` before ARTICLE and --out are missed, and after ``--effects-from``."""
    if not asked:
        return
    from validation.report.effects import page_of_effects

    click.echo(page_of_effects(), nl=False)
    ctx.exit()


@command("swing")
@argument("article")
@options.JSON
@options.SET
@option("--unit", metavar="UNIT", help="Unit of length of your own mesh file, for example mm.")
@option("--material", metavar="NAME", help="Material of your own file, for every body that has none.")
@option("--animate", is_flag=True, help="Also write the swing as a GIF under out/, or where --out says.")
@option("--plot", is_flag=True, help="Also draw the pendulum and its signal under out/; --out does so anyway.")
@option("--out", type=click.Path(path_type=Path), metavar="FOLDER", help="Write record, measurement file and picture.")
@option("--step", metavar="TIME", help="Step of the integration.  [default: a thousandth of the period or finer]")
@option("--gravity", metavar="G", help='[default: "9.80665 m/s^2"]')
@option("--seed", type=int, default=0, show_default=True, metavar="N", help="Of the noise.")
@option("--noise", metavar="ANGLE", help='Standard deviation of the recorder\'s noise, for example "1 mrad".')
@option("--rate", type=float, default=50.0, show_default=True, metavar="HZ", help="Of the recorder.")
@option("--cycles", type=float, default=20.0, show_default=True, metavar="N", help="To record.")
@option("--start", type=click.Choice(["twist", "push"]), default="twist", show_default=True, help="Let go, or pushed.")
@option("--unequal", metavar="LENGTH", help="By which the first rope is longer than the others.")
@option("--off-centre", metavar="LENGTH[,LENGTH]", help="From where the CoG is thought to be to where it is, on x and y.")
@option("--rope-stiffness", metavar="FORCE", help='EA of each rope, for example "1e6 N"; ropes do not stretch without.')
@option("--links", type=int, metavar="N", help="Of which a rope with mass is made.  [default: 8]")
@option("--rope-mass", metavar="MASS", help="Of all ropes together.")
@option("--damping", metavar="RATIO", help='Viscous, of the twist: 0.01 or "1 %".')
@option("--amplitude", default="0.1 rad", show_default=True, metavar="ANGLE", help="Twist at the start.")
@option("--height", metavar="LENGTH", help="Of the ropes' feet above the CoG.  [default: 100 mm]")
@option("--along", metavar="AXIS", help="The article's axis that lies along two ropes.  [default: z, or x with z upright]")
@option("--axis", default="z", show_default=True, metavar="AXIS", help="The article's axis that is upright: x, y or z.")
@option("--length", default="2 m", show_default=True, metavar="LENGTH", help="Of the ropes, unloaded.")
@option("--s2", metavar="LENGTH", help="From the CoG to the second of two ropes.")
@option("--s1", metavar="LENGTH", help="From the CoG to the first of two ropes.")
@option("--radius", metavar="LENGTH", help="Of the circle of three ropes about the CoG.  [default: 300 mm]")
@option("--ropes", type=int, metavar="N", help="2 or 3.  [default: 3, or 2 with --s1 and --s2]")
def swing_command(
    article: str,
    as_json: bool,
    settings: tuple[str, ...],
    unit: str | None,
    material: str | None,
    animate: bool,
    plot: bool,
    out: Path | None,
    **words: Any,
) -> None:
    """ARTICLE on two or three ropes, let swing by exudyn, recorded, and reduced by Eq. 5 as a measured pendulum would be.

    Prints the period beside that of Eq. 5, what every effect alone does to it, and the inertia that comes out beside that of the
    article. With --out FOLDER the record goes through `massline pendulum FOLDER/pendulum.toml` like any other.
    """
    from validation.classical.swing import OPTIONS, Words, as_option, setup, simulated, write
    from validation.output import print_answer, require_folder, share_done, shown, wrote
    from validation.report import excite
    from validation.report.scenes.setups import draw_swing, in_the_way

    options.require_articles([article])
    asked = options.reading(None, unit, material, settings)
    texts = {name: words.pop(name) for name in OPTIONS}
    question = setup(article, Words(texts=texts, **words), asked)
    wanted = {"--plot": plot, "--animate": animate}
    folders = {"--out": out} if out is not None else {name: Path("out") for name, drawn in wanted.items() if drawn}
    for name, folder in folders.items():
        require_folder(folder, name)
    try:
        found = simulated(question, partial(share_done, quiet=as_json))
    except BadInput as error:
        raise as_option(error) from None
    record = found.record
    if out is not None:
        path = write(out, record.setup, record.swing, record.signal, record.decay)
        click.echo(f"massline: wrote {path} and its record. Reduce it with `massline pendulum {path}`.", err=True)
    print_answer(lambda: excite.as_json(found, out), lambda: excite.text(found), as_json=as_json)
    for folder in set(folders.values()):
        with shown("pictures of the swing", quiet=as_json):
            written = draw_swing(found, asked, folder, animate=animate)
            said = in_the_way(record.setup, asked)
        wrote(*written)
        if said:
            click.echo(f"massline: {said}", err=True)


@command("verify", epilog="Families: " + ", ".join(f"{name} ({words})" for name, words in FAMILIES.items()) + ".")
@argument("families", metavar="[FAMILY]...", nargs=-1, type=click.Choice(tuple(FAMILIES)))
@option("--fine", is_flag=True, help="Finer meshes, a few minutes.")
@option("--markdown", "as_markdown", is_flag=True, help="Print the table in Markdown instead.")
@options.JSON
def verify_command(families: tuple[str, ...], fine: bool, as_markdown: bool, as_json: bool) -> None:
    """Check elements, modes and dynamic mass against closed forms, published benchmarks and rates of convergence.

    Each row: the reference and where it comes from, the value found, the error and the bar that it has to stay within. Without
    FAMILY, all of them.

    Exit code 0 when every check passes, 1 when one does not.
    """
    from validation.output import print_json, print_pages, to_json
    from validation.report.flexible import markdown, pages, summary
    from validation.verification.check import Mesh, checks, run

    results = run(checks(*families), Mesh.FINE if fine else Mesh.FAST, quiet=as_json)
    passed = all(result.passed for result in results)
    if as_json:
        print_json({"rows": to_json(results), "pass": passed, "text": summary(results)})
    elif as_markdown:
        click.echo(markdown(results))
    else:
        print_pages(pages(results))
    if not passed:
        raise CheckFailed(summary(results))
    if not as_json and not as_markdown:
        click.echo(summary(results))
