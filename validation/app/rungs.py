"""The ladder as the page shows it: rungs with their errors, the fall, and identified inertia on its way."""

from __future__ import annotations

from typing import Any

from validation.app import leaving
from validation.app.bench import Bench
from validation.app.figures import as_state
from validation.desk import climbing
from validation.ladders.climbing import Standing
from validation.ladders.nouns import Body, Rung
from validation.plots.inertia import identified_inertia
from validation.plots.ladder import falling_errors, way_to

LOW = 290
"""Least height of a figure [pixels]; the page gives it what there is."""

HEADINGS = {
    "mass and moments about the CoG [%]": "mass and moments<br>about the CoG [%]",
    "products about the CoG [% of √(Θii Θjj)]": "products about the CoG<br>[% of √(Θii Θjj)]",
}
"""Of the inertia, in two lines."""

SHORTER = {
    "plain, fitted data": "plain",
    "plain, held out": "held out",
    "χ² per degree of freedom": "χ² per dof",
    "z² of the tolerances over what is due": "z² over due",
}
"""Names in the legend."""

BESIDE = 4
"""Rungs whose inertia is drawn, the last ones."""


async def shown(bench: Bench) -> None:
    """Bring rungs, falling errors and identified inertia to the ladder."""
    if bench.desk is None:
        return
    state, at = bench.state, await bench.away(climbing.ladder, bench.desk)
    state.rungs = [_rung(one, at) for one in reversed(at.ladder.rungs)]
    state.before = _before(at)
    state.unsaved = leaving.unsaved(bench.desk)
    state.undoable = at.below is not None and at.below.parent is not None
    state.step = _step(at)
    dark = bool(state.dark)
    fallen = [one for one in at.ladder.rungs if one.errors is not None]
    state.fig_ladder = await bench.away(lambda: _fall(at, dark)) if fallen else None
    bodies = _bodies(at)
    state.fig_inertia = await bench.away(lambda: _inertia(bodies, dark)) if bodies else None


def _fall(at: Standing, dark: bool) -> dict[str, Any]:
    """With a legend in fewer words: a panel is narrower than a page."""
    figure = falling_errors(at, dark=dark)
    figure.for_each_trace(lambda one: one.update(name=SHORTER.get(one.name, one.name)))
    figure.update_layout(margin={"b": 28, "l": 54})
    figure.update_yaxes(title_font_size=11, tickfont_size=11)
    return _untitled(figure, 60)


def _inertia(bodies: dict[str, Body], dark: bool) -> dict[str, Any]:
    """With its headings in two lines: a panel is narrower than a page."""
    figure = identified_inertia(bodies, dark=dark)
    for heading, lines in HEADINGS.items():
        figure.update_annotations(text=lines, font_size=11, selector={"text": heading})
    return _untitled(figure, 78)


def _untitled(figure: Any, top: int) -> dict[str, Any]:
    """Without its title, which the tab above it says, in a low panel; `top` [pixels] are left for a legend at the upper edge."""
    legend = {"yref": "container", "y": 1.0, "yanchor": "top", "font": {"size": 11}}
    figure.update_layout(title_text="", height=LOW, margin_t=top, legend=legend)
    return as_state(figure)


def _rung(one: Rung, at: Standing) -> dict[str, Any]:
    errors = one.errors
    told = "no figures yet"
    if errors is not None:
        held = "" if errors.held_out is None else f", held out {errors.held_out:.3g} %"
        told = f"plain {errors.plain:.3g} %{held}, χ² {errors.chi2_per_dof:.2f}, tolerances {errors.tolerance_z2:.0f}"
    return {
        "number": one.number,
        "title": one.title,
        "errors": told,
        "plain": None if errors is None else errors.plain,
        "verdict": " ".join(one.verdict),
        "here": at.rung is not None and at.rung.number == one.number,
    }


def _before(at: Standing) -> dict[str, str]:
    """The errors of the rung below, by the names that a comparison gives them."""
    if at.rung is None or at.rung.parent is None or (errors := at.ladder.rung(at.rung.parent).errors) is None:
        return {}
    found = {
        "nominal error": f"{errors.nominal:.3g} %",
        "plain error": f"{errors.plain:.3g} %",
        "fitted error": f"χ² {errors.chi2_per_dof:.3g}, z² {errors.tolerance_z2:.3g}",
    }
    return found if errors.held_out is None else found | {"held-out error": f"{errors.held_out:.3g} %"}


def _step(at: Standing) -> str:
    """What the last step did."""
    if at.rung is None or not at.rung.verdict:
        return ""
    return " ".join(at.rung.verdict)


def _bodies(at: Standing) -> dict[str, Body]:
    """The first article's identified inertia on each rung of the way."""
    found = {f"{one.number} {one.title}": one.bodies[0] for one in way_to(at) if one.bodies}
    return dict(list(found.items())[-BESIDE:])
