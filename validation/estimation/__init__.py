"""Cross-check of a prediction with data. Knows parameters, lines, channels and effects - and of none of them what it is."""
