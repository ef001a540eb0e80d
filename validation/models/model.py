"""`Model`: what a model file says. One model serves a whole series: a campaign's `article` picks the set-up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array, frozen
from geometry.inertia import Inertia
from geometry.tolerances import Tolerances
from validation.effects.identifiers import Named

BEAM, RIGID, USER = KINDS = ("beam", "rigid", "own")


@dataclass(frozen=True, kw_only=True)
class StructureTolerances:
    """How well the structure is known beforehand; standard deviations, relative but for `damping_law` and `mode_coupling`.

    Attributes
    ----------
    modulus : of every part's moduli
    frequency : of every mode's frequency, beside the moduli
    damping : of every part's loss factor, or of the logarithm of every mode's damping where that is given by mode
    mode_damping : of the logarithm of every mode's damping beside the loss factors of the parts
    damping_law : share of what parts lose that follows the velocity instead of the displacement
    participation : of every mode's participation, along each axis, as a share of its largest
    mode_coupling : of the damping that couples two modes, as a share of the geometric mean of theirs
    """

    modulus: float = 0.025
    frequency: float = 0.0015
    damping: float = 0.35
    mode_damping: float = 0.1
    damping_law: float = 0.5
    participation: float = 0.02
    mode_coupling: float = 0.5


@dataclass(frozen=True, eq=False, kw_only=True)
class Added:
    """An effect of the model.

    Attributes
    ----------
    named : what it is, where it acts, and its size
    deviation : standard deviation by key of its values, as its fit left it; empty for one that was never fitted
    fixed : whether its size is given and not to be fitted
    """

    named: Named
    deviation: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    fixed: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Model:
    """A model.

    Attributes
    ----------
    source : the file, for messages
    title : in a few words
    article : the set-up it was written for, and whose parts it may describe
    hardware : id of FMD and sensors for which it holds; empty for any
    gravity : [m/s²]
    fmd : inertia of the FMD's moving part about F; None for that of the drawing
    fmd_tolerance : standard deviation of its parameters, as a share
    cell_stiffness : (3,) [N/m] of one load cell along x, y, z; None where it is not known
    tolerances : of the measurement chain
    kind : of `KINDS`, how the articles are modelled
    modes : how many are kept
    changes : a user's own dimensions of built-in articles, as `geometry.articles.changes` names them
    damping_ratio : of every mode; None for the loss factors of the parts
    own : by article, the path of a user's own model (`fem.users_model`)
    structure : tolerances of the structure
    effects : in the order in which they act
    """

    source: str
    title: str
    article: str
    hardware: str = ""
    gravity: float = 9.81
    fmd: Inertia | None = None
    fmd_tolerance: float = 0.05
    cell_stiffness: Array | None = None
    tolerances: Tolerances = field(default_factory=Tolerances)
    kind: str = BEAM
    modes: int = 30
    changes: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    damping_ratio: float | None = None
    own: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    structure: StructureTolerances = field(default_factory=StructureTolerances)
    effects: tuple[Added, ...] = ()

    def __post_init__(self) -> None:
        if self.cell_stiffness is not None:
            object.__setattr__(self, "cell_stiffness", frozen(self.cell_stiffness, (3,), "cell_stiffness"))
            if np.any(self.cell_stiffness <= 0):
                raise ValueError("`cell_stiffness` must be positive")
