"""The recorded swing: sampled, noisy, written as any recorder's file, and reduced by the code that reduces measured ones."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fem.flexible_body.rope_pendulum import Swing, small_period, swing
from fem.flexible_body.rope_pendulum.watch import Progress
from geometry.arrays import Array, frozen
from geometry.atomic import write_text
from geometry.errors import BadInput
from validation import pendulum_file
from validation.measurement_file import read
from validation.pendulum_corrections import TERMS, rope_amplitude_factor
from validation.period import Decay, from_signal
from validation.swing.setup import SOURCE, Setup, require_recordable

SURPLUS, LEAST_SURPLUS = 0.15, 0.05
"""Cycles recorded beyond those asked for, as foreseen and as found. Pitch and sway that no formula foresees may make
them longer than thought; where less than the second is left the pendulum swings once more, for longer."""

RECORD, MEASUREMENT = "record.csv", "pendulum.toml"


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """A swing and what the recorder made of it.

    Attributes
    ----------
    setup : that was simulated
    swing : by exudyn, sampled at the recorder's rate
    signal : (n,) [rad] yaw with noise
    decay : the decaying sinusoid fitted to it
    plain, corrected : moment of inertia [kg m²] by Eq. 5 alone and with every correction
    effects : relative change that each correction makes
    """

    setup: Setup
    swing: Swing
    signal: Array
    decay: Decay
    plain: float
    corrected: float
    effects: dict[str, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "signal", frozen(self.signal, np.shape(self.swing.yaw), "signal"))

    @property
    def period(self) -> float:
        """[s]"""
        return float(self.decay.period.nominal_value)

    @property
    def shift(self) -> float:
        """Of the period, relative to that of Eq. 5."""
        return self.period / self.setup.ideal_period - 1


def recorded(setup: Setup, progress: Progress | None = None) -> Record:
    """`setup` simulated, recorded and reduced.

    Raises
    ------
    BadInput : it cannot be hung, simulated or recorded like that.
    CheckFailed : exudyn failed, or a rope slacks.
    """
    require_recordable(setup)
    run = _run(setup, progress)
    noise = np.random.default_rng(setup.seed).normal(0.0, setup.noise, len(run.yaw)) if setup.noise else 0.0
    signal = run.yaw + noise
    decay = _fitted(setup, run, signal)
    with TemporaryDirectory() as folder:
        path = write(Path(folder), setup, run, signal, decay)
        file = read(str(path), ("pendulum",))
        with_all, plain = (pendulum_file.reduce(file, off) for off in ((), TERMS))
    key = f"I{setup.axis}{setup.axis}"
    return Record(
        setup=setup,
        swing=run,
        signal=signal,
        decay=decay,
        plain=float(plain.results[key].nominal_value),
        corrected=float(with_all.results[key].nominal_value),
        effects=dict(with_all.terms[key]),
    )


def write(folder: Path, setup: Setup, run: Swing, signal: Array, decay: Decay) -> Path:
    """Write record and measurement file into `folder`; where the measurement file is."""
    head = f"# Simulated by massline swing with exudyn {run.settings['version']}, not measured. Columns: time [s], twist [rad]"
    rows = [f"{t:.9g},{y:.9g}" for t, y in zip(run.time, signal, strict=True)]
    write_text(folder / RECORD, "\n".join([head, *rows]) + "\n")
    write_text(folder / MEASUREMENT, _measurement(setup, run, decay))
    return folder / MEASUREMENT


def _run(setup: Setup, progress: Progress | None) -> Swing:
    s1, s2 = setup.s1_s2
    small = small_period(setup.inertia, setup.suspension, setup.gravity)
    kappa = setup.inertia.mass * s1 * s2 / setup.reference
    cycle = small * rope_amplitude_factor(setup.suspension.amplitude, s1 * s2 / setup.suspension.length**2, kappa)
    more: dict[str, Any] = {"step": setup.step, "rate": setup.rate, "gravity": setup.gravity, "progress": progress}
    run = swing(setup.inertia, setup.suspension, duration=(setup.cycles + SURPLUS) * cycle, **more)
    took = _cycle(run)
    if run.time[-1] > (setup.cycles + LEAST_SURPLUS) * took:
        return run
    return swing(setup.inertia, setup.suspension, duration=(setup.cycles + SURPLUS) * took, **more)


def _cycle(run: Swing) -> float:
    """[s] of one cycle on average, from the passages through the middle of the twist."""
    y = run.yaw - np.mean(run.yaw)
    k = np.flatnonzero(np.signbit(y[1:]) != np.signbit(y[:-1]))
    t = run.time[k] + np.diff(run.time)[k] * y[k] / (y[k] - y[k + 1])
    return float(2 * (t[-1] - t[0]) / (len(t) - 1)) if len(t) > 1 else 0.0


def _fitted(setup: Setup, run: Swing, signal: Array) -> Decay:
    """The decaying sinusoid in `signal`; what cannot be fitted is said of what can be changed here."""
    try:
        return from_signal(run.time, signal, "the simulated record")
    except BadInput as error:
        name = "noise" if setup.noise else "amplitude"
        remedy = "Use less noise or a larger twist" if setup.noise else "Use a smaller twist, or lighter and more equal ropes"
        raise BadInput(
            source=SOURCE, field=name, problem=f"its record cannot be reduced: {error.problem}", remedy=remedy
        ) from None


def _measurement(setup: Setup, run: Swing, decay: Decay) -> str:
    """The measurement file: what the laboratory would know. Stretch and an off-centre CoG it would not."""
    s, version = setup.suspension, run.settings["version"]
    radii = [f's{i} = "{radius!r} m"' for i, radius in enumerate(setup.radii, start=1)]
    lines = [
        "# What a laboratory would write down beside its record. Run: massline pendulum pendulum.toml",
        "format = 1",
        'kind = "pendulum"',
        f"title = {_text(setup.article + f' on {s.ropes} ropes, twist simulated')}",
        f"origin = {_text(f'simulated by exudyn {version}, not measured')}",
        f'gravity = "{setup.gravity!r} m/s^2"',
        "",
        "[article]",
        f"name = {_text(setup.article)}",
        f'mass = "{setup.inertia.mass!r} kg"',
        "",
        "[[swing]]",
        f'about = "{setup.axis}"',
        'suspension = "ropes"',
        f'rope_length = "{s.length!r} m"',
        *(radii if len(setup.radii) == 2 else [f'radius = "{setup.radii[0]!r} m"']),
        f'signal = "{RECORD}"',
        f'amplitude = "{decay.amplitude:.9g} rad" # root mean square of the peaks over the record',
        *([f'rope_mass = "{s.rope_mass!r} kg"'] if s.rope_mass else []),
    ]
    return "\n".join(lines) + "\n"


def _text(words: str) -> str:
    """`words` as a TOML string."""
    return json.dumps(words, ensure_ascii=False)
