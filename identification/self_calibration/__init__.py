"""Self-calibration: tolerances of the measurement chain estimated together with the article, over tares and article."""

from identification.self_calibration.fit import calibrated

__all__ = ["calibrated"]
