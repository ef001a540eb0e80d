"""`Report`: everything that a page says, found by the rooms; the page adds nothing to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from identification.campaign import Campaign
from validation.comparing.comparison import Comparison
from validation.diagnosing.diagnosis import Diagnosis
from validation.identifying.findings import Findings
from validation.ladders.climbing import Standing
from validation.ladders.nouns import Body, Source
from validation.models.model import Model
from validation.reduction import Reduction
from validation.reference_table import ReferenceTable
from validation.statement import Statement


@dataclass(frozen=True, eq=False, kw_only=True)
class Picture:
    """A picture as it lies in a file.

    Attributes
    ----------
    png : its bytes
    said : what it shows, for who cannot see it, and below it
    """

    png: bytes
    said: str


@dataclass(frozen=True, eq=False, kw_only=True)
class ArticlePart:
    """What is known of an article by itself.

    Attributes
    ----------
    name : what stands on the FMD
    table : by three routes, in print, weighed and swung; None where `missing` says why
    picture : rendered, with CoG and principal axes
    shapes : its mode shapes
    missing : sentences: what cannot be shown, and why
    """

    name: str
    table: ReferenceTable | None = None
    picture: Picture | None = None
    shapes: Picture | None = None
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class CampaignPart:
    """What is known of a campaign by itself.

    Attributes
    ----------
    campaign : as it was read
    sensors : map of its sensors
    findings : identified inertia, plain and self-calibrated; None where `missing` says why
    reference : of the article that was identified; None where none is known
    command : which command line gives the same findings
    missing : sentences: what cannot be shown, and why
    """

    campaign: Campaign
    sensors: Picture | None = None
    findings: Findings | None = None
    reference: Statement | None = None
    command: str = ""
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Provenance:
    """Where the page comes from.

    Attributes
    ----------
    when : local date and time, ISO 8601
    by : who made it; empty where nobody said
    command : the command line
    versions : of the programs
    inputs : model, campaigns and files with their SHA-256
    settings : method, band, what was held out
    model_text : of the model file
    """

    when: str
    by: str = ""
    command: str = ""
    versions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    inputs: tuple[Source, ...] = ()
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    model_text: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Report:
    """A model and data, and all that was found.

    Attributes
    ----------
    model : as it was read
    comparison : four errors, maps and worst spots
    provenance : where it comes from
    articles, campaigns : each by itself
    identified : inertia of the model's article from all data, with the effects of the model
    not_identified : why there is none, where the model has effects
    classical : weighings, CoG and pendulum tests, reduced
    diagnosis : what is missing; None where nobody asked, and `not_diagnosed` says why
    standing : the model's ladder; without rungs where there is none
    """

    model: Model
    comparison: Comparison
    provenance: Provenance
    articles: tuple[ArticlePart, ...] = ()
    campaigns: tuple[CampaignPart, ...] = ()
    identified: tuple[Body, ...] = ()
    not_identified: str = ""
    classical: tuple[Reduction, ...] = ()
    diagnosis: Diagnosis | None = None
    not_diagnosed: str = ""
    standing: Standing | None = None
