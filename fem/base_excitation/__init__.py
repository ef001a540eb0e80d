"""Base excitation in time: what the table does, what stands on it, and what comes of it.

The nouns are shared by every way to an answer: a pattern becomes a `BaseMotion`, which drives a `Rig`, and a `Response` is found.
`response` answers by an exact recursion in modal coordinates and brings the run down to the rate of a record; `fem.exudyn` lets
exudyn integrate joints, gaps and friction as well. Neither knows the other's equations.
"""
