"""Predictions: what every channel of a campaign, or of any other test, should read by a model."""
