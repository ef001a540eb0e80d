"""A `Campaign` as the text of its ``campaign.toml``, in the order and the layout of the contract."""

from __future__ import annotations

import json
from collections.abc import Iterable

import numpy as np

from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.sensors import Channel, Place
from identification.campaign import Campaign, Excitation, Processing, Run
from identification.units import factor

ROUNDING = 1e-12
"""How far a mounting may be turned about another axis than z [1]: rounding of a rotation matrix."""


def text(campaign: Campaign) -> str:
    """The text of ``campaign.toml``; lengths in metres, noise floors in the unit of their channel.

    Raises
    ------
    BadInput : a mounting that is turned about another axis than z, which the format cannot say.
    """
    blocks = [
        f"format = {toml_file.FORMAT}",
        _block("[campaign]", _about(campaign)),
        *([] if campaign.mounting is None else [_block("[mounting]", _mounting(campaign.mounting, campaign.source))]),
        _block("[environment]", [("gravity", _number(campaign.gravity))]),
        _block("[frame]", [("origin", _numbers(campaign.table.origin)), ("length_unit", '"m"')]),
        *([] if campaign.processing is None else [_block("[processing]", _processing(campaign.processing))]),
        *(_block("[[channel]]", _channel(channel)) for channel in campaign.table.channels),
        *(_block("[[run]]", _run(run)) for run in campaign.runs),
    ]
    return "\n\n".join(blocks) + "\n"


Lines = list[tuple[str, str]]


def _block(head: str, lines: Lines) -> str:
    return "\n".join([head, *(f"{key} = {value}" for key, value in lines)])


def _about(campaign: Campaign) -> Lines:
    words = (("title", campaign.title), ("article", campaign.article), ("hardware", campaign.hardware), ("notes", campaign.notes))
    return [(key, _string(value)) for key, value in words if value]


def _mounting(pose: Pose, source: str) -> Lines:
    R = pose.rotation
    if abs(R[2, 2] - 1) > ROUNDING:
        problem = "is turned about another axis than z"
        raise BadInput(source=source, field="mounting", problem=problem, remedy="The format knows rotation_deg about z only")
    turn = float(np.degrees(np.arctan2(R[1, 0], R[0, 0])))
    return [("origin", _numbers(pose.position)), ("rotation_deg", _number(turn))]


def _processing(of: Processing) -> Lines:
    lines = [("method", _string(of.method))]
    if of.method == "peak-reference-hold":
        lines += [("block_size", str(of.block_size)), ("overlap", _number(of.overlap))]
    grid = f"{{ start = {_number(of.start)}, stop = {_number(of.stop)}, step = {_number(of.step)} }}"
    return [*lines, ("frequency", grid)]


def _channel(channel: Channel) -> Lines:
    lines = [(key, _string(getattr(channel, key))) for key in ("name", "quantity", "unit", "group")]
    if channel.is_sum:
        cells = "".join(
            f"  {{ position = {position}, direction = {direction} }},\n" for position, direction in map(_place, channel.places)
        )
        lines.append(("cells", f"[\n{cells}]"))
    else:
        position, direction = _place(channel.places[0])
        lines += [("position", position), ("direction", direction)]
    if channel.reference:
        lines.append(("reference", "true"))
    if channel.quantity == "acceleration":
        lines.append(("senses_gravity", "true" if channel.senses_gravity else "false"))
    if channel.noise_rms is not None:
        size = factor(channel.unit, channel.quantity, source="channel", field=channel.name)
        lines.append(("noise_rms", _number(channel.noise_rms / size)))
    return lines


def _place(place: Place) -> tuple[str, str]:
    return _numbers(place.position), _numbers(place.direction)


def _run(run: Run) -> Lines:
    lines = [("name", _string(run.name)), ("file", _string(run.file))]
    lines += [("axis", _string(run.axis))] if run.axis else []
    return lines if run.excitation is None else [*lines, ("excitation", _excitation(run.excitation))]


def _excitation(of: Excitation) -> str:
    figures = [f"{key} = {_numbers(value) if isinstance(value, tuple) else _number(value)}" for key, value in of.figures.items()]
    return "{ " + ", ".join([f"kind = {_string(of.kind)}", *figures]) + " }"


def _string(value: str) -> str:
    """A basic string of TOML: JSON's escapes are TOML's, but for one character that JSON leaves as it is."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _number(value: float) -> str:
    """The fewest digits that give `value` back exactly."""
    return repr(float(value) + 0.0)


def _numbers(values: Iterable[float]) -> str:
    return "[" + ", ".join(map(_number, values)) + "]"
