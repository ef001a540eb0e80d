"""The way of a command through the modules, as data:

    python -m tools.way --until validation.estimation.fit:fit massline diagnose MODEL DATA ...

A reader opens a function when it is called for the first time. In that order of reading this counts the functions and their
modules, and how often the reader goes back into a module that he had left. What runs while a module is imported is not read.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
from types import CodeType, FrameType

ROOMS = ("geometry", "fem", "identification", "validation", "massline")
HIDDEN = ("<module>", "<lambda>", "<listcomp>", "<dictcomp>", "<setcomp>", "<genexpr>")


class Reached(BaseException):
    """The function at which the way ends was called; no `except Exception` on the way may stop it."""


class Way:
    """The functions of a run in the order of their first call, each as (module, name)."""

    def __init__(self, begin: str, until: str) -> None:
        self.begin, self.until = begin, until
        self.began = not begin
        self.importing = 0
        self.seen: set[CodeType] = set()
        self.functions: list[tuple[str, str]] = []

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if code.co_name == "<module>":  # nested imports are counted in and out
            self.importing += {"call": 1, "return": -1}.get(event, 0)
        module = str(frame.f_globals.get("__name__", ""))
        if event != "call" or self.importing or module.split(".")[0] not in ROOMS or code in self.seen:
            return
        name = f"{module}:{code.co_qualname}"
        self.began = self.began or name == self.begin
        if not self.began or code.co_name in HIDDEN:
            return
        self.seen.add(code)
        self.functions.append((module, code.co_qualname))
        if name == self.until:
            raise Reached

    def modules(self, room: str = "") -> list[str]:
        """Those of `room` in the order of reading, an entry for each change of module."""
        read = [module for module, _ in self.functions if module.startswith(room)]
        return [module for number, module in enumerate(read) if number == 0 or read[number - 1] != module]

    def said(self, room: str = "") -> str:
        """How many modules of `room` are read, and how often the reader goes back into one."""
        modules = self.modules(room)
        return f"{len(set(modules))} modules, {len(modules) - len(set(modules))} times back"


def walked(words: list[str], begin: str, until: str) -> Way:
    """`massline WORDS ...` run in this process as far as `until`, its output dropped."""
    from validation.cli import main

    run = getattr(main, "run", None) or sys.modules["validation.cli"].run  # before the move the command line was one module
    way = Way(begin, until)
    sys.setprofile(way)
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            run(words)
    except Reached:
        pass
    finally:
        sys.setprofile(None)
    return way


def main() -> None:
    parser = argparse.ArgumentParser(description="The way of a command through the modules of massline.")
    parser.add_argument("--begin", default="", help="MODULE:FUNCTION where it begins to be counted")
    parser.add_argument("--until", default="", help="MODULE:FUNCTION where it ends")
    parser.add_argument("--list", action="store_true", help="print every change of module")
    parser.add_argument("massline", choices=["massline"])
    parser.add_argument("words", nargs=argparse.REMAINDER)
    asked = parser.parse_args()
    way = walked(asked.words, asked.begin, asked.until)
    if asked.list:
        sys.stdout.write("\n".join(way.modules()) + "\n")
    sys.stdout.write(f"{len(way.functions)} functions\n{way.said()}\n{way.said('validation')} of validation\n")


if __name__ == "__main__":
    main()
