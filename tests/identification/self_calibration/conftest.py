"""A laboratory on paper: six runs through a known chain on a known structure, straight as spectra."""

from dataclasses import dataclass, field, replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.inertia import Inertia
from geometry.sensors import ChannelTable, Tolerances
from identification.campaign import Campaign
from identification.chain import chain
from identification.elastic import model
from identification.elastic.model import ElasticTerms
from identification.request import Evidence, Known, Settings, TareSpectra
from identification.spectra.line_spectra import Spectra

STIFFNESS = np.array([1e8, 1e8, 4e8])
NOISE = {"acceleration": 2e-3, "force": 0.05}
"""Of spectra whose driven level is that of `LEVELS`."""

FMD = Inertia.from_cog(18.0, [0.001, -0.0005, 0.024], np.diag([0.25, 0.26, 0.5]))
CUBOID = Inertia.from_cog(23.1, [0.0, 0.0, 0.16], np.diag([0.5, 0.52, 0.2]))
ARTICLE = Inertia.from_cog(33.0, [0.002, -0.003, 0.31], [[6.4, 0.02, -0.03], [0.02, 6.0, 0.01], [-0.03, 0.01, 0.77]])

MODES = ElasticTerms(
    frequency=np.array([11.5, 16.2]),
    damping=np.array([[0.6, 0.1], [0.1, 0.7]]),
    participation=np.array([[3.5, 0.2, 0.0, 0.1, 2.0, 0.0], [0.1, 3.2, 0.3, -1.8, 0.0, 0.1]]),
    residual=1e-5 * np.diag([3.0, 3.0, 2.0, 0.5, 0.5, 0.1]),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class Laboratory:
    """A chain with its deviations from nominal, and a generator for noise."""

    rng: np.random.Generator
    table: ChannelTable
    tolerances: Tolerances
    noise: float = 1.0
    frequency: np.ndarray = field(default_factory=lambda: np.arange(4.0, 32.01, 1.0))
    theta: np.ndarray | None = None

    @property
    def chain(self):
        return chain(self.table, self.tolerances, stiffness=STIFFNESS)

    def drawn(self) -> "Laboratory":
        """The same laboratory with deviations drawn from their tolerances."""
        return replace(self, theta=self.rng.standard_normal(len(self.chain.parameters)) * self.chain.tolerances)

    def spectra(self, standing: Inertia, terms: ElasticTerms | None = None) -> Spectra:
        """Six sweeps with a few per cent of cross motion, of the FMD and what stands on it."""
        of, f = self.chain, self.frequency
        H = model.dynamic_mass((FMD + standing).mass_matrix, terms or ElasticTerms(), f)
        a0, a1 = of.rows(np.zeros(len(of.parameters)) if self.theta is None else self.theta, f)
        level = np.array([LEVELS[axis] for axis in MOTIONS])
        cross = 0.03 * (self.rng.standard_normal((6, 6)) + 1j * self.rng.standard_normal((6, 6)))
        slope = 1 + 0.2 * self.rng.standard_normal((6, 6)) * np.linspace(-1, 1, len(f))[:, None, None]
        motion = ((np.eye(6) + cross) * slope * level).transpose(1, 0, 2)  # (run, line, motion)
        y = np.zeros((6, len(f), len(self.table)), dtype=np.complex128)
        y[:, :, of.columns] = ((a0 + a1 @ H) @ motion[..., None])[..., 0]
        sd = self.noise * np.array([NOISE[one.quantity] for one in self.table.channels])
        noise = np.broadcast_to(sd, y.shape)
        y += noise * (self.rng.standard_normal(y.shape) + 1j * self.rng.standard_normal(y.shape)) / np.sqrt(2)
        return Spectra(
            table=self.table, frequency=f, values=y, noise=noise, quality=np.ones(y.shape[:2]), runs=MOTIONS, axes=MOTIONS
        )

    def settings(self, **more: object) -> Settings:
        return replace(Settings(tolerances=self.tolerances, stiffness=STIFFNESS), **more)

    def evidence(self, *, terms: ElasticTerms | None = None, relative: float = 3e-4, **more: object) -> Evidence:
        """The article, and the Cuboid as a tare."""
        tare = TareSpectra(spectra=self.spectra(CUBOID), known=Known.within(CUBOID, relative), hardware="a", name="cuboid")
        given = {"article": self.spectra(ARTICLE, terms), "tares": (tare,), "hardware": "a"}
        return Evidence(**{**given, **more})


@pytest.fixture(scope="session")
def exact(lab) -> Laboratory:
    """No noise, no deviation, nothing to calibrate but the softness of the cells."""
    return lab.Laboratory(rng=np.random.default_rng(1), tolerances=Tolerances().scaled(0.0), noise=0.0)


@pytest.fixture(scope="session")
def ordinary(lab) -> Laboratory:
    """Ordinary tolerances, drawn once, and noise."""
    return lab.Laboratory(rng=np.random.default_rng(2), tolerances=Tolerances()).drawn()


NOTHING = Inertia(parameters=np.zeros(10))


@pytest.fixture(scope="session")
def lab(campaign: Campaign):
    """Names of this module, for tests that cannot import it."""
    return SimpleNamespace(
        FMD=FMD,
        CUBOID=CUBOID,
        ARTICLE=ARTICLE,
        NOTHING=NOTHING,
        MODES=MODES,
        Laboratory=partial(Laboratory, table=campaign.table),
    )
