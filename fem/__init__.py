"""Predict: flexible bodies, their modes and their base-excited dynamic mass."""
