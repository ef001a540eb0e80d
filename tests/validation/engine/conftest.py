"""A toy laboratory whose truth is known: two base motions, five pick-ups, eight forces, an article that resonates once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from validation.estimation.problem import DECLARED, EFFECT, IDENTIFIED, Change, Measured, Parameter, Predicted

PICK_UPS = ("a1", "a2", "a3", "a4", "a5")
FORCES = tuple(f"f{k}" for k in range(1, 9))
CHANNELS = (*PICK_UPS, *FORCES)
NOISE = 2e-4
"""Of an acceleration of 1; forces are about ten times as large and noisy."""

PLACES = np.array([[1.0, 0.3], [1.0, -0.2], [1.0, 0.5], [0.7, 1.0], [0.4, -1.0]])
SHARES = np.array([[0.25, 0.0]] * 4 + [[0.0, 1.0], [0.0, -1.0], [0.0, 0.5], [0.0, -0.5]])
"""The first four force channels carry a translation, a quarter each; the others carry a turn."""

SENSORS = tuple(Parameter(name=f"gain:{name}", unit="1", tolerance=0.003) for name in CHANNELS)


def resonance(frequency: np.ndarray, f: float, zeta: float) -> np.ndarray:
    """omega² / (omega_r² - omega² + 2 i zeta omega_r omega)."""
    return frequency**2 / (f**2 - frequency**2 + 2j * zeta * f * frequency)


@dataclass(frozen=True, eq=False, kw_only=True)
class Toy:
    """A prediction of one data set of the toy laboratory; `twist` has the last word on what it says."""

    measured: Measured
    parameters: tuple[Parameter, ...]
    stiffer: float = 1.0
    per_run: bool = False
    twist: Callable[..., Predicted] = lambda said, offsets, lines: said

    def on(self, runs: Sequence[str]) -> "Toy":
        return replace(self, measured=self.measured.on(runs))

    def at(self, offsets, lines=None, *, derivatives=True) -> Predicted:
        lines = np.arange(len(self.measured.frequency)) if lines is None else lines
        changes = {p.name: self._change(p, offsets, lines) for p in self.parameters} if derivatives else {}
        return self.twist(Predicted(rows=self._shaped(self._rows(offsets, lines)), changes=changes), offsets, lines)

    def _shaped(self, rows):
        return np.broadcast_to(rows, (len(self.measured.runs), *rows.shape)) if self.per_run else rows

    def _change(self, p, offsets, lines):
        here, step = offsets.get(p.name, 0.0), 1e-5 * (p.tolerance if 0 < p.tolerance < np.inf else 1.0)
        up, down = (self._rows({**offsets, p.name: here + sign * step}, lines) for sign in (1, -1))
        slope = (up - down) / (2 * step)
        channels = tuple(int(c) for c in np.flatnonzero(np.any(slope != 0, axis=(0, 2)))) or (0,)
        return Change(channels=channels, rows=self._shaped(slope[:, channels, :]))

    def _rows(self, offsets, lines):
        known = {p.name: p for p in self.parameters}

        def value(name, absent):
            return known[name].value(offsets.get(name, 0.0)) if name in known else absent

        f = self.measured.frequency[lines]
        mass, inertia = value("mass", 8.0), value("inertia", 2.0)
        own = value(f"frequency:{self.measured.configuration}", 12.0 * self.stiffer)
        bent = 2.0 * resonance(f, own, value("damping", 0.02))
        bent = bent + value("appendage[m]", 0.0) * (1 + resonance(f, value("appendage[f]", 20.0), 0.01))
        H = np.zeros((len(f), 2, 2), dtype=complex)
        H[:, 0, 0], H[:, 1, 1] = mass + bent, inertia + 0.3 * bent
        H[:, 0, 1] = H[:, 1, 0] = 0.4 * bent + value("offset", 0.0)
        rows = np.concatenate([np.broadcast_to(PLACES, (len(f), *PLACES.shape)), SHARES @ H], axis=1)
        gains = np.array([1 + offsets.get(f"gain:{name}", 0.0) for name in CHANNELS])
        return gains[:, None] * rows


LABORATORY = (
    Parameter(name="mass", unit="kg", tolerance=0.05, kind=IDENTIFIED, nominal=8.0, logarithmic=True),
    Parameter(name="inertia", unit="kg m^2", tolerance=0.05, kind=IDENTIFIED, nominal=2.0, logarithmic=True),
    Parameter(name="damping", unit="1", tolerance=0.35, kind=DECLARED, nominal=0.02, logarithmic=True, within=0.875),
    *SENSORS,
)


class Laboratory:
    """Makes data sets of the toy, with a truth and noise."""

    CHANNELS, FORCES, PICK_UPS, LABORATORY, Parameter = CHANNELS, FORCES, PICK_UPS, LABORATORY, Parameter

    @staticmethod
    def frequency_of(configuration: str, stiffer: float = 1.0) -> Parameter:
        return Parameter(
            name=f"frequency:{configuration}",
            unit="Hz",
            tolerance=0.02,
            kind=DECLARED,
            nominal=12.0 * stiffer,
            logarithmic=True,
            within=0.05,
        )

    @staticmethod
    def effect(name: str, tolerance: float, **more: float) -> Parameter:
        return Parameter(name=name, unit="1", tolerance=tolerance, kind=EFFECT, **more)

    @staticmethod
    def toy(
        truth: dict[str, float],
        *,
        name: str = "one",
        configuration: str = "",
        parameters: Sequence[Parameter] = LABORATORY,
        acting: Sequence[Parameter] = (),
        runs: int = 3,
        lines: int = 60,
        seed: int | None = 0,
        stiffer: float = 1.0,
        known: bool = False,
        per_run: bool = False,
        motion: tuple[float, float] = (1.0, 1.0),
    ) -> Toy:
        """A prediction with `parameters` of data made at the offsets `truth` of `parameters` and `acting`; no seed, no noise."""
        configuration = configuration or name
        rng = np.random.default_rng(seed or 0)
        frequency = np.linspace(4.0, 30.0, lines)
        parameters = (*parameters, Laboratory.frequency_of(configuration, stiffer))
        everything = {p.name: p for p in (*parameters, *acting)}
        u = np.array(motion) * (rng.standard_normal((runs, 1, 2)) + 1j * rng.standard_normal((runs, 1, 2)))
        u = u + np.zeros((1, lines, 1))
        shape = (runs, lines, len(CHANNELS))
        noise = NOISE * np.where(np.isin(CHANNELS, FORCES), 3.0, 1.0) * np.ones(shape)
        measured = Measured(
            name=name,
            configuration=configuration,
            runs=tuple(f"r{k + 1}" for k in range(runs)),
            channels=CHANNELS,
            judged=np.isin(CHANNELS, FORCES),
            frequency=frequency,
            values=np.zeros(shape, dtype=complex),
            noise=noise,
            inputs=u if known else None,
        )
        maker = Toy(measured=measured, parameters=tuple(everything.values()), stiffer=stiffer)
        values = (maker._rows(truth, np.arange(lines)) @ u[..., None])[..., 0]
        if seed is not None:
            values = values + noise * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)
        return Toy(measured=replace(measured, values=values), parameters=parameters, stiffer=stiffer, per_run=per_run)

    @staticmethod
    def breaking(where):
        """A twist: the model breaks down at offsets of which ``where(offsets)`` is true."""

        def twist(said, offsets, lines):
            if where(offsets):
                raise np.linalg.LinAlgError("a stiffness turned negative")
            return said

        return twist

    @staticmethod
    def drawn(seed: int, scale: float = 1.0) -> dict[str, float]:
        """Tolerances of the measurement as a laboratory might have them."""
        rng = np.random.default_rng(1000 + seed)
        return {p.name: scale * p.tolerance * float(rng.standard_normal()) for p in SENSORS}


@pytest.fixture(scope="session")
def lab():
    return Laboratory
