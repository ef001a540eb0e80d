"""Figures on their way to the page."""

from __future__ import annotations

import json
from typing import Any


def as_state(figure: Any) -> dict[str, Any]:
    """A figure of `validation.plots` as JSON values; arrays stay packed, which plotly.js reads."""
    made: dict[str, Any] = json.loads(figure.to_json(validate=False))
    return made
