"""A `Report` from results that are there. What it still lacks is found here: articles by themselves, sensors, identified inertia.

comparison = compared(model, data, ...)                      # validation.comparing
report = assembled(model, data, comparison, diagnosis=found, standing=at, provenance=...)
page.write(report, Path("out/report.html"))
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from validation.comparing.comparison import Comparison
from validation.comparing.gathered import Data
from validation.diagnosing.diagnosis import Diagnosis
from validation.identifying.classical import REDUCED
from validation.identifying.known import above_fmd
from validation.ladders.climbing import Standing
from validation.ladders.nouns import Body
from validation.measurement_file import read
from validation.models.model import Model
from validation.reduction import Reduction
from validation.report.articles import article_part
from validation.report.campaigns import campaign_part
from validation.report.nouns import ArticlePart, CampaignPart, Provenance, Report

Progress = Callable[[str, float], None]


@dataclass(frozen=True, kw_only=True)
class How:
    """With what everything was computed.

    Attributes
    ----------
    band : [Hz]; None for that of the campaigns
    method : how spectra are made
    """

    band: tuple[float, float] | None = None
    method: str = "full-record"


def assembled(
    model: Model,
    data: Data,
    comparison: Comparison,
    *,
    provenance: Provenance,
    how: How | None = None,
    identified: Sequence[Body] = (),
    not_identified: str = "",
    diagnosis: Diagnosis | None = None,
    not_diagnosed: str = "",
    standing: Standing | None = None,
    progress: Progress | None = None,
) -> Report:
    """The report of `comparison`, with everything that can be told of its articles and campaigns by themselves.

    What cannot be made is left out, with the reason in its part: a user's own FE model has no drawing, a campaign of fewer than
    six runs no identified inertia.

    Parameters
    ----------
    model, data : of `comparison`
    identified, not_identified : inertia with the effects of the model, or why there is none (see `validation.report.corrected`)
    diagnosis : of the same; None leaves the section with the reason `not_diagnosed`
    standing : of the model file

    Raises
    ------
    OSError : a file cannot be read any more.
    """
    how, tell = how or How(), progress or (lambda what, share: None)
    classical = reductions(data.classical)
    names = tuple(dict.fromkeys(name for one in data.campaigns if (name := above_fmd(one.article))))
    count = len(names) + len(data.campaigns)
    articles: list[ArticlePart] = []
    campaigns: list[CampaignPart] = []
    for name in names:
        tell(name, len(articles) / count)
        articles.append(article_part(name, model, comparison, classical))
    for one in data.campaigns:
        tell(Path(one.source).name, (len(articles) + len(campaigns)) / count)
        campaigns.append(campaign_part(one, data.campaigns, model, how.band, how.method))
    return Report(
        model=model,
        comparison=comparison,
        provenance=provenance,
        articles=tuple(articles),
        campaigns=tuple(campaigns),
        identified=tuple(identified),
        not_identified=not_identified,
        classical=classical,
        diagnosis=diagnosis,
        not_diagnosed=not_diagnosed,
        standing=standing,
    )


def reductions(names: Sequence[str]) -> tuple[Reduction, ...]:
    """The measurement files `names`, reduced as `massline weigh`, `cog` and `pendulum` do it.

    Raises
    ------
    BadInput : one of them cannot be used.
    """
    found = []
    for name in names:
        file = read(name, tuple(REDUCED))
        found.append(REDUCED[file.text("kind")](file))
    return tuple(found)
