"""The ladder of model versions: add an effect, watch the error fall, go back, branch."""
