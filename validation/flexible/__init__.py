"""Flexible models of articles: their modes and dynamic masses."""
