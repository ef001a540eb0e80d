"""The paper's reading: six sweeps of FMD and article, Eqs. 6 to 11, then Eqs. 1 and 4 on a band, the structure taken for rigid.

The same for tare and article; the tare less the known disc and Cuboid is the FMD, the article's set-up less the FMD is Clumod.
Near a given set-up the reading is linear: H = F U⁻¹ changes by (dF - H dU) U⁻¹, and the ten parameters are a weighted sum of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray, DynamicMass
from geometry.frames import Array
from geometry.sensors import ChannelTable, motion_rows
from geometry.sensors import resultants as resultant_rows
from identification import rigid_body
from identification.base_motion import base_motion, combinations, groups_used, resultants
from identification.dynamic_mass import from_runs
from identification.spectra.line_spectra import Spectra

LEVEL = np.array([LEVELS[axis] for axis in MOTIONS])

ALL, TURNING = ROWS = ("all", "turning")
"""Which entries of H tell: all, every load weighed by its rms; or all but the moments of translation sweeps, so that the centre
of gravity follows from the forces of rotation sweeps. What the paper's "algorithm parameters" were is not printed."""


def dynamic_mass(spectra: Spectra) -> DynamicMass:
    """H of the whole set-up about F (Eqs. 6 to 11)."""
    motion, load = base_motion(spectra), resultants(spectra)
    return from_runs(load.values, motion.values, spectra.frequency, spectra.table.origin).dynamic_mass


def ten(spectra: Spectra, rows: str = ALL) -> Array:
    """(10,) of the whole set-up about F (Eqs. 1 and 4), from the `rows` of `ROWS`."""
    H = dynamic_mass(spectra)
    return rigid_body.fit(H, weights=_weights(H, rows)).inertia.parameters


def spectra(table: ChannelTable, names: Sequence[str], frequency: Array, rows: ComplexArray) -> Spectra:
    """Noise-free spectra of six sweeps at nominal levels.

    Parameters
    ----------
    names : (c,) channels of `rows`
    rows : (n, c, 6) what each reads for a unit of each motion
    """
    values = np.zeros((6, len(frequency), len(table)), dtype=np.complex128)
    values[..., [table.names.index(name) for name in names]] = np.transpose(rows * LEVEL, (2, 0, 1))
    nothing = np.zeros(values.shape)
    quality = np.ones(values.shape[:2])
    return Spectra(table=table, frequency=frequency, values=values, noise=nothing, quality=quality, runs=MOTIONS, axes=MOTIONS)


@dataclass(frozen=True, eq=False, kw_only=True)
class Linear:
    """The reading near one set-up.

    Attributes
    ----------
    motion, load : (6, c) from channels to motions and resultants of F
    H : (n, 6, 6) as it is read
    turned : (n, 6, 6) inverse of what is read of unit motions
    weights : (10, n, 6, 6) of the entries of H in each of the ten
    """

    motion: Array
    load: Array
    H: ComplexArray
    turned: ComplexArray
    weights: Array

    @property
    def ten(self) -> Array:
        """(10,) of the set-up as it is read."""
        return np.asarray(np.tensordot(self.weights, self.H.real, axes=3))

    def changed(self, channels: Sequence[int], rows: ComplexArray) -> Array:
        """(10,) d ten where the `channels` (k,) read `rows` (n, k, 6) more for unit motions."""
        at = list(channels)
        dH = (self.load[:, at] @ rows - self.H @ (self.motion[:, at] @ rows)) @ self.turned
        return np.asarray(np.tensordot(self.weights, dH.real, axes=3))


def linear(table: ChannelTable, names: Sequence[str], rows: ComplexArray, read: DynamicMass, told: str = ALL) -> Linear:
    """The reading, from the rows `told`, of what reads `rows` (n, c, 6), whose dynamic mass is `read`."""
    known = dict(zip(table.names, table.channels, strict=True))
    groups = groups_used(table)
    channels = [known.get(name) for name in names]
    used = [k for k, one in enumerate(channels) if one and one.quantity == "acceleration" and one.group in groups]
    forces = [k for k, one in enumerate(channels) if one and one.group == "fmd"]
    motion, load = np.zeros((6, len(names))), np.zeros((6, len(names)))
    motion[:, used] = np.linalg.pinv(motion_rows([known[names[k]] for k in used], table.origin))
    load[:, forces] = resultant_rows([known[names[k]] for k in forces], table.origin)
    weight = _weights(read, told)
    solved = np.linalg.pinv((rigid_body.BASIS[:, None] * weight).reshape(10, -1).T).reshape(10, *weight.shape)
    turned = np.asarray(np.linalg.inv(motion @ rows), dtype=np.complex128)
    return Linear(motion=motion, load=load, H=read.matrix, turned=turned, weights=solved * weight)


def redundant(table: ChannelTable, names: Sequence[str]) -> Array:
    """(4, c) what must be nothing: combinations of the cover's accelerometers that no motion makes, and of force channels."""
    by_name = [table.channels[table.names.index(name)] for name in names]
    used = [k for k, one in enumerate(by_name) if one.group == "cover"]
    forces = [k for k, one in enumerate(by_name) if one.group == "fmd"]
    motionless = np.linalg.svd(motion_rows([by_name[k] for k in used], table.origin))[0][:, 6:].T
    balanced = combinations(table, [table.names.index(names[k]) for k in forces])
    found = np.zeros((len(motionless) + len(balanced), len(names)))
    found[: len(motionless), used], found[len(motionless) :, forces] = motionless, balanced
    return found


def without(spectra: Spectra, group: str) -> Spectra:
    """The same without the accelerometers of `group`."""
    kept = [k for k, one in enumerate(spectra.table.channels) if one.group != group]
    table = replace(spectra.table, channels=tuple(spectra.table.channels[k] for k in kept))
    return replace(spectra, table=table, values=spectra.values[..., kept], noise=spectra.noise[..., kept])


def _weights(read: DynamicMass, rows: str) -> Array:
    """(n, 6, 6) of the entries of H: loads weigh by their rms in sweeps at nominal levels."""
    size = np.sqrt(np.mean(np.abs(read.matrix * LEVEL) ** 2, axis=(0, 2)))
    weight = np.array(np.broadcast_to(LEVEL / size[:, None], read.matrix.shape))
    if rows == TURNING:
        weight[:, 3:, :3] = 0.0
    return weight
