"""What `massline diagnose` was asked, checked at the door."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from geometry.errors import BadInput
from geometry.keys import nearest
from identification.campaign import METHODS, Campaign
from validation.comparing import asked as comparing
from validation.comparing.gathered import Data
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE, MISTAKE, PENDULUM, PROCESSING
from validation.effects.identifiers import parse
from validation.ladders.candidate import completed
from validation.models.model import Model
from validation.models.pairing import require_target, vocabulary

OPTION = "--candidate"

FEWEST_RUNS = 2
"""Runs of all campaigns together: what one teaches another must confirm."""

OTHERWISE = {
    MISTAKE: "Leave it out: mistakes are looked for in every diagnosis, before any fit",
    PROCESSING: "Leave it out: `massline compare` and `massline add` try it",
    PENDULUM: "Leave it out: what a swing is missing is told where its file is among DATA",
}
"""By side of the catalogue, what to do about a candidate that no fit of spectra looks for."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The options as typed.

    Attributes
    ----------
    model : path of the model file
    data : campaign folders and measurement files
    hold_out : names of runs, campaigns and files
    band : [Hz]; None for that of the campaigns
    method : of `METHODS`
    candidates : ids and families that are looked for; all where none is named
    effects_from : folders of the user's own effects
    """

    model: Path
    data: tuple[str, ...]
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    method: str = METHODS[0]
    candidates: tuple[str, ...] = ()
    effects_from: tuple[str, ...] = ()

    @property
    def compared(self) -> comparing.Asked:
        """As `massline compare` is asked."""
        return comparing.Asked(model=str(self.model), data=self.data, hold_out=self.hold_out, band=self.band, method=self.method)


def ready(asked: Asked, progress: Callable[[str, float], None] | None = None) -> tuple[Model, Data]:
    """The model and the data, read, and the candidates found to be such that these data could have them.

    Raises
    ------
    BadInput : see `validation.comparing.asked.ready`; too few runs; a candidate that nobody knows or that acts on nothing here.
    OSError : a file cannot be read.
    """
    for text in asked.candidates:
        _require_family(text)
    model, data = comparing.ready(asked.compared, progress)
    require_runs(data.campaigns)
    for text in asked.candidates:
        _require_here(text, model, data.campaigns)
    return model, data


def require_runs(campaigns: Sequence[Campaign]) -> None:
    """Refuse a series of which nothing can be held out.

    Raises
    ------
    BadInput : fewer runs than `FEWEST_RUNS` in all.
    """
    count = sum(len(one.runs) for one in campaigns)
    if count < FEWEST_RUNS:
        names = ", ".join(f"{run.name} of {one.source}" for one in campaigns for run in one.runs)
        raise BadInput(
            source="DATA",
            field="runs",
            problem=f"too few: {count} in all ({names}), and what one run teaches another must confirm",
            remedy="Name a campaign with more runs, one for each of the six axes at best, or more campaigns of the series",
        )


def _require_family(text: str) -> None:
    """Refuse what is no effect of the catalogue, has a size, or is not looked for by fits."""
    name, equals, _ = text.partition("=")
    family = name.partition(":")[0].strip()
    if family not in FAMILIES:
        remedy = f"{nearest(family, FAMILIES)}`massline effects` lists all of them; your own come with --effects-from DIR"
        raise BadInput(source=OPTION, field=text, problem=f"no effect is called {family!r}", remedy=remedy)
    if equals:
        remedy = f"Write {name.strip()}; `massline add MODEL {text.strip()}` begins at a size"
        raise BadInput(source=OPTION, field=text, problem="it has a size, which is what is looked for", remedy=remedy)
    if (side := FAMILIES[family].side) in OTHERWISE:
        raise BadInput(source=OPTION, field=text, problem=f"is of the kind {side!r}", remedy=OTHERWISE[side])


def _require_here(text: str, model: Model, campaigns: Sequence[Campaign]) -> None:
    """Refuse a target that these `campaigns` do not have."""
    if ":" in text:
        named = parse(completed(text)[0], vocabulary(model, campaigns), source=OPTION)
        require_target(model, campaigns, named, OPTION)


def of_levels(asked: Asked) -> tuple[str, ...]:
    """The candidates that only two levels show."""
    return tuple(text for text in asked.candidates if FAMILIES[text.partition(":")[0].strip()].side == AMPLITUDE)
