"""A leftover in several pairs of axes at once, such as a spring off the reference point: a symmetric matrix of one course."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.observability import LOADS
from validation.diagnosing.leftover.axes import Loaded, entries, entry
from validation.diagnosing.leftover.courses import OF_PAIRS, Course
from validation.diagnosing.leftover.places import SPAN, Place
from validation.diagnosing.leftover.tangents import LEAST, following, products
from validation.engine.screening import Products

PLACES = tuple((i, j) for i in range(6) for j in range(i, 6))
"""Entries of a symmetric matrix."""

PHYSICAL = tuple(course for course in OF_PAIRS if course.stated)
"""What symmetric matrices are of: mass, stiffness, damping."""

NAMED = 0.25
"""Share of the leading pair, at the nominal level of the motions, from which another one is named with it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Spanned:
    """All entries of a symmetric matrix in one data set.

    Attributes
    ----------
    data_set : its name
    products : (q,) of the entries, line by line
    gram : (m, q, q) complex, of the entries with each other, inputs eliminated
    root : of the covariance of the fit
    """

    data_set: str
    products: Products
    gram: ComplexArray
    root: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Span:
    """What a symmetric matrix of one course explains.

    Attributes
    ----------
    place : the leading pair, and those that take part
    course : of all entries
    gain : [nats]
    size : of the leading pair
    """

    place: Place
    course: Course
    gain: float
    size: float


def spanned(of: Loaded) -> Spanned:
    """Of one data set."""
    mixed = np.stack([entry(i, j) + (entry(j, i) if j > i else 0) for i, j in PLACES], axis=1)
    readings, at = entries(of) @ mixed, of.of.of
    kept = at.kept(readings * at.weight[:, :, of.channels, None], of.channels)
    flat = kept.transpose(1, 0, 2, 3).reshape(len(at.frequency), -1, len(PLACES))
    gram = np.asarray(flat.conj().swapaxes(1, 2) @ flat)
    return Spanned(data_set=at.name, products=products(of.of, readings, of.channels), gram=gram, root=of.of.root)


def spans(alike: Sequence[Spanned], slope: Array) -> Iterator[Span]:
    """Of the courses of matrices, with one matrix for the data sets `alike`; `slope` as `Swallowing` has it."""
    for course in PHYSICAL:
        score, told = np.zeros(len(PLACES)), np.zeros((len(PLACES), len(PLACES)))
        swallowed = 0.0
        for one in alike:
            c = course.of(2 * np.pi * one.products.frequency)
            answers = following(one.products, c[None], one.root)
            score += answers.score[0]
            told += np.tensordot(np.abs(c) ** 2, one.gram.real, axes=1)
            swallowed = swallowed + answers.swallowed[0]
        yield _span(course, score + swallowed @ slope, told, np.asarray(swallowed))


def _span(course: Course, score: Array, own: Array, swallowed: Array) -> Span:
    scale = 1 / np.sqrt(np.maximum(np.diag(own), np.finfo(np.float64).tiny))
    told = scale[:, None] * (own - swallowed @ swallowed.T) * scale
    size = scale * (np.linalg.pinv(told, rcond=LEAST, hermitian=True) @ (scale * score))
    return Span(place=_place(size), course=course, gain=0.5 * float(size @ score), size=float(size[_leading(size)[0]]))


def _leading(size: Array) -> list[int]:
    """The entries that take part, the greatest first, at the nominal level of the motions."""
    level = np.array([LEVELS[MOTIONS[i]] * LEVELS[MOTIONS[j]] for i, j in PLACES])
    weight = np.abs(size) * level
    order = np.argsort(-weight)
    return [int(k) for k in order if weight[k] >= NAMED * weight[order[0]]]


def _place(size: Array) -> Place:
    (first, *others) = ((LOADS[PLACES[k][0]], MOTIONS[PLACES[k][1]]) for k in _leading(size))
    return Place(kind=SPAN, load=first[0], motion=first[1], others=tuple(others))
