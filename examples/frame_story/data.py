"""The measured accelerances of the frame, read from their files."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np
import numpy.typing as npt

from frame_story.structure import FLOORS
from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from geometry.sensors import Point
from validation.prediction import series
from validation.prediction.effects import Nuisances
from validation.prediction.response_functions import ResponseFunctionTest, measured

FILES = {"driven at floor 1": "Experimental.csv", "driven at floor 2": "test_2.csv", "driven at floor 3": "test_3.csv"}
BAND = (3.0, 90.0)
REPEATED = (5.0, 30.0)
"""[Hz] The band of the comparison; where runs are held against each other."""


def require_files(folder: Path) -> None:
    """Nothing where all files are there.

    Raises
    ------
    click.UsageError : one of them is absent.
    """
    for file in FILES.values():
        if not (folder / file).is_file():
            raise click.UsageError(f"{folder / file} is absent; give the data folder with --data or MASSLINE_DATA")


def read(folder: Path) -> tuple[Array, dict[str, ComplexArray]]:
    """Frequencies (n,) [Hz], and by run the accelerances (n, 3) [1/kg] of the floors; shortest file's lines."""
    found = {run: _lines(folder / file) for run, file in FILES.items()}
    n = min(map(len, found.values()))
    return next(iter(found.values()))[:n, 0].real, {run: lines[:n, 1:] for run, lines in found.items()}


def _lines(file: Path) -> ComplexArray:
    """Complex numbers of a file whose fields are divided by semicolons."""
    lines = file.read_text(encoding="utf-8").split()
    return np.array([[complex(number.replace("+-", "-")) for number in line.split(";")] for line in lines])


def tested(folder: Path, structure: Nuisances) -> ResponseFunctionTest:
    """The model `structure` of the three runs in `folder`."""
    frequency, accelerance = read(folder)
    share = repeated(frequency, list(accelerance.values()))
    data = measured("accelerances", "frame", frequency, accelerance, FLOORS, band=BAND, share=share)
    points = tuple(Point(place=floor) for floor in FLOORS)
    return ResponseFunctionTest(measured=data, structure=structure, responses=points, drives=points)


def repeated(frequency: Array, accelerances: npt.ArrayLike) -> float:
    """How far readings repeat, as a share of them, from `accelerances` (3, n, 3) of the runs."""
    there = (frequency >= REPEATED[0]) & (frequency <= REPEATED[1])
    return series.repeatability(np.asarray(accelerances)[:, there])
