"""The history of a model: add an effect, watch the error fall, go back, branch."""
