"""Names of channels as variables of MATLAB."""

from __future__ import annotations


def variable(name: str) -> str:
    """The variable of the channel `name`: ``-`` becomes ``_`` and the ``+`` of a blade's tip ``p``."""
    return name.replace("-", "_").replace("+", "p")
