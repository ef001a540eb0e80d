"""Names of channels as variables of MATLAB."""

from __future__ import annotations


def variable(name: str) -> str:
    """The variable of the channel `name`: ``-`` becomes ``_``."""
    return name.replace("-", "_")
