"""Many of what is nominally one article, each diagnosed by itself: which of them differs, by what, and how all scatter."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy import linalg, optimize, stats

from geometry import cache, parallel
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from identification import campaign_file
from validation.diagnose import candidates
from validation.diagnose.candidate_fits import fit_with, goodness_of_fit
from validation.diagnose.candidates import baseline
from validation.diagnose.diagnose import as_cause, diagnosed_once, ready
from validation.diagnose.diagnosis import ANY, UNKNOWN, Diagnosis, EffectEstimate, headline
from validation.effects import catalogue
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import MISTAKE
from validation.model.model import Added
from validation.output import entry, unwritten
from validation.study import Options, Study, is_test

FALSE_ALARM = 0.01
"""[probability] that any article of a fleet of equal ones is said to differ. Held by test_fleet.py."""

MOST_SIZES = 12
"""[count] of effects whose sizes are asked of every article: each costs a fit of each. Exercised by test_fleet.py."""

TOLD_APART = 1e-6
"""[share] of a contribution that those before it do not have, below which it is rounding. By definition."""

ERROR = "plain error of the model"

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


@dataclass(frozen=True, kw_only=True)
class Member:
    """One mounting of one article.

    Attributes
    ----------
    name : of its folder or file, from the folder of the fleet
    article : its serial number; else the folder that holds its mountings, else `name`
    laboratory : the place of the test, else its hardware; empty where neither is stated
    asked : the study of it
    """

    name: str
    article: str
    laboratory: str = entry(null="", default="")
    asked: Options = unwritten()

    @staticmethod
    def below(folder: Path, asked: Options) -> "tuple[Member, ...]":
        """Every campaign folder and test file below `folder`, each with the model and the other data that are `asked`.

        Raises
        ------
        BadInput : there is none.
        """
        own = {Path(asked.model).resolve(), *(Path(path).resolve() for path in asked.data)}
        found = [path.parent for path in folder.rglob(campaign_file.NAME)]
        inside = set(found)
        found += [path for path in folder.rglob("*.toml") if inside.isdisjoint(path.parents) and is_test(str(path))]
        listed = []
        for path in sorted(one for one in found if one.resolve() not in own):
            name = path.relative_to(folder)
            article, laboratory = str(name.parts[0] if len(name.parts) > 1 else name if path.is_dir() else name.stem), ""
            with suppress(BadInput, OSError):  # which its diagnosis says
                if path.is_dir():
                    said = campaign_file.read_description(path)
                    article, laboratory = said.serial_number or article, said.place or said.hardware
            of = replace(asked, data=(*asked.data, str(path)))
            listed.append(Member(name=name.as_posix(), article=article, laboratory=laboratory, asked=of))
        if not listed:
            problem = "there is no campaign folder and no test file below it"
            raise BadInput("--each", str(folder), problem, "Name the folder that holds one for each article")
        return tuple(listed)


@dataclass(frozen=True, eq=False, kw_only=True)
class MemberAnswer:
    """What was said of a member.

    Attributes
    ----------
    verdict : of `validation.diagnose.diagnosis.VERDICTS`; "refused" where there is none
    said : in one sentence
    accepted : ids of what is missing from the model
    error : [%] plain error of the model as it is; None where it refused
    sizes : of the effects that were found in any member, by their ids, SI
    """

    member: Member
    verdict: str
    said: str
    accepted: tuple[str, ...] = ()
    error: float | None = entry("error_percent", default=None)
    sizes: Mapping[str, EffectEstimate] = entry(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class NumberScatter:
    """How one number scatters over the articles that do not differ.

    Attributes
    ----------
    of : id of an effect, or `ERROR`
    unit : SI, "%" of an error
    middle : of these articles
    articles, mountings, laboratories : standard deviations of what each contributes; None where these data do not tell it from
        the others: with one mounting an article, `articles` is of both. What a measurement adds is in `mountings`
    stated : median of the standard deviations that the fits state, tolerances of the laboratory included; None of an error
    count : members
    """

    of: str
    unit: str
    middle: float
    articles: float | None
    mountings: float | None
    laboratories: float | None
    stated: float | None = None
    count: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Difference:
    """One number by which an article differs from the others.

    Attributes
    ----------
    article : which
    of : id of an effect, or `ERROR`; of what has no size the sentence of its diagnosis
    unit : SI; empty where there is no number
    value, middle : of the article, and of all; None where there is no number
    sigma : distance between them in standard deviations of an article among the others
    """

    article: str
    of: str
    unit: str = entry(null="", default="")
    value: float | None = None
    middle: float | None = None
    sigma: float | None = None


def diagnosed_each(
    studies: Iterable[Study | Options], *, processes: int = 0, scheduler: str = ""
) -> Iterator[tuple[int, Diagnosis | BadInput | CheckFailed]]:
    """The number of each study, from 0, with what is missing of it or why that cannot be said, as they are finished.

    What was diagnosed before by the same code is read from the cache of whoever did it.

    Parameters
    ----------
    studies : opened, or what is asked of one, which is then opened where it is diagnosed
    processes, scheduler : see `geometry.parallel.finished`
    """
    numbered = list(enumerate(studies))
    for (number, _), found in parallel.finished(_diagnosed, numbered, processes=processes, scheduler=scheduler):
        yield number, CheckFailed(str(found)) if isinstance(found, parallel.WorkerLost) else found


def _opened(of: Study | Options) -> Study:
    if isinstance(of, Study):
        return of.plain
    for folder in of.effects_from:
        catalogue.load(folder)
    return Study.of(*ready(of), of)


def _diagnosed(task: tuple[int, Study | Options]) -> Diagnosis | BadInput | CheckFailed:
    try:
        study = _opened(task[1])
        return diagnosed_once(study, only=study.asked.candidates, leave_out=study.asked.leave_out)
    except OSError as error:
        return BadInput(str(error.filename or ""), "", f"cannot be read: {error.strerror}", "Check its rights")
    except (BadInput, CheckFailed) as error:
        return error


@dataclass(frozen=True, kw_only=True)
class SizesAsked:
    """Of a member: what it lacks as its diagnosis wrote it, and ids of effects that were found in others."""

    member: Member
    accepted: tuple[str, ...]
    ids: tuple[str, ...]

    def sizes(self) -> Mapping[str, EffectEstimate]:
        """Sizes of effects in one member, each fitted on top of what it lacks; none of those that cannot be fitted there."""
        study = _opened(self.member.asked)

        def fitted() -> dict[str, EffectEstimate]:
            lacks = tuple(Added(named=parse(text, ANY)) for text in self.accepted)
            mistakes = tuple(replace(one, fixed=True) for one in lacks if FAMILIES[one.named.family].side == MISTAKE)
            right = study.by(replace(study.model, effects=(*study.model.effects, *mistakes)))
            at = baseline(right)
            for one in lacks:
                at = at if one in mistakes or FAMILIES[one.named.family].side == MISTAKE else fit_with(right, at, one)
            found = {}
            for id in self.ids:
                with suppress(BadInput, CheckFailed, IndexError):
                    there = fit_with(right, at, candidates.candidates(right, only=[id])[0])
                    cause = as_cause(there.effects[-1], there, 0.0, goodness_of_fit(there.fit, there.problem))
                    found[id] = cause.sizes[0]
            return found

        own = catalogue.code_of_families(study.asked.effects_from)
        with suppress(CheckFailed):  # what answers otherwise at another level has no linear fit
            found: dict[str, EffectEstimate] = cache.answer(fitted, "sizes", study, self.accepted, self.ids, own)
            return found
        return {}


@dataclass(frozen=True, eq=False, kw_only=True)
class Numbers:
    """One number of each of n members: the size of an effect, or the error of the model.

    Its scatter is that of independent contributions of article, laboratory and mounting, whose variances are those of largest
    restricted likelihood (Patterson and Thompson, Biometrika 58 (1971) 545). Whether one differs is asked before.

    Attributes
    ----------
    values : (n,)
    articles, laboratories : (n,) names
    """

    values: Array
    articles: Any
    laboratories: Any

    def different(self, numbers: int = 1) -> dict[str, float]:
        """Articles that lie farther from the others than chance lets any of them, with their distance in standard deviations.

        By the generalised extreme Studentised deviate (Rosner, Technometrics 25 (1983) 165), which several that differ do not
        hide from each other, of at most half of the articles.

        Parameters
        ----------
        numbers : how many are looked at, which share `FALSE_ALARM`
        """
        names = np.unique(self.articles)
        means = np.array([self.values[self.articles == one].mean() for one in names])
        n, left, taken, apart = len(names), list(range(len(names))), [], 0
        for k in range(1, (n - 1) // 2 + 1):
            rest = means[left]
            spread = float(np.std(rest, ddof=1))
            if spread <= TOLD_APART * float(np.max(np.abs(rest))):
                break
            farthest = int(np.argmax(np.abs(rest - rest.mean())))
            half = FALSE_ALARM / 2 / numbers  # all steps together raise twice the alarms of the first
            t = stats.t.isf(half / (2 * (n - k + 1)), n - k - 1)
            limit = (n - k) * t / np.sqrt((n - k - 1 + t**2) * (n - k + 1))
            apart = k if abs(rest[farthest] - rest.mean()) > limit * spread else apart
            taken.append(left.pop(farthest))
        others = np.delete(means, taken[:apart])
        return {str(names[k]): float((means[k] - others.mean()) / np.std(others, ddof=1)) for k in taken[:apart]}

    def contributions(self) -> dict[str, float | None]:
        """Standard deviations of what articles, mountings and laboratories contribute, by these names.

        None where these members do not tell one from the others. With one mounting an article what is told is of both, and stands
        under "articles".
        """
        values, n = self.values, len(self.values)
        told: dict[str, float | None] = dict.fromkeys(("articles", "mountings", "laboratories"))
        centred, shapes = np.eye(n) - 1 / n, {"mountings": np.eye(n)}
        kept = [(centred @ shapes["mountings"] @ centred).ravel()]
        for name, of in (("articles", self.articles), ("laboratories", self.laboratories)):
            shape = (np.asarray(of)[:, None] == np.asarray(of)[None, :]).astype(float)
            seen = (centred @ shape @ centred).ravel()
            left = seen - np.column_stack(kept) @ np.linalg.lstsq(np.column_stack(kept), seen, rcond=None)[0]
            if np.linalg.norm(left) > TOLD_APART * np.linalg.norm(shape):
                kept.append(seen)
                shapes[name] = shape
        size = float(np.std(values))
        if n > 1 and size > 0:
            y = (values - np.mean(values)) / size

            def cost(variances: Array) -> tuple[float, Array]:
                """Minus the logarithm of the restricted likelihood, and its derivatives."""
                V = sum(v * shape for v, shape in zip(variances, shapes.values(), strict=True)) + TOLD_APART**2 * np.eye(n)
                inverse = linalg.inv(V)
                ones = inverse.sum(axis=1)
                P = inverse - np.outer(ones, ones) / ones.sum()
                logarithms = np.linalg.slogdet(V)[1] + np.log(ones.sum())
                slope = [np.vdot(P, shape) - y @ P @ shape @ P @ y for shape in shapes.values()]
                return 0.5 * float(logarithms + y @ P @ y), 0.5 * np.array(slope)

            begin = np.full(len(shapes), 1 / len(shapes))
            tight = {"ftol": 1e-14, "gtol": 1e-9, "maxiter": 1000}
            best = optimize.minimize(cost, begin, jac=True, method="L-BFGS-B", bounds=[(0.0, None)] * len(shapes), options=tight)
            told |= {name: size * float(np.sqrt(v)) for name, v in zip(shapes, best.x, strict=True)}
        elif n > 1:
            told |= dict.fromkeys(shapes, 0.0)
        if "articles" not in shapes:
            told["articles"], told["mountings"] = told["mountings"], None
        return told


@dataclass(frozen=True, eq=False, kw_only=True)
class Fleet:
    """The answer.

    Attributes
    ----------
    members : in the order of their names
    differences : by which articles differ, the farthest first
    scatter : of every number, without the articles that differ by it
    remarks : what was left out
    """

    members: tuple[MemberAnswer, ...]
    differences: tuple[Difference, ...]
    scatter: tuple[NumberScatter, ...]
    remarks: tuple[str, ...] = entry("warnings", default=())

    @property
    def articles(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(dict.fromkeys(one.member.article for one in self.members))

    @staticmethod
    def of(answers: Sequence[MemberAnswer], ids: Sequence[str], remarks: Sequence[str] = ()) -> "Fleet":
        """What follows from the `answers`, of which the effects `ids` have sizes."""
        differences: list[Difference] = []
        scattered: list[NumberScatter] = []
        for of in (*ids, ERROR):
            own = [one for one in answers if (of in one.sizes if of != ERROR else one.error is not None)]
            sizes = [one.sizes[of] for one in own if of != ERROR]
            values = np.array([one.value for one in sizes] if of != ERROR else [one.error for one in own], dtype=float)
            if len(values) == 0:
                continue
            unit = sizes[0].unit if sizes else "%"
            articles = np.array([one.member.article for one in own])
            laboratories = np.array([one.member.laboratory for one in own])
            compared = Numbers(values=np.log(values) if of == ERROR else values, articles=articles, laboratories=laboratories)
            far = compared.different(len(ids) + 1)
            alike = ~np.isin(articles, list(far))
            middle = float(np.mean(values[alike]))
            for article, sigma in far.items():
                value = float(np.mean(values[articles == article]))
                differences.append(Difference(article=article, of=of, unit=unit, value=value, middle=middle, sigma=sigma))
            rest = Numbers(values=values[alike], articles=articles[alike], laboratories=laboratories[alike])
            told = rest.contributions()
            stated = float(np.median([(one.high - one.low) / 2 / stats.norm.ppf(0.95) for one in sizes])) if sizes else None
            scattered.append(NumberScatter(of=of, unit=unit, middle=middle, **told, stated=stated, count=int(np.sum(alike))))
        # What has no size: mistakes, and what nobody can name, where most of the others have neither
        names = tuple(dict.fromkeys(one.member.article for one in answers))
        odd: dict[str, dict[str, str]] = {}
        for one in answers:
            unsized = [id for id in one.accepted if id not in ids]
            for what in (*unsized, *([UNKNOWN] if one.verdict == UNKNOWN else [])):
                odd.setdefault(what, {})[one.member.article] = one.said
        for said in (of for of in odd.values() if 2 * len(of) < len(names)):
            differences += [Difference(article=article, of=text) for article, text in said.items()]
        ordered = sorted(differences, key=lambda one: np.inf if one.sigma is None else -abs(one.sigma))
        return Fleet(members=tuple(answers), differences=tuple(ordered), scatter=tuple(scattered), remarks=tuple(remarks))

    @staticmethod
    def diagnosed(
        every: Sequence[Member], *, processes: int = 0, scheduler: str = "", progress: Progress | None = None
    ) -> "Fleet":
        """Which of the articles of `every` member differs, by what, and how they scatter.

        Parameters
        ----------
        processes, scheduler : see `geometry.parallel.finished`

        Raises
        ------
        CheckFailed : nothing could be said of any of them.
        """
        tell = progress or (lambda what, share: None)
        found: dict[int, Diagnosis | BadInput | CheckFailed] = {}
        for number, answer in diagnosed_each([one.asked for one in every], processes=processes, scheduler=scheduler):
            found[number] = answer
            tell("diagnosing each", len(found) / len(every))
        diagnoses = {k: one for k, one in sorted(found.items()) if isinstance(one, Diagnosis)}
        if not diagnoses:
            raise CheckFailed(f"Of none of {len(every)} could anything be said; of {every[0].name}: {found[0]}")
        in_members: dict[str, int] = {}
        for of in diagnoses.values():
            for one in of.accepted:
                sized = bool(one.named.fitted_sizes) and FAMILIES[one.named.family].side != MISTAKE
                in_members[one.id] = in_members.get(one.id, 0) + sized
        ids = sorted((id for id, count in in_members.items() if count), key=lambda id: (-in_members[id], id))
        asked = []
        for k, of in diagnoses.items():
            own = {one.id for one in of.accepted}
            wanted = tuple(id for id in ids[:MOST_SIZES] if id not in own)
            if wanted:
                asked.append(SizesAsked(member=every[k], accepted=tuple(str(one.named) for one in of.accepted), ids=wanted))
        others: dict[str, Mapping[str, EffectEstimate]] = {}
        made = parallel.finished(SizesAsked.sizes, asked, processes=processes, scheduler=scheduler)
        for done, (task, sizes) in enumerate(made, start=1):
            others[task.member.name] = {} if isinstance(sizes, parallel.WorkerLost) else sizes
            tell("sizes of what was found", done / len(asked))

        def answered(k: int, member: Member) -> MemberAnswer:
            of = found[k]
            if not isinstance(of, Diagnosis):
                return MemberAnswer(member=member, verdict="refused", said=str(of))
            return MemberAnswer(
                member=member,
                verdict=of.verdict,
                said=headline(of),
                accepted=tuple(one.id for one in of.accepted),
                error=of.before.plain.percent,
                sizes={**others.get(member.name, {}), **{one.id: one.sizes[0] for one in of.accepted if one.sizes}},
            )

        answers = [answered(k, one) for k, one in enumerate(every)]
        more = len(ids) - MOST_SIZES
        left = (f"{more} more effects were found in few, and their sizes asked of nobody else",) if more > 0 else ()
        return Fleet.of(answers, ids[:MOST_SIZES], left)
