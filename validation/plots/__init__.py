"""Figures to look into with a pointer: the door to plotly. Data go in, a figure comes out; nothing is computed here."""
