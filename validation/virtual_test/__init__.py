"""Virtual tests: a campaign as the paper's multi-axis shaker would have recorded it, and the truth behind it.

`plan.Plan` says what is mounted, driven and drawn; `simulate.simulate` makes a `Campaign` and its truth of it. Everything random
follows from one seed and stable names (`streams`): the same seed is the same laboratory, whatever stands on the FMD.

Nothing here is shared with identification but the nouns of `geometry`: the records come from time-domain models of `fem`."""
