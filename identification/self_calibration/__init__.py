"""Self-calibration: every tolerance of the measurement chain estimated together with the article, over tare and article campaigns."""

from identification.self_calibration.calibrated import calibrated

__all__ = ["calibrated"]
