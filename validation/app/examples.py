"""The built-in examples: virtual tests with an effect that their model does not know, simulated at first use and kept.

They lie in the user's cache (`fem.solid.model.folder`), made by the very functions behind `massline simulate` and `massline
model`; the same every time. Nothing is shipped, and the folder may be deleted at any time. Whatever one of them is made of is in
the name of its folder, so that another version of massline makes its own.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from fem.solid import model
from geometry.atomic import write_text
from geometry.errors import BadInput
from geometry.toml_file import nearest
from identification import campaign_file
from validation.model import model_file
from validation.model.model_file import draft
from validation.output import json_text
from validation.virtual_test import simulate as virtual_test_simulate
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import SimulateOptions, question

Progress = Callable[[str, float], None]

MODEL = "model.toml"


@dataclass(frozen=True, kw_only=True)
class Example:
    """A story to begin with.

    Attributes
    ----------
    name : by which it is picked
    title : in a few words
    words : what there is to see, a sentence or two; the effect that is hidden is not said
    articles : stacks that stand on the shaker, one a campaign; the last one is what the model is of
    effects : that are hidden, as on a command line
    octaves_per_minute, seed, driven : of the sweeps; the last one [Hz]
    tolerances, noise : factors on those of an ordinary laboratory
    rate : of the records [Hz]
    band : [Hz] that is compared; None for all that is driven
    hold_out : runs that no fit sees
    """

    name: str
    title: str
    words: str
    articles: tuple[str, ...]
    effects: tuple[str, ...]
    octaves_per_minute: float
    seed: int = 3
    driven: tuple[float, float] = (4.0, 32.0)
    tolerances: str = "1"
    noise: str = "1"
    rate: float = 564.0
    band: tuple[float, float] | None = None
    hold_out: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Series:
    """A model and data that belong together: what `validation.app.session.begun` takes.

    Attributes
    ----------
    model : path of the model file
    data : campaign folders and measurement files
    hold_out : runs that are predicted, never fitted
    band : [Hz] that is compared; None for all that is driven
    title : in a few words
    """

    model: str
    data: tuple[str, ...]
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    title: str = ""


EXAMPLES = (
    Example(
        name="block",
        title="A block with a hidden effect",
        words="Disc and Cuboid on the force measurement device, quick sweeps, compared from 8 to 16 Hz. Something is wrong with "
        "the measurement, and no model of the block will ever explain it. The z-sweep is held out of every fit.",
        articles=("fmd+disc+cuboid",),
        effects=("force-gain:fmd-z2=0.08",),
        octaves_per_minute=60.0,
        seed=0,
        band=(8.0, 16.0),
        hold_out=("z",),
    ),
    Example(
        name="mast",
        title="A mast with one blade and a hidden effect",
        words="Clumod with one blade, and disc and Cuboid for a tare: two campaigns that share their sensors. Resonances and the "
        "mass line both look wrong; tolerances alone can nearly explain it, at an absurd price.",
        articles=("fmd+disc+cuboid", "fmd+clumod-1"),
        effects=("force-gain:fmd-z2=0.15",),
        octaves_per_minute=16.0,
    ),
)


def examples() -> tuple[Example, ...]:
    """All of them, the quickest first."""
    return EXAMPLES


def series(name: str, progress: Progress | None = None) -> Series:
    """The files of the example `name`, made now where they are not there yet; that takes from seconds to a minute.

    Raises
    ------
    BadInput : no example is called so, with the nearest; there is no folder for a cache.
    OSError : the cache cannot be written.
    """
    of = next((one for one in EXAMPLES if one.name == name), None)
    if of is None:
        known = [one.name for one in EXAMPLES]
        remedy = f"{nearest(name, known)}Known are {', '.join(known)}"
        raise BadInput(source="example", field=name, problem="no example is called so", remedy=remedy)
    there = model.folder()
    if there is None:
        folder_remedy = "Name a folder in the environment variable MASSLINE_CACHE"
        raise BadInput(
            source="example", field=of.name, problem="there is no folder in which it could be kept", remedy=folder_remedy
        )
    made_of = json_text({"version": version("massline"), **asdict(of)})
    folder = there / "examples" / f"{of.name}-{sha256(made_of.encode()).hexdigest()[:12]}"
    if not folder.exists():
        # All of it in a folder of its own, then in place; of two that make it at once the first one stays
        make_progress = progress or (lambda what, share: None)
        folder.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{of.name}-", dir=folder.parent))
        try:
            # As `massline simulate` would be asked
            asked = question(
                articles=of.articles,
                out=temporary,
                effects=of.effects,
                seed=of.seed,
                levels="1",
                sealed=None,
                pattern="sweep",
                runs=None,
                band=of.driven,
                octaves_per_minute=of.octaves_per_minute,
                cross=0.03,
                tolerances=of.tolerances,
                noise=of.noise,
                mains="1",
                model="beam",
                damping_ratio=None,
                rate=of.rate,
                form="h5",
                units=(),
                settings=(),
            )
            for k, plan in enumerate(asked.plans):
                _simulate(plan, asked, temporary, k, make_progress)
            write_text(temporary / MODEL, model_file.text(draft(of.articles[-1], temporary / MODEL)))
            temporary.chmod(0o755)
            temporary.rename(folder)
        except OSError:
            if not folder.exists():
                raise
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    campaigns = tuple(str(folder / one) for one in of.articles)
    return Series(model=str(folder / MODEL), data=campaigns, hold_out=of.hold_out, band=of.band, title=of.title)


def _simulate(plan: Plan, asked: SimulateOptions, folder: Path, k: int, progress: Progress) -> None:
    from validation.virtual_test.simulate import simulate

    test = simulate(plan, lambda share: progress("simulating the example", (k + share) / len(asked.plans)))
    truth = folder / "truth" / f"{plan.article}.json"
    virtual_test_simulate.write(folder / plan.article, truth, test.truth, partial(campaign_file.write, campaign=test.campaign))
