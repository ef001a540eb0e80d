"""Spectra: from the time histories of a campaign to complex lines of every channel."""
