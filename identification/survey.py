"""A first look at recorded runs: what the table did, and what the channels read when nothing moved.

Both come from short blocks of the time histories. Spectra have no quiet part and no level; they are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.observability import of_motions
from geometry.sensors import ChannelTable, motion_rows
from identification.campaign import Campaign
from identification.campaign_checks import RIGID_GROUPS
from identification.recording import Recording

NOMINAL = np.array([LEVELS[axis] for axis in MOTIONS])

BLOCK = 0.5
"""[s] of a block: two periods of the lowest line that the paper uses."""

DRIVEN = 0.5
"""Share of the strongest block from which a block counts as driven."""

STILL = 2.0
"""How far above those of the quietest block of its run the accelerometers of table and cover plate may read in a quiet block."""

QUIET = 0.05
"""Share of the driven level above which no block of a run is quiet."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Levels:
    """What the table did in one run, about the reference point.

    Attributes
    ----------
    amplitude : (6,) of each base motion while it was driven, sqrt(2) times its rms: the amplitude of a sine [m/s², rad/s²]
    share : (6,) the same as a share of the largest, every axis divided by its nominal level [1]
    driven : [s] how long the table was driven
    """

    amplitude: Array
    share: Array
    driven: float

    def __post_init__(self) -> None:
        for name in ("amplitude", "share"):
            object.__setattr__(self, name, frozen(getattr(self, name), (6,), name))


def levels(recorded: Recording, table: ChannelTable) -> Levels | None:
    """The levels of one run by Eqs. 6 and 7; None for spectra, records below two blocks, and tables that tell no base motion.

    The cover plate's accelerometers are used where they tell all six motions, else the table's, too.
    """
    motion = base_motion(recorded, table)
    if motion is None or recorded.sampling_rate is None:
        return None
    rms = block_rms(motion, recorded.sampling_rate)
    if len(rms) < 2:
        return None
    size = np.linalg.norm(rms / NOMINAL, axis=1)
    driven = size > DRIVEN * size.max()
    amplitude = np.sqrt(2 * np.mean(np.square(rms[driven]), axis=0))
    scaled = amplitude / NOMINAL
    return Levels(
        amplitude=amplitude, share=scaled / max(scaled.max(), np.finfo(np.float64).tiny), driven=float(driven.sum() * BLOCK)
    )


def base_motion(recorded: Recording, table: ChannelTable) -> Array | None:
    """The six accelerations (n, 6) of the reference point by Eqs. 6 and 7; None for spectra and where no base motion is told."""
    for groups in (("cover",), RIGID_GROUPS):
        if of_motions(table, groups).complete and not recorded.is_spectrum:
            chosen = table.select(group=groups, quantity="acceleration")
            rows = motion_rows([table.channels[k] for k in chosen], table.origin)
            return np.asarray(recorded.values[:, chosen] @ np.linalg.pinv(rows).T)
    return None


def noise_floors(campaign: Campaign) -> Array | None:
    """Broadband rms (c,) of every channel while nothing moved, in SI; None where no run has a quiet part.

    A block is quiet when the accelerometers of table and cover plate are. What still rings on the structure is louder than noise,
    so of the quiet blocks of all runs the quieter half of each channel counts.
    """
    blocks = [block for recorded in campaign.recordings.values() if (block := _quiet(recorded, campaign.table)) is not None]
    if not blocks:
        return None
    rms = np.sort(np.vstack(blocks), axis=0)
    return np.asarray(np.sqrt(np.mean(np.square(rms[: max(len(rms) // 2, 1)]), axis=0)))


def _quiet(recorded: Recording, table: ChannelTable) -> Array | None:
    """The rms (b, c) of all channels in the quiet blocks of a run; None where there is none."""
    quiet = quiet_blocks(recorded, table)
    return None if quiet is None or recorded.sampling_rate is None else block_rms(recorded.values, recorded.sampling_rate)[quiet]


def quiet_blocks(recorded: Recording, table: ChannelTable) -> npt.NDArray[np.bool_] | None:
    """Which of the consecutive blocks of `BLOCK` seconds (b,) are quiet; None for spectra and where no block is."""
    watched = table.select(group=RIGID_GROUPS, quantity="acceleration")
    if recorded.sampling_rate is None or not watched:
        return None
    rms = block_rms(recorded.values[:, watched], recorded.sampling_rate)
    if len(rms) < 2:
        return None
    size = np.linalg.norm(rms, axis=1)
    return np.asarray(size <= STILL * size.min()) if size.min() < QUIET * size.max() else None


def block_length(rate: float) -> int:
    """Samples of a block at `rate` [Hz]."""
    return max(round(BLOCK * rate), 2)


def block_rms(values: Array, rate: float) -> Array:
    """(b, c) rms about the mean of consecutive blocks of (n, c); what does not fill a block at the end is left out."""
    length = block_length(rate)
    count = len(values) // length
    return np.asarray(np.std(values[: count * length].reshape(count, length, -1), axis=1))
