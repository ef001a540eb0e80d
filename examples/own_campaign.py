"""A campaign of your own, made in Python and written in every format that `massline check` reads.

python examples/own_campaign.py out/own-campaign

A rigid block on a table, six short sweeps, fourteen accelerometers and the eight load-cell channels of the paper. Replace
`recordings` by your own samples, and `table` by where your own sensors sit.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.frames import Array, Pose
from geometry.inertia import Inertia
from geometry.sensors import Channel, ChannelTable, Place, motion_rows, resultants
from identification import campaign_file
from identification.campaign import Campaign, Excitation, Recording, Run

ENDINGS = (".h5", ".csv", ".uff", ".mat")

RATE = 256.0
"""Samples a second."""

REST, DRIVEN = 1.0, 4.0
"""Seconds of silence before and behind the drive, and of the drive: a real sweep takes a minute and a half."""

START, STOP = 4.0, 32.0

BLOCK = Inertia.from_cog(mass=41.0, cog=np.array([0.0, 0.0, 0.1]), tensor=np.diag([0.9, 0.95, 0.75]))
"""What stands on the load cells; its CoG is given from F."""


def table() -> ChannelTable:
    """The paper's 22 signals: pick-ups of table and cover plate, and load cells of which those of x and y are summed."""
    x, y, z = np.eye(3)
    named = [
        *(("table-z1", (0.25, 0, -0.06), z), ("table-z2", (-0.15, 0.22, -0.06), z), ("table-z3", (-0.15, -0.22, -0.06), z)),
        *(("table-x1", (0, -0.25, -0.06), x), ("table-y1", (0.25, 0, -0.06), y), ("table-y2", (-0.25, 0, -0.06), y)),
        *((f"cover-z{k}", (0.185 * a, 0.185 * b, 0.045), z) for k, (a, b) in enumerate(CORNERS, start=1)),
        *(("cover-x1", (0.2, 0.15, 0.03), x), ("cover-x2", (0.2, -0.15, 0.03), x)),
        *(("cover-y1", (0.15, 0.2, 0.03), y), ("cover-y2", (-0.15, 0.2, 0.03), y)),
    ]
    pickups = [
        Channel(
            name=name,
            quantity="acceleration",
            group=name.partition("-")[0],
            places=(Place(position=np.array(at), direction=along),),
            reference=name.startswith("table"),
            noise_rms=0.005,
        )
        for name, at, along in named
    ]
    sums = (("fmd-x12", (0, 1), x), ("fmd-x34", (2, 3), x), ("fmd-y14", (0, 3), y), ("fmd-y23", (1, 2), y))
    singles = tuple((f"fmd-z{k + 1}", (k,), z) for k in range(4))
    cells = [np.array([0.13 * a, 0.13 * b, 0.0]) for a, b in CORNERS]
    forces = [
        Channel(
            name=name,
            quantity="force",
            group="fmd",
            places=tuple(Place(position=cells[k], direction=along) for k in chosen),
            noise_rms=0.3,
        )
        for name, chosen, along in (*sums, *singles)
    ]
    return ChannelTable(channels=(*pickups, *forces))


CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))


def campaign() -> Campaign:
    """Six runs, one an axis."""
    return Campaign(
        title="A rigid block",
        article="fmd+disc+cuboid",
        hardware="example/1",
        notes="made by examples/own_campaign.py",
        table=table(),
        runs=tuple(_run(axis) for axis in MOTIONS),
        recordings=recordings(table()),
        mounting=Pose(position=np.array([0.0, 0.0, 0.045])),
    )


def recordings(channels: ChannelTable) -> Mapping[str, Recording]:
    """What the channels read while the block is moved along one axis after the other, with a little noise."""
    noise = np.random.default_rng(2026)
    return {axis: _recording(channels, k, noise) for k, axis in enumerate(MOTIONS)}


def _recording(channels: ChannelTable, axis: int, noise: np.random.Generator) -> Recording:
    motion = np.zeros((len(_sweep()), 6))
    motion[:, axis] = LEVELS[MOTIONS[axis]] * _sweep()
    pickups = [channels.channels[k] for k in channels.select(quantity="acceleration")]
    cells = [channels.channels[k] for k in channels.select(quantity="force")]
    loads = motion @ BLOCK.mass_matrix.T
    read = np.hstack(
        [motion @ motion_rows(pickups, channels.origin).T, loads @ np.linalg.pinv(resultants(cells, channels.origin)).T]
    )
    floors = np.array([channel.noise_rms or 0.0 for channel in channels.channels])
    return Recording(names=channels.names, values=read + floors * noise.standard_normal(read.shape), sampling_rate=RATE)


def _sweep() -> Array:
    """A logarithmic sine sweep of amplitude 1 between two rests."""
    t = np.arange(int(DRIVEN * RATE)) / RATE
    octaves = np.log2(STOP / START)
    phase = 2 * np.pi * START * DRIVEN / (octaves * np.log(2)) * (2 ** (octaves * t / DRIVEN) - 1)
    rest = np.zeros(int(REST * RATE))
    return np.concatenate([rest, np.sin(phase), rest])


def _run(axis: str) -> Run:
    rate = 60 * np.log2(STOP / START) / DRIVEN
    figures = {"start_hz": START, "stop_hz": STOP, "octaves_per_minute": float(rate), "level": LEVELS[axis]}
    return Run(name=axis, file=f"{axis}.h5", axis=axis, excitation=Excitation(kind="sine-sweep", figures=figures))


def main(folder: Path) -> None:
    """Write the campaign below `folder`, once in every format that is not there yet: a campaign is never overwritten."""
    made = campaign()
    for ending in ENDINGS:
        if not (folder / ending[1:]).exists():
            campaign_file.write(folder / ending[1:], made, ending=ending)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/own-campaign"))
