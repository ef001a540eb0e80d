"""The page of a window: its template, what it shows at first, and what each of its buttons does."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any

from validation.app import climbing, comparing, jobs, opening, saving, shell, structure, trying
from validation.app.asked import Opened
from validation.app.bench import Bench
from validation.app.keeping import keep
from validation.desk import jobs as desk_jobs
from validation.plots.overlay import LOADS, MOTIONS, SIGNS, entry, unit

PARTS = ("open", "work", "scene", "standing", "missing", "effect", "ladder")
"""Of the template, each replacing its name in capitals."""

WIDE = "($vuetify.display.width >= 1700)"
"""When the structure has room of its own, as in massline.css."""

SCHEMES = {"system": "light", "light": "dark", "dark": "system"}
"""What follows what, when the button for the colours is pressed."""

COLOURS = {
    "light": {"primary": "#20507f", "surface": "#ffffff", "background": "#eef1f5"},
    "dark": {"primary": "#8fc1f3", "surface": "#171b22", "background": "#0f1217", "on-primary": "#0f1217"},
}

Handler = Callable[..., Awaitable[None]]


def build(server: Any, folder: Path, opened: Opened) -> Bench:
    """Lay out the page of `server`, and let it begin when the server runs."""
    from trame.ui.vuetify3 import VAppLayout

    files, name = {shell.SERVED: str(shell.WWW)}, shell.SERVED
    scripts = [f"{name}/{one}.js" for one in ("keys", "massline")]
    own = {"serve": files, "scripts": scripts, "styles": [f"{name}/massline.css"], "vue_use": ["massline"]}
    server.enable_module(own)
    bench = Bench(state=server.state, folder=folder, opened=opened)
    server.state.update(first_state())
    themes = {name: {"dark": name == "dark", "colors": colours} for name, colours in COLOURS.items()}
    with VAppLayout(server, vuetify_config={"theme": {"themes": themes}}) as layout:
        layout.root.clear()
    server.state.trame__template_main = template()
    server.state.trame__template_error = ENDED
    for name, handler in HANDLERS.items():
        server.controller.trigger(name)(_heard(bench, handler))
    server.controller.on_server_ready.add(lambda **_: bench.begin(opening.first(bench)))
    return bench


def template() -> str:
    """The whole page, of its parts."""
    folder = shell.WWW / "page"
    text = (folder / "frame.html").read_text(encoding="utf-8")
    for part in PARTS:
        text = text.replace(part.upper(), (folder / f"{part}.html").read_text(encoding="utf-8"))
    return text.replace("WIDE", WIDE)


ENDED = """<main class="begins" role="alert"><h1>The workbench has ended</h1><p>Its process was stopped, or the machine slept.
Load the page again; if nothing answers, start <code>massline app</code> again.</p></main>"""
"""In place of the page when its server is gone."""


def first_state() -> dict[str, Any]:
    """What an empty page shows; every name that the template asks for is here."""
    return {
        "trame__title": "massline",
        "trame__favicon": None,
        "screen": "open",
        "title": "",
        "scheme": "system",
        "dark": False,
        "job": None,
        "opening": False,
        "failure": "",
        "ready": None,
        "unsaved": False,
        "examples": opening.listed(),
        "models": [],
        "model_path": "",
        "data_paths": "",
        "hold_out": "",
        "band": "",
        "faults": {"model": [], "data": [], "options": []},
        "compared": False,
        "errors": [],
        "before": {},
        "worst": [],
        "remarks": [],
        "campaigns": [],
        "campaign": "",
        "signs": list(SIGNS),
        "entries": [[_entry(i, j) for j in range(6)] for i in range(6)],
        "peaks": [["" for _ in range(6)] for _ in range(6)],
        "tints": [[0 for _ in range(6)] for _ in range(6)],
        "load": 2,
        "motion": 2,
        "marked": None,
        "fig_overlay": {},
        "live": None,
        "fig_map": {},
        "map_kind": "channels",
        "runs": [],
        "run": -1,
        "modes": [],
        "mode": structure.AT_REST,
        "view": "",
        "view_label": "",
        "view_note": "",
        "view_far": "",
        "tab": "structure",
        "part": "fails",
        "big": "",
        "verdict": None,
        "ranking": [],
        "effects": [],
        "effect": None,
        "rungs": [],
        "undoable": False,
        "step": "",
        "fig_ladder": None,
        "fig_inertia": None,
    }


async def _dark(bench: Bench, dark: bool) -> None:
    if bench.state.dark != bool(dark):
        bench.state.dark = bool(dark)
        bench.state.flush()
        if bench.compared is not None:
            await comparing.redrawn(bench)


async def _scheme(bench: Bench) -> None:
    bench.state.scheme = SCHEMES[bench.state.scheme]


async def _tab(bench: Bench, name: str) -> None:
    bench.state.tab = str(name)


async def _part(bench: Bench, name: str) -> None:
    bench.state.part = str(name)


async def _enlarge(bench: Bench, name: str) -> None:
    bench.state.big = "" if bench.state.big == name else str(name)


async def _seen(bench: Bench) -> None:
    bench.state.failure, bench.state.ready = "", None


async def _another(bench: Bench) -> None:
    opening.another(bench)


async def _compare(bench: Bench) -> None:
    from validation.app import working

    jobs.start(bench, desk_jobs.COMPARE, working.stands)


async def _diagnose(bench: Bench) -> None:
    from validation.app import diagnosing

    jobs.start(bench, desk_jobs.DIAGNOSE, diagnosing.shown)


HANDLERS: Mapping[str, Handler] = {
    "dark": _dark,
    "scheme": _scheme,
    "tab": _tab,
    "part": _part,
    "enlarge": _enlarge,
    "seen": _seen,
    "another": _another,
    "example": opening.example,
    "open": opening.paths,
    "cancel": jobs.cancel,
    "compare": _compare,
    "entry": comparing.entry,
    "marked": comparing.marked,
    "cell": comparing.cell,
    "spot": comparing.spot,
    "campaign": comparing.campaign,
    "map": comparing.show_map,
    "run": comparing.show_run,
    "mode": structure.mode,
    "diagnose": _diagnose,
    "effect": trying.chosen,
    "drag": trying.drag,
    "size": trying.size,
    "add": climbing.add,
    "undo": climbing.undo,
    "rung": climbing.go,
    "report": saving.report,
    "figures": saving.figures,
}
"""By the name under which the template triggers it."""


def _heard(bench: Bench, handler: Handler) -> Callable[..., Awaitable[None]]:
    async def heard(*arguments: Any) -> None:
        await bench.told(handler(bench, *arguments))
        if handler is not trying.drag:  # which keeps what it comes to at rest
            keep(bench)

    return heard


def _entry(load: int, motion: int) -> str:
    return f"{entry(load, motion)}: {LOADS[load]} by {MOTIONS[motion]}, in {unit(load, motion)}"
