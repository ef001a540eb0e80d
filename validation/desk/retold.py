"""A diagnosis again from its JSON, as the noun that figures and reports are made of.

A window keeps what it found as text (`validation.desk.diagnosing`): no object of a program outlives that program. All that pages
and pictures show comes back as it was; of the fits' covariance only its diagonal is there.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import Any

import numpy as np

from validation.diagnosing.diagnosis import Advice, Cause, Detectable, Diagnosis, Leftover, Level, Size, Step
from validation.effects.identifiers import parse
from validation.effects.targets import Vocabulary
from validation.engine.evaluation import Evaluation, Fit, Share
from validation.engine.parameter import Parameter

ANY = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)

Object = Mapping[str, Any]

Known = Mapping[str, float | None]


def tolerances(found: Diagnosis) -> dict[str, dict[str, float | None]]:
    """Before and after, by parameter what was known of it beforehand, None for nothing: what the JSON of fits lacks."""
    both = {"before": found.before, "after": found.after}
    return {when: {one.name: _or_none(one.tolerance) for one in of.fitted.parameters} for when, of in both.items()}


def diagnosis(said: Object, known: Mapping[str, Known]) -> Diagnosis:
    """The diagnosis whose JSON is `said`; `known` are its `tolerances`.

    Raises
    ------
    KeyError, TypeError, ValueError : it is not whole.
    """
    errors = said["errors"]
    before = _evaluation(said["before"], errors, "before", known["before"])
    accepted = tuple(map(_cause, said["accepted"]))
    described = said["leftover_described"]
    return Diagnosis(
        verdict=said["verdict"],
        text="" if said["text"] == said["headline"] else said["text"],
        accepted=accepted,
        ranking=tuple(map(_cause, said["ranking"])),
        equivalence_class=tuple(said["equivalence_class"]),
        advice=tuple(map(_advice, said["advice"])),
        leftover=None if described is None else _leftover(described),
        detectable=tuple(_detectable(one) for one in said["detectable"]),
        levels=tuple(map(_level, said["levels"])),
        before=before,
        after=_evaluation(said["after"], errors, "after", known["after"]) if accepted else before,
        steps=tuple(map(_step, said["steps"])),
        hold_out=tuple(said["held_out"]),
        remarks=tuple(said["warnings"]),
        only=tuple(said["candidates"]),
        settings=dict(said["settings"]),
    )


def _cause(one: Object) -> Cause:
    sizes = tuple(
        Size(key=size["key"], value=size["value"], unit=size["unit"], low=size["interval90"][0], high=size["interval90"][1])
        for size in one["values"]
    )
    return Cause(
        named=parse(one["written"], ANY),
        sizes=sizes,
        evidence=_number(one["evidence_nats"]),
        misfit=_number(one["chi2_per_dof"]),
        price=_number(one["price"]),
        null=one["as_where_nothing_is_missing"],
        note=one["note"] or "",
    )


def _advice(one: Object) -> Advice:
    gain = _number(one["expected_evidence_nats"])
    return Advice(test=one["test"], gain=gain, separates=tuple(one["separates"]), hours=one["hours"] or 0.0)


def _leftover(one: Object) -> Leftover:
    return Leftover(
        text=one["text"],
        looks_like=one["looks_like"],
        load=one["load"] or "",
        motion=one["motion"] or "",
        channels=tuple(one["channels"]),
        frequency=one["frequency_hz"],
        share=one["share"],
        size=one["size"],
        unit=one["unit"] or "",
    )


def _detectable(one: Object) -> Detectable:
    return Detectable(id=one["id"], size=_number(one["size"]), unit=one["unit"], at=one["at"] or "")


def _level(one: Object) -> Level:
    first, second = one["runs"]
    return Level(
        data_set=one["campaign"],
        runs=(first, second),
        axis=one["axis"],
        channels=tuple(one["channels"]),
        frequency=one["frequency_hz"],
        sigma=one["sigma"],
    )


def _step(one: Object) -> Step:
    return Step(
        added=one["added"] or "",
        ranking=tuple(map(_cause, one["ranking"])),
        misfit=_number(one["chi2_per_dof"]),
        price=_number(one["price"]),
        text=one["text"],
    )


def _evaluation(one: Object, errors: Object, when: str, known: Known) -> Evaluation:
    plain = Share(
        percent=errors[f"plain_{when}_percent"],
        by_channel=one["plain_percent_by_channel"],
        by_run=one["plain_percent_by_run"],
    )
    return Evaluation(
        nominal=Share(percent=errors[f"nominal_{when}_percent"]),
        plain=plain,
        held_out=_share(errors[f"heldout_{when}_percent"], one["heldout_percent_by_fold"]),
        held_out_nominal=_share(errors[f"heldout_nominal_{when}_percent"], {}),
        plain_fit=_fit(one["plain"], known),
        fitted=_fit(one["fitted"], known),
        held_out_names=tuple(one["held_out"]),
        held_out_configurations=_share(errors[f"heldout_configurations_{when}_percent"], {}),
    )


def _share(percent: float | None, by_fold: Mapping[str, float]) -> Share | None:
    return None if percent is None else Share(percent=percent, by_fold=by_fold)


def _fit(one: Object, known: Known) -> Fit:
    said = one["parameters"]
    parameters = tuple(
        Parameter(name=name, unit="", tolerance=inf if known[name] is None else float(known[name] or 0.0), kind=each["kind"])
        for name, each in said.items()
    )
    return Fit(
        parameters=parameters,
        offsets=np.array([each["offset"] for each in said.values()], dtype=np.float64),
        covariance=np.diag(np.array([each["sd"] for each in said.values()], dtype=np.float64) ** 2),
        cost=inf,
        chi2=_number(one["chi2"]),
        degrees_of_freedom=one["degrees_of_freedom"],
        tolerance_z2=_number(one["tolerance_z2"]),
        tolerances=one["tolerances"],
        log_evidence=_number(one["log_evidence_nats"]),
        converged=one["converged"],
    )


def _or_none(value: float) -> float | None:
    return None if value == inf else value


def _number(value: float | None) -> float:
    """JSON knows no infinity, and has nothing in its place."""
    return inf if value is None else float(value)
