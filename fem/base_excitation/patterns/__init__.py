"""What a six-axis table is driven with: sweeps, several axes at once, noise, bursts, and the table's own cross motion.

Every pattern is a closed form of the displacement; `motion` samples it with its exact derivatives.
"""

from fem.base_excitation.patterns.burst import Burst
from fem.base_excitation.patterns.cross_motion import CrossMotion, drawn
from fem.base_excitation.patterns.multi_axis import MultiAxis, phased_sweeps
from fem.base_excitation.patterns.noise import Random
from fem.base_excitation.patterns.pattern import Pattern
from fem.base_excitation.patterns.sweep import Sweep, sweeps
from geometry.dynamic_mass import LEVELS

__all__ = ["LEVELS", "Burst", "CrossMotion", "MultiAxis", "Pattern", "Random", "Sweep", "drawn", "phased_sweeps", "sweeps"]
