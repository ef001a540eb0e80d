"""Weights, centres of gravity and periods alone: what would explain them, what they cannot tell apart, what to measure next."""
