"""Predictions: what every channel of a campaign, or of an accelerance test, should read by a model."""
