"""A small, fast virtual test without any error: all six axes swept at once, a block on the FMD."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from geometry.sensors import ChannelTable, motion_rows, resultants
from validation.effects import catalogue
from validation.effects.catalogue import parse_all
from validation.virtual_test.plan import MULTI, RIGID, Plan, exact
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import laboratory, record, recording, runs

RATE = 256.0


@dataclass(frozen=True)
class Recorded:
    """One run: samples, and their spectra on the lines that were driven."""

    values: Array
    table: ChannelTable

    def column(self, name: str) -> int:
        return self.table.names.index(name)

    @property
    def frequency(self) -> Array:
        return np.fft.rfftfreq(len(self.values), 1 / RATE)[self._driven]

    @property
    def omega(self) -> Array:
        return 2 * np.pi * self.frequency

    @property
    def _driven(self) -> slice:
        return slice(*np.searchsorted(np.fft.rfftfreq(len(self.values), 1 / RATE), (8.0, 32.0)))

    @property
    def spectra(self) -> ComplexArray:
        return np.fft.rfft(self.values, axis=0)[self._driven]

    def spectrum(self, name: str) -> ComplexArray:
        return self.spectra[:, self.column(name)]

    def loads(self) -> ComplexArray:
        """(n, 6) about F, by the channels alone."""
        chosen = self.table.select(quantity="force")
        return self.spectra[:, chosen] @ resultants([self.table.channels[k] for k in chosen], self.table.origin).T

    def motion(self, group: str) -> ComplexArray:
        """(n, 6) of table or cover plate about F, by the channels alone."""
        chosen = self.table.select(group=group)
        rows = motion_rows([self.table.channels[k] for k in chosen], self.table.origin)
        return np.linalg.lstsq(rows, self.spectra[:, chosen].T, rcond=None)[0].T


Recorder = Callable[..., Recorded]


@pytest.fixture(autouse=True)
def _catalogue_as_it_was() -> Iterator[None]:
    """A process keeps what it has read; a test gives it back."""
    kept = [dict(one) for one in (catalogue._found, catalogue._sources, catalogue._files)]
    yield
    for one, before in zip((catalogue._found, catalogue._sources, catalogue._files), kept, strict=True):
        one.clear()
        one.update(before)


@pytest.fixture(scope="session")
def plan() -> Plan:
    quick = Plan(
        article="fmd+disc+cuboid",
        model=RIGID,
        pattern=MULTI,
        band=(8.0, 32.0),
        octaves_per_minute=240.0,
        quiet=0.2,
        rate=RATE,
        simulation_rate=8 * RATE,
    )
    return exact(quick)


@pytest.fixture(scope="session")
def recorder(plan) -> Recorder:
    """Runs the first run with effects as they are written."""

    def run(*effects: str, **changes: object) -> Recorded:
        own = replace(plan, effects=planted(parse_all(effects)), **changes)  # type: ignore[arg-type]
        lab = laboratory(own)
        first = runs(own)[0]
        found = recording(own, lab.layout, lab.chain, first, record(own, lab, first))
        return Recorded(values=found.values, table=lab.layout.table)

    return run


@pytest.fixture(scope="session")
def plain(recorder) -> Recorded:
    """The run without any effect."""
    return recorder()
