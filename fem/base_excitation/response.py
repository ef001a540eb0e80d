"""`Response`: what table, cover plate, load cells and article did during one run, and how that was found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """One run, equally sampled, all channels at the same instants.

    Loads are those of the table *on* what stands on it, f = +M a.

    Attributes
    ----------
    sampling_rate : [Hz]
    table : (n, 6) acceleration of the table about the reference point, x, y, z [m/s²], alpha, beta, gamma [rad/s²]
    cover : (n, 6) the same of what carries the article: of the FMD's cover plate, of the table when there are no cells
    load : (n, 6) force [N] and moment [N m] about the reference point
    cells : (n, c, 3) force [N] of every load cell along x, y, z of the laboratory; c is 0 when there are none
    places : (n, 3) acceleration [m/s²] of places of the article by name, in the laboratory's axes
    coordinates : (n, k) when they were asked for, (n, 0) otherwise; by the recursion all of the rig relative to the table, as
        `fem.base_excitation.rig_structure` orders them, by exudyn those of the article in the laboratory
    slipping : [1] share of the record in which each of the rig's loose parts slipped; none by a route that knows no friction
    reference_point : (3,) [m]
    settings : how it was found: route, program and version, step, what it kept; JSON values
    warnings : sentences
    """

    sampling_rate: float
    table: Array
    cover: Array
    load: Array
    cells: Array
    places: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    coordinates: Array = field(default_factory=lambda: np.zeros((0, 0)))
    slipping: tuple[float, ...] = ()
    reference_point: Array = field(default_factory=lambda: np.zeros(3))
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        n = np.shape(self.table)[0]
        coordinates = self.coordinates if np.size(self.coordinates) else np.zeros((n, 0))
        object.__setattr__(self, "coordinates", coordinates)
        shapes = {
            "table": (n, 6),
            "cover": (n, 6),
            "load": (n, 6),
            "cells": (n, np.shape(self.cells)[1], 3),
            "coordinates": (n, np.shape(coordinates)[1]),
            "reference_point": (3,),
        }
        for name, shape in shapes.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))
        object.__setattr__(
            self, "places", MappingProxyType({name: frozen(a, (n, 3), f"places.{name}") for name, a in self.places.items()})
        )
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    @property
    def time(self) -> Array:
        """(n,) [s], from 0."""
        return np.arange(len(self.table)) / self.sampling_rate
