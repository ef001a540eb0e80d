"""What `massline simulate` was asked, checked at the door: from options to plans, and to the folders that they go to."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan
from pathlib import Path

from fem.damping import Damping
from geometry import keys
from geometry.errors import BadInput
from geometry.sensors import SI
from geometry.tolerances import Tolerances
from identification.units import UNITS
from validation import changed
from validation.effects.identifiers import Named, parse_all
from validation.excitation.asked import LARGEST_LEVEL, drive, require_rate
from validation.virtual_test.effects.planting import planted
from validation.virtual_test.effects.reach import reaching, require_reaching
from validation.virtual_test.plan import DIAGONAL, MAINS, MODELS, MULTI, NOISE, SINGLE, TWICE, Plan, Scatter
from validation.virtual_test.set_up import require_stack

FORMATS = ("h5", "uff", "csv", "mat")

SWEEP = "sweep"
PATTERNS = {SWEEP: {6: SINGLE, 12: TWICE}, DIAGONAL: {12: DIAGONAL}, MULTI: {6: MULTI}}
"""Pattern of a plan by pattern and number of runs as they are asked for; the first number is the one that holds unasked."""

LARGEST_FACTOR = 100.0

OFF = "off"


@dataclass(frozen=True, eq=False, kw_only=True)
class Question:
    """What was asked.

    Attributes
    ----------
    plans : one a campaign
    effects : that are planted in all of them
    out : folder of the campaign, or the one above those of a series
    sealed : where the truth goes; None for beside
    ending : of the signal files
    units : of the signal files, by quantity
    """

    plans: tuple[Plan, ...]
    effects: tuple[Named, ...]
    out: Path
    sealed: Path | None
    ending: str
    units: dict[str, str]

    def folder(self, plan: Plan) -> Path:
        """Where the campaign of `plan` goes."""
        return self.out if len(self.plans) == 1 else self.out / plan.article

    def truth(self, plan: Plan) -> Path:
        """Where its truth goes."""
        folder = self.folder(plan)
        beside = folder.parent / f"{folder.name}.truth.json"
        if self.sealed is None:
            return beside
        return self.sealed if len(self.plans) == 1 else self.sealed / beside.name


def question(
    *,
    articles: Sequence[str],
    out: Path,
    effects: Sequence[str],
    seed: int,
    levels: str,
    sealed: Path | None,
    pattern: str,
    runs: int | None,
    band: tuple[float, float],
    octaves_per_minute: float,
    cross: float,
    tolerances: str,
    noise: str,
    mains: str,
    model: str,
    damping_ratio: float | None,
    rate: float,
    form: str,
    units: Sequence[str],
    settings: Sequence[str],
) -> Question:
    """The options of `massline simulate`, checked.

    Raises
    ------
    BadInput : one of them cannot be; what was found, and what to write.
    """
    _require_articles(articles)
    _word("--model", model, MODELS)
    _word("--format", form, FORMATS)
    named = parse_all(effects)
    planted(named)  # whatever the articles: what no virtual test can plant is refused first
    factors = _levels(levels)
    _require_drive(band, octaves_per_minute, cross, seed, factors)
    _require_rate(rate, band)
    changes = changed.read(settings)
    changed.require_used(articles, changes)
    share = _factor("--tolerances", tolerances)
    plans = tuple(
        Plan(
            article=article,
            seed=seed,
            model=model,
            tolerances=Tolerances().scaled(share),
            scatter=Scatter().scaled(share),
            damping=_damping(damping_ratio),
            pattern=_pattern(pattern, runs),
            levels=factors,
            band=band,
            octaves_per_minute=octaves_per_minute,
            cross=cross,
            noise_rms=_scaled(NOISE, _factor("--noise", noise)),
            mains=_scaled(MAINS, _factor("--mains", mains)),
            rate=rate,
            dimensions=changes,
        )
        for article in articles
    )
    require_reaching(named, plans)
    plans = tuple(replace(plan, effects=planted(reaching(named, plan))) for plan in plans)
    return Question(plans=plans, effects=named, out=out, sealed=sealed, ending=f".{form}", units=_units(units))


def _require_articles(articles: Sequence[str]) -> None:
    for article in articles:
        require_stack(article)
    twice = next((article for article in articles if list(articles).count(article) > 1), None)
    if twice is not None:
        raise BadInput(
            source=f"article {twice}", problem="it is named twice", remedy="Name each once, or change --seed and --out"
        )


def _word(option: str, word: str, known: Collection[str]) -> None:
    if word not in known:
        remedy = keys.nearest(word, known) or "Choose one of them"
        raise BadInput(source=option, problem=f"must be one of {', '.join(known)}, found {word!r}", remedy=remedy)


def _levels(text: str) -> tuple[float, ...]:
    found = tuple(_number("--levels", part.strip(), "Write for example 1, or 1,0.5") for part in text.split(","))
    for level in found:
        if not 0 < level <= LARGEST_LEVEL:
            problem = f"a level must lie above 0 and up to {LARGEST_LEVEL:g}, found {level:g}"
            raise BadInput(source="--levels", problem=problem, remedy="1 is the nominal level, 0.5 half of it")
    if len(set(found)) < len(found):
        raise BadInput(source="--levels", problem=f"one of them stands there twice, found {text}", remedy="Name each once")
    return found


def _require_drive(band: tuple[float, float], rate: float, cross: float, seed: int, levels: tuple[float, ...]) -> None:
    """What a drive of `massline excite` may be, this one may be too."""
    for level in levels:
        drive(
            axes=(),
            every=True,
            pattern=SWEEP,
            band=band,
            octaves_per_minute=rate,
            level=level,
            cross=cross,
            seed=seed,
            duration=None,
            ring_down="auto",
        )


def _require_rate(rate: float, band: tuple[float, float]) -> None:
    from fem.base_excitation.decimation import require_recorded

    require_rate(rate)
    try:
        require_recorded(band[1], rate, "--rate")
    except BadInput as error:
        raise BadInput(source="--rate", problem=error.problem, remedy="Record faster, or end lower with --band") from None


def _factor(option: str, text: str) -> float:
    if text.strip() == OFF:
        return 0.0
    remedy = f"1 is the ordinary one, {OFF} is none"
    found = _number(option, text, remedy)
    if not 0 <= found <= LARGEST_FACTOR:
        raise BadInput(source=option, problem=f"must lie between 0 and {LARGEST_FACTOR:g}, found {text}", remedy=remedy)
    return found


def _number(option: str, text: str, remedy: str) -> float:
    try:
        found = float(text)
    except ValueError:
        found = nan
    if not isfinite(found):
        raise BadInput(source=option, problem=f"a number is expected, found {text!r}", remedy=remedy)
    return found


def _scaled(ordinary: Mapping[str, float], factor: float) -> dict[str, float]:
    return {quantity: factor * size for quantity, size in ordinary.items()}


def _damping(ratio: float | None) -> Damping | None:
    return None if ratio is None else Damping(ratio=ratio)


def _pattern(pattern: str, runs: int | None) -> str:
    _word("--pattern", pattern, PATTERNS)
    known = PATTERNS[pattern]
    if runs is None:
        return next(iter(known.values()))
    if runs not in known:
        problem = f"the pattern {pattern} has {' or '.join(map(str, known))} runs, found {runs}"
        others = ", ".join(f"{name} ({' or '.join(map(str, counts))})" for name, counts in PATTERNS.items())
        raise BadInput(source="--runs", problem=problem, remedy=f"There are {others}; --levels adds runs too")
    return known[runs]


def _units(units: Sequence[str]) -> dict[str, str]:
    """The units of the files by quantity, SI where nothing is said."""
    found: dict[str, str] = {}
    quantities = {unit: quantity for quantity in ("acceleration", "force") for unit in UNITS[quantity]}
    for unit in units:
        if unit not in quantities:
            remedy = f"{keys.nearest(unit, quantities)}Known are {', '.join(quantities)}"
            raise BadInput(source="--unit", problem=f"no unit of acceleration or force is called {unit!r}", remedy=remedy)
        if quantities[unit] in found:
            problem = f"{found[quantities[unit]]} and {unit} are both units of {quantities[unit]}"
            raise BadInput(source="--unit", problem=problem, remedy="Keep one of them")
        found[quantities[unit]] = unit
    return {**{quantity: SI[quantity] for quantity in ("acceleration", "force")}, **found}
