"""What `massline pretest` was asked, checked at the door: from options to plans of the article's campaign and of the tare."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path

from geometry.articles import NAMES
from geometry.errors import BadInput
from geometry.observability import of_resultants
from geometry.sensors import Channel, ChannelTable
from geometry.tolerances import Tolerances
from identification import campaign_file
from identification.base_motion import groups_used
from validation.identifying.asked import tolerances_of
from validation.virtual_test import asked as simulated
from validation.virtual_test.plan import BEAM, NOISE, Plan

FMD = "fmd"

NO_TARE = "none"

TARE = "fmd+disc+cuboid"
"""The paper's."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Question:
    """What was asked.

    Attributes
    ----------
    plan : of the article's campaign
    tare : of the tare's; None where there is none
    table : the user's own sensors; None for those of the virtual shaker
    tolerances : of the laboratory
    condition_limit : scaled condition number above which a line is left out
    rigid : elastic share up to which a place counts as rigid
    lost : whether every channel is left out in turn
    """

    plan: Plan
    tare: Plan | None
    table: ChannelTable | None
    tolerances: Tolerances
    condition_limit: float
    rigid: float
    lost: bool

    @property
    def above(self) -> str:
        """What stands on the FMD."""
        return self.plan.on_fmd


def question(
    *,
    article: str,
    tare: str,
    sensors: Path | None,
    pattern: str,
    runs: int | None,
    level: float,
    band: tuple[float, float],
    octaves_per_minute: float,
    cross: float,
    seed: int,
    tolerances: Sequence[str],
    noise: str,
    damping_ratio: float | None,
    condition_limit: float,
    rigid_percent: float,
    lost: bool,
    settings: Sequence[str],
) -> Question:
    """The options, checked.

    Raises
    ------
    BadInput : one of them cannot be; what was found, and what to write.
    """
    known = tolerances_of(tolerances)
    _require(condition_limit, "--condition-limit", "a condition number is above 1", above=1.0)
    _require(rigid_percent, "--rigid", "a share above 0 % is expected", above=0.0)
    stacks = [_on_fmd(article), *([] if tare == NO_TARE else [_on_fmd(tare)])]
    _require_two(article, stacks)
    plans = simulated.question(
        articles=stacks,
        out=Path("out"),
        effects=(),
        seed=seed,
        levels=f"{level:g}",
        sealed=None,
        pattern=pattern,
        runs=runs,
        band=band,
        octaves_per_minute=octaves_per_minute,
        cross=cross,
        tolerances=simulated.OFF,
        noise=noise,
        mains=simulated.OFF,
        model=BEAM,
        damping_ratio=damping_ratio,
        rate=564.0,
        form="h5",
        units=(),
        settings=settings,
    ).plans
    return Question(
        plan=plans[0],
        tare=plans[1] if len(plans) > 1 else None,
        table=None if sensors is None else _sensors(sensors, plans[0].noise_rms),
        tolerances=known,
        condition_limit=condition_limit,
        rigid=rigid_percent / 100,
        lost=lost,
    )


def _on_fmd(article: str) -> str:
    """The stack with the FMD below it: what is tested here always stands on one."""
    return article if article.split("+")[0] not in NAMES or article.split("+")[0] == FMD else f"{FMD}+{article}"


def _require_two(article: str, stacks: Sequence[str]) -> None:
    if len(set(stacks)) < len(stacks):
        problem = f"the tare is the article itself, {article}"
        raise BadInput(source="--tare", problem=problem, remedy=f"Name another known article, or --tare {NO_TARE}")


def _sensors(folder: Path, floors: Mapping[str, float]) -> ChannelTable:
    """The channel table of a campaign, which must tell six motions and six resultants; ordinary noise where it states none."""
    table = campaign_file.read_description(folder).table
    groups_used(table)
    verdict = of_resultants(table)
    if not verdict.complete:
        problem = f"the load cells of {folder} do not tell the six resultants: {verdict.text}"
        raise BadInput(source="--sensors", problem=problem, remedy=f"Add a cell that sees {', '.join(verdict.missing)}")
    return ChannelTable(channels=tuple(_noisy(one, floors) for one in table.channels), origin=table.origin)


def _noisy(channel: Channel, floors: Mapping[str, float]) -> Channel:
    """`channel` with its floor times the factor that was asked for."""
    ordinary, asked = NOISE.get(channel.quantity, 0.0), floors.get(channel.quantity, 0.0)
    factor = asked / ordinary if ordinary else 1.0
    return replace(channel, noise_rms=factor * (ordinary if channel.noise_rms is None else channel.noise_rms))


def _require(value: float, option: str, words: str, *, above: float) -> None:
    if not (isfinite(value) and value > above):
        raise BadInput(source=option, problem=f"{words}, found {value:g}", remedy="Leave it out for the ordinary one")
