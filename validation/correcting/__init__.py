"""Corrected copies of campaigns: a known fault of the measurement, taken out of what was recorded."""
