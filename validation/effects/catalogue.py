"""Where effects are found: the files of `validation/effects/families`, entry points ``massline.effects``, folders of a user.

A file is a family when it holds a `FAMILY`. The catalogue of a process only grows: `load` adds what a user brings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from inspect import getsourcefile, ismodule
from pathlib import Path
from types import MappingProxyType

from validation.effects import own
from validation.effects.family import Family

GROUP = "massline.effects"
"""Of the entry points by which an installed package brings families: modules with a `FAMILY`, or families themselves."""

ORDER = [
    "point-mass",
    "rigid-inertia",
    "modulus",
    "joint-compliance",
    "structural-damping",
    "layer-damping",
    "appendage",
    "absorber",
    "slosh",
    "cable",
    "orientation",
    "mounting-offset",
    "gravity",
    "force-gain",
    "load-path-shunt",
    "force-delay",
    "board-delay",
    "force-highpass",
    "force-crosstalk",
    "force-plane-offset",
    "fmd-compliance",
    "cell-stiffness",
    "accelerometer-gain",
    "accelerometer-delay",
    "accelerometer-position",
    "accelerometer-misalignment",
    "accelerometer-tilt",
    "cover-plate-flexibility",
    "polarity",
    "channel-swap",
    "unit",
    "friction",
    "gap",
    "saturation",
    "sweep-bias",
    "noise",
    "mains",
    "pendulum-amplitude",
    "pendulum-damping",
    "rope-mass",
    "rope-elasticity",
    "air-inertia",
    "off-centre-suspension",
]
"""Of the catalogue's page; what is not in it follows."""


_found: dict[str, Family] = {}

FAMILIES: Mapping[str, Family] = MappingProxyType(_found)
"""Every family by name, in the order of the catalogue."""

_sources: dict[str, str] = {}

SOURCES: Mapping[str, str] = MappingProxyType(_sources)
"""By name of a family that the package does not bring: the file or the entry point that it came from."""

_files: dict[Path, str] = {}


def load(directory: str | Path) -> tuple[Family, ...]:
    """The families in the files of `directory`, from now on in the catalogue. A file that was read before is not read again.

    Raises
    ------
    BadInput : no such folder, a file without a family, or one that is not whole (`validation.effects.sound`); then none of the
        folder's is added.
    """
    paths = own.files(Path(directory))
    new = [path for path in paths if path not in _files]
    found = [(path, own.family(path)) for path in new]
    added: list[Path] = []
    try:
        for path, family in found:
            _add(family, str(path))
            _files[path] = family.name
            added.append(path)
    except BaseException:
        for path in added:
            _forget(_files.pop(path))
        raise
    return tuple(_found[_files[path]] for path in paths)


def _add(family: Family, source: str) -> None:
    from validation.effects.sound import require_usable, require_whole

    require_whole(family, FAMILIES, SOURCES, source)
    _found[family.name], _sources[family.name] = family, source
    try:
        require_usable(family, source)
    except BaseException:
        _forget(family.name)
        raise


def _forget(name: str) -> None:
    del _found[name], _sources[name]


def _built_in() -> Iterator[Family]:
    for name in ORDER:
        yield import_module(f"validation.effects.families.{name.replace('-', '_')}").FAMILY


def add_installed(points: Iterator[EntryPoint]) -> None:
    """The families of entry points, into the catalogue.

    Raises
    ------
    BadInput : one of them cannot be imported, or is not whole.
    """
    for point in points:
        source = f"entry point {point.name} = {point.value} of {point.dist.name if point.dist else 'a package'}"
        try:
            value = point.load()
        except Exception as error:
            raise own.in_words(error, source, GROUP) from None
        file = (getsourcefile(value) if ismodule(value) else None) or source
        _add(own.of(getattr(value, "FAMILY", value), file), source)


_found.update({family.name: family for family in _built_in()})
add_installed(iter(entry_points(group=GROUP)))
