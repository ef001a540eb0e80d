"""The verdict in one sentence, and causes with their sizes in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from validation.diagnosing import figures
from validation.diagnosing.diagnosis import (
    AMBIGUOUS,
    MISSING,
    MISTAKE,
    NONLINEAR,
    NOTHING,
    SEVERAL,
    UNKNOWN,
    Cause,
    Diagnosis,
    Size,
)
from validation.effects.catalogue import FAMILIES
from validation.effects.family import MISTAKE as OF_MISTAKES
from validation.rows import NONE

NAMED = 4
"""Effects that a sentence names; of more, their number is."""


def headline(found: Diagnosis) -> str:
    """The verdict in one sentence."""
    return HEADLINES[found.verdict](found)


def cause(of: Cause) -> str:
    """ "force-gain:fmd-z2, +7.93 % (+7.69 to +8.17)"."""
    told = "; ".join(sized(of, size) for size in of.sizes)
    return f"{of.id}, {told}" if told else of.id


def sized(of: Cause, size: Size) -> str:
    """One size with its interval, and its key where it has one."""
    value, low, high, unit = interval(of, size)
    key = f"{size.key} " if size.key else ""
    if size.low == size.high:
        return key + figures.with_unit(value, unit)
    return f"{key}{figures.with_unit(value, unit)} ({low} to {high})"


def interval(of: Cause, size: Size) -> tuple[str, str, str, str]:
    """Value, both ends of the interval, and the unit in which they stand."""
    (value, low, high), unit = figures.written(of.named.family, size.key, size.unit, (size.value, size.low, size.high))
    return value, low, high, unit


def mistaken(of: Cause) -> str:
    """What it is mistaken for."""
    return ", ".join(of.mistaken_for) or NONE


def listed(names: Sequence[str], last: str = "and") -> str:
    """As a sentence lists them; of more than `NAMED` the number of the others."""
    if len(names) > NAMED:
        return f"{', '.join(names[:NAMED])} {last} {len(names) - NAMED} more"
    return f" {last} ".join(part for part in (", ".join(names[:-1]), *names[-1:]) if part)


def what(id: str) -> str:
    """The family of an effect in a few words."""
    return FAMILIES[id.partition(":")[0]].what


def asked(found: Diagnosis) -> str:
    """What alone was looked for, where not everything was."""
    return f" of what was asked for ({listed(found.only)})" if found.only else ""


def _nothing(found: Diagnosis) -> str:
    known = f", beside {listed([one.id for one in found.accepted])}" if found.accepted else ""
    return f"NOTHING IS MISSING{asked(found)} at the resolution of these data{known}."


def _missing(found: Diagnosis) -> str:
    return f"MISSING: {'; '.join(f'{cause(one)}: {one.named.what}' for one in found.accepted)}."


def _ambiguous(found: Diagnosis) -> str:
    sure = [cause(one) for one in found.accepted if one.id not in found.equivalence_class]
    beside = f"{listed(sure)}, and then one" if sure else "one"
    return f"MISSING IS {beside} of these, which these data cannot tell apart: {listed(found.equivalence_class, 'or')}."


def _several(found: Diagnosis) -> str:
    return f"SEVERAL ARE MISSING: {listed([cause(one) for one in found.accepted])}."


def _unknown(found: Diagnosis) -> str:
    known = f"; {listed([one.id for one in found.accepted])} alone leaves too much" if found.accepted else ""
    what = f"nothing{asked(found)}" if found.only else "no effect that massline knows"
    return f"UNKNOWN: something is missing, and {what} explains it{known}."


def _nonlinear(found: Diagnosis) -> str:
    axes = listed(list(dict.fromkeys(level.axis for level in found.levels)))
    where = f" along {axes}" if axes else ""
    named = f": {listed([cause(one) for one in found.accepted])}" if found.accepted else ""
    return f"NOT LINEAR: the article or the rig answers otherwise at another level{where}{named}."


def _mistake(found: Diagnosis) -> str:
    wrong = [one for one in found.accepted if FAMILIES[one.named.family].side == OF_MISTAKES]
    rest = [cause(one) for one in found.accepted if one not in wrong]
    beside = f"; and missing beside it: {listed(rest)}" if rest else ""
    return f"A MISTAKE in the data: {'; '.join(f'{cause(one)}: {one.named.what}' for one in wrong)}{beside}."


HEADLINES: Mapping[str, Callable[[Diagnosis], str]] = MappingProxyType(
    {
        NOTHING: _nothing,
        MISSING: _missing,
        AMBIGUOUS: _ambiguous,
        SEVERAL: _several,
        UNKNOWN: _unknown,
        NONLINEAR: _nonlinear,
        MISTAKE: _mistake,
    }
)
"""By verdict."""
