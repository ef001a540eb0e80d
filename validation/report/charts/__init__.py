"""Charts, printed and interactive: the door to matplotlib and plotly."""
