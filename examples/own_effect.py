"""An effect of one's own, from its file to a campaign that holds it: ``python examples/own_effect.py``.

`examples/effects/force_lowpass.py` is put into the catalogue, planted in a virtual test, and found again in the quotient of two
spectra, which is its equation.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from validation.effects import catalogue
from validation.effects.identifiers import parse
from validation.effects.stages import Reading
from validation.virtual_test.effects.planting import planted
from validation.virtual_test.plan import RIGID, Plan, exact
from validation.virtual_test.simulate import simulate

HERE = Path(__file__).parent / "effects"
EFFECT = "force-lowpass:fmd-z2=1e-3"
RUN, BAND = "z", (8.0, 32.0)


def spectra(*effects: str) -> dict[str, np.ndarray]:
    """Spectra by channel of a sweep along z, and their lines, of a block without any other error."""
    plan = exact(Plan(article="fmd+cuboid", model=RIGID, band=BAND, octaves_per_minute=120.0, cross=0.0))
    campaign = simulate(replace(plan, effects=planted([parse(text) for text in effects]))).campaign
    recorded = campaign.recordings[RUN]
    every = np.fft.rfftfreq(len(recorded.values), 1 / (recorded.sampling_rate or 1.0))
    driven = (every > BAND[0] + 2) & (every < BAND[1] - 2)
    found = {name: np.fft.rfft(column)[driven] for name, column in zip(recorded.names, recorded.values.T, strict=True)}
    return {"frequency": every[driven], **found}


def main(console: Console | None = None) -> float:
    """Print equation and simulation side by side, and return how far they differ at most."""
    out = console or Console()
    catalogue.load(HERE)
    named = parse(EFFECT)
    family = catalogue.FAMILIES[named.family]
    out.print(f"{named}: {family.what}; {family.equation}")
    plain, changed = spectra(), spectra(EFFECT)
    n = min(len(plain["frequency"]), len(changed["frequency"]))
    f, measured = plain["frequency"][:n], changed[named.target][:n] / plain[named.target][:n]
    reading = Reading(frequency=f, channels=(named.target,), rows=np.ones((n, 1, 6), dtype=np.complex128))
    predicted = family.change(reading, named.targets, named.values).rows[:, 0, 0]
    for k in np.linspace(0, n - 1, 5, dtype=int):
        out.print(f"{f[k]:6.2f} Hz   simulated {measured[k]:.4f}   by the equation {predicted[k]:.4f}")
    return float(np.max(np.abs(measured - predicted)))


if __name__ == "__main__":
    main()
