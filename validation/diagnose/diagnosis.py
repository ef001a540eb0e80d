"""`Diagnosis`: the answer to "what is my model missing", with everything that it rests on."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from types import MappingProxyType
from typing import Any

import numpy as np

from identification.quality import NORMAL_90
from validation.correct import CORRECTIONS
from validation.effects import practical_units
from validation.effects.catalogue import FAMILIES, Named, parse
from validation.effects.effect import MISTAKE as OF_MISTAKES
from validation.effects.effect import Vocabulary, position
from validation.estimation.problem import DECLARED, SENSOR, Evaluation, Fit, Parameter, Problem
from validation.estimation.screening import ScoreTest, Smallest
from validation.estimation.verdicts import expected_z2, largest_z, misfit
from validation.model.model import Added
from validation.output import derived, entry, unwritten, with_unit

NOTHING, MISSING, AMBIGUOUS, SEVERAL, UNKNOWN, NONLINEAR, MISTAKE = VERDICTS = (
    "nothing",
    "missing",
    "ambiguous",
    "several",
    "unknown",
    "nonlinear",
    "mistake",
)

MANY_NATS = 1000.0
"""[nats] beyond which a forecast of evidence says only that it is decided. Held by diagnosing/test_page.py."""


ANY = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)
"""In which every written effect is known: what was found was checked when it was found."""


@dataclass(frozen=True, eq=False, kw_only=True)
class EffectEstimate:
    """One number of a cause.

    Attributes
    ----------
    key : as in ``key:number``; empty for the one that stands alone
    value : SI
    unit : of it
    low, high : 90 % interval; both the value of one that was not fitted
    """

    key: str
    value: float
    unit: str
    low: float = entry("interval90/0")
    high: float = entry("interval90/1")


@dataclass(frozen=True, eq=False, kw_only=True)
class Cause:
    """An effect that would explain the data, as a fit of all parameters left it.

    Attributes
    ----------
    named : what it is and where, at the size that was found
    sizes : with their intervals, the first one first; none of a mistake that has no size
    evidence : [nats] against the model without it
    misfit : chi² per degree of freedom with it
    price : sum of z² of the tolerances with it, over what is due where nothing is wrong
    null : whether misfit and price are then those of a model that misses nothing
    note : what these data say of it beyond its size, in words: "its numbers are in g, and were taken for m/s^2"
    same : ids of other effects, places or mistakes that explain these data to the last digit alike
    """

    evidence: float = entry("evidence_nats", unit="nats", null=inf)
    named: Named = entry("written", write=str, read=lambda written: parse(written, ANY))
    sizes: tuple[EffectEstimate, ...] = entry("values")
    misfit: float = entry("chi2_per_dof", null=inf, default=0.0)
    price: float = entry(null=inf, default=0.0)
    null: bool = entry("as_where_nothing_is_missing", default=True)
    note: str = entry(null="", default="")
    same: tuple[str, ...] = entry(rare=True, default=())

    @property
    @derived("id", before="evidence_nats")
    def id(self) -> str:
        """``family:target``."""
        return self.named.id

    @property
    @derived("", before="evidence_nats")
    def first(self) -> dict[str, Any]:
        """Its first size by the keys of an effect in JSON; None where it has none."""
        one = self.sizes[0] if self.sizes else None
        return {
            "value": None if one is None else one.value,
            "unit": None if one is None else one.unit,
            "interval90": None if one is None else [one.low, one.high],
        }

    @property
    @derived("what", before="values")
    def what(self) -> str:
        """Its family in a few words."""
        return self.named.what

    @property
    @derived("text", before="written")
    def text(self) -> str:
        """What it means, for somebody who never heard of it."""
        family, targets = FAMILIES[self.named.family], self.named.targets
        return family.sentence.format(target=self.named.target, targets=" and ".join(targets))

    @property
    @derived("mistaken_for")
    def mistaken_for(self) -> tuple[str, ...]:
        """Ids or families that look like it."""
        return FAMILIES[self.named.family].mistaken_for

    @property
    @derived("confirmed_by")
    def confirmed_by(self) -> str:
        """What would confirm it in the laboratory."""
        return FAMILIES[self.named.family].confirmed_by


@dataclass(frozen=True, kw_only=True)
class Detectable:
    """The smallest size at which these data would name an effect.

    Attributes
    ----------
    id : of the effect
    size : of its first number, SI, positive, from where there is no effect: 0.5 of a factor of 1.5
    unit : of it
    at : what it belongs to, such as "four of five frequencies" of a resonator; empty where it is one size
    """

    id: str
    size: float = entry(null=inf)
    unit: str
    at: str = entry(null="", default="")


@dataclass(frozen=True, eq=False, kw_only=True)
class Advice:
    """A measurement that would tell explanations apart.

    Attributes
    ----------
    test : what to do, in words: "run the Cuboid turned by 90 degrees about z"
    gain : expected evidence for the right explanation against the others [nats]; 0 where it tells nothing
    separates : ids that it tells apart
    hours : of work that it takes, roughly; assumed, to compare tests by
    """

    test: str
    gain: float = entry("expected_evidence_nats", unit="nats", null=inf)
    separates: tuple[str, ...] = ()
    hours: float = entry(unit="h", null=0.0, default=0.0)

    @property
    def text(self) -> str:
        """All of it in words."""
        if not self.separates:
            return self.test
        first, *others = self.separates
        expected = f"{self.gain:.0f} nats" if self.gain < MANY_NATS else f"more than {MANY_NATS:g} nats"
        return f"{self.test} (about {self.hours:g} h): expected {expected} between {first} and {', '.join(others)}"


@dataclass(frozen=True, eq=False, kw_only=True)
class FoundNode:
    """The node of a structure's mesh at which something of one kind would explain most, beside the model as it is.

    Attributes
    ----------
    named : what would sit there, with its size
    article : the structure
    evidence : [nats] for it somewhere on the mesh, with what looking everywhere costs taken off
    position : (x, y, z) [m] in the article's frame
    nearest : the named place nearest to it; empty where none has coordinates
    distance : [m] to that
    named_place, named_evidence : the place with a name that would explain most, and how much [nats]; empty where there is none
    looked : [nats] that looking everywhere costs
    straight : what would explain most to first order, tolerances moving with it, which is right near a minimum; None where that
        was not asked
    fit : of all tolerances beside it; None of one that was not fitted
    """

    evidence: float = entry("evidence_nats", unit="nats", null=inf)
    named: Named = entry("written", write=str, read=lambda written: parse(written, ANY))
    article: str
    position: tuple[float, float, float] = entry("position_m", unit="m")
    nearest: str = entry("nearest_place", null="", default="")
    distance: float | None = entry("distance_m", unit="m", default=None)
    named_place: str = entry(null="", default="")
    named_evidence: float = entry("named_evidence_nats", unit="nats", null=inf, default=0.0)
    looked: float = unwritten(default=0.0)
    straight: Named | None = unwritten(default=None)
    fit: Fit | None = unwritten(default=None)

    @property
    def kind(self) -> str:
        """Its family, with the direction of a spring."""
        return ":".join((self.named.family, *self.named.targets[1:]))

    @property
    @derived("id", before="evidence_nats")
    def id(self) -> str:
        """``family:target``."""
        return self.named.id


@dataclass(frozen=True, eq=False, kw_only=True)
class Leftover:
    """What no effect explains, described.

    Attributes
    ----------
    text : where it is and what it looks like, in words
    looks_like : "stiffness", "mass", "damping", "resonance", "delay", "gain", "tilt", "noise" or "irregular"
    load, motion : of the leading pair, by `geometry.inertia.LOADS` and `geometry.dynamic_mass.MOTIONS`; empty where
        channels fit better than a pair
    channels : that show it, the worst first
    frequency : [Hz] of a resonance; None for none
    share : of the leftover that the description covers, 0 to 1
    size : coefficient of the description in SI with `unit`: kg, N/m, s, 1 ...; None where there is none
    unit : of it
    """

    text: str
    looks_like: str
    load: str = entry(null="", default="")
    motion: str = entry(null="", default="")
    channels: tuple[str, ...] = ()
    frequency: float | None = entry("frequency_hz", unit="Hz", default=None)
    share: float = 0.0
    size: float | None = None
    unit: str = entry(null="", default="")


@dataclass(frozen=True, eq=False, kw_only=True)
class LevelDifference:
    """One axis driven at two levels that do not give the same.

    Attributes
    ----------
    data_set : campaign
    runs : the two, the lower level first
    axis : driven
    channels : that answer differently, the worst first
    frequency : [Hz] where most
    sigma : how surprising, in standard deviations of noise
    """

    data_set: str = entry("campaign")
    runs: tuple[str, str]
    axis: str
    channels: tuple[str, ...]
    frequency: float = entry("frequency_hz", unit="Hz")
    sigma: float


NARROWED = 0.5
"""[share] of what was admitted of a tolerance to which data narrow what is known better. Held by test_known_better.py."""

SIGNIFICANT = 2.0
"""[sd] from no effect, or from nominal, at which something is one. Exercised by test_diagnosed.py."""


@dataclass(frozen=True, kw_only=True)
class KnownBetter:
    """A tolerance of the laboratory of which these data say more than was known, and something else than its nominal.

    Attributes
    ----------
    id : of the parameter, where the catalogue has it that of the effect
    value, low, high : SI, with its 90 % interval
    unit : of them
    before : standard deviation of what the laboratory's class admits of it, in the same unit
    correctable : whether `massline correct` takes ``id=value`` out of a record
    """

    id: str
    value: float
    unit: str
    low: float = entry("interval90/0")
    high: float = entry("interval90/1")
    before: float = entry("admitted_sd")
    correctable: bool

    @staticmethod
    def of(fit: Fit) -> "tuple[KnownBetter, ...]":
        """What a fit tells of the tolerances of a laboratory beyond what was admitted, the surest first.

        A tolerance is there that data narrow, and that does not stand at its nominal; of what data leave as wide as it was, and
        of what turned out as stated, there is nothing to tell.
        """
        found = []
        spread = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
        for one, x, sd in zip(fit.parameters, map(float, fit.offsets), map(float, spread), strict=True):
            if one.kind not in (DECLARED, SENSOR) or not 0 < sd <= NARROWED * one.tolerance or abs(x) <= SIGNIFICANT * sd:
                continue
            ends = (one.value(x - NORMAL_90 * sd), one.value(x + NORMAL_90 * sd))
            known = KnownBetter(
                id=one.name,
                value=one.value(x),
                unit=one.unit,
                low=min(ends),
                high=max(ends),
                before=one.tolerance * abs(one.slope(0.0)),
                correctable=one.family in CORRECTIONS,
            )
            found.append((abs(x) / sd, known))
        return tuple(known for _, known in sorted(found, key=lambda pair: -pair[0]))


@dataclass(frozen=True, eq=False, kw_only=True)
class ReportedStep:
    """One round of the search.

    Attributes
    ----------
    added : id of what was accepted; empty where nothing was
    ranking : what was tried, the best evidence first
    misfit, price : before; of an effect that was asked once more, without it
    text : why it was or was not accepted
    """

    added: str = entry(null="")
    text: str
    misfit: float = entry("chi2_per_dof", null=inf)
    price: float = entry(null=inf)
    ranking: tuple[Cause, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer:
    """What every answer has, from spectra or from weights and periods.

    Attributes
    ----------
    verdict : of `VERDICTS`
    text : the answer in words
    accepted : what is missing, in the order of acceptance; without spectra none of several that cannot be told apart
    ranking : all that was tried against the model without the effect that was found last, the best first
    equivalence_class : ids that these data cannot tell apart, the best first; one where there is no doubt. Of several effects
        those of which each could be another; none where there is no doubt
    advice : measurements that would tell them apart, or confirm, the best first
    leftover : of an unknown effect
    detectable : the smallest size at which each effect would have been named
    """

    verdict: str
    text: str
    accepted: tuple[Cause, ...] = ()
    ranking: tuple[Cause, ...] = ()
    equivalence_class: tuple[str, ...] = ()
    advice: tuple[Advice, ...] = ()
    leftover: Leftover | None = entry("leftover_described", default=None)
    detectable: tuple[Detectable, ...] = ()

    @property
    @derived("next_measurement", before="advice")
    def next_measurement(self) -> str:
        """The best advice in words; empty where there is none."""
        return self.advice[0].test if self.advice else ""

    @property
    @derived("leftover", before="leftover_described")
    def left(self) -> str | None:
        """What no effect explains, in words."""
        return None if self.leftover is None else self.leftover.text


@dataclass(frozen=True, eq=False, kw_only=True)
class Diagnosis(Answer):
    """The answer from spectra.

    Attributes
    ----------
    text : what the sentence of the verdict (`headline`) does not say; empty where it says all
    levels : axes that answer differently at two levels
    before, after : the four errors without and with what was accepted; the same where nothing was
    known_better : calibrations that come with the answer, the surest first; none is missing from the model
    steps : how it was found
    everywhere : of a structure with a mesh, where on it something of each kind would explain most, the best first
    nodes : what the data say of every node (`validation.diagnose.everywhere.NodeScores`), to be drawn
    correlation : of tests of structures what analysts deliver (`validation.compare.correlation`), by the model as it is
    hold_out : what was held out, in words
    remarks : warnings, about data that were left out and the like
    only : families and ids that alone were looked for; empty where everything was
    settings : method, band, limits, lines, version, what was asked; see `validation.diagnose.diagnose`
    """

    text: str = unwritten()
    levels: tuple[LevelDifference, ...] = ()
    known_better: tuple[KnownBetter, ...] = entry(rare=True, default=())
    steps: tuple[ReportedStep, ...] = ()
    everywhere: tuple[FoundNode, ...] = entry(default=(), later=True)
    nodes: tuple[Any, ...] = unwritten(default=())
    correlation: tuple[Any, ...] = unwritten(default=())
    hold_out: tuple[str, ...] = entry("held_out", default=())
    remarks: tuple[str, ...] = entry("warnings", default=())
    before: Evaluation = entry(write=lambda of: _evaluation_json(of))
    after: Evaluation = entry(write=lambda of: _evaluation_json(of))
    only: tuple[str, ...] = unwritten(default=())
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))

    @property
    @derived("", before="accepted")
    def sentences(self) -> dict[str, str]:
        """What there is to say of it, and the verdict in one sentence, by their keys in JSON."""
        return {"text": self.text or headline(self), "headline": headline(self)}

    @property
    @derived("errors", before="detectable")
    def errors(self) -> dict[str, float | None]:
        """The errors before and after what was accepted, by their keys in JSON."""
        names = {"plain": "plain", "heldout": "held_out", "nominal": "nominal", "heldout_nominal": "held_out_nominal"}
        names |= {"heldout_configurations": "held_out_configurations"}
        both = (("before", self.before), ("after", self.after))
        shares = {f"{key}_{when}_percent": getattr(of, name) for when, of in both for key, name in names.items()}
        return {key: None if of is None else of.percent for key, of in shares.items()}


def _evaluation_json(of: Evaluation) -> dict[str, Any]:
    return {
        "plain_percent_by_channel": of.plain.by_channel,
        "plain_percent_by_run": of.plain.by_run,
        "heldout_percent_by_fold": {} if of.held_out is None else of.held_out.by_fold,
        "held_out": of.held_out_names,
        "fitted": _fit_json(of.fitted),
        "plain": _fit_json(of.plain_fit),
    }


def _fit_json(of: Fit) -> dict[str, Any]:
    return {
        "chi2": of.chi2,
        "degrees_of_freedom": of.degrees_of_freedom,
        "chi2_per_dof": misfit(of),
        "tolerance_z2": of.tolerance_z2,
        "tolerance_z2_expected": expected_z2(of),
        "largest_z": largest_z(of),
        "tolerances": of.tolerances,
        "log_evidence_nats": of.log_evidence,
        "converged": of.converged,
        "parameters": of.by_parameter,
    }


# The answer where only weights, centres of gravity and periods are known.


@dataclass(frozen=True, kw_only=True)
class MeasurementComparison:
    """One measurement beside the model.

    Attributes
    ----------
    name : file and quantity
    quantity : what was measured, in words: "period of swing 2"
    predicted, measured, deviation : SI, the last one standard deviation of the measured
    unit : of them
    sigma : (predicted - measured) / deviation
    period : [s] measured, of a swing; 0 of anything else
    period_shift : how much longer than the model's it is, as a share; 0 of anything else
    """

    name: str
    quantity: str = unwritten()
    sigma: float
    unit: str
    predicted: float
    measured: float
    deviation: float = entry("tolerance")
    period: float = entry("period_s", unit="s", null=0.0, default=0.0)
    period_shift: float = unwritten(default=0.0)

    @property
    @derived("period_shift_percent")
    def period_percent(self) -> float | None:
        """The shift in per cent; None of what is no swing."""
        return 100 * self.period_shift if self.period else None


@dataclass(frozen=True, kw_only=True)
class Needed:
    """How large an effect would have to be to explain the measurements by itself.

    Attributes
    ----------
    id : of the effect
    value, unit : SI
    plausible : what a fault of it may be, one standard deviation
    possible : whether any size that a test may have explains them; False for one that can only move them the other way
    fits : whether what is then left is what tolerances leave
    evidence : [nats] against the model without it
    text : all of it in words
    """

    id: str
    value: float
    unit: str
    plausible: float
    possible: bool
    fits: bool = entry("explains")
    evidence: float = entry("evidence_nats", unit="nats")
    text: str


@dataclass(frozen=True, kw_only=True)
class MeasurementInput:
    """An input of a measurement that would explain the deviation, were it wrong.

    Attributes
    ----------
    name : "rope length"
    value, change : as it stands, and by how much it would have to be wrong, SI
    tolerances : the same in its tolerances (95 %)
    of : measurements that it enters
    """

    name: str = entry("input")
    value: float = entry("value_si")
    change: float = entry("change_si")
    tolerances: float
    of: tuple[str, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class SwingAnswer(Answer):
    """The answer from weights, centres of gravity and periods.

    Attributes
    ----------
    title : of the model
    source : the model's file
    chi2, measurements : of the model without any effect, and how many numbers were measured
    facts : every measurement beside the model
    needed : by effect the size that would explain the measurements by itself
    readings : inputs that would explain them, were they wrong, the least wrong first
    remarks : what should be known
    settings : thresholds
    """

    title: str = unwritten()
    source: str = unwritten()
    chi2: float
    measurements: int
    facts: tuple[MeasurementComparison, ...] = entry("classical")
    needed: tuple[Needed, ...] = ()
    readings: tuple[MeasurementInput, ...] = ()
    remarks: tuple[str, ...] = entry("warnings", default=())
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))

    @property
    @derived("errors", before="detectable")
    def errors(self) -> None:
        """There are no spectra, and so no errors of them."""
        return None


# A model of effects fitted to the data of a study.


@dataclass(frozen=True, eq=False, kw_only=True)
class Candidate:
    """Effects on top of those of the model, and the fit of all parameters with them.

    Attributes
    ----------
    effects : at the sizes that the fit found, the one that was tried last last
    fit : of `validation.estimation.problem.FITTED`; logarithmic sizes count from those of the effects that `problem` has
    problem : that was fitted
    """

    effects: tuple[Added, ...]
    fit: Fit
    problem: Problem


# What the catalogue knows to confirm a cause, as advice for which there is no figure.


def confirming(effects: Iterable[Named]) -> tuple[Advice, ...]:
    """One for each of `effects`, in their order; none of those that nothing confirms."""
    known = [(one.id, FAMILIES[one.family].confirmed_by) for one in effects]
    return tuple(Advice(test=f"to confirm {id}: {how}", gain=0.0) for id, how in known if how)


# `Screened`: what a straight line says of one candidate.


@dataclass(frozen=True, eq=False, kw_only=True)
class Screened:
    """What a straight line says of a candidate.

    Attributes
    ----------
    added : at the size that it says
    evidence : [nats]
    told : its parameter; of a resonator the mass at the best frequency
    plausible : standard deviation of a plausible fault, in the offset of the parameter
    parameter : that the straight line is along, which says what its offset means; None of resonators and of periods
    usual : of a resonator what the data say of its mass at a frequency and damping at which they say neither much nor little
    any_size : the same of a size that no straight line follows far: of a loss, and of a spring
    begin : of what was fitted beside other places of a mesh, where that fit ended
    """

    added: Added
    evidence: float
    told: ScoreTest
    plausible: float
    parameter: Parameter | None = None
    usual: ScoreTest | None = None
    any_size: Smallest | None = None
    begin: Fit | None = None

    @property
    def id(self) -> str:
        """Of the effect."""
        return self.added.named.id


# The verdict in one sentence, and causes with their sizes in words.


NAMED = 4
"""[count] of effects that a sentence names; of more, their number is. Held by diagnosing/test_page.py."""


def headline(found: Diagnosis) -> str:
    """The verdict in one sentence."""
    causes = {one.id: cause(one) for one in found.accepted}
    names, told = listed(list(causes)), listed(list(causes.values()))
    if found.verdict == NOTHING:
        known = f", beside {names}" if names else ""
        return f"NOTHING IS MISSING{asked(found)} at the resolution of these data{known}."
    if found.verdict == MISSING:
        return f"MISSING: {'; '.join(f'{cause(one)}: {one.named.what}' for one in found.accepted)}."
    if found.verdict == AMBIGUOUS:
        sure = [text for id, text in causes.items() if id not in found.equivalence_class]
        beside = f"{listed(sure)}, and then one" if sure else "one"
        return f"MISSING IS {beside} of these, which these data cannot tell apart: {listed(found.equivalence_class, 'or')}."
    if found.verdict == SEVERAL:
        return f"SEVERAL ARE MISSING: {told}."
    if found.verdict == UNKNOWN:
        what = f"nothing{asked(found)}" if found.only else "no effect that massline knows"
        if names:
            return f"MISSING IN PART: {told}; and something is left that {what} explains."
        if found.leftover is None:
            return "UNKNOWN: the fit of the model as it is did not converge, and chance would explain what is left."
        return f"UNKNOWN: something is missing, and {what} explains it."
    if found.verdict == NONLINEAR:
        axes = listed(list(dict.fromkeys(level.axis for level in found.levels)))
        where, named = f" along {axes}" if axes else "", f": {told}" if told else ""
        return f"NOT LINEAR: the article or the rig answers otherwise at another level{where}{named}."
    wrong = [one for one in found.accepted if FAMILIES[one.named.family].side == OF_MISTAKES]
    rest = [cause(one) for one in found.accepted if one not in wrong]
    beside = f"; and missing beside it: {listed(rest)}" if rest else ""
    return f"A MISTAKE in the data: {'; '.join(f'{cause(one)}: {one.named.what}' for one in wrong)}{beside}."


def cause(of: Cause) -> str:
    """ "force-gain:fmd-z2, +7.93 % (+7.69 to +8.17)"."""
    told = "; ".join(sized(of, size) for size in of.sizes)
    name = f"{of.id} (or {listed(of.same, 'or')}, which is the same to these data)" if of.same else of.id
    return f"{name}, {told}" if told else name


def sized(of: Cause, size: EffectEstimate) -> str:
    """One size with its interval, and its key where it has one."""
    value, low, high, unit = interval(of, size)
    key = f"{size.key} " if size.key else ""
    if size.low == size.high:
        return key + with_unit(value, unit)
    if end := open_end(of, size):
        return f"{key}{end} {with_unit(low if end == AT_LEAST else high, unit)}"
    return f"{key}{with_unit(value, unit)} ({low} to {high})"


def of_a_class(one: Cause, alike: Sequence[Cause]) -> Cause:
    """`one` with a note of its size over all places of `alike` that data cannot tell from its own. An interval is of one place
    that has a name, and of all of them where a place is looked for."""
    sizes = [each.sizes[0] for each in alike if each.named.family == one.named.family and each.sizes]
    sizes = [each for each in sizes if each.value * one.sizes[0].value > 0]
    if len(sizes) < 2:
        return one
    own, *others = one.sizes
    over = replace(own, low=min(own.low, *(each.low for each in sizes)), high=max(own.high, *(each.high for each in sizes)))
    looked_for = any(position(target) is not None for target in one.named.targets)
    _, low, high, unit = interval(one, own if looked_for else over)
    count, to = len(sizes), f"it is {low} to {high} {unit}".rstrip()
    if not looked_for:
        return replace(one, note=f"an interval is that of one place; over all {count} that they cannot tell apart {to}")
    return replace(one, sizes=(over, *others), note=f"the interval is over the {count} of this class; at this place alone {to}")


AT_LEAST, AT_MOST = "at least", "at most"


def open_end(of: Cause, size: EffectEstimate) -> str:
    """Which end of its interval alone the data tell of one size, in words; empty of both."""
    spec = next(one for one in of.named.sizes if one.key == size.key)
    if size.low == size.high:
        return ""
    return AT_LEAST if size.high >= spec.high else AT_MOST if spec.low > 0 and size.low <= spec.low else ""


def interval(of: Cause, size: EffectEstimate) -> tuple[str, str, str, str]:
    """Value, both ends of the interval, and the unit in which they stand."""
    (value, low, high), unit = practical_units.written(of.named.family, size.key, size.unit, (size.value, size.low, size.high))
    return value, low, high, unit


def listed(names: Sequence[str], last: str = "and") -> str:
    """As a sentence lists them; of more than `NAMED` the number of the others."""
    if len(names) > NAMED:
        return f"{', '.join(names[:NAMED])} {last} {len(names) - NAMED} more"
    return f" {last} ".join(part for part in (", ".join(names[:-1]), *names[-1:]) if part)


def asked(found: Diagnosis) -> str:
    """What alone was looked for, where not everything was."""
    return f" of what was asked for ({listed(found.only)})" if found.only else ""
