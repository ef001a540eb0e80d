"""Model files: the laboratory, the structure, and the effects that were added so far."""
