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

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from benchmarks.laboratories.drawing import CELLS, SHEETS, DataSheet, Hardware, Mounting, bolts, hardware, mounting
from geometry.articles import built_in
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.frames import Array, Pose
from geometry.inertia import PARAMETERS, Inertia
from geometry.routes import inertia
from identification.campaign import Campaign, Excitation, Recording, Run
from validation.effects.families.joint_compliance import DIRECTIONS
from validation.effects.families.layer_damping import LAYER
from validation.effects.stages import ALONG, Matrices
from validation.model.model import Model
from validation.prediction.mounting import mounted_article
from validation.virtual_test.layout import mavis

GRAVITY = 9.81

FLANGE = tuple(np.array([0.06 * np.cos(a), 0.06 * np.sin(a), 0.01]) for a in np.arange(6) * np.pi / 3)
"""[m] of six bolts, from the article's origin."""

SLIPS = 20.0
"""[N m] of the moment at which a seat has slipped half of what it can."""

HANGS = (5.5, 9.3, 14.1)
"""[Hz] of the modes of a cable that hangs."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Bench:
    """What a laboratory has, and how it drives: all of it is stated in its files.

    Attributes
    ----------
    stiffness : (3,) [N/m] nominal of one cell along x, y, z
    square : [m] of the cells from either axis
    band : [Hz] that is driven
    rate : [Hz] of the records
    pace : [octaves/min]
    quiet, ringing : [s] before a sweep and after it
    acceleration, force : [m/s², N] broadband rms
    seat : (3,) [m] of an article's origin from F
    """

    stiffness: tuple[float, float, float] = (2e8, 2e8, 8e8)
    square: float = 0.13
    band: tuple[float, float] = (4.0, 32.0)
    rate: float = 256.0
    pace: float = 2.0
    quiet: float = 2.0
    ringing: float = 90.0
    acceleration: float = 0.005
    force: float = 0.3
    seat: tuple[float, float, float] = (0.0, 0.0, 0.045)

    @staticmethod
    def drawn(generator: np.random.Generator) -> Bench:
        """One of any kind: cells of 1/3 to 3 times the stiffness, sweeps up to four times as fast, 1/2 to 4 times the noise."""
        stiff, loud = 3 ** generator.uniform(-1, 1), 2 ** generator.uniform(-1, 2)
        return Bench(
            stiffness=(2e8 * stiff, 2e8 * stiff, 8e8 * stiff),
            square=float(generator.uniform(0.1, 0.16)),
            band=(float(generator.choice([4.0, 5.0])), float(generator.choice([24.0, 32.0, 45.0]))),
            pace=float(generator.choice([2.0, 4.0, 8.0])),
            ringing=60.0,
            acceleration=0.005 * loud,
            force=0.3 * loud,
            seat=(
                float(generator.uniform(-0.03, 0.03)),
                float(generator.uniform(-0.03, 0.03)),
                0.045 + float(generator.choice([0.0, 0.03])),
            ),
        )

    @property
    def cells(self) -> list[Array]:
        """(3,) [m] each, counter-clockwise from +x +y."""
        return [np.array([s * self.square, t * self.square, 0.0]) for s, t in ((1, 1), (-1, 1), (-1, -1), (1, -1))]


@dataclass(frozen=True, eq=False, kw_only=True)
class Faults:
    """What is wrong beyond the data sheets: nothing of a null.

    Attributes
    ----------
    sizes : by id, as the catalogue writes it, ``force-gain:fmd-z2``, or a name of `UNKNOWN` with a place; SI
    """

    sizes: Mapping[str, tuple[float, ...]] = field(default_factory=lambda: MappingProxyType({}))

    def of(self, *id: str) -> float:
        """The size of one, 0 where it is not wrong."""
        return self.sizes.get(":".join(id), (0.0,))[0]

    def family(self, name: str) -> dict[str, tuple[float, ...]]:
        """Sizes of one family by target."""
        return {id.partition(":")[2]: size for id, size in self.sizes.items() if id.partition(":")[0] == name}

    def vector(self, *family: str) -> Array:
        """(3,) of a family whose last target is an axis."""
        return np.array([self.of(*family, axis) for axis in "xyz"])


SOUND = Faults()

UNKNOWN = ("damper", "rotor", "slipping", "hanging", "creeping", "rising")
"""Physics of no family: a damper to the ground at a place [N s/m]; a wheel that spins about z [N m s]; a seat that slips, the
more so the harder it is driven [rad/(N m)]; a cable with three modes of its own that hangs at a place [kg]; a part whose loss
rises as the frequency falls [1]; a channel whose gain rises with the square of frequency [1 at 32 Hz]."""


def series(
    laboratory: int, articles: Sequence[str], sheet: str, faults: Faults = SOUND, bench: Bench | None = None
) -> tuple[Campaign, ...]:
    """Campaigns of `articles` on the hardware of `laboratory`, whose limits are those of `sheet`."""
    return tuple(campaign for campaign, _, _ in mountings(laboratory, articles, sheet, faults, bench))


def mountings(
    laboratory: int, articles: Sequence[str], sheet: str, faults: Faults = SOUND, bench: Bench | None = None
) -> Iterator[tuple[Campaign, Inertia, Inertia]]:
    """Campaigns of `articles`, what truly stands on the FMD about F, and what the drawing says of that.

    The seed of a laboratory decides its hardware; its number and the place of an article in the list decide the mounting.
    """
    of, on = SHEETS[sheet], bench or Bench()
    layout = mavis(on.cells, {})
    directions = {channel.name: np.array(channel.places[0].direction) for channel in layout.table.channels}
    made = hardware(of, directions, np.random.default_rng([laboratory, 0]))
    for number, article in enumerate(articles):
        generator = np.random.default_rng([laboratory, 1, number])
        bare = Campaign(
            title="drawn",
            article=article,
            hardware=f"laboratory-{laboratory}",
            table=layout.table,
            runs=(),
            mounting=Pose(position=np.array(on.seat)),
            gravity=GRAVITY,
            source=f"laboratory-{laboratory}/{article}",
        )
        own, matrices = np.random.default_rng([laboratory, 2]), drawn(bare)
        carried = _Carried.of(matrices, made, mounting(of, generator), of, own, generator, faults, on)
        shaken = [_run(axis, carried, made, bare, faults, of.cross, generator, on) for axis in MOTIONS]
        stated, rigid = _arm(np.array(on.seat)), np.asarray(matrices.mass)[:6, :6]
        yield (
            replace(bare, runs=tuple(run for run, _ in shaken), recordings={run.name: one for run, one in shaken}),
            Inertia.from_mass_matrix(carried.X.T @ carried.rigid @ carried.X),
            Inertia.from_mass_matrix(stated.T @ rigid @ stated),
        )


def truth(laboratory: int, sheet: str, faults: Faults, parts: Sequence[str] = ()) -> dict[str, list[float]]:
    """The sizes of `faults` by id, what hardware and `parts` of the article of `laboratory` have of the same kind among them."""
    directions = {one.name: np.array(one.places[0].direction) for one in mavis(Bench().cells, {}).table.channels}
    made, found = hardware(SHEETS[sheet], directions, np.random.default_rng([laboratory, 0])), {}
    softer = SHEETS[sheet].modulus * np.random.default_rng([laboratory, 2]).uniform(-1, 1, len(parts))
    for id, sizes in faults.sizes.items():
        family, _, target = id.partition(":")
        name, kind, own = target.partition(":")[0], family.rpartition("-")[2], 0.0
        if kind == "gain":
            own = made.gain[name] * (1 + sizes[0])
        elif kind in ("delay", "highpass") and family != "board-delay":
            own = (made.late if kind == "delay" else made.corner)[name]
        elif family == "accelerometer-position":
            own = made.place[name]["xyz".index(target[-1])]
        elif family == "force-plane-offset":
            own = made.plane["xy".index(target)]
        elif family == "cell-stiffness":
            own = (made.stiffness[int(target[0]) - 1, "xyz".index(target[1])] - 1) * (1 + sizes[0])
        elif family == "modulus" and target in parts:
            own = float(softer[sorted(parts).index(target)])
        found[id] = [float(sizes[0] + own), *sizes[1:]]
    return found


def drawn(campaign: Campaign) -> Matrices:
    """The article of `campaign` as the analyst has it; nothing on a bare FMD."""
    matrices = mounted_article(Model(source="drawing", title="", article=campaign.article), campaign).matrices
    if matrices is None:
        nothing = np.zeros((6, 6))
        return Matrices(base=6, mass=nothing, stiffness=nothing, viscous=nothing, structural=nothing)
    return matrices


@dataclass(frozen=True, eq=False, kw_only=True)
class _Carried:
    """All that the cells carry.

    Attributes
    ----------
    plate : (6, 6) the FMD's moving part about F
    rigid : (6, 6) the article about its origin
    participation, omega, zeta : (n, 6), [rad/s] and damping of its modes
    creep : (n,) [rad²/s²] loss of each mode at 10 Hz that rises as the frequency falls
    places : by name the motion (3, 6) of a place with the origin, and (3, n) in the modes
    X : (6, 6) motion of the article's origin for that of F
    """

    plate: Array
    rigid: Array
    participation: Array
    omega: Array
    zeta: Array
    creep: Array
    places: Mapping[str, tuple[Array, Array]]
    X: Array

    @classmethod
    def of(
        cls,
        matrices: Matrices,
        made: Hardware,
        stands: Mounting,
        sheet: DataSheet,
        own: np.random.Generator,
        generator: np.random.Generator,
        faults: Faults,
        on: Bench,
    ) -> _Carried:
        b = matrices.base
        K, M = np.array(matrices.stiffness), np.array(matrices.mass)
        S, creep = np.array(matrices.structural), np.zeros_like(K)
        for part in sorted(matrices.parts):  # the same in every campaign that has the part
            share = matrices.parts[part]
            K += (sheet.modulus * own.uniform(-1, 1) + faults.of("modulus", part)) * share
            S += faults.of("structural-damping", part) * share
            creep += faults.of("creeping", part) * share
            if part.endswith(LAYER):
                S += faults.of("layer-damping", part.removesuffix(LAYER)) * share
        M = M * (1 + sheet.density * generator.uniform(-1, 1))
        for at, mass in zip(FLANGE, bolts(sheet, FLANGE, generator), strict=True):
            rides = _arm(at)[:3]
            M[:b, :b] += mass * rides.T @ rides * bool(M.any())
        about = _arm(-np.array(matrices.cog))  # ten parameters about the centre of gravity, seen from the origin
        for parameter, (size, *_) in faults.family("rigid-inertia").items():
            unit = Inertia(parameters=np.eye(10)[PARAMETERS.index(parameter)]).mass_matrix
            M[:b, :b] += size * np.linalg.inv(about).T @ unit @ np.linalg.inv(about)
        square, shapes = eigh(K[b:, b:], M[b:, b:]) if len(K) > b else (np.zeros(0), np.zeros((0, 0)))
        omega = np.sqrt(square)
        lost, crept = (np.einsum("kr,kl,lr->r", shapes, one[b:, b:], shapes) for one in (S, creep))
        viscous = np.einsum("kr,kl,lr->r", shapes, matrices.viscous[b:, b:], shapes) / np.maximum(2 * omega, 1e-9)
        zeta = np.maximum(lost / np.maximum(2 * square, 1e-9) + viscous, 1e-4)
        Q = Rotation.from_rotvec(stands.turned + faults.vector("orientation")).as_matrix()
        fmd = inertia(built_in("fmd"))
        tensor = made.moments[:, None] ** 0.5 * fmd.tensor_cog * made.moments**0.5
        C, m = _cross(np.array(fmd.cog) + made.cog), fmd.mass * made.mass
        return cls(
            plate=np.block([[m * np.eye(3), -m * C], [m * C, tensor - m * C @ C]]),
            rigid=M[:b, :b],
            participation=shapes.T @ M[b:, :b],
            omega=omega,
            zeta=zeta * np.exp(sheet.damping * generator.standard_normal(len(omega))),
            creep=crept,
            places={name: (rows[:, :b], rows[:, b:] @ shapes) for name, rows in matrices.places.items()},
            X=np.kron(np.eye(2), Q.T) @ _arm(np.array(on.seat) + stands.beside + faults.vector("mounting-offset")),
        )

    def at(self, omega: Array, G: Array, level: Array, faults: Faults) -> ComplexArray:
        """(n, 6, 6) at `omega` (n,): the load on F for its acceleration, of which `G` (n, 6, 6) is what a mass feels.

        The `level` (6,) of a run tells how far a seat slips.
        """
        w = omega[:, None]
        rising = np.sqrt(2 * np.pi * 10 / np.maximum(w, 2 * np.pi))
        answer = w**2 / (self.omega**2 - w**2 + 2j * self.zeta * self.omega * w + 1j * self.creep * rising)
        by_mode = self.participation[:, :, None] * self.participation[:, None, :]
        elastic = (answer @ by_mode.reshape(-1, 36)).reshape(-1, 6, 6)
        X, H = self.X, self.rigid + elastic
        for place, mu, tied in hung(faults, omega, set(self.places)):
            # p = T a - A mu p with A = - phi w² / D phi^T; what is tied to the ground feels the true motion of its place
            rides, moves = self.places[place]
            by_base = rides + (moves * answer[:, None, :]) @ self.participation
            A = -(moves * answer[:, None, :]) @ moves.T
            felt = by_base if not tied else by_base + rides @ X @ (np.linalg.inv(G) - np.eye(6)) @ np.linalg.inv(X)
            H = H + by_base.transpose(0, 2, 1) @ mu @ np.linalg.solve(np.eye(3) + A @ mu, felt)
        C = np.zeros((len(omega), 6, 6), dtype=np.complex128)
        for direction, gives in DIRECTIONS.items():
            C[:, gives, gives] = faults.of("joint-compliance", direction)
        moment = np.linalg.norm((H @ (X @ level))[:, 3:5], axis=1)
        C[:, [3, 4], [3, 4]] += (faults.of("slipping", "seat") * moment / (SLIPS + moment) * (1 - 0.4j))[:, None]
        H = np.linalg.solve(np.eye(6) - omega[:, None, None] ** 2 * H @ C, H)
        whole = np.asarray(self.plate + X.T @ H @ X, dtype=np.complex128)
        for axis, (m, f, zeta) in faults.family("appendage").items():
            k = MOTIONS.index(axis)
            whole[:, k, k] = whole[:, k, k] + m * resonance(omega, f, zeta)
        whole[:, 3:, 3:] -= _cross(np.array([0, 0, faults.of("rotor", "seat")])) / (1j * omega[:, None, None])
        return np.asarray(whole)


def hung(faults: Faults, omega: Array, places: set[str]) -> Iterator[tuple[str, ComplexArray, bool]]:
    """What `faults` hang on `places`: where, its dynamic mass (n, 3, 3), and whether it is tied to the ground."""
    for id, size in faults.sizes.items():
        family, _, target = id.partition(":")
        place, _, direction = target.partition(":")
        if place not in places:
            continue
        mu = np.zeros((len(omega), 3), dtype=np.complex128)
        if family == "point-mass":
            mu[:] = size[0]
        elif family == "absorber":
            mu[:] = (size[0] * resonance(omega, *size[1:]))[:, None]
        elif family == "slosh":
            mu[:, :2] = (size[0] * resonance(omega, *size[1:]))[:, None]
        elif family == "hanging":
            for f in HANGS:
                mu[:, :2] += (size[0] / len(HANGS) * resonance(omega, f, 0.12))[:, None]
        elif family in ("cable", "damper"):
            along = ALONG[direction]
            mu[:, along] = (-size[0] / omega**2 if family == "cable" else size[0] / (1j * omega))[:, None]
        else:
            continue
        yield place, np.asarray(mu[:, :, None] * np.eye(3)), family in ("cable", "damper")


def resonance(omega: Array, f: float, zeta: float) -> ComplexArray:
    """(n,) what a mass on a spring adds, as a share of itself."""
    own = 2 * np.pi * f
    spring = own**2 + 2j * zeta * own * omega
    return np.asarray(spring / (spring - omega**2))


def _run(
    axis: str,
    carried: _Carried,
    made: Hardware,
    of: Campaign,
    faults: Faults,
    cross: float,
    generator: np.random.Generator,
    on: Bench,
) -> tuple[Run, Recording]:
    low, high = on.band
    span = 60 * np.log2(high / low) / on.pace
    count = int((on.quiet + span + on.ringing) * on.rate)
    time = np.arange(count) / on.rate - on.quiet
    going = (time >= 0) & (time <= span)
    k = np.log(2) * on.pace / 60
    fade = np.clip(time / 0.3, 0, 1) * np.clip((span - time) / 0.3, 0, 1)
    wave = np.where(going, fade * np.sin(2 * np.pi * low * np.expm1(k * np.where(going, time, 0)) / k), 0.0)
    driven = np.fft.rfft(wave)
    frequency = np.fft.rfftfreq(count, 1 / on.rate)
    omega = 2 * np.pi * np.maximum(frequency, 1e-3)
    driven[(frequency < 0.8) | (frequency > 2 * high)] = 0.0
    there = np.flatnonzero(driven)
    omega, driven = omega[there], driven[there]
    level = np.array([LEVELS[one] for one in MOTIONS])
    along = np.where(np.array(MOTIONS) == axis, level, 0.0)
    other = cross * generator.standard_normal(6) * np.exp(2j * np.pi * generator.random(6))
    table = np.outer(driven, along + other * level)  # apparent, (n, 6)
    E = np.zeros((6, 6))
    E[0, 4], E[1, 3] = 1.0, -1.0
    square = (omega**2)[:, None, None]
    G, back = np.eye(6) + GRAVITY / square * E, np.eye(6) - GRAVITY / square * E
    t = (back @ table[..., None]) / -square
    B = np.zeros((CELLS, 3, 6))
    for c, at in enumerate(on.cells):
        for a in range(3):
            height = made.plane[a] + faults.of("force-plane-offset", "xy"[a]) if a < 2 else 0.0
            B[c, a] = _arm(at + height * np.array([0, 0, 1]))[a]
    k_cells = np.array(on.stiffness) * made.stiffness
    for name, gives in (("lateral", [0, 1]), ("vertical", [2])):
        k_cells[:, gives] /= faults.of("fmd-compliance", name) or 1.0
    for target, (size, *_) in faults.family("cell-stiffness").items():
        k_cells[int(target[0]) - 1, "xyz".index(target[1])] *= 1 + size
    K = np.einsum("cam,ca,can->mn", B, k_cells, B)
    loads = carried.at(omega, G, along, faults) @ G
    q = np.linalg.solve(K - square * loads, K @ t)
    forces = k_cells * np.einsum("cam,nm->nca", B, (t - q)[..., 0])
    read = np.einsum("cij,ncj->nci", made.cells, forces)
    for pair, (size, *_) in faults.family("force-crosstalk").items():
        read[:, :, "xyz".index(pair[0])] += size * forces[:, :, "xyz".index(pair[1])].mean(axis=1)[:, None]
    plate = (G @ (-square * q))[..., 0]
    vertical = forces[:, :, 2].sum(axis=1)
    out = np.zeros((len(frequency), len(of.table)), dtype=np.complex128)
    for column, channel in enumerate(of.table.channels):
        name, group = channel.name, channel.group
        if channel.quantity == "force":
            letter = name.split("-")[1][0]
            numbers = [int(n) - 1 for n in name.split("-")[1][1:]]
            signal = read[:, numbers, "xyz".index(letter)].sum(axis=1) * (1 - faults.of("load-path-shunt", letter))
            family, board = "force", "force"
        else:
            motion = table if group == "table" else plate
            at = channel.places[0].position + made.place[name] + faults.vector("accelerometer-position", name)
            points = channel.places[0].direction + made.direction[name]
            points = points + np.cross(faults.vector("accelerometer-misalignment", name), channel.places[0].direction)
            signal = motion @ (points @ _arm(at)[:3])
            if group == "cover":
                signal = signal - omega**2 * faults.of("cover-plate-flexibility") * points[2] * vertical
            family, board = "accelerometer", group
        late = made.late[name] + faults.of(f"{family}-delay", name) + faults.of("board-delay", board)
        gain = (1 + made.gain[name]) * (1 + faults.of(f"{family}-gain", name))
        gain = gain * (1 + faults.of("rising", name) * (omega / (2 * np.pi * 32)) ** 2)
        corner = made.corner[name] + faults.of(f"{family}-highpass", name)
        out[there, column] = signal * gain * np.exp(-1j * omega * late) / (1 - 2j * np.pi * corner / omega)
    values = np.fft.irfft(out, n=count, axis=0)
    rms = np.array([{"acceleration": on.acceleration, "force": on.force}[channel.quantity] for channel in of.table.channels])
    values += rms * generator.standard_normal(values.shape)
    for name in faults.family("polarity"):
        values[:, of.table.names.index(name)] *= -1
    stated = Excitation(
        kind="sine-sweep", figures={"start_hz": low, "stop_hz": high, "octaves_per_minute": on.pace, "level": float(LEVELS[axis])}
    )
    run = Run(name=axis, file=f"{axis}.h5", axis=axis, excitation=stated)
    return run, Recording(names=of.table.names, values=values, sampling_rate=on.rate, source=axis)


def _cross(at: Array) -> Array:
    x, y, z = at
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def _arm(at: Array) -> Array:
    """(6, 6) motion at `at` (3,) for one of the origin: ``v + w x r``."""
    T = np.eye(6)
    T[:3, 3:] = -_cross(at)
    return T
