"""What identification costs: beside the test itself, Eqs. 9 to 11 written out, other people's spectra; and as it grows.

The first table identifies a virtual campaign of six sweeps of a minute and a half; the time of the test is that of its records.
The second sets Eqs. 9 to 11 for all lines at once beside a loop over the lines. The third makes the dynamic mass from the same
records of motions and loads in five ways and says how far each is off: the loads come from a dynamic mass with one lightly damped
mode, so the truth is known at every line. The others grow channels, lines and runs one at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec

import numpy as np

from benchmarks.ratios import Timing, measure, show
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.frames import Array
from geometry.inertia import Inertia
from geometry.sensors import Channel, ChannelTable, Place, motion_rows, resultants
from identification import base_motion, identify, rigid_body
from identification.base_motion import RunNoise
from identification.campaign import Campaign
from identification.dynamic_mass import corrected, from_runs
from identification.elastic import model
from identification.elastic.model import ElasticTerms
from identification.request import Request
from identification.spectra.line_spectra import Spectra, full_record
from identification.spectra.of_campaign import spectra
from identification.spectra.peak_hold import peak_reference_hold
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate

ARTICLE = "fmd+clumod-1"
LINES = np.round(np.arange(4.0, 32.01, 0.05), 6)
LEVEL = np.array([LEVELS[axis] for axis in MOTIONS])
RATE, BLOCK, OVERLAP = 564, 8192, 0.9
"""The paper's settings: samples a second, samples a block, share of a block."""

BODY = Inertia.from_cog(mass=41.0, cog=[0.0, 0.0, 0.1], tensor=np.diag([0.9, 0.95, 0.75]))
RESONANCE, DAMPING = 12.3, 0.0035

Call = Callable[[], object]


# --- beside the test -----------------------------------------------------------------------------------------------------


def campaign() -> None:
    """A full campaign beside the time that it takes on the shaker."""
    made: Campaign = simulate(Plan(article=ARTICLE)).campaign
    of = spectra(made)
    lasted = sum(len(one.values) / float(one.sampling_rate or 1) for one in made.recordings.values())
    calls: dict[str, Call] = {"spectra": partial(spectra, made), "Eqs. 2 to 11, ten parameters": partial(plain, of)}
    timings = {"six sweeps on the shaker": Timing(fastest=lasted, median=lasted)} | measure(calls, rounds=3)
    timings |= measure({"both ways, elastic, with intervals": partial(identify.identify, Request(campaign=made))}, rounds=1)
    show(
        f"A campaign of {ARTICLE}: {len(of.table)} channels, {len(of.frequency)} lines", timings, base="six sweeps on the shaker"
    )


def plain(of: Spectra) -> rigid_body.RigidFit:
    """Eqs. 2 to 11, and Eqs. 1 and 4 turned round."""
    motion, load = base_motion.base_motion(of), base_motion.resultants(of)
    return rigid_body.fit(from_runs(load.values, motion.values, of.frequency).dynamic_mass)


# --- beside Eqs. 9 to 11 written out -------------------------------------------------------------------------------------


def written_out() -> None:
    """All lines at once, with condition numbers, beside a loop over the lines; and errors in variables."""
    of = drawn(ChannelTable(channels=channels()), LINES, 12)
    U, F = base_motion.base_motion(of), base_motion.resultants(of)
    noise = RunNoise(load=F.covariance, motion=U.covariance)
    estimate = from_runs(F.values, U.values, of.frequency)
    calls: dict[str, Call] = {
        "line by line": partial(line_by_line, F.values[:6], U.values[:6]),
        "massline, 6 runs": partial(from_runs, F.values[:6], U.values[:6], of.frequency),
        "line by line, least squares of 12 runs": partial(line_by_line, F.values, U.values),
        "massline, 12 runs": partial(from_runs, F.values, U.values, of.frequency),
        "massline, 12 runs, errors in variables": partial(corrected, F.values, U.values, noise, estimate),
    }
    truth = line_by_line(F.values[:6], U.values[:6])
    apart = np.abs(from_runs(F.values[:6], U.values[:6], of.frequency).dynamic_mass.matrix - truth).max() / np.abs(truth).max()
    notes = {"massline, 6 runs": f"{apart:.1e} from line by line"}
    show(f"Eqs. 9 to 11, {len(LINES)} lines", measure(calls), base="line by line", notes=notes)


def line_by_line(load: ComplexArray, motion: ComplexArray) -> ComplexArray:
    """Eq. 11 as it stands in the paper: S_f S_u^-1, a line at a time; with more than six runs by least squares."""
    H = np.empty((load.shape[1], 6, 6), dtype=np.complex128)
    for line in range(load.shape[1]):
        S_f, S_u = load[:, line].T, motion[:, line].T
        H[line] = S_f @ np.linalg.inv(S_u) if len(load) == 6 else np.linalg.lstsq(S_u.T, S_f.T, rcond=None)[0].T
    return H


# --- beside other spectra ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, kw_only=True)
class Records:
    """Motions and loads (runs, samples, 6) of six sweeps, and the dynamic mass (n, 6, 6) behind them at `LINES`."""

    motion: Array
    load: Array
    truth: ComplexArray


def other_spectra() -> None:
    """The same records through five kinds of spectra."""
    of = records()
    ways: dict[str, Callable[[Records], ComplexArray]] = {
        "massline, full record": by_full_record,
        "massline, peak-reference-hold": by_peak_hold,
        "scipy.signal.csd, blocks": by_scipy,
    }
    if find_spec("pyFRF"):
        ways |= {"pyFRF H1, full record": by_pyfrf, "pyFRF H1, blocks": partial(by_pyfrf, block=BLOCK)}
    notes = {name: error(way(of), of.truth) for name, way in ways.items()}
    absent = "" if find_spec("pyFRF") else "; pyFRF is not installed"
    title = f"Dynamic mass from the same records, {len(of.motion)} sweeps of {of.motion.shape[1] / RATE:.0f} s"
    timings = measure({name: partial(way, of) for name, way in ways.items()}, rounds=2)
    show(f"{title} (error at the resonance, elsewhere{absent})", timings, base="massline, full record", notes=notes)


def records() -> Records:
    """Six logarithmic sweeps, 4 to 32 Hz at two octaves a minute, with cross motion; silence for the ring-down of the mode."""
    rng, seconds, ring = np.random.default_rng(0), 90.0, 14.0
    t = np.arange(int(seconds * RATE)) / RATE
    phase = 2 * np.pi * 4.0 * seconds / np.log(8.0) * np.expm1(t / seconds * np.log(8.0))
    fade = np.clip(np.minimum(t, seconds - t) / 0.5, 0, 1)
    shares = np.eye(6) + 0.03 * rng.standard_normal((6, 6))
    sweeps = np.sin(phase + rng.uniform(0, 2 * np.pi, (6, 6, 1))) * fade * (shares * LEVEL)[:, :, None]
    motion = np.concatenate([sweeps, np.zeros((6, 6, int(ring * RATE)))], axis=2).transpose(0, 2, 1)
    length = 2 * motion.shape[1]
    every = dynamic_mass(np.asarray(np.fft.rfftfreq(length, 1 / RATE), dtype=np.float64))
    load = np.fft.irfft(np.einsum("njk,rnk->rnj", every, np.fft.rfft(motion, length, axis=1)), length, axis=1)
    return Records(motion=motion, load=load[:, : motion.shape[1]], truth=dynamic_mass(LINES))


def dynamic_mass(lines: Array) -> ComplexArray:
    """A body with one mode along x and beta."""
    damping = np.array([[2 * DAMPING * 2 * np.pi * RESONANCE]])
    terms = ElasticTerms(frequency=np.array([RESONANCE]), damping=damping, participation=np.array([[2.0, 0, 0, 0, 1.0, 0]]))
    return model.dynamic_mass(BODY.mass_matrix, terms, lines)


def by_full_record(of: Records) -> ComplexArray:
    U, F = (np.stack([full_record(run, RATE, LINES) for run in both]) for both in (of.motion, of.load))
    return from_runs(F, U, LINES).dynamic_mass.matrix


def by_peak_hold(of: Records) -> ComplexArray:
    held = []
    for run, (motion, load) in enumerate(zip(of.motion, of.load, strict=True)):
        every = np.concatenate([motion, load], axis=1)
        held.append(peak_reference_hold(every, RATE, motion[:, run], LINES, block_size=BLOCK, overlap=OVERLAP))
    both = np.stack(held)
    return from_runs(both[..., 6:], both[..., :6], LINES).dynamic_mass.matrix


def by_scipy(of: Records) -> ComplexArray:
    """H1 of six inputs: cross spectra of all runs added up, S_fu S_uu^-1, between the lines of the blocks by interpolation."""
    from scipy.signal import csd

    options = {"fs": RATE, "nperseg": BLOCK, "noverlap": int(OVERLAP * BLOCK), "axis": -1, "detrend": False}
    U, F = of.motion.transpose(0, 2, 1), of.load.transpose(0, 2, 1)
    native, S_uu = csd(U[:, :, None], U[:, None], **options)
    _, S_uf = csd(U[:, :, None], F[:, None], **options)
    H = np.linalg.solve(S_uu.sum(axis=0).transpose(2, 0, 1), S_uf.sum(axis=0).transpose(2, 0, 1)).swapaxes(1, 2)
    return at_lines(native, H)


def by_pyfrf(of: Records, block: int | None = None) -> ComplexArray:
    """The same estimator by pyFRF, over whole records - padded with zeros to lines of 0.05 Hz - or over blocks."""
    from pyFRF import FRF

    U, F = of.motion.transpose(0, 2, 1), of.load.transpose(0, 2, 1)
    step = round(RATE / 0.05)
    whole = {"window": "none", "fft_len": -(-U.shape[2] // step) * step}
    blocks = {"window": "hann", "nperseg": block, "noverlap": int(OVERLAP * BLOCK), "fft_len": block}
    found = FRF(RATE, U, F, exc_type="a", resp_type="e", **(blocks if block else whole))
    H = np.moveaxis(found.get_H1(), -1, 0)
    return at_lines(found.get_f_axis(), H)


def at_lines(native: Array, H: ComplexArray) -> ComplexArray:
    """H (m, 6, 6) at `native` lines, interpolated to `LINES`."""
    flat = H.reshape(len(native), 36).T
    return np.stack([np.interp(LINES, native, entry) for entry in flat], axis=1).reshape(-1, 6, 6)


def error(found: ComplexArray, truth: ComplexArray) -> str:
    """Largest error within 0.5 Hz of the resonance and beyond, entries as shares of the rms of sqrt(H_jj H_kk) at the line."""
    own = np.sqrt(np.abs(np.diagonal(truth, axis1=1, axis2=2)))
    share = np.abs(found - truth) / (own[:, :, None] * own[:, None, :])
    near = np.abs(LINES - RESONANCE) < 0.5
    return f"{share[near].max():.1e}, {share[~near].max():.1e}"


# --- as it grows ---------------------------------------------------------------------------------------------------------


def growth() -> None:
    """Channels, lines and runs, one at a time."""
    cases = {
        "channels": {22 + more: (channels(more), LINES, 6) for more in (0, 22, 66, 154)},
        "lines": {count: (channels(), np.linspace(4.0, 32.0, count), 6) for count in (141, 281, 561, 1121)},
        "runs": {count: (channels(), LINES, count) for count in (6, 12, 24, 48)},
    }
    for what, sizes in cases.items():
        made = {
            f"{size} {what}": drawn(ChannelTable(channels=table), lines, count) for size, (table, lines, count) in sizes.items()
        }
        calls: dict[str, Call] = {name: partial(plain, of) for name, of in made.items()}
        show(f"Eqs. 2 to 11 and ten parameters: more {what}", measure(calls, rounds=5), base=next(iter(calls)))


def channels(more: int = 0) -> tuple[Channel, ...]:
    """Cover plate and load cells of the virtual laboratory, and `more` pick-ups on the plate."""
    table = simulate_table()
    rng = np.random.default_rng(1)
    extra = [
        Channel(
            name=f"cover-extra-{k}",
            quantity="acceleration",
            group="cover",
            places=(Place(position=rng.uniform(-0.2, 0.2, 3), direction=np.eye(3)[k % 3]),),
        )
        for k in range(more)
    ]
    return (*extra, *table.channels)


def simulate_table() -> ChannelTable:
    """The paper's 22 channels."""
    from validation.virtual_test.simulate import laboratory

    return laboratory(Plan(article="fmd+disc+cuboid", model="rigid")).layout.table


def drawn(table: ChannelTable, lines: Array, runs: int) -> Spectra:
    """Spectra of a rigid body as these channels read it, with noise of 0.1 %."""
    rng = np.random.default_rng(2)
    shape = (runs, len(lines), 6)
    U = (np.eye(6)[np.arange(runs) % 6][:, None] + 0.03 * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))) * LEVEL
    F = U @ BODY.mass_matrix
    values = np.empty((runs, len(lines), len(table)), dtype=np.complex128)
    moved, felt = list(table.select(quantity="acceleration")), list(table.select(quantity="force"))
    values[..., moved] = U @ motion_rows([table.channels[k] for k in moved], table.origin).T
    values[..., felt] = F @ np.linalg.pinv(resultants([table.channels[k] for k in felt], table.origin)).T
    sd = 1e-3 * np.broadcast_to(np.sqrt(np.mean(np.abs(values) ** 2, axis=(0, 1))), values.shape)
    noise = sd * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)) / np.sqrt(2)
    names = tuple(f"run-{k}" for k in range(runs))
    made = Spectra(
        table=table, frequency=lines, values=values, noise=sd, quality=np.ones(shape[:2]), runs=names, axes=("",) * runs
    )
    return replace(made, values=values + noise)


if __name__ == "__main__":
    for each in (campaign, written_out, other_spectra, growth):
        each()
