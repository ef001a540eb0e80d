"""Campaigns of one laboratory: the cover plate in equilibrium on four cells, line by line, and what its channels read of that.

With q and t the motions of cover plate and table (displacements about F), H(omega) the dynamic mass of all that the cells carry
and G = I + g / omega² E the free fall that a tilted body lacks,

    [K - omega² H G] q = K t,        K = sum over cells of B^T k B ,

where B are rows of a cell at its true height, f = k B (t - q) the force that it carries, and C f what it reads. The dynamic mass
of the article is the sum over its modes, each with a viscous damping ratio of its own:

    H = M + sum over modes of L L^T omega² / (omega_r² - omega² + 2 i zeta_r omega_r omega) .

Records are the inverse transform of what a sweep of the table does to all that. Blevins, Formulas for Natural Frequency and Mode
Shape (1979); Ewins, Modal Testing (2000), for the sum over modes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from benchmarks.laboratories.drawing import CELLS, SHEETS, DataSheet, Hardware, Mounting, bolts, hardware, mounting
from geometry.articles import built_in
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.frames import Array, Pose
from geometry.routes import inertia
from identification.campaign import Campaign, Excitation, Recording, Run
from validation.effects.stages import Matrices
from validation.model.model import Model
from validation.prediction.structure import mounted_article
from validation.virtual_test.layout import mavis

GRAVITY = 9.81
STIFFNESS = (2e8, 2e8, 8e8)
"""[N/m] nominal of one cell along x, y, z, which the laboratory states."""

SQUARE = 0.13
"""[m] of the cells from either axis."""

BAND, RATE, PACE = (4.0, 32.0), 256.0, 2.0
"""[Hz] that is driven, [Hz] of the records, [octaves/min]."""

QUIET, RINGING = 2.0, 90.0
"""[s] before a sweep and after it."""

NOISE = {"acceleration": 0.005, "force": 0.3}
"""Broadband rms [m/s², N]."""

SEAT = np.array([0.0, 0.0, 0.045])
"""[m] of an article's origin from F, as the campaign file states it."""

FLANGE = tuple(np.array([0.06 * np.cos(a), 0.06 * np.sin(a), 0.01]) for a in np.arange(6) * np.pi / 3)
"""[m] of six bolts, from the article's origin."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Faults:
    """What is wrong beyond the data sheets: nothing of a null.

    Attributes
    ----------
    gain, late : by channel, relative and [s]
    place : (3,) [m] by accelerometer
    mass : [kg] by place of the article
    """

    gain: Mapping[str, float]
    late: Mapping[str, float]
    place: Mapping[str, Array]
    mass: Mapping[str, float]


SOUND = Faults(gain={}, late={}, place={}, mass={})


def series(laboratory: int, articles: Sequence[str], sheet: str, faults: Faults = SOUND) -> tuple[Campaign, ...]:
    """Campaigns of `articles` on the hardware of `laboratory`, whose limits are those of `sheet`.

    The seed of a laboratory decides its hardware; its number and the place of an article in the list decide the mounting.
    """
    of = SHEETS[sheet]
    layout = mavis([[s * SQUARE, t * SQUARE, 0.0] for s, t in ((1, 1), (-1, 1), (-1, -1), (1, -1))], {})
    directions = {channel.name: np.array(channel.places[0].direction) for channel in layout.table.channels}
    made = hardware(of, directions, np.random.default_rng([laboratory, 0]))
    campaigns = []
    for number, article in enumerate(articles):
        generator = np.random.default_rng([laboratory, 1, number])
        bare = Campaign(
            title="drawn",
            article=article,
            hardware=f"laboratory-{laboratory}",
            table=layout.table,
            runs=(),
            mounting=Pose(position=SEAT),
            gravity=GRAVITY,
            source=f"laboratory-{laboratory}/{article}",
        )
        matrices = _heavier(drawn(bare), faults.mass)
        H = _Carried.of(matrices, made, mounting(of, generator), of, np.random.default_rng([laboratory, 2]), generator)
        shaken = [_run(axis, H, made, bare, faults, of.cross, generator) for axis in MOTIONS]
        campaigns.append(replace(bare, runs=tuple(run for run, _ in shaken), recordings={run.name: one for run, one in shaken}))
    return tuple(campaigns)


def drawn(campaign: Campaign) -> Matrices:
    """The article of `campaign` as the analyst has it."""
    matrices = mounted_article(Model(source="drawing", title="", article=campaign.article), campaign).matrices
    if matrices is None:
        raise ValueError(f"`campaign` must have an article on the FMD, found {campaign.article}")
    return matrices


def _heavier(matrices: Matrices, masses: Mapping[str, float]) -> Matrices:
    for place, mass in masses.items():
        if place in matrices.places:
            rows = matrices.places[place]
            matrices = replace(matrices, mass=matrices.mass + mass * rows.T @ rows)
    return matrices


@dataclass(frozen=True, eq=False, kw_only=True)
class _Carried:
    """All that the cells carry: a rigid matrix (6, 6) about F, and modes with participations (n, 6), [rad/s] and damping."""

    rigid: Array
    participation: Array
    omega: Array
    zeta: Array

    @classmethod
    def of(
        cls,
        matrices: Matrices,
        made: Hardware,
        stands: Mounting,
        sheet: DataSheet,
        own: np.random.Generator,
        generator: np.random.Generator,
    ) -> _Carried:
        b = matrices.base
        K, M = np.array(matrices.stiffness), np.array(matrices.mass)
        for part in sorted(matrices.parts):  # the same in every campaign that has the part
            K += sheet.modulus * own.uniform(-1, 1) * matrices.parts[part]
        M = M * (1 + sheet.density * generator.uniform(-1, 1))
        for at, mass in zip(FLANGE, bolts(sheet, FLANGE, generator), strict=True):
            rides = _arm(at)[:3]
            M[:b, :b] += mass * rides.T @ rides
        square, shapes = eigh(K[b:, b:], M[b:, b:]) if len(K) > b else (np.zeros(0), np.zeros((0, 0)))
        L, omega = shapes.T @ M[b:, :b], np.sqrt(square)
        lost = np.einsum("kr,kl,lr->r", shapes, matrices.structural[b:, b:], shapes) / np.maximum(2 * square, 1e-9)
        viscous = np.einsum("kr,kl,lr->r", shapes, matrices.viscous[b:, b:], shapes) / np.maximum(2 * omega, 1e-9)
        zeta = np.maximum(lost + viscous, 1e-4) * np.exp(sheet.damping * generator.standard_normal(len(omega)))
        Q = Rotation.from_rotvec(stands.turned).as_matrix()
        X = np.kron(np.eye(2), Q.T) @ _arm(SEAT + stands.beside)
        fmd = inertia(built_in("fmd"))
        about = made.moments[:, None] ** 0.5 * fmd.tensor_cog * made.moments**0.5
        cog = np.array(fmd.cog) + made.cog
        S = _cross(cog)
        m = fmd.mass * made.mass
        plate = np.block([[m * np.eye(3), -m * S], [m * S, about - m * S @ S]])
        return cls(rigid=X.T @ M[:b, :b] @ X + plate, participation=L @ X, omega=omega, zeta=zeta)

    def at(self, omega: Array) -> ComplexArray:
        """(n, 6, 6) at `omega` (n,)."""
        w = omega[:, None]
        answer = w**2 / (self.omega**2 - w**2 + 2j * self.zeta * self.omega * w)
        return np.asarray(self.rigid + np.einsum("nr,ra,rb->nab", answer, self.participation, self.participation, optimize=True))


def _run(
    axis: str, carried: _Carried, made: Hardware, of: Campaign, faults: Faults, cross: float, generator: np.random.Generator
) -> tuple[Run, Recording]:
    low, high = BAND
    span = 60 * np.log2(high / low) / PACE
    count = int((QUIET + span + RINGING) * RATE)
    time = np.arange(count) / RATE - QUIET
    going = (time >= 0) & (time <= span)
    k = np.log(2) * PACE / 60
    fade = np.clip(time / 0.3, 0, 1) * np.clip((span - time) / 0.3, 0, 1)
    wave = np.where(going, fade * np.sin(2 * np.pi * low * np.expm1(k * np.where(going, time, 0)) / k), 0.0)
    driven = np.fft.rfft(wave)
    frequency = np.fft.rfftfreq(count, 1 / RATE)
    omega = 2 * np.pi * np.maximum(frequency, 1e-3)
    driven[frequency < 0.8] = 0.0
    level = np.array([LEVELS[one] for one in MOTIONS])
    other = cross * generator.standard_normal(6) * np.exp(2j * np.pi * generator.random(6))
    table = np.outer(driven, np.where(np.array(MOTIONS) == axis, 1.0, 0.0) * level + other * level)  # apparent, (n, 6)
    E = np.zeros((6, 6))
    E[0, 4], E[1, 3] = 1.0, -1.0
    square = (omega**2)[:, None, None]
    G, back = np.eye(6) + GRAVITY / square * E, np.eye(6) - GRAVITY / square * E
    t = (back @ table[..., None]) / -square
    cells = [np.array(one) for one in ((SQUARE, SQUARE, 0), (-SQUARE, SQUARE, 0), (-SQUARE, -SQUARE, 0), (SQUARE, -SQUARE, 0))]
    B = np.zeros((CELLS, 3, 6))
    for c, at in enumerate(cells):
        for a in range(3):
            height = np.array([0, 0, made.plane[a]]) if a < 2 else np.zeros(3)
            B[c, a] = _arm(at + height)[a]
    k_cells = np.array(STIFFNESS) * made.stiffness
    K = np.einsum("cam,ca,can->mn", B, k_cells, B)
    H = carried.at(omega)
    q = np.linalg.solve(K - square * (H @ G), K @ t)
    forces = k_cells * np.einsum("cam,nm->nca", B, (t - q)[..., 0])
    read = np.einsum("cij,ncj->nci", made.cells, forces)
    plate = (G @ (-square * q))[..., 0]
    out = np.zeros((len(frequency), len(of.table)), dtype=np.complex128)
    for column, channel in enumerate(of.table.channels):
        name = channel.name
        if channel.quantity == "force":
            a = "xyz".index(name.split("-")[1][0])
            numbers = [int(n) - 1 for n in name.split("-")[1][1:]]
            signal = read[:, numbers, a].sum(axis=1)
        else:
            motion = table if channel.group == "table" else plate
            at = channel.places[0].position + made.place[name] + faults.place.get(name, 0.0)
            signal = motion @ ((channel.places[0].direction + made.direction[name]) @ _arm(at)[:3])
        late = made.late[name] + faults.late.get(name, 0.0)
        gain = (1 + made.gain[name]) * (1 + faults.gain.get(name, 0.0))
        out[:, column] = signal * gain * np.exp(-1j * omega * late) / (1 - 1j * made.corner[name] / np.maximum(frequency, 0.5))
    values = np.fft.irfft(out, n=count, axis=0)
    rms = np.array([NOISE[channel.quantity] for channel in of.table.channels])
    values += rms * generator.standard_normal(values.shape)
    stated = Excitation(
        kind="sine-sweep", figures={"start_hz": low, "stop_hz": high, "octaves_per_minute": PACE, "level": float(LEVELS[axis])}
    )
    run = Run(name=axis, file=f"{axis}.h5", axis=axis, excitation=stated)
    return run, Recording(names=of.table.names, values=values, sampling_rate=RATE, source=axis)


def _cross(at: Array) -> Array:
    x, y, z = at
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def _arm(at: Array) -> Array:
    """(6, 6) motion at `at` (3,) for one of the origin: ``v + w x r``."""
    T = np.eye(6)
    T[:3, 3:] = -_cross(at)
    return T
