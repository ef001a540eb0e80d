"""What a laboratory has learnt of itself: how its hardware is, and how well articles are mounted; and the file that says so."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry import toml_file
from geometry.errors import BadInput
from geometry.toml_file import string
from identification.parameter import Parameter
from validation.classical.files import Fields
from validation.model.tolerance_classes import NAMES, ROWS, ClassedTolerance

#     [laboratory]
#     learnt = "lab.toml"          # in a model file
#
# `massline laboratory` writes it, `validation.identify.laboratory` works it out. Of every parameter of the hardware it has the
# offset at which it stands and the standard deviation that is left; of every tolerance that is drawn anew with each mounting the
# standard deviation of these draws.


KIND = "laboratory"

ANEW = tuple(row for row in ROWS if row.of == "mounting" and row.name != "inertia")
"""Tolerances that are drawn anew with every mounting."""


@dataclass(frozen=True, kw_only=True)
class Offset:
    """One parameter of the hardware.

    Attributes
    ----------
    offset : from nominal, of the logarithm where the parameter is one [its unit]
    deviation : standard deviation of what is not known of it any more
    before : what its class admitted
    """

    offset: float
    deviation: float
    before: float


@dataclass(frozen=True, kw_only=True)
class Spread:
    """How far one tolerance scatters from mounting to mounting, SI.

    Attributes
    ----------
    deviation : standard deviation
    low, high : 90 % interval of it
    before : what the class says
    count : figures that tell it
    """

    deviation: float
    low: float
    high: float
    before: float
    count: int

    @staticmethod
    def of_draws(draws: npt.ArrayLike) -> "Spread":
        """From `draws` (n, 3): posterior offset of each, its standard deviation, and that of its prior, SI.

        tau has the likelihood of the head of `validation.identify.laboratory`, over nine octaves.
        """
        x, sd, prior = np.asarray(draws, dtype=np.float64).T
        variance = 1 / (1 / sd**2 - 1 / prior**2)
        alone, before = x * variance / sd**2, float(prior[0])
        tau = before * np.exp2(np.linspace(-6, 3, 400))
        total = variance[:, None] + tau**2
        density = -0.5 * np.sum(np.log(total) + alone[:, None] ** 2 / total, axis=0) - 0.5 * np.log2(tau / before) ** 2
        share = np.cumsum(np.exp(density - density.max()))
        low, middle, high = (float(np.interp(p, share / share[-1], tau)) for p in (0.05, 0.5, 0.95))
        return Spread(deviation=middle, low=low, high=high, before=before, count=len(x))


@dataclass(frozen=True, eq=False, kw_only=True)
class Learnt:
    """All of it.

    Attributes
    ----------
    source : the file, for messages
    hardware : id of FMD and sensors, which is theirs alone
    tolerance_class : from which it began
    campaigns : that told it
    offsets : by name of the parameter
    spreads : by key of the tolerance
    """

    source: str
    hardware: str
    tolerance_class: str
    campaigns: tuple[str, ...]
    offsets: Mapping[str, Offset] = field(default_factory=lambda: MappingProxyType({}))
    spreads: Mapping[str, Spread] = field(default_factory=lambda: MappingProxyType({}))

    def known(self, one: Parameter) -> Parameter:
        """`one` as it stands: its offsets count from there, within what is left of its tolerance."""
        told = self.offsets.get(one.name)
        if told is None:
            return one
        nominal = one.value(told.offset) - (one.above if one.logarithmic else 0.0)
        low, high = one.low - told.offset, one.high - told.offset
        return replace(one, nominal=nominal, tolerance=told.deviation, low=low, high=high)

    def at(self, offsets: Mapping[str, float], names: Sequence[str]) -> dict[str, float]:
        """`offsets` of `known` parameters as those of the parameters themselves, all `names` among them."""
        shifts = {name: self.offsets[name].offset for name in names if name in self.offsets}
        return {**offsets, **{name: offsets.get(name, 0.0) + shift for name, shift in shifts.items()}}

    @staticmethod
    def read(path: str | Path, hardware: str) -> "Learnt":
        """What the file at `path` has learnt of `hardware`.

        Raises
        ------
        BadInput : no such file, another kind of file, other hardware, a figure that cannot be.
        """
        source = str(path)
        table = toml_file.read(path, remedy="`massline laboratory CAMPAIGN ... --out FILE` writes one")
        if table.get("kind") != KIND:
            problem = f"a file of kind {KIND!r} is expected, found {table.get('kind')!r}"
            raise BadInput(source, "kind", problem, "`massline laboratory` writes one")
        toml_file.require_format(table, source)
        whole = Fields(source=source, place="", table=table)
        whole.only(("format", "kind", "hardware", "class", "campaigns", "known", "mounting"))
        told = whole.text("hardware")
        if hardware and told != hardware:
            problem = f"it was learnt of {told!r}, and the model describes {hardware!r}: other sensors have other errors"
            raise BadInput(source, "hardware", problem, "Name the file of this hardware")
        known, mounting = whole.inner("known"), whole.inner("mounting").only([row.key for row in ANEW])

        def number(of: Fields, key: str, *, positive: bool = False) -> float:
            value = of.table.get(key)
            if (
                isinstance(value, bool)
                or not isinstance(value, int | float)
                or not abs(value) < float("inf")
                or (positive and value <= 0)
            ):
                problem = f"a number{' above 0' if positive else ''} is expected, found {value!r}"
                raise of.refused(key, problem, "Let `massline laboratory` write the file anew")
            return float(value)

        offsets = {}
        for name in known.table:
            one = known.inner(name).only(("offset", "sd", "before"))
            offsets[name] = Offset(
                offset=number(one, "offset"), deviation=number(one, "sd", positive=True), before=number(one, "before")
            )
        spreads = {}
        for row in ANEW:
            if row.key in mounting.table:
                one = mounting.inner(row.key).only(("sd", "low", "high", "before", "count"))
                sd, low, high, before = (row.si(number(one, key)) for key in ("sd", "low", "high", "before"))
                count = one.integer("count", 0, 0)
                spreads[row.key] = Spread(deviation=sd, low=low, high=high, before=before, count=count)
        return Learnt(
            source=source,
            hardware=told,
            tolerance_class=whole.choice("class", NAMES),
            campaigns=tuple(str(one) for one in table.get("campaigns", ())),
            offsets=MappingProxyType(offsets),
            spreads=MappingProxyType(spreads),
        )

    @property
    def text(self) -> str:
        """The file."""
        named = ", ".join(string(one) for one in self.campaigns)
        lines = [
            "# What a laboratory learnt of itself: `massline laboratory` wrote it, [laboratory] of a model file names it.",
            "format = 1",
            f"kind = {string(KIND)}",
            f"hardware = {string(self.hardware)}",
            f"class = {string(self.tolerance_class)}",
            f"campaigns = [{named}]",
        ]
        for key, one in self.spreads.items():
            row: ClassedTolerance = next(row for row in ANEW if row.key == key)
            sd, low, high, before = (f"{size / row.si(1.0):.4g}" for size in (one.deviation, one.low, one.high, one.before))
            lines += ["", f"[mounting.{key}]  # {row.what}; 90 % interval, what its class says, figures that told it"]
            lines += [f"sd = {sd}", f"low = {low}", f"high = {high}", f"before = {before}", f"count = {one.count}"]
        lines += [
            "",
            "# By parameter: offset from nominal, what is not known of it any more, and what its class admitted; SI.",
            "[known]",
        ]
        for name, told in self.offsets.items():
            figures = f"offset = {told.offset:.6g}, sd = {told.deviation:.4g}, before = {told.before:.4g}"
            lines.append(f"{string(name)} = {{ {figures} }}")
        return "\n".join(lines) + "\n"
