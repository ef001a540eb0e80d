"""`Bench`: data that stand ready for any model of effects, and `Hypothesis`, such a model fitted to them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from identification.campaign import Campaign
from validation.engine.evaluation import Fit
from validation.engine.hold_out import named, without
from validation.engine.prediction import Fact
from validation.engine.problem import Problem
from validation.models.model import Added, Model
from validation.prediction.series import SeriesPrediction


@dataclass(frozen=True, eq=False, kw_only=True)
class Bench:
    """Data, ready for any effects.

    Attributes
    ----------
    model : whose laboratory and structure are held against the data, with the effects that it has
    campaigns : as they were read
    made : predictions of the campaigns by the model without effects
    facts : by effects, what weights and periods say
    hold_out : names of runs, data sets and facts that no fit sees, as the engine knows them
    """

    model: Model
    campaigns: tuple[Campaign, ...]
    made: tuple[SeriesPrediction, ...]
    facts: Callable[[Sequence[Added]], tuple[Fact, ...]] = lambda effects: ()
    hold_out: tuple[str, ...] = ()

    def whole(self, effects: Sequence[Added] = ()) -> Problem:
        """All data by the model with these `effects` on top of its own."""
        every = (*self.model.effects, *effects)
        return Problem(tuple(one.with_effects(every) for one in self.made), self.facts(every))

    def problem(self, effects: Sequence[Added] = ()) -> Problem:
        """What fits see of it: fewer lines, and nothing that is held out."""
        thinned = self.whole(effects).thinned()
        return without(thinned, named(thinned, self.hold_out)) if self.hold_out else thinned


@dataclass(frozen=True, eq=False, kw_only=True)
class Hypothesis:
    """Effects on top of those of the model, and the fit of all parameters with them.

    Attributes
    ----------
    effects : at the sizes that the fit found, the one that was tried last last
    fit : of `validation.engine.parameter.FITTED`; logarithmic sizes count from those of the effects that `problem` has
    problem : that was fitted
    """

    effects: tuple[Added, ...]
    fit: Fit
    problem: Problem
