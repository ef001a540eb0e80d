"""Sensors and FMD as a linear chain: what every channel reads for a motion of the cover plate, with every tolerance a parameter.

    y = (A0 + A1 H) u

u (6,) is the motion of the reference point F on the cover plate - the *apparent* acceleration that the structure feels, tilt
included - and H the dynamic mass of all that stands above the force plane. Accelerometers are `identification.chain.pick_ups`,
load cells `identification.chain.loads`; what a load cell does to table and cover plate alike is `identification.chain.cells`.

Identification calibrates with the chain, validation predicts with it: there is no other. Source: the paper's Eqs. 2, 3, 6 and 7
with their errors written out; "The likelihood" of the catalogue of effects.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.sensors import ChannelTable, summation
from geometry.tolerances import Tolerances
from identification.chain import fmd, loads, pick_ups, tilt
from identification.chain.cells import COMPLIANCE, ELEMENT, Springs
from identification.chain.loads import Loads
from identification.chain.parameter import Parameter, opened
from identification.chain.pick_ups import PickUps

STANDARD_GRAVITY = 9.81
"""[m/s²] of a campaign that states none, as `campaign.toml` does by default."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Derivative:
    """How the chain answers to one parameter.

    Attributes
    ----------
    channels : columns of the chain that change, all others do not
    rows : (n, k, 6) complex, d(A0 + A1 H) / d offset of these
    """

    channels: tuple[int, ...]
    rows: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Chain:
    """A measurement chain. A vector theta (p,) holds offsets of `parameters` from nominal; zeros are the chain as drawn.

    Attributes
    ----------
    columns : indices in the channel table of the chain's channels, in the order of its rows
    names : (c,) of these
    parameters : that may move
    possible : names of every parameter that it could have, open or not
    left_out : names of channels of the table that the chain does not predict
    remarks : sentences: what was left out and why, what was assumed of the load cells
    cover, table, forces : its parts
    springs : the load cells
    """

    columns: tuple[int, ...]
    names: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    possible: tuple[str, ...]
    left_out: tuple[str, ...]
    remarks: tuple[str, ...]
    cover: PickUps
    table: PickUps
    forces: Loads
    springs: Springs

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def tolerances(self) -> Array:
        """(p,) standard deviation of every offset before anything was measured."""
        return np.array([one.tolerance for one in self.parameters])

    def theta(self, values: Mapping[str, float]) -> Array:
        """(p,) offsets at which the parameters named in `values` have these values and all others their nominal one.

        Raises
        ------
        BadInput : a name of no open parameter, or a value that turns a stiffness negative.
        """
        by_name = {one.name: k for k, one in enumerate(self.parameters)}
        theta = np.zeros(len(self.parameters))
        for name, value in values.items():
            if name not in by_name:
                problem = "the chain has no such open parameter"
                raise BadInput(source="measurement chain", field=name, problem=problem, remedy="Give it a tolerance above 0")
            theta[by_name[name]] = self.parameters[by_name[name]].offset(value)
        return theta

    def values(self, theta: npt.ArrayLike) -> dict[str, float]:
        """By parameter, its value in its unit at `theta` (p,)."""
        return {one.name: one.value(float(t)) for one, t in zip(self.parameters, self._checked(theta), strict=True)}

    def rows(self, theta: npt.ArrayLike, frequency: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """A0 and A1, (n, c, 6) each, at `theta` (p,) and `frequency` (n,) [Hz], above zero: channels = (A0 + A1 H) u.

        Columns are the motions, and for A1 the loads, about the reference point in the order of `MOTIONS`.
        """
        x, lines = self._offsets(theta), _lines(frequency)
        cover, table = (pick_ups.rows(part, x, lines) for part in (self.cover, self.table))
        A1 = loads.rows(self.forces, x, lines)
        return np.concatenate([cover[0], table[0], np.zeros_like(A1)], axis=1), np.concatenate([cover[1], table[1], A1], axis=1)

    def derivatives(
        self, theta: npt.ArrayLike, frequency: npt.ArrayLike, H: npt.ArrayLike, wanted: Collection[str] | None = None
    ) -> tuple[Derivative, ...]:
        """By parameter, in order, d(A0 + A1 H) / d offset at `theta` (p,), `frequency` (n,) [Hz] and `H` (n, 6, 6).

        Of parameters whose names are not `wanted` there are none; by default all are.
        """
        names = [one.name for one in self.parameters if wanted is None or one.name in wanted]
        x, lines, matrix = self._offsets(theta), _lines(frequency), np.asarray(H, dtype=np.complex128)
        found: dict[str, list[tuple[list[int], ComplexArray]]] = {name: [] for name in names}
        for part in (self.cover, self.table):
            for key, touched, (A0, A1) in pick_ups.changes(part, x, lines, found):
                found[key].append(([part.first + k for k in touched], A0 + A1 @ matrix))
        for key, touched, A1 in loads.changes(self.forces, x, lines, found):
            found[key].append(([self.forces.first + k for k in touched], A1 @ matrix))
        return tuple(_joined(found[name]) for name in names)

    def _checked(self, theta: npt.ArrayLike) -> Array:
        return frozen(theta, (len(self.parameters),), "theta")

    def _offsets(self, theta: npt.ArrayLike) -> dict[str, float]:
        return {one.name: float(t) for one, t in zip(self.parameters, self._checked(theta), strict=True)}


def chain(
    table: ChannelTable,
    tolerances: Tolerances | None = None,
    *,
    stiffness: npt.ArrayLike | None = None,
    gravity: float = STANDARD_GRAVITY,
    overrides: Mapping[str, float] = MappingProxyType({}),
) -> Chain:
    """The chain of `table`: accelerometers on cover plate and table, then forces and moments of the FMD.

    Parameters
    ----------
    table : channels and reference point
    tolerances : priors; those of an ordinary laboratory by default
    stiffness : (3,) [N/m] of one load cell along x, y, z; infinity for an FMD that does not give. None when nobody knows: that of
        the reconstructed FMD then, with a prior as wide as the ignorance
    gravity : [m/s²]
    overrides : standard deviations by name of a parameter or of its family, in place of `tolerances`. 0 closes a
        parameter; what is closed by default (delays of boards, shunts, high-passes, ...) opens by a positive one

    Raises
    ------
    BadInput : a stiffness or an override that cannot be used.
    """
    known = tolerances or Tolerances()
    cover, below, force = (
        table.select(group=group, quantity=quantity)
        for group, quantity in (("cover", "acceleration"), ("table", "acceleration"), ("fmd", ("force", "moment")))
    )
    columns = (*cover, *below, *force)
    sums = summation([table.channels[k] for k in force], table.origin)
    elements = [place for quantity, place in sums.elements if quantity == "force"]
    springs = fmd.springs(elements, table.origin, stiffness)
    parts = [
        PickUps(
            group=group,
            channels=tuple(table.channels[k] for k in chosen),
            first=first,
            point=table.origin,
            springs=springs,
            gravity=gravity,
        )
        for group, chosen, first in (("cover", cover, 0), ("table", below, len(cover)))
    ]
    forces = Loads(channels=tuple(table.channels[k] for k in force), first=len(cover) + len(below), sums=sums, springs=springs)
    candidates = _candidates(parts[0], parts[1], forces, known, fmd.ASSUMED if stiffness is None else fmd.STATED)
    return Chain(
        columns=columns,
        names=tuple(table.names[k] for k in columns),
        parameters=opened(candidates, overrides),
        possible=tuple(one.name for one in candidates),
        left_out=tuple(name for k, name in enumerate(table.names) if k not in columns),
        remarks=(*_left_out(table, columns), *_assumed(springs, bool(below), stiffness is None)),
        cover=parts[0],
        table=parts[1],
        forces=forces,
        springs=springs,
    )


def _candidates(cover: PickUps, table: PickUps, forces: Loads, known: Tolerances, softness: float) -> tuple[Parameter, ...]:
    """Every parameter that the chain could have, family by family; tolerance 0 where none is expected to move."""
    pick_up = [*pick_ups.parameters(cover, known), *pick_ups.parameters(table, known)]
    common = [*_cells(table, forces, known, softness), *_gravity(cover, table)]
    return tuple(sorted([*loads.parameters(forces, known), *pick_up, *common], key=lambda one: _FAMILIES.index(one.family)))


_FAMILIES = (
    *("force-gain", "accelerometer-gain", "force-delay", "accelerometer-delay", "board-delay", "force-highpass"),
    *("accelerometer-position", "accelerometer-misalignment", ELEMENT, COMPLIANCE, "force-crosstalk", "load-path-shunt"),
    *("force-plane-offset", "cover-plate-flexibility", tilt.STRUCTURE, tilt.SENSOR),
)


def _cells(table: PickUps, forces: Loads, known: Tolerances, softness: float) -> list[Parameter]:
    springs, below = forces.springs, table.columns if not forces.springs.rigid else ()
    elements = springs.names if springs.of_cells else ()
    cell = Parameter(name=ELEMENT, unit="1", tolerance=known.cell_stiffness, channels=(*below, *forces.columns), logarithmic=True)
    common = Parameter(name=COMPLIANCE, unit="1", tolerance=softness, channels=below, nominal=1.0, logarithmic=True)
    return [replace(cell, name=f"{ELEMENT}:{name}") for name in elements] + [
        replace(common, name=f"{COMPLIANCE}:{name}") for name in springs.shares if below
    ]


def _gravity(cover: PickUps, table: PickUps) -> list[Parameter]:
    columns = (*cover.columns, *table.columns)
    return [
        Parameter(name=name, unit="1", tolerance=0.0, channels=columns, nominal=1.0)
        for name in (tilt.STRUCTURE, tilt.SENSOR)
        if columns
    ]


def _left_out(table: ChannelTable, columns: tuple[int, ...]) -> list[str]:
    """Which channels the chain does not predict, and why."""
    left = [channel for k, channel in enumerate(table.channels) if k not in columns]
    on_structure = [channel.name for channel in left if channel.group == "article"]
    others = [channel.name for channel in left if channel.group != "article"]
    why = ((on_structure, "sits on the structure, which is not rigid"), (others, "measures no load of the FMD"))
    return [f"not used: {', '.join(names)}; what {reason}, tells nothing here" for names, reason in why if names]


def _assumed(springs: Springs, table: bool, unknown: bool) -> list[str]:
    """What the chain takes for granted of the load cells."""
    found = []
    if not springs.of_cells:
        found.append("the force channels do not tell how cells share the load: their readings are taken for the resultants")
    if table and unknown:
        found.append(
            "the stiffness of the load cells is not stated: that of the reconstructed FMD is assumed, within a factor of five"
        )
    return found


def _lines(frequency: npt.ArrayLike) -> Array:
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if np.any(lines <= 0):
        raise ValueError(f"`frequency` must be above zero, found {lines.min():g}: at rest a tilt is no acceleration")
    return frozen(lines, lines.shape, "frequency")


def _joined(parts: list[tuple[list[int], ComplexArray]]) -> Derivative:
    return Derivative(
        channels=tuple(k for touched, _ in parts for k in touched),
        rows=np.concatenate([rows for _, rows in parts], axis=1),
    )
