"""What a pattern or a route refuses, said of the option that asked for it, with advice that can be typed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fem.base_excitation.rig import Rig
from geometry.errors import BadInput
from validation.excitation.asked import BAND, EXUDYN, HIGHEST_RATE, Question

if TYPE_CHECKING:
    from fem.base_excitation.patterns import Pattern
    from validation.excitation.rig import Mounted

OF_PATTERN = {
    "start": ("--band", ""),
    "stop": ("--band", ""),
    "rate": ("--octaves-per-minute", "Sweep slower, or start higher with --band"),
    "duration": ("--duration", "Drive longer, or start higher with --band"),
    "level": ("--level", ""),
    "rms": ("--level", ""),
    "seed": ("--seed", ""),
}
"""Option and advice by the field of a pattern; no advice where the pattern's own can be followed."""

OF_RIG = {"flange": "--flange", "struts.stiffness": "--cable", "struts.damping": "--damper", "frictions": "--friction"}
"""Option by how the field of a rig begins."""

SOFTER = 0.9
"""Share of the rig's highest frequency below which it falls without the attachment that is to blame for it."""


def of_pattern(error: BadInput) -> BadInput:
    """`error` of a pattern that could not be made."""
    option, remedy = OF_PATTERN.get(error.field.partition(".")[0], ("--pattern", ""))
    return BadInput(source=option, problem=error.problem, remedy=remedy or error.remedy)


def of_rig(error: BadInput) -> BadInput:
    """`error` of a rig that cannot be built; others pass unchanged."""
    option = next((option for field, option in OF_RIG.items() if error.source == "rig" and error.field.startswith(field)), "")
    return BadInput(source=option, problem=error.problem, remedy=error.remedy) if option else error


def of_record(error: BadInput, pattern: Pattern, question: Question) -> BadInput:
    """`error` of a record whose rate is too low for `pattern`."""
    from fem.base_excitation.decimation import PASS

    needed = float(np.ceil(2 * pattern.highest / PASS))
    option = "--rate" if question.drive.band == BAND else "--band"
    faster = f"Record at --rate {needed:.0f} or more, or stop" if needed <= HIGHEST_RATE else "Stop"
    return BadInput(source=option, problem=error.problem, remedy=f"{faster} lower with --band")


def of_route(error: BadInput, question: Question, mounted: Mounted, followed: float) -> BadInput:
    """`error` of a route.

    Parameters
    ----------
    followed : [Hz] of a mode that the step follows at a step a sample
    """
    if error.source.startswith("--"):
        return error
    match error.field:
        case "sampling_rate":
            return _modes(question, mounted, followed)
        case "subdivision":
            return _stiff(error, question, mounted, followed)
        case "displacement":
            return BadInput(source="--level", problem=error.problem, remedy=error.remedy)
        case "":
            remedy = "Record at a lower --rate, or make the run shorter"
            return BadInput(source="--rate", problem=error.problem, remedy=remedy)
    return of_rig(error)


def _modes(question: Question, mounted: Mounted, followed: float) -> BadInput:
    """More modes than the step follows."""
    from fem.base_excitation.linear import COARSEST

    kept = mounted.rig.article.kept
    count, last = int(np.sum(kept <= followed)), float(kept.max())
    problem = f"the step follows modes up to {followed:.4g} Hz, {count} of those, found {len(kept)} up to {last:.4g} Hz"
    fewer = f"Write --modes {count}, or leave it out" if count else "Leave it out"
    faster = COARSEST * last
    more = f", or record at --rate {np.ceil(faster):.0f}" if faster <= HIGHEST_RATE and question.route != EXUDYN else ""
    return BadInput(source="--modes", problem=problem, remedy=f"{fewer}: the others then answer statically{more}")


def _stiff(error: BadInput, question: Question, mounted: Mounted, followed: float) -> BadInput:
    """Something too stiff for exudyn's step: the attachment without which the highest frequency falls most."""
    from fem.flexible_body.driven_base.steps import highest

    rig = mounted.rig
    found = {option: highest(other) for option, other in _without(rig).items()}
    option = min(found, key=lambda name: found[name], default="")
    if not option or found[option] > SOFTER * highest(rig):
        if question.every_mode and rig.article.kept.max(initial=0.0) > followed:
            return _modes(question, mounted, followed)
        option, remedy = "--modes", "Keep fewer"
    else:
        remedy = "Make the part lighter" if option == "--friction" else "Make it softer, leave it out"
    other = ", or take --route linear" if rig.linear else ""
    return BadInput(source=option, problem=f"it makes exudyn's steps too short: {error.problem}", remedy=f"{remedy}{other}")


def _without(rig: Rig) -> dict[str, Rig]:
    """`rig` without what an option adds to its stiffness, by that option."""
    left = {
        "--cable": replace(rig, struts=tuple(strut for strut in rig.struts if strut.to != "ground")),
        "--flange": replace(rig, flange=None),
        "--friction": replace(rig, frictions=()),
    }
    there = {"--cable": len(left["--cable"].struts) < len(rig.struts), "--flange": rig.flange, "--friction": rig.frictions}
    return {option: left[option] for option, given in there.items() if given}
