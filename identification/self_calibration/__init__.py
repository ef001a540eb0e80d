"""Self-calibration: tolerances of the measurement chain estimated together with the article, over tares and article."""
