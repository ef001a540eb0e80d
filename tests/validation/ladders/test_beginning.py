"""A resonator that nobody sized, or at a frequency 30 % off, begins where it is; what is fixed stays."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary
from validation.estimation.fit import fit
from validation.estimation.problem import DECLARED, PLAIN, Change, Measured, Parameter, Predicted, Problem
from validation.history.add import starting_sizes
from validation.model.model import Added
from validation.prediction import effects

WORDS = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)
MASS = Parameter(name="mass", unit="kg", tolerance=0.05, kind=DECLARED, nominal=20.0, logarithmic=True)
TRUTH = {"m": 0.1, "f": 18.0, "zeta": 0.01}


@dataclass(frozen=True, eq=False, kw_only=True)
class Beside:
    """A mass on a known base, and a resonator beside it."""

    measured: Measured
    parameters: tuple[Parameter, ...]

    def at(self, offsets, lines=None, *, derivatives=True):
        known = {one.name: one for one in self.parameters}
        f = self.measured.frequency if lines is None else self.measured.frequency[lines]

        def reads(at):
            sizes = {key: known[f"appendage:z[{key}]"].value(at.get(f"appendage:z[{key}]", 0.0)) for key in TRUTH}
            return (MASS.value(at.get("mass", 0.0)) + resonator(f, **sizes))[:, None, None]

        changes = {}
        for name in known if derivatives else ():
            up, down = (reads({**offsets, name: offsets.get(name, 0.0) + side * 1e-6}) for side in (1, -1))
            changes[name] = Change(channels=(0,), rows=(up - down) / 2e-6)
        return Predicted(rows=reads(offsets), changes=changes)


def resonator(frequency, m, f, zeta):
    spring = f**2 + 2j * zeta * f * frequency
    return m * spring / (spring - frequency**2)


def problem(added: Added) -> Problem:
    f = np.linspace(4.0, 32.0, 200)
    values = (20.3 + resonator(f, **TRUTH))[None, :, None]
    measured = Measured(
        name="one",
        configuration="one",
        runs=("r",),
        channels=("c",),
        judged=np.ones(1, dtype=bool),
        frequency=f,
        values=values,
        noise=np.full(values.shape, 2e-3),
        inputs=np.ones(values.shape, dtype=complex),
    )
    return Problem((Beside(measured=measured, parameters=(MASS, *effects.parameters((added,)))),))


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("appendage:z=m:0.05,f:10,zeta:0.01", ("m", "f", "zeta")),
        ("appendage:z=m:0.02,f:23.4,zeta:0.03", ()),
        ("appendage:z=m:0.5,f:12.6,zeta:0.01", ()),
    ],
    ids=["nothing said", "30 % too high", "30 % too low"],
)
def test_a_resonator_is_found_from_where_it_begins(text, left):
    added = Added(named=parse(text, WORDS))
    found = starting_sizes(added, left, problem(added), {"mass": 0.015})
    assert found.named.values["f"] == pytest.approx(TRUTH["f"], rel=0.04)
    whole = problem(found)
    fitted = fit(whole, PLAIN, start=fit(without(whole), PLAIN), floor=0.0)
    sizes = {name: whole.by_name[f"appendage:z[{name}]"].value(fitted.by_name[f"appendage:z[{name}]"]) for name in TRUTH}
    assert sizes == pytest.approx(TRUTH, rel=0.02)


def without(whole: Problem) -> Problem:
    return Problem(tuple(Without(measured=one.measured) for one in whole.predictions))


@dataclass(frozen=True, eq=False, kw_only=True)
class Without:
    """The mass alone."""

    measured: Measured
    parameters: tuple[Parameter, ...] = (MASS,)

    def at(self, offsets, lines=None, *, derivatives=True):
        n = len(self.measured.frequency if lines is None else lines)
        rows = np.full((n, 1, 1), MASS.value(offsets.get("mass", 0.0)), dtype=complex)
        return Predicted(rows=rows, changes={"mass": Change(channels=(0,), rows=rows)})


def test_what_is_fixed_begins_as_it_was_asked_for():
    added = Added(named=parse("appendage:z=m:0.05,f:10,zeta:0.01", WORDS), fixed=True)
    assert starting_sizes(added, (), problem(replace(added, fixed=False)), {}) is added
