"""Estimate: from recorded base-excitation campaigns to inertia parameters. Knows nothing of `fem`."""
