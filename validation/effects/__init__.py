"""The catalogue of physical effects: what they are called, where they may act, and how large they may be."""
