"""Which campaigns share FMD and sensors, and so their errors."""

from __future__ import annotations

from geometry.errors import BadInput
from identification.evidence import Evidence, Settings


def groups(evidence: Evidence, settings: Settings) -> tuple[list[int], tuple[str, ...]]:
    """The group of every tare - 0 is the article's own - and what must be said about it.

    A campaign that states no hardware is taken to share the article's, and a warning says so.

    Raises
    ------
    BadInput : a tare of other hardware than the article, without `settings.any_hardware`.
    """
    known, found, warnings = [evidence.hardware], [], []
    for tare in evidence.tares:
        if not tare.hardware or not evidence.hardware:
            if tare.hardware != evidence.hardware:
                warnings.append(
                    f"{tare.name}: hardware is not stated on both sides; FMD and sensors are taken to be the article's"
                )
            found.append(0)
            continue
        if tare.hardware not in known:
            known.append(tare.hardware)
        found.append(known.index(tare.hardware))
        if found[-1]:
            _require_allowed(evidence, tare.hardware, tare.name, settings)
            warnings.append(
                f"{tare.name}: its hardware {tare.hardware!r} is not the article's {evidence.hardware!r}; they share "
                "neither sensor errors nor FMD, and the tare says nothing about the article"
            )
    return found, tuple(warnings)


def _require_allowed(evidence: Evidence, other: str, name: str, settings: Settings) -> None:
    if not settings.any_hardware:
        raise BadInput(
            source=name,
            field="campaign.hardware",
            problem=f"must be that of the article's campaign, {evidence.hardware!r}, found {other!r}: another FMD, other sensors",
            remedy="Give a tare of the same hardware, or ask for the combination explicitly",
        )
