"""Machine-readable output: one JSON object on standard output, keys end in their unit, inertia says its reference point."""

from __future__ import annotations

import json
from typing import Any

import click

from geometry.inertia import Inertia


def print_json(value: dict[str, Any]) -> None:
    """Print `value` as the one JSON object of a command."""
    click.echo(json_text(value))


def json_text(value: dict[str, Any]) -> str:
    """`value` as one JSON object; NaN and infinity are refused, they are not JSON."""
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)


def inertia_json(inertia: Inertia) -> dict[str, Any]:
    """INERTIA of the output contract: CoG [mm] in the body's frame, moments and products [kg m²] about the CoG."""
    return {
        "mass_kg": inertia.mass,
        "cog_mm": (1e3 * inertia.cog).tolist(),
        "moi_cog_kgm2": inertia.moments_cog.tolist(),
        "poi_cog_kgm2": inertia.products_cog.tolist(),
        "about": "cog",
    }
