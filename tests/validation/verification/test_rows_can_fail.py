"""Every row of the verification table fails when what it checks is broken.

A break changes one thing behind the rows of a family, not their references; the last test adds up what failed. Meshes are coarser
than the command's, so a broken row must also be at least twice as wrong as the sound one on the same mesh.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

import fem.beam.frame
import fem.solid.assembly
import fem.solid.model
from fem import dynamic_mass
from fem.base_excitation import response, rig
from fem.base_excitation.response import Response
from fem.beam import articles, elements
from fem.exudyn import driven_run, linear, rope_pendulum
from fem.exudyn.rope_pendulum import Swing
from fem.modes import Modes
from validation.verification import beams, dynamics, solids
from validation.verification.check import FAMILIES, CheckResult, Mesh, checks, run

SOFT = 1.2
"""A wrong stiffness or mass: this many times the right one."""

Patch = pytest.MonkeyPatch


def scaled(patch: Patch, module: object, name: str, factor: float = SOFT) -> None:
    """`name` of `module` returns `factor` times what it should."""
    right = getattr(module, name)
    patch.setattr(module, name, lambda *args, **kwargs: factor * right(*args, **kwargs))


def _element(patch: Patch, change: Callable[[object], object]) -> None:
    right = fem.beam.frame.timoshenko
    patch.setattr(fem.beam.frame, "timoshenko", lambda *args: change(right(*args)))


def beam_stiffness(patch: Patch) -> None:
    _element(patch, lambda one: replace(one, stiffness={part: SOFT * k for part, k in one.stiffness.items()}))


def beam_mass(patch: Patch) -> None:
    _element(patch, lambda one: replace(one, mass=SOFT * one.mass))


def beam_grounded(patch: Patch) -> None:
    _element(patch, lambda one: replace(one, stiffness={part: k + np.diag(np.diag(k)) for part, k in one.stiffness.items()}))


def layer_stiffness(patch: Patch) -> None:
    right = elements.sandwich
    patch.setattr(beams, "sandwich", lambda *args: replace(right(*args), slip=SOFT * right(*args).slip))


def solid_stiffness(patch: Patch) -> None:
    scaled(patch, fem.solid.assembly, "_stiffness")


def solid_mass(patch: Patch) -> None:
    scaled(patch, fem.solid.assembly, "_mass")


def solid_grounded(patch: Patch) -> None:
    right = fem.solid.assembly._stiffness

    def wrong(*args: object) -> np.ndarray:
        K = right(*args)
        size = K.shape[1] * 3
        return K + 1e8 * np.eye(size).reshape(K.shape[1:])

    patch.setattr(fem.solid.assembly, "_stiffness", wrong)


def second_source(patch: Patch) -> None:
    for name in ("thin_plate", "in_plane"):
        scaled(patch, solids, name, 1.01)


def article_mass(patch: Patch) -> None:
    right = articles.structure
    patch.setattr(dynamics, "structure", lambda name: replace(right(name), mass=1.01 * right(name).mass))


def residual(patch: Patch) -> None:
    """Left out where it belongs, put in where it does not."""
    right = dynamic_mass.modal
    patch.setattr(dynamics, "modal", lambda modes, lines, residual=True: right(modes, lines, residual=not residual))


def reciprocity(patch: Patch) -> None:
    right = dynamic_mass.direct

    def wrong(*args: object, **kwargs: object) -> object:
        H = right(*args, **kwargs)
        return replace(H, matrix=H.matrix + np.eye(6, k=1))

    patch.setattr(dynamics, "direct", wrong)


def exudyn_stiffness(patch: Patch) -> None:
    right = linear.modes_of_plan

    def stiffer(section: object) -> object:
        names = ("axial", "torsion", "bending_y", "bending_z", "shear_y", "shear_z")
        return replace(section, **{name: SOFT * getattr(section, name) for name in names})

    def wrong(plan: object, count: int) -> Modes:
        members = tuple(replace(m, section=stiffer(m.section)) for m in plan.members)
        return right(replace(plan, members=members), count)

    patch.setattr(beams, "modes_of_plan", wrong)


def recursion_load(patch: Patch) -> None:
    _wrong_run(patch, response)


def exudyn_load(patch: Patch) -> None:
    _wrong_run(patch, driven_run)


def _wrong_run(patch: Patch, route: object) -> None:
    right = route.respond

    def wrong(*args: object) -> Response:
        run = right(*args)
        return replace(run, load=1.02 * run.load, cells=1.02 * run.cells)

    patch.setattr(route, "respond", wrong)


def rig_dynamic_mass(patch: Patch) -> None:
    right = rig.dynamic_mass

    def wrong(*args: object) -> object:
        H = right(*args)
        return replace(H, matrix=SOFT * H.matrix)

    patch.setattr(dynamics, "dynamic_mass", wrong)


def pendulum_record(patch: Patch) -> None:
    """A clock that is slow by a ten-thousandth."""
    right = rope_pendulum.swing

    def wrong(*args: object, **kwargs: object) -> Swing:
        run = right(*args, **kwargs)
        return replace(run, time=1.0001 * run.time)

    patch.setattr(dynamics, "swing", wrong)


@dataclass(frozen=True)
class Family:
    """The breaks that together fail every row of a family."""

    name: str
    breaks: tuple[Callable[[Patch], None], ...]


CASES = (
    Family("beams", (beam_stiffness, beam_mass, beam_grounded)),
    Family("sandwich", (layer_stiffness,)),
    Family("solids", (solid_stiffness,)),
    Family("essentials", (solid_stiffness, solid_mass, solid_grounded)),
    Family("plates", (solid_stiffness, second_source)),
    Family("rods", (solid_stiffness, solid_mass)),
    Family("dynamic-mass", (beam_stiffness, solid_mass, beam_mass, article_mass, residual, reciprocity)),
    Family("exudyn", (exudyn_stiffness,)),
    Family("time", (recursion_load, exudyn_load, rig_dynamic_mass)),
    Family("pendulum", (pendulum_record,)),
)


@pytest.fixture
def coarse(monkeypatch) -> None:
    """Meshes on which a family takes a second or so."""
    monkeypatch.setitem(solids.BAR_CELLS, Mesh.FAST, (2, 1, 10))
    for nodes, cells in ((solids.HEX, (2, 3, 4)), (solids.TET, (3, 4, 6))):
        monkeypatch.setitem(solids.CUBE_CELLS, nodes, cells)
    monkeypatch.setitem(solids.THIN_CELLS, Mesh.FAST, (4, 6))
    monkeypatch.setitem(solids.THICK_CELLS, Mesh.FAST, (4, 4, 1))
    monkeypatch.setattr(fem.solid.model, "tetrahedra", cache(fem.solid.model.tetrahedra))  # gmsh once, not once a break
    monkeypatch.setattr(fem.solid.model, "bodies", cache(fem.solid.model.bodies))
    monkeypatch.setattr(solids, "article", cache(solids.article))
    monkeypatch.setitem(solids.FINENESS, Mesh.FAST, 1.0)
    monkeypatch.setitem(beams.EXUDYN_BEAMS_ELEMENTS, Mesh.FAST, 6)
    monkeypatch.setitem(dynamics.RATE, Mesh.FAST, 2048.0)
    monkeypatch.setattr(dynamics, "ARTICLE_LINES", np.array([8.0, 20.0, 32.0]))


def test_every_family_has_its_breaks():
    assert [case.name for case in CASES] == list(FAMILIES)


LONG = ("time", "pendulum", "rods")
"""Cases of the proof; test_verify_command.py holds that their rows pass."""


@pytest.mark.usefixtures("coarse")
@pytest.mark.parametrize(
    "case", [pytest.param(one, marks=[pytest.mark.proof] * (one.name in LONG), id=one.name) for one in CASES]
)
def test_every_row_fails_when_what_it_checks_is_broken(case):
    sound = run(checks(case.name))
    failed: set[str] = set()
    for broken in case.breaks:
        with pytest.MonkeyPatch.context() as patch:
            broken(patch)
            now = {was.what for was, result in zip(sound, run(checks(case.name)), strict=True) if _worse(was, result)}
        assert now, f"{broken.__name__} breaks nothing"
        failed |= now
    assert failed == {result.what for result in sound}


def _worse(sound: CheckResult, broken: CheckResult) -> bool:
    return not broken.passed and broken.error > 2 * sound.error


def test_rows_have_names_of_their_own():
    names = [check.what for check in checks()]
    assert len(names) == len(set(names))
