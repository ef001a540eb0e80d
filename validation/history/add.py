"""From what `massline add` was asked to the rung that is written: data gathered, the effect checked, both models evaluated.

The rung of the model before is kept as soon as it is evaluated, so that an interruption of the fit behind it loses nothing.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.atomic import probe
from geometry.errors import BadInput, CheckFailed
from geometry.toml_file import nearest
from identification.campaign import Campaign
from validation.effects import catalogue
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import SizeSpec, Vocabulary
from validation.estimation import evaluate, verdicts
from validation.estimation import problem as estimation
from validation.estimation.fit import start
from validation.history import history
from validation.history.history import BOTH_FITS, Body, Conditions, Errors, HistoryPosition, Version, VersionSize
from validation.history.verdict import NOTICED, Alias, alias, at_offsets, body_of, kept_offsets, noticed, sentence, verdict
from validation.model import model_file
from validation.model.model import Added, Model
from validation.prediction import effects
from validation.prediction.classical_facts import require_bodies
from validation.study import Options, Progress, Study, read_data, require_band

# Where the fit of an effect begins that no fit finds from afar: a resonator by its frequency, a part by its modulus.
#
# A resonator answers at its own frequency only. A fit that begins a few of its widths beside it sees nothing of it, and one that
# a user takes from a spectrum is soon that far off. So its frequency is looked for where the data are, or around what the user
# says, at the solution of the model without it; its mass is what the data want there, and its damping ratio is modest.


MASS, FREQUENCY, DAMPING = RESONATOR = ("m", "f", "zeta")
"""Keys of the sizes by which a family is a resonator."""

MODEST = 0.02
"""Damping ratio at which a resonator is looked for of which nothing is said."""

AROUND = 1.5
"""Factor either way within which a frequency is looked for that the user says."""

SPACING = 0.035
"""From one frequency to the next, as a share: less than twice the width of a resonance of `MODEST` damping."""


def starting_sizes(
    added: Added,
    left: Sequence[str],
    problem: estimation.Problem,
    base: estimation.Offsets,
    progress: Callable[[float], None] | None = None,
) -> Added:
    """`added` with the sizes at which its fit begins.

    Parameters
    ----------
    left : keys of the sizes of which the user said nothing
    problem : of the model with it
    base : the plain fit of the model without it
    """
    if added.fixed:
        return added
    named = added.named
    names = {size.key: effects.name(named, size.key) for size in named.sizes}
    known = {key: problem.by_name[one] for key, one in names.items() if one in problem.by_name}
    free = {key: one for key, one in known.items() if one.kind == estimation.EFFECT}
    if set(RESONATOR) <= set(free):
        # By name of frequency and damping ratio, the offsets at which a resonator is looked for
        mass, frequency, damping = (free[key] for key in RESONATOR)
        lines = np.concatenate([one.measured.frequency for one in problem.predictions])
        own = frequency.nominal
        low, high = (lines.min(), lines.max()) if FREQUENCY in left else (own / AROUND, own * AROUND)
        low = max(float(low), float(high) / 1e3)
        along = np.geomspace(low, high, 2 + int(np.log(high / low) / SPACING))
        ratio = MODEST if DAMPING in left else damping.nominal
        places = {frequency.name: np.array([frequency.offset(f) for f in along]), damping.name: np.array([damping.offset(ratio)])}
        return _at(added, free, start(problem, tuple(places), base=base, places=places, amplitude=mass.name, progress=progress))
    # What a fit cannot find from afar: a corner or a resonance, the modulus of a part
    corners = {size.key for size in named.sizes if size.unit == "Hz" and size.logarithmic}
    far = {key: one for key, one in free.items() if key in left and (key in corners or named.family == "modulus")}
    return _at(added, far, start(problem, [one.name for one in far.values()], base=base, progress=progress)) if far else added


def _at(added: Added, free: Mapping[str, estimation.Parameter], found: estimation.Offsets) -> Added:
    """`added` at the offsets `found` of the parameters `free`, by key, within what its family allows."""
    values = dict(added.named.values)
    for size in added.named.sizes:
        if size.key in free:
            one = free[size.key]
            values[size.key] = min(max(one.value(found.get(one.name, one.start)), size.low), size.high)
    return replace(added, named=replace(added.named, values=values))


# The effect that is to be added, checked before anything is fitted: known, not there yet, seen by these data, no exact alias.


ARGUMENT = "EFFECT"

FIRST_GUESS: Mapping[str, float] = {"m": 0.05, "f": 10.0, "zeta": 0.01}
"""Of a resonator of which nothing is said: fifty grams at the middle of the paper's band; where it is, a grid says."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AddedEffect:
    """An effect that may be added.

    Attributes
    ----------
    added : with the sizes that were asked for, or a first guess
    left : keys of the sizes that are a guess
    alias : what does the same to these data; None where nothing does
    tolerances : by key of its sizes what a laboratory or the model admits, one standard deviation
    nulls : by key the size at which there is no effect
    said : sentences about how it is taken
    """

    added: Added
    left: tuple[str, ...]
    alias: "Alias | None"
    tolerances: Mapping[str, float]
    nulls: Mapping[str, float]
    said: tuple[str, ...] = ()


def read(text: str, model: Model, words: Vocabulary, *, fixed: bool) -> tuple[Added, tuple[str, ...]]:
    """The effect that `text` names, and the keys of its sizes that `text` leaves open.

    Raises
    ------
    BadInput : no effect of the catalogue, a size that is no physics, one that the model has already, `fixed` without a size.
    """
    whole, left = completed(text)
    named = catalogue.parse(whole, words, source=ARGUMENT)
    there = next((one for one in model.effects if one.named.id == named.id), None)
    if there is not None:
        remedy = "`massline undo` takes the last one out; to start it elsewhere, change its value in the file"
        raise BadInput(model.source, named.id, f"the model has it already, {there.named}", remedy)
    if fixed and left:
        remedy = f"Write for example {FAMILIES[named.family].example}"
        raise BadInput("--fixed", named.id, "its size is missing, to which it is to be fixed", remedy)
    switch = bool(named.sizes) and all(size.whole for size in named.sizes)
    return Added(named=named, fixed=fixed or switch), left


def candidate(added: Added, left: Sequence[str], study: Study, *, allowed: bool) -> AddedEffect:
    """`added`, whose sizes were partly `left` open, as it can be fitted to the data of a `study`.

    Raises
    ------
    BadInput : it acts nowhere on these data; others of the model do exactly the same, and that is not `allowed`.
    """
    named, before, after = added.named, study.whole().thinned(), study.whole([added]).thinned()
    names = names_of(after, named)
    if not (noticed(after, names) > NOTICED if names else _differ(before, after)):
        by_itself = "; they are tests of a structure by itself, without a base, an FMD or its cells" if not study.made else ""
        problem = f"it acts nowhere on these data: no channel would read anything else{by_itself}"
        remedy = "Name data of an article that has it, or of a run that drives it"
        known = {name: None for there in study.there for name in catalogue.known(named, there)} if named.targets else {}
        if catalogue.is_local(named) and known and named.target not in known:
            problem = f"nothing is called {named.target!r} there"
            remedy = f"{nearest(named.target, known)}It has {', '.join(list(known)[:20])}"
        raise BadInput(ARGUMENT, named.id, problem, remedy)
    # Every effect of the models free, those too whose size was given
    every = tuple(replace(each, fixed=False) for each in (*study.model.effects, added))
    made = tuple(one.with_effects(every) for one in (*study.made, *study.tests))
    free = replace(after, predictions=made)
    found = alias(free, named.id, names_of(free, named))
    if found is not None and found.effects and not allowed:
        remedy = "Add data that tell them apart, undo the other, or say --alias-ok: knowledge beforehand then shares it out"
        raise BadInput(ARGUMENT, named.id, f"these data cannot tell it from what is in the model: {found.text}", remedy)
    # Of a size that was a tolerance of the model before, that; else what its family admits of a careful laboratory
    admitted = {size.key: FAMILIES[named.family].tolerance for size in named.sizes}
    if named.id in before.by_name:
        admitted[""] = before.by_name[named.id].tolerance
    return AddedEffect(
        added=added,
        left=tuple(left),
        alias=found,
        tolerances=admitted,
        nulls={size.key: size.null for size in named.sizes},
        said=() if found is None else (f"{found.text}; only what is known beforehand shares it out",),
    )


def completed(text: str) -> tuple[str, tuple[str, ...]]:
    """`text` with a first guess for every size that it leaves out, and the keys of these."""
    name, equals, value = (part.strip() for part in text.partition("="))
    family, *targets = (part.strip() for part in name.split(":"))
    if family not in FAMILIES or (equals and not value):
        return text, ()
    given = {part.rpartition(":")[0].strip() for part in value.split(",")} if value else set()
    open_ = [size for size in FAMILIES[family].sizes_at(tuple(targets)) if size.key not in given]
    if not open_ or "" in given:
        return text, ()
    guesses = [f"{size.key}:{_guess(size)!r}" if size.key else repr(_guess(size)) for size in open_]
    return f"{name}={','.join([*([value] if value else []), *guesses])}", tuple(size.key for size in open_)


def _guess(size: SizeSpec) -> float:
    """No effect where that is a size; of a switch the other position; else something that is there."""
    if size.whole:
        return size.low if size.null == size.high else size.high
    first = FIRST_GUESS.get(size.key, size.plausible) if size.logarithmic else size.null
    return min(max(first, size.low), size.high)


def _differ(before: estimation.Problem, after: estimation.Problem) -> bool:
    """Whether any channel is predicted otherwise, or its noise."""
    for one, other in zip(before.predictions, after.predictions, strict=True):
        lines = before.lines_of(one)
        first, second = (each.at(problem.start, lines, derivatives=False) for each, problem in ((one, before), (other, after)))
        if first.rows.shape != second.rows.shape or not np.array_equal(first.rows, second.rows):
            return True
        if (first.noise is None) != (second.noise is None):
            return True
    return False


def names_of(problem: estimation.Problem, named: Named) -> tuple[str, ...]:
    """The parameters of `problem` that are sizes of the effect `named`."""
    known = {named.id, *(f"{named.id}[{size.key}]" for size in named.sizes)}
    return tuple(one.name for one in problem.parameters if one.name in known and one.kind == estimation.EFFECT)


# A model held against data: the figures of a rung, and the model file with the sizes that its effects were found to have.


@dataclass(frozen=True, eq=False, kw_only=True)
class EvaluatedModel:
    """A model and what came out.

    Attributes
    ----------
    model : with the sizes that its effects were found to have
    evaluation : errors and fits; the nominal ones at those sizes
    body : identified inertia; None where there is none
    """

    model: Model
    evaluation: estimation.Evaluation
    body: Body | None


def judged(study: Study, parent: Version | None, progress: Progress | None = None, *, ended: bool = True) -> EvaluatedModel:
    """The model of a `study` held against its data.

    Parameters
    ----------
    parent : on the same data, of the model without its last effect: no fit costs more than its own
    ended : whether a fit without a parent must have converged

    Raises
    ------
    CheckFailed : it must, and does not.
    """
    tell = progress or (lambda what, share: None)
    if parent is None:
        found = study.evaluation(lambda share: tell("fitting", share))
        for one in (found.plain_fit, found.fitted) if ended else ():
            one.required()
    else:
        whole = study.whole()
        # As much of the evaluation of `parent` as a child begins with: where its fits ended, and what they explained
        figures = ("chi2", "degrees_of_freedom", "tolerance_z2", "tolerances")
        explained = {name: getattr(parent.errors, name) for name in figures if parent.errors is not None}
        began = estimation.Evaluation(
            nominal=estimation.Share(percent=0.0),
            plain=estimation.Share(percent=0.0),
            held_out=None,
            held_out_nominal=None,
            plain_fit=at_offsets(parent.plain_offsets, whole),
            fitted=replace(at_offsets(parent.fitted_offsets, whole), **explained),
        )
        found = evaluate.evaluate(whole, hold_out=study.hold_out, parent=began, progress=lambda share: tell("fitting", share))
    sized = study.by(replace(study.model, effects=tuple(sized_by(one, found.fitted) for one in study.model.effects)))
    # The errors of the model as it stands now, on what is fitted and on what the held-out plain error is told of: runs, or what
    # is named, no configurations
    problem = known = sized.whole()
    turns = [fold for fold in evaluate.folds(problem) if not fold.configuration]
    if study.hold_out:
        turns = [evaluate.named(problem, study.hold_out)]
        known = evaluate.without(problem, turns[0])
    fitted = [each for one in known.predictions for each in evaluate.squares(one, problem.start)]
    held = [
        each
        for fold in turns
        for one, lines in evaluate.held(problem, fold)
        for each in evaluate.squares(one, problem.start, lines, fold=fold.name)
    ]
    found = replace(found, nominal=evaluate.share(fitted), held_out_nominal=evaluate.share(held) if held else None)
    body = body_of(sized, found.plain_fit, lambda share: tell("identifying", share))
    return EvaluatedModel(model=sized.model, evaluation=found, body=body)


def rung_with(rung: Version, of: EvaluatedModel) -> Version:
    """`rung` with the figures of what was judged."""
    told = of.evaluation
    errors = Errors(
        nominal=told.nominal.percent,
        plain=told.plain.percent,
        held_out_nominal=None if told.held_out_nominal is None else told.held_out_nominal.percent,
        held_out=None if told.held_out is None else told.held_out.percent,
        chi2=told.fitted.chi2,
        degrees_of_freedom=told.fitted.degrees_of_freedom,
        tolerance_z2=told.fitted.tolerance_z2,
        tolerances=told.fitted.tolerances,
        log_evidence=told.fitted.log_evidence,
        expected_z2=verdicts.expected_z2(told.fitted),
        largest_z=verdicts.largest_z(told.fitted),
        converged=told.plain_fit.converged and told.fitted.converged,
        unfinished=tuple(name for name, fit in zip(BOTH_FITS, (told.plain_fit, told.fitted), strict=True) if not fit.converged),
        held_out_names=told.held_out_names,
        by_channel=dict(told.plain.by_channel),
        by_fold={} if told.held_out is None else dict(told.held_out.by_fold),
    )
    # A size that was not fitted has no deviation
    sizes = {
        one.named.id: tuple(
            VersionSize(
                key=size.key,
                value=one.named.values[size.key],
                unit=size.unit,
                deviation=None if one.fixed else one.deviation.get(size.key),
            )
            for size in one.named.sizes
        )
        for one in of.model.effects
    }
    return replace(
        rung,
        errors=errors,
        effects=sizes,
        bodies=() if of.body is None else (of.body,),
        plain_offsets=kept_offsets(told.plain_fit),
        fitted_offsets=kept_offsets(told.fitted),
    )


def rewritten(text: str, effects: Sequence[Added], source: str) -> str:
    """The `text` of the model file `source` with all `effects` at their sizes.

    Raises
    ------
    BadInput : its layout allows no change of one effect alone.
    """
    for one in effects:
        text = model_file.with_effect(text, one, source)
    return text


def sized_by(added: Added, fit: estimation.Fit) -> Added:
    """`added` at the size and the standard deviation that `fit` found, within what its family allows."""
    values, deviation = dict(added.named.values), {}
    spread = np.sqrt(np.diag(fit.covariance))
    found = {one.name: (one, float(x), float(sd)) for one, x, sd in zip(fit.parameters, fit.offsets, spread, strict=True)}
    for size in added.named.sizes:
        which = effects.name(added.named, size.key)
        if not added.fixed and which in found and found[which][0].kind == estimation.EFFECT:
            one, x, sd = found[which]
            values[size.key] = min(max(one.value(x), size.low), size.high)
            deviation[size.key] = abs(one.slope(x)) * sd
    return replace(added, named=replace(added.named, values=values), deviation=deviation or added.deviation)


ALONE = "Without it no fit of these data converges, so that its errors have none to be held against."
"""Of a rung above one without figures."""


@dataclass(frozen=True, kw_only=True)
class AddedEffectOptions:
    """What `massline add` is asked beside a model and its data.

    Attributes
    ----------
    effect : ``ID[=VALUE]``
    fixed : whether it stays at its size
    alias_ok : whether an exact alias of what the model has may be added
    remarks : sentences that the rung's verdict ends with, of whoever asks for it
    """

    effect: str
    fixed: bool = False
    alias_ok: bool = False
    remarks: Sequence[str] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class AddResult:
    """What adding an effect came to.

    Attributes
    ----------
    at : where the model file stands now
    before, after : the rungs
    said : sentences
    study : the same data by the model with the effect
    """

    at: HistoryPosition
    before: Version
    after: Version
    said: tuple[str, ...]
    study: Study


def opened(asked: Options, effect: AddedEffectOptions, progress: Progress | None = None) -> tuple[Study, tuple[str, ...]]:
    """The study that an `effect` is to be added to, where nothing is named with the data that the ladder knows; and what is to
    be said of that.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    """
    require_band(asked.band)
    if asked.path.is_file():
        probe(asked.path)  # what cannot be written at the end is said before minutes are spent
    for folder in asked.effects_from:
        catalogue.load(folder)
    at = history.history_position(asked.path)
    with history.reminded(at.path):
        model = model_file.of_text(at.text, str(at.path))
    # Where the data are and what is held against what: as named, else as in the nearest rung downwards that has data
    path = () if at.below is None else at.ladder.path(at.below.number)
    known = next((one.conditions for one in reversed(path) if one.conditions.data), Conditions())
    paths = asked.data
    if not paths and known.data:
        paths = history.paths(known, at.path.parent, str(history.path_beside(at.path)))
    elif not paths and not model.tests:
        problem = "there is no data: the model has no ladder yet that knows any"
        raise BadInput("DATA", "", problem, "Name campaign folders behind EFFECT")
    data = read_data(paths, model, progress)
    like = Conditions() if asked.data else known
    now = Conditions(
        data=history.sources(paths, at.path.parent),
        hold_out=asked.hold_out or like.hold_out,
        band=asked.band or like.band,
        method=asked.method or like.method,
    )
    _effect(effect, at, model, data.campaigns)  # refused before spectra are made
    whole = replace(asked, data=paths, hold_out=now.hold_out, band=now.band, method=now.method)
    return Study.of(model, data, whole, progress), history.changed(known, now)


def _effect(
    asked: AddedEffectOptions, at: HistoryPosition, model: Model, campaigns: Sequence[Campaign]
) -> tuple[Added, tuple[str, ...]]:
    """The effect that is `asked`, and the keys of its sizes that are left open.

    Its channels are those of the `campaigns`; its places and parts are those of whatever article, as in a model file.

    Raises
    ------
    BadInput : see `read`; no body is left with it; a layout of the model file that cannot be changed.
    """
    channels = [channel for campaign in campaigns for channel in campaign.table.channels]
    accelerometers = dict.fromkeys(one.name for one in channels if one.quantity == "acceleration")
    forces = dict.fromkeys(one.name for one in channels if one.quantity != "acceleration")
    words = Vocabulary(accelerometers=tuple(accelerometers), forces=tuple(forces), places=None)
    if model.own:
        words = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)
    effect, left = read(asked.effect, model, words, fixed=asked.fixed)
    require_bodies(replace(model, effects=(*model.effects, effect)), campaigns)
    rewritten(at.text, (effect,), str(at.path))
    return effect, left


def added(study: Study, asked: AddedEffectOptions, progress: Progress | None = None) -> AddResult:
    """The rung that an effect leads to, written; the rung below it is evaluated and kept first where it was not yet.

    Raises
    ------
    BadInput, CheckFailed : see `candidate` and `judged`.
    """
    tell = progress or (lambda what, share: None)
    at = study.history
    with history.reminded(at.path):
        model = model_file.of_text(at.text, str(at.path))
    if _sized(model) != _sized(study.model):  # the file went on since the study was opened
        study = study.by(model)
    effect, left = _effect(asked, at, model, study.campaigns)
    if looked_at := set(replace(model, effects=(effect,)).positions) - set(study.model.positions):
        study = study.ready_at(sorted(looked_at))
    tell("looking for aliases", 0.0)
    chosen = candidate(effect, left, study, allowed=asked.alias_ok)
    try:
        at, known = grounded(at, study, tell)
    except CheckFailed as failed:
        # What is missing, or a mistake in the data, may be why nothing fits without it: the rung below has no figures then
        if at.rung is not None and at.rung.errors is not None:
            raise
        at = history.kept(at, replace(history.next_rung(at), settings=_settings(study.model)))
        known = (f"the model before cannot be fitted to these data, and its rung has no figures: {failed}",)
    before = at.rung
    if before is None:
        raise BadInput(str(at.path), "", "it was changed while it was evaluated", "Nothing is lost: give the command again")
    # The sizes at which its fit begins; data that are held out do not say where
    looking = study.problem([effect]), before.plain_offsets
    effect = starting_sizes(effect, left, *looking, lambda share: tell("looking where it is", share))
    parent = before if before.errors is not None else None
    after = judged(study.by(replace(model, effects=(*model.effects, effect))), parent, tell)
    rung = _next(at, before, after, replace(chosen, added=effect), asked, study)
    there = history.climbed(at, rung)
    new = next(one for one in reversed(there.ladder.rungs) if one.model == rung.model)
    said = [*study.left_out, *known, *study.on_several((effect,))]
    if there.rung is None or there.rung.number != new.number:
        told = "was changed while the fit ran and is left as it is"
        said.append(f"{there.path.name} {told}; `--go {new.number}` goes to the new rung")
    return AddResult(at=there, before=before, after=new, said=(*said, *history.conditions(there)), study=study.by(after.model))


def _sized(model: Model) -> list[tuple[str, dict[str, float], bool]]:
    return [(one.named.id, dict(one.named.values), one.fixed) for one in model.effects]


def conditions_of(study: Study) -> Conditions:
    """What is held against what, as a rung keeps it."""
    asked = study.asked
    sources = history.sources(asked.data, asked.path.parent)
    return Conditions(data=sources, hold_out=study.hold_out, band=asked.band, method=asked.spectra)


def grounded(
    at: HistoryPosition, study: Study, progress: Progress, *, ended: bool = True
) -> tuple[HistoryPosition, tuple[str, ...]]:
    """`at` on a rung that stands on the data of a `study`, evaluated and kept at once where there was none, and what is to be
    said; `ended` as in `judged`."""
    conditions = conditions_of(study)
    errors = None if at.rung is None or not at.rung.stands_on(conditions) else at.rung.errors
    if errors is not None and (errors.converged or not ended):
        return at, ()
    if at.rung is None or at.rung.errors is None:
        rung = history.next_rung(at)
        said = (f"{at.path.name} was edited by hand: that is a rung of its own",) if at.edited else ()
    else:
        rung = Version(number=len(at.ladder.rungs), parent=at.rung.number, cause=history.OTHER_DATA, model=at.text)
        said = (f"rung {at.rung.number} stands on other data or settings: the model is held against these first",)
    found = judged(study, None, lambda what, share: progress(f"the model before: {what}", share), ended=ended)
    return history.kept(at, replace(rung_with(rung, found), conditions=conditions, settings=_settings(study.model))), said


def _next(
    at: HistoryPosition, before: Version, of: EvaluatedModel, chosen: AddedEffect, asked: AddedEffectOptions, study: Study
) -> Version:
    """The rung of the effect that was added, with its verdict."""
    alias = chosen.alias
    bare = Version(
        number=len(at.ladder.rungs),
        parent=before.number,
        cause=history.ADDED,
        effect=chosen.added.named.id,
        model=rewritten(at.text, of.model.effects, str(at.path)),
        conditions=conditions_of(study),
        settings={
            **_settings(of.model),
            "asked": asked.effect,
            "fixed": chosen.added.fixed,
            "effects_from": list(study.asked.effects_from),
            "alias": None if alias is None else {"text": alias.text, "mixture": dict(alias.mixture), "size": alias.size},
        },
    )
    rung = rung_with(bare, of)
    old, new = before.errors, rung.errors
    rung = replace(rung, gain=new.log_evidence - old.log_evidence if old is not None and new is not None else None)
    told = tuple(verdict(before, rung, chosen.tolerances, chosen.nulls)) or (ALONE,)
    return replace(rung, verdict=(*told, *(sentence(one) for one in (*chosen.said, *asked.remarks))))


def _settings(model: Model) -> dict[str, object]:
    return {"article": model.article, "kind": model.kind}
