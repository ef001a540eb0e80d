"""An effect of one's own, from its file to its size in a campaign: ``python examples/own_effect.py``.

`examples/effects/force_lowpass.py` is put into the catalogue and planted in a virtual test. The quotient of two spectra is its
equation, and a fit that knows nothing but the model and the campaign finds its size.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from identification.campaign import Campaign
from validation.effects import catalogue
from validation.effects.catalogue import parse
from validation.effects.stages import ChannelResponse
from validation.estimation.fit import fit
from validation.estimation.problem import EFFECT, IDENTIFIED, Problem
from validation.model.model import Added, Model
from validation.prediction.series import predictions
from validation.virtual_test.plan import RIGID, Plan, exact
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import simulate

HERE = Path(__file__).parent / "effects"
PLANTED, START = "force-lowpass:fmd-z2=1e-3", "force-lowpass:fmd-z2=1e-5"
ARTICLE, RUN, BAND = "fmd+cuboid", "z", (8.0, 32.0)


def campaign(*effects: str) -> Campaign:
    """Sweeps of a block in a laboratory without any other error."""
    plan = exact(Plan(article=ARTICLE, model=RIGID, band=BAND, octaves_per_minute=120.0, cross=0.0))
    return simulate(replace(plan, effects=planted([parse(text) for text in effects]))).campaign


def spectra(measured: Campaign, channel: str) -> tuple[np.ndarray, np.ndarray]:
    """Lines [Hz] that the sweep along z drives, and the spectrum of a channel there."""
    recorded = measured.recordings[RUN]
    every = np.fft.rfftfreq(len(recorded.values), 1 / (recorded.sampling_rate or 1.0))
    driven = (every > BAND[0] + 2) & (every < BAND[1] - 2)
    return every[driven], np.fft.rfft(recorded.values[:, recorded.names.index(channel)])[driven]


def simulated_beside_the_equation(plain: Campaign, changed: Campaign, out: Console) -> float:
    """Print both at a few lines; how far they differ at most."""
    named = parse(PLANTED)
    (f, before), (_, after) = spectra(plain, named.target), spectra(changed, named.target)
    reading = ChannelResponse(frequency=f, channels=(named.target,), rows=np.ones((len(f), 1, 6), dtype=np.complex128))
    predicted = catalogue.FAMILIES[named.family].change(reading, named.targets, named.values).rows[:, 0, 0]
    for k in np.linspace(0, len(f) - 1, 4, dtype=int):
        out.print(f"{f[k]:6.2f} Hz   simulated {after[k] / before[k]:.4f}   by the equation {predicted[k]:.4f}")
    return float(np.max(np.abs(after / before - predicted)))


def fitted(measured: Campaign, *effects: str) -> tuple[float, dict[str, float]]:
    """Misfit chi² of a model with `effects`, and the size that each was found to have."""
    added = tuple(Added(named=parse(text)) for text in effects)
    model = Model(source="own_effect.py", title="the block", article=ARTICLE, kind="rigid", effects=added)
    found = fit(Problem(predictions(model, [measured])).thinned(), (IDENTIFIED, EFFECT))
    sizes = {one.name: one.value(float(x)) for one, x in zip(found.parameters, found.offsets, strict=True) if one.kind == EFFECT}
    return found.chi2, sizes


def main(console: Console | None = None) -> tuple[float, float]:
    """Print both proofs; how far equation and simulation differ, and the size that was found [s]."""
    out = console or Console()
    catalogue.load(HERE)
    plain, changed = campaign(), campaign(PLANTED)
    worst = simulated_beside_the_equation(plain, changed, out)
    without, _ = fitted(changed)
    chi2, sizes = fitted(changed, START)
    (found,) = sizes.values()
    out.print(f"planted {PLANTED}, found {1e3 * found:.4f} ms; chi² falls from {without:.3g} to {chi2:.3g}")
    return worst, found


if __name__ == "__main__":
    main()
