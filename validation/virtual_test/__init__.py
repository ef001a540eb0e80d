"""Virtual tests: a campaign as the multi-axis shaker of the paper would have recorded it, and the truth behind it."""
