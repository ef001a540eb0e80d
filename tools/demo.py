"""``make demo``: everything massline shows, in order, each step the very command that a user would type.

A step is a title and a command line, of ``massline`` or of a script in ``examples/``. Whatever is new appends its own to `STEPS`;
nothing here computes anything.
"""

import os
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import click

from validation.cli.main import DONE, FAILED_CHECK, run

DATA = Path(os.environ.get("MASSLINE_DATA", Path("..") / "shared" / "data"))
"""Real measured data of others; a step that needs it is passed over, in words, where it is absent."""


@dataclass(frozen=True, kw_only=True)
class DemoStep:
    """One thing to see.

    Attributes
    ----------
    title : what it shows
    command : the line to type, ``massline ...`` or ``python examples/...``
    ends : exit code that belongs to it: 1 where the point is a check that fails
    needs : folder of data without which it is passed over; None when it needs none
    """

    title: str
    command: str
    ends: int = DONE
    needs: Path | None = None


GAP = '--cells --preload "1 kN" --band 10 20 --octaves-per-minute 30 --ring-down "2 s"'
"""A quick sweep past the mast's resonance on preloaded cells."""

EXAMPLE = shlex.quote(str(DATA / "example_series"))

HIDDEN, MODEL = "out/hidden", "out/hidden/model.toml"
"""A series with an effect that its model lacks, and the model."""

BOTH = f"{HIDDEN}/fmd+disc+cuboid {HIDDEN}/fmd+clumod-1"
"""Its campaigns."""

REPORT = f"{HIDDEN}/report.html"
"""What is known of both at the end."""

SERIES, IDENTIFIED = "out/series", "out/identified"
"""Of the virtual test."""

STEPS = (
    DemoStep(
        title="The four articles, Clumod in both configurations: three routes beside published and measured values, and pictures",
        command="massline reference cuboid disc fmd clumod-1 clumod-4 --view",
    ),
    DemoStep(title="The set-up of the tare, stacked", command="massline reference fmd+disc+cuboid"),
    DemoStep(
        title="The paper's Table 2: an identification against the reference",
        command=("massline validate clumod-1-table2 --against clumod-1"),
        ends=FAILED_CHECK,
    ),
    DemoStep(title="A weighing", command="massline weigh clumod-4-weighing --against clumod-4"),
    DemoStep(title="The height of the CoG by crane and balance", command="massline cog clumod-4-cog --against clumod-4"),
    DemoStep(title="Periods on ropes, Eq. 5", command="massline pendulum clumod-4-pendulum --against clumod-4"),
    DemoStep(title="A recorded swing", command="massline pendulum examples/clumod-4-upright.toml --against clumod-4"),
    DemoStep(
        title="A pendulum swung by exudyn: what every imperfection costs, and what the corrections give back; with an animation",
        command='massline swing clumod-4 --amplitude "20 deg" --damping "0.5 %" --rope-mass "0.3 kg" --off-centre "5 mm" '
        '--height "990 mm" --noise "3 mrad" --cycles 10 --animate --out out/swing',
    ),
    DemoStep(title="... its record, reduced like a measured one", command="massline pendulum out/swing/pendulum.toml"),
    DemoStep(
        title="Real data: four bicycles on torsion and compound pendulums come out as published",
        command=f"python examples/bicycles.py --data {shlex.quote(str(DATA))}",
        needs=DATA / "bicycle_pendulum",
    ),
    DemoStep(title="Eigenfrequencies of Clumod, beside those in print", command="massline modes clumod-4"),
    DemoStep(title="What a base-excitation test of it should see, with plots", command="massline dynamic-mass clumod-1 --plot"),
    DemoStep(
        title="Base excitation in time: four times as fast as the paper, past the resonance of the mast; plot and animation",
        command="massline excite clumod-1 --axis beta --octaves-per-minute 8 --plot --animate",
    ),
    DemoStep(
        title="Load cells that lift off their preload, integrated by exudyn: at the nominal level ...",
        command=f"massline excite fmd+clumod-1 --axis beta {GAP} --out out/gap-nominal.h5",
    ),
    DemoStep(
        title="... and at a third of it, where they stay closed and nothing is driven along z",
        command=f"massline excite fmd+clumod-1 --axis beta {GAP} --level 0.3333 --out out/gap-third.h5",
    ),
    DemoStep(title="How far these predictions can be trusted: closed forms, benchmarks, rates", command="massline verify"),
    DemoStep(title="Your own article: a STEP assembly and two meshes", command="python examples/own_article.py out/own-article"),
    DemoStep(title="... with a material for each body", command="massline reference out/own-article --view"),
    DemoStep(
        title="Before a test: what it would tell, where pick-ups belong", command="massline pretest clumod-1 --no-lost --plot"
    ),
    DemoStep(title="The bias of peak-reference-hold at a lightly damped mode", command="python examples/peak_hold_bias.py"),
    DemoStep(title="A recorded campaign, in four formats", command="python examples/own_campaign.py out/own-campaign"),
    DemoStep(title="... what it holds, with a map of its sensors", command="massline check out/own-campaign/uff --view"),
    DemoStep(
        title="A virtual test, eight times as fast as the paper's: Clumod with one blade, and disc and Cuboid for a tare",
        command=f"massline simulate fmd+disc+cuboid fmd+clumod-1 --seed 3 --octaves-per-minute 16 --out {SERIES}",
    ),
    DemoStep(
        title="... its inertia, plain and self-calibrated, with verdicts; condition, dynamic mass, stability over the band",
        command=f"massline identify {SERIES}/fmd+clumod-1 --tare {SERIES}/fmd+disc+cuboid --out {IDENTIFIED}",
    ),
    DemoStep(title="... beside the drawing", command=f"massline validate {IDENTIFIED}/identify.json --against clumod-1"),
    DemoStep(
        title="... and beside CAD, exudyn, a pendulum and what is in print, Table 2 among it, in one row each",
        command=f"python examples/closure_table.py {IDENTIFIED}/identify.json",
    ),
    DemoStep(
        title="A campaign that another program wrote",
        command=f"massline check {shlex.quote(str(DATA / 'example_series' / 'fmd+clumod-1'))}",
        needs=DATA / "example_series",
    ),
    DemoStep(
        title="... identified, with what its maker knew of the load cells",
        command=f"massline identify {EXAMPLE}/fmd+clumod-1 --tare {EXAMPLE}/fmd+disc+cuboid "
        "--cell-stiffness 1e8 1e8 4e8 --no-study",
        needs=DATA / "example_series",
    ),
    DemoStep(
        title="A series with a hidden effect ...",
        command="massline simulate fmd+disc+cuboid fmd+clumod-1 --seed 3 --octaves-per-minute 16 "
        f"--effect force-gain:fmd-z2=0.15 --out {HIDDEN}",
    ),
    DemoStep(
        title="... the model of a laboratory that does not know", command=f"massline model fmd+clumod-1 --out {MODEL} --force"
    ),
    DemoStep(
        title="... where it fails: errors, worst spots in words, maps",
        command=f"massline compare {MODEL} {BOTH} --out {HIDDEN}/compared",
    ),
    DemoStep(
        title="... what it is missing: ranked causes, how surely, what they are mistaken for, what would confirm them",
        command=f"massline diagnose {MODEL} {BOTH} --out {HIDDEN}/diagnosed",
    ),
    DemoStep(
        title="... the effect added: the error falls, on held-out sweeps too, the identified CoG returns into its interval",
        command=f"massline add {MODEL} force-gain:fmd-z2 {BOTH}",
    ),
    DemoStep(title="... and the ladder, with pictures of the fall", command=f"massline ladder {MODEL} --out {HIDDEN}/ladder"),
    DemoStep(
        title="Real data with a real missing effect: a three-storey frame",
        command=f"massline league three_storey_frame --data {shlex.quote(str(DATA))}",
        needs=DATA / "three_storey_frame",
    ),
    DemoStep(title="An effect of one's own, from its file to a campaign", command="python examples/own_effect.py"),
    DemoStep(
        title="All of the hidden effect on one page, to be read, printed and signed",
        command=f"massline report {MODEL} {BOTH} --no-diagnosis --out {REPORT}",
    ),
)

WHERE = """Pictures:  {pictures}
Tables:    every table above is one command; `massline COMMAND --help` says more, and --json gives a program the same figures.
Report:    {report} opens in any browser.
Workbench: {massline} app {model} {data}
           opens the same in the browser, to click on, to add and to undo; `{massline} app` alone begins with examples."""


def main() -> int:
    """Run every step and stop at the first that ends otherwise than it should; its exit code is the demo's."""
    for number, step in enumerate(STEPS, start=1):
        click.secho(f"\n{number}/{len(STEPS)}  {step.title}", bold=True)
        click.echo(f"$ {step.command}\n")
        if step.needs is not None and not step.needs.is_dir():
            click.echo(f"Passed over: {step.needs} is absent. MASSLINE_DATA may name the folder of data.")
            continue
        program, *arguments = shlex.split(step.command)
        sys.stdout.flush()
        code = run(arguments) if program == "massline" else subprocess.run([sys.executable, *arguments], check=False).returncode
        if code != step.ends:
            click.echo(f"The demo stops here: `{step.command}` ended with exit code {code}.", err=True)
            return code or FAILED_CHECK
    click.echo(
        "\n"
        + WHERE.format(
            pictures=", ".join(sorted(str(path) for kind in ("png", "gif") for path in Path("out").glob(f"**/*.{kind}")))
            or "none",
            report=Path(REPORT).absolute().as_uri(),
            massline=os.path.relpath(Path(sys.executable).with_name("massline")),
            model=MODEL,
            data=BOTH,
        )
    )
    return DONE


if __name__ == "__main__":
    sys.exit(main())
