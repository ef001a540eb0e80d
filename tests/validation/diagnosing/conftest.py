"""Diagnoses made by hand, one of every verdict; nothing is fitted."""

from collections.abc import Callable
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from validation.diagnose import diagnosis
from validation.effects.catalogue import parse
from validation.estimation.problem import DECLARED, IDENTIFIED, Evaluation, Fit, Parameter, Share

FOLDS = {"run z of cuboid": 1.6, "run x of cuboid": 1.4}


def evaluation(plain: float, z: float, evidence: float) -> Evaluation:
    """With the gain of a channel at `z` tolerances."""
    parameters = (
        Parameter(name="fmd:m", unit="kg", tolerance=0.9, kind=IDENTIFIED, nominal=18.0),
        Parameter(name="modulus:mast", unit="1", tolerance=0.025, kind=DECLARED),
        Parameter(name="force-gain:fmd-z1", unit="1", tolerance=0.003),
    )
    fit = Fit(
        parameters=parameters,
        offsets=np.array([0.1, 0.01, 0.003 * z]),
        covariance=np.diag([1e-4, 1e-5, 1e-6]),
        cost=900.0,
        chi2=1760.0,
        degrees_of_freedom=2000,
        tolerance_z2=0.16 + z**2,
        tolerances=2,
        log_evidence=evidence,
        converged=True,
    )
    return Evaluation(
        nominal=Share(percent=3 * plain),
        plain=Share(percent=plain, by_channel={"fmd-z1": 0.5 * plain, "fmd-z2": 0.8 * plain}),
        held_out=Share(percent=1.1 * plain, by_fold=FOLDS),
        held_out_nominal=Share(percent=3.1 * plain),
        plain_fit=fit,
        fitted=fit,
        held_out_names=tuple(FOLDS),
    )


BEFORE, AFTER = evaluation(4.1, 24.0, -900.0), evaluation(0.3, 1.0, -691.7)


def cause(
    text: str, evidence: float, spread: float = 0.0, *, misfit: float = 0.88, price: float = 1.0, null: bool = True
) -> diagnosis.Cause:
    named = parse(text)
    sizes = tuple(
        diagnosis.EffectEstimate(
            key=key, value=value, unit=one.unit, low=value - spread * abs(value), high=value + spread * abs(value)
        )
        for one in named.sizes
        for key, value in named.values.items()
        if one.key == key
    )
    return diagnosis.Cause(named=named, sizes=sizes, evidence=evidence, misfit=misfit, price=price, null=null)


GAIN = cause("force-gain:fmd-z2=0.0793", 208.3, 0.03)
STIFF = cause("cell-stiffness:2z=1.6", 205.1, 0.05)
SHUNT = cause("load-path-shunt:z=0.04", 31.2, 0.2, misfit=1.4, price=60.0, null=False)
MASS = cause("point-mass:mast-top=0.198", 55.0, 0.02)
STEPS = (
    diagnosis.ReportedStep(
        added="force-gain:fmd-z2", ranking=(GAIN, SHUNT), misfit=0.88, price=193.0, text="208.3 nats where 8 are asked for"
    ),
    diagnosis.ReportedStep(added="", ranking=(MASS,), misfit=0.88, price=1.0, text="nothing gains more than 8 nats"),
)
SETTINGS = MappingProxyType({"method": "full-record", "band_hz": (4.0, 32.0), "worth_nats": {"": 8.0}, "lines": np.int64(560)})
COMMON = {"before": BEFORE, "after": AFTER, "hold_out": tuple(FOLDS), "settings": SETTINGS, "steps": STEPS}
TURNED = diagnosis.Advice(test="run the Cuboid turned by 90 degrees about z", gain=34.2, separates=(GAIN.id, STIFF.id))
DETECTABLE = (
    diagnosis.Detectable(id="force-gain:fmd-z2", size=0.015, unit="1"),
    diagnosis.Detectable(id="appendage:z", size=0.0102, unit="kg", at="21 Hz"),
    diagnosis.Detectable(id="force-delay:fmd-z1", size=1.04e-4, unit="s"),
)

FOUND: dict[str, diagnosis.Diagnosis] = {
    "nothing": diagnosis.Diagnosis(
        verdict="nothing",
        text="The tolerances explain the data at a price of 1.0, as they do where nothing is wrong.",
        **{**COMMON, "before": AFTER, "steps": STEPS[1:]},
        ranking=(MASS,),
        detectable=DETECTABLE,
    ),
    "missing": diagnosis.Diagnosis(
        verdict="missing",
        text="No other effect of the catalogue comes within 5 nats.",
        accepted=(GAIN,),
        ranking=(GAIN, SHUNT),
        equivalence_class=(GAIN.id,),
        advice=(replace(TURNED, separates=(GAIN.id,)),),
        detectable=DETECTABLE,
        remarks=("the mounting is assumed",),
        **COMMON,
    ),
    "ambiguous": diagnosis.Diagnosis(
        verdict="ambiguous",
        text="",
        accepted=(GAIN,),
        ranking=(GAIN, STIFF, SHUNT),
        equivalence_class=(GAIN.id, STIFF.id, "force-crosstalk:xz"),
        advice=(TURNED, diagnosis.Advice(test="weigh the article", gain=0.0)),
        **COMMON,
    ),
    "several": diagnosis.Diagnosis(
        verdict="several", text="", accepted=(GAIN, MASS), ranking=(MASS,), equivalence_class=(MASS.id,), **COMMON
    ),
    "unknown": diagnosis.Diagnosis(
        verdict="unknown",
        text="",
        ranking=(SHUNT,),
        leftover=diagnosis.Leftover(
            text="a resonance at 21.3 Hz in z, 0.31 kg",
            looks_like="resonance",
            load="force along z",
            motion="z",
            channels=("fmd-z1", "fmd-z3"),
            frequency=21.3,
            share=0.83,
            size=0.31,
            unit="kg",
        ),
        **{**COMMON, "after": BEFORE, "steps": STEPS[1:]},
    ),
    "nonlinear": diagnosis.Diagnosis(
        verdict="nonlinear",
        text="",
        accepted=(cause("friction:flange:x=40.0", 120.0, 0.1),),
        levels=(
            diagnosis.LevelDifference(
                data_set="cuboid", runs=("x-0.5", "x"), axis="x", channels=("fmd-x12", "fmd-x34"), frequency=12.0, sigma=44.0
            ),
        ),
        **{**COMMON, "steps": ()},
    ),
    "mistake": diagnosis.Diagnosis(
        verdict="mistake", text="", accepted=(cause("polarity:fmd-z2", 20000.0),), **{**COMMON, "steps": ()}
    ),
}


@pytest.fixture(scope="session")
def made() -> Callable[[str], diagnosis.Diagnosis]:
    """``made(verdict)``."""
    return FOUND.__getitem__
