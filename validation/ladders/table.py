"""The pages of `massline add`, `massline ladder` and `massline undo`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from geometry.arrays import Array
from validation.ladders.climbing import Standing
from validation.ladders.nouns import SHOWN, Body, Errors, Rung, Size
from validation.ladders.verdict import percent, unit
from validation.rows import NONE, rounded
from validation.statement import QUANTITIES
from validation.tables.grid import Grid, aligned

HERE, NOT_HERE = "→ ", "  "
"""Before the rung on which the model stands, and before the others."""

ERRORS: tuple[tuple[str, Callable[[Errors], str]], ...] = (
    ("nominal error", lambda e: percent(e.nominal)),
    ("plain error, fitted data", lambda e: percent(e.plain)),
    ("plain error, held out", lambda e: percent(e.held_out)),
    ("nominal error, held out", lambda e: percent(e.held_out_nominal)),
    ("fitted: chi² per degree of freedom", lambda e: f"{e.chi2_per_dof:.3g}"),
    ("fitted: sum z² of the tolerances, and what is due", lambda e: _price(e)),
)


def of_step(before: Rung, after: Rung) -> list[Grid]:
    """The four errors before and after, the sizes of all effects, and how far each article is from its reference."""
    return [_errors(before, after), *_sizes(after), *(_distance(before, after, body) for body in after.bodies)]


def _errors(before: Rung, after: Rung) -> Grid:
    cells = [[tell(one.errors) if one.errors else NONE for one in (before, after)] for _, tell in ERRORS]
    gain = ("evidence gained", "", NONE if after.gain is None else f"{after.gain:+.1f} nats")
    columns = [aligned(tuple(column)) for column in zip(*cells, gain[1:], strict=True)]
    names = (*(name for name, _ in ERRORS), gain[0])
    return Grid(header=("", f"rung {before.number}", f"rung {after.number}"), lines=tuple(zip(names, *columns, strict=True)))


def _sizes(rung: Rung) -> list[Grid]:
    lines = tuple(line for name, sizes in rung.effects.items() for line in _lines(name, sizes))
    cells = aligned(tuple(cell for _, cell in lines))
    named = tuple((name, cell) for (name, _), cell in zip(lines, cells, strict=True))
    return [Grid(header=("effects of the model", "size ± one standard deviation"), lines=named)] if named else []


def _lines(name: str, sizes: Sequence[Size]) -> list[tuple[str, str]]:
    """A line a size; one that says that there is none, of an effect that is there or not."""
    return [(_label(name, size), _size(size)) for size in sizes] or [(name, NONE)]


def _label(name: str, size: Size) -> str:
    return f"{name} {size.key}".rstrip()


def _size(size: Size) -> str:
    spread = "" if size.deviation is None else f" ± {size.deviation:.2g}"
    return f"{size.value:.5g}{spread}{unit(size.unit)}"


def _distance(before: Rung, after: Rung, body: Body) -> Grid:
    earlier = next((one for one in before.bodies if one.article == body.article), None)
    rungs = [(before, earlier), (after, body)] if earlier is not None else [(after, body)]
    return distances(body.article, [(one.number, of) for one, of in rungs if of is not None])


def distances(article: str, bodies: Sequence[tuple[int, Body]]) -> Grid:
    """How far the identified inertia of `article` lies from the model's, rung by rung: in mm or per cent, and in sigmas."""
    header = ["identified - reference"]
    columns: list[tuple[str, ...]] = [tuple(quantity.label for quantity in QUANTITIES)]
    for number, body in bodies:
        header += [f"{article}, rung {number}", "σ"]
        columns.append(aligned(tuple(f"{one:+.3g} {name}" for one, name in zip(body.shown, SHOWN, strict=True))))
        columns.append(aligned(tuple(f"{one:+.1f}" for one in body.sigmas)))
    return Grid(header=tuple(header), lines=tuple(zip(*columns, strict=True)))


def values(article: str, bodies: Sequence[tuple[int, Body]]) -> Grid:
    """The identified inertia of `article` rung by rung with its 95 % intervals, and the model's own on the last."""
    header = ["identified ± 95 %"]
    columns: list[tuple[str, ...]] = [tuple(f"{quantity.label} [{quantity.unit}]" for quantity in QUANTITIES)]
    for number, body in bodies:
        header.append(f"{article}, rung {number}")
        columns.append(aligned(tuple(_value(body, k) for k in range(len(QUANTITIES)))))
    header.append("reference")
    last = bodies[-1][1]
    columns.append(aligned(tuple(rounded(*_printed(last.reference, last.half_width, k)) for k in range(len(QUANTITIES)))))
    return Grid(header=tuple(header), lines=tuple(zip(*columns, strict=True)))


def _value(body: Body, k: int) -> str:
    value, half = _printed(body.values, body.half_width, k)
    return f"{rounded(value, half)} ± {rounded(half, half)}"


def _printed(values: Array, half_width: Array, k: int) -> tuple[float, float]:
    """One of the ten and half of its interval in the unit in which both are printed."""
    return float(values[k]) * QUANTITIES[k].per_si, float(half_width[k]) * QUANTITIES[k].per_si


def of_ladder(at: Standing) -> list[Grid]:
    """All rungs as a tree, and of every article what was identified and its way to the reference along the rungs to here."""
    return [_tree(at), *_way(at)]


def _tree(at: Standing) -> Grid:
    here = None if at.rung is None else at.rung.number
    rows = [(_place(one, branch, here), *_figures(one)) for branch, one in at.ladder.tree()]
    columns = list(zip(*rows, strict=True))
    header = ("  rung", "size", "nominal", "plain", "held out", "chi²/dof", "sum z²", "evidence")
    shown = [columns[0], *(aligned(column) for column in columns[1:])]
    return Grid(header=header, lines=tuple(zip(*shown, strict=True)))


def _place(one: Rung, branch: str, here: int | None) -> str:
    return f"{HERE if one.number == here else NOT_HERE}{branch}{one.number} {one.title}"


def _figures(one: Rung) -> tuple[str, ...]:
    sizes = one.effects.get(one.effect, ())
    size = _size(sizes[0]) if len(sizes) == 1 else ", ".join(f"{each.key} {each.value:.4g}" for each in sizes) or NONE
    return (size, *_told(one.errors), NONE if one.gain is None else f"{one.gain:+.1f}")


def _told(errors: Errors | None) -> tuple[str, ...]:
    if errors is None:
        return (NONE,) * 5
    percents = [percent(value) for value in (errors.nominal, errors.plain, errors.held_out)]
    return (*percents, f"{errors.chi2_per_dof:.3g}", _price(errors))


def _price(errors: Errors) -> str:
    return f"{errors.tolerance_z2:.3g} of {errors.due_z2:.0f}"


def _way(at: Standing) -> list[Grid]:
    below = at.below
    path = () if below is None else at.ladder.path(below.number)
    articles = dict.fromkeys(body.article for one in path for body in one.bodies)
    found = []
    for article in articles:
        bodies = [(one.number, body) for one in path for body in one.bodies if body.article == article]
        found += [values(article, bodies), distances(article, bodies)]
    return found


def notes(at: Standing) -> Iterator[str]:
    """What must be known to read the tables, and what is odd."""
    yield "Nominal: as it stands. Plain: tolerances of the measurement not fitted. Per cent of the force read. Evidence in nats."
    yield "Sum z²: of the tolerances, all fitted, and what is due where nothing is wrong."
    yield "Identified: CoG from the article's own origin, moments and products about it. Reference: the model with its effects."
    yield "Less reference: mass, moments in per cent, products in per cent of √(Θii Θjj), CoG in mm; σ: one standard deviation."
    yield from conditions(at)


def conditions(at: Standing) -> Iterator[str]:
    """What is odd about where the model stands."""
    if at.edited and at.below is not None:
        yield f"{at.path.name} was edited by hand since rung {at.below.number}; the next `massline add` makes a rung of it."
    for one in at.ladder.rungs:
        if one.errors is None:
            yield f"Rung {one.number} was put aside before it was held against data."
