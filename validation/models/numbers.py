"""Numbers of a model file, each within what is physics."""

from __future__ import annotations

from math import isfinite

from validation.measurement_file import Fields

LARGEST = 1e15


def number(table: Fields, key: str, *, low: float = -LARGEST, high: float = LARGEST, above: bool = False) -> float:
    """The number under `key` of `table`, from `low` to `high`; `above` leaves `low` itself out.

    Raises
    ------
    BadInput : it is missing, no number, or outside.
    """
    if key not in table.table:
        raise table.refused(key, "is missing", "Add it, or leave its whole table out")
    return checked(table, key, table.table[key], low=low, high=high, above=above)


def three(table: Fields, key: str, *, low: float = -LARGEST, high: float = LARGEST, above: bool = False) -> list[float]:
    """Three numbers under `key`, each as `number` has it.

    Raises
    ------
    BadInput : they are missing, not three, no numbers, or outside.
    """
    value = table.table.get(key)
    if not isinstance(value, list) or len(value) != 3:
        problem = "is missing" if value is None else f"three numbers are expected, found {value!r}"
        raise table.refused(key, problem, "Write [x, y, z]")
    return [checked(table, key, one, low=low, high=high, above=above) for one in value]


def checked(table: Fields, key: str, value: object, *, low: float, high: float, above: bool = False) -> float:
    """`value`, which stands under `key`, if it is such a number.

    Raises
    ------
    BadInput : it is not.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise table.refused(key, f"a number is expected, found {value!r}", "Write it without unit and quotes; the key names it")
    if not isfinite(value) or not low <= value <= high or (above and value == low):
        least = f"above {low:g}" if above else f"from {low:g}"
        raise table.refused(key, f"must be {least} to {high:g}, found {value!r}", "Check the number and the unit of the key")
    return float(value)
