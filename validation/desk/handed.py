"""Files that a browser handed over, put into the desk's folder: whatever they are called, they go nowhere else.

Names come from a stranger: they are taken apart at ``/`` and ``\\``, and what climbs, is absolute, a device, hidden, too long or
holds characters that no file name needs is refused in words. What is left keeps its folders, so that a dropped series is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from validation.desk.faults import Fault

LARGEST = 2 * 2**30
"""Bytes of all files of a desk together."""

MOST = 2000
"""Files."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Handed:
    """One file as a browser gives it.

    Attributes
    ----------
    name : with the folders of what was dropped, ``series/block/x.h5``
    content : its bytes, or a file that already holds them and is copied
    """

    name: str
    content: bytes | Path


@dataclass(frozen=True, kw_only=True)
class Received:
    """What was taken over, told apart by what it holds.

    Attributes
    ----------
    folder : in which everything lies
    models : paths of model files
    data : paths of campaign folders and measurement files
    faults : what was refused, in words
    """

    folder: Path
    models: tuple[str, ...]
    data: tuple[str, ...]
    faults: tuple[Fault, ...]


def received(folder: str | Path, files: Sequence[Handed], *, limit: int = LARGEST) -> Received:
    """`files` written below `folder` (that of the desk to be), in ``given/``; those that are refused are told and left out.

    Parameters
    ----------
    limit : bytes of all files together, those that are there already included

    Raises
    ------
    OSError : the folder cannot be written.
    """
    raise NotImplementedError


def sorted_out(folder: str | Path) -> Received:
    """What a `folder` on this machine holds: models, campaigns and measurements, looked for three levels deep; nothing is copied.

    Raises
    ------
    BadInput : there is no such folder.
    """
    raise NotImplementedError
