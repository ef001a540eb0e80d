"""Figures on their way to the page."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


def as_state(figure: Figure) -> dict[str, Any]:
    """`figure` as JSON values; arrays stay packed, which plotly.js reads."""
    made: dict[str, Any] = json.loads(figure.to_json(validate=False))
    return made
