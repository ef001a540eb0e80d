"""Diagnosis: which physical effect a model is missing, that nothing is missing, or that it is none of those known."""
