"""A planned campaign as the spectra that an exact laboratory would get: the base motions of the pattern, the model, the channels.

The table's motion, cross motion included, is sampled and transformed as a record would be; what the channels read of it follows
from the nominal measurement chain and the model of what stands on the load cells. Noise is what the plan states, over the length
of the record. The table's motion is taken for that of the cover plate: the cells' give changes no interval.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fem.base_excitation.rig_structure import dynamic_mass
from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from geometry.sensors import ChannelTable
from geometry.tolerances import Tolerances
from identification.campaign import Processing
from identification.measurement_chain import chain
from identification.spectra import noise
from identification.spectra.full_record import full_record
from identification.spectra.line_spectra import Spectra
from validation.virtual_test.laboratory import Laboratory, laboratory
from validation.virtual_test.plan import Plan, Scatter
from validation.virtual_test.runs import DrivenRun, cross_motion, runs

REST = 8.0
"""[s] recorded behind the drive."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Planned:
    """A planned campaign.

    Attributes
    ----------
    spectra : of exact channels, with the noise that is planned
    dynamic_mass : of all that stands on the load cells, about F
    seat : (3,) [m] of the origin of what stands on the FMD, from F
    stiffness : (3,) [N/m] of one load cell
    """

    spectra: Spectra
    dynamic_mass: DynamicMass
    seat: Array
    stiffness: Array


def planned(plan: Plan, table: ChannelTable | None = None) -> Planned:
    """The campaign of `plan`, its structure as drawn, with the sensors of `table` (by default those of the virtual shaker).

    Raises
    ------
    BadInput : an article that cannot be built, channels that the chain cannot predict, a drive that cannot be.
    """
    lab = _nominal(plan)
    channels = lab.layout.table if table is None else table
    lines = _lines(plan)
    H = dynamic_mass(replace(lab.rig, cells=()), lines)
    driven = runs(plan)
    motions, durations = zip(*(_motion(plan, run, lines) for run in driven), strict=True)
    values = _read(channels, np.asarray(lab.rig.cells[0].stiffness), H, np.stack(motions), plan.gravity)
    floors = np.array([one.noise_rms or 0.0 for one in channels.channels])
    density = np.broadcast_to(floors**2 / plan.rate, values.shape)
    spectra = Spectra(
        table=channels,
        frequency=lines,
        values=values,
        noise=noise.of_full_record(density, np.array(durations)),
        quality=np.ones(values.shape[:2]),
        runs=tuple(run.name for run in driven),
        axes=tuple(run.axis for run in driven),
    )
    return Planned(
        spectra=spectra, dynamic_mass=H, seat=np.asarray(lab.rig.seat), stiffness=np.asarray(lab.rig.cells[0].stiffness)
    )


def _nominal(plan: Plan) -> Laboratory:
    return laboratory(replace(plan, tolerances=Tolerances().scaled(0.0), scatter=Scatter().scaled(0.0)))


def _lines(plan: Plan) -> Array:
    low, high = plan.band
    return np.asarray(low + Processing().step * np.arange(round((high - low) / Processing().step) + 1), dtype=np.float64)


def _motion(plan: Plan, run: DrivenRun, lines: Array) -> tuple[np.ndarray, float]:
    """Spectra (n, 6) of the table's accelerations in `run`, and the length of its record [s]."""
    motion = run.pattern.motion(  # type: ignore[attr-defined]
        plan.rate, ring_down=REST + plan.quiet, cross=cross_motion(plan, run.name)
    )
    return full_record(motion.acceleration, plan.rate, lines), len(motion.acceleration) / plan.rate


def _read(table: ChannelTable, stiffness: Array, H: DynamicMass, motions: np.ndarray, gravity: float) -> np.ndarray:
    """(r, n, c): what the nominal chain reads of `motions` (r, n, 6); 0 in channels on the structure."""
    of = chain(table, stiffness=stiffness, gravity=gravity)
    A0, A1 = of.rows(np.zeros(len(of.parameters)), H.frequency)
    values = np.zeros((*motions.shape[:2], len(table)), dtype=np.complex128)
    values[:, :, list(of.columns)] = np.einsum("nck,rnk->rnc", A0 + A1 @ H.matrix, motions)
    return values
