"""Base excitation in time: what the table does, what stands on it, and what comes of it.

The nouns are shared by every way to an answer: `BaseMotion` drives a `Rig`, and a `Response` comes out. `response` answers by an
exact recursion in modal coordinates; `fem.exudyn.driven_run` lets exudyn integrate joints, gaps and friction as well. Neither
knows the other's equations.

`patterns` says what the table is driven with, `response.judge` whether linear equations may answer it, and `decimation` brings a
simulated run down to the rate of a record, all channels through one filter."""
