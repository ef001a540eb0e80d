"""How much evidence an effect must bring to be worth its parameters: limits that were set from tests in which nothing is wrong.

The figures behind them are those of ``make blind``; docs/diagnosis-proven-blind.md tells them.
"""

from __future__ import annotations

WORTH = 8.0
"""[nats] of evidence that an effect must bring to be named."""

ALIKE = 5.0
"""[nats] within which two explanations are as good as each other."""

WORTH_OF = {"modulus": 6.0, "cell-stiffness": 12.0, "structural-damping": 20.0, "layer-damping": 20.0}
"""The same by family. Moduli are few, and known to scatter as they are said to. Of cell stiffnesses there are many that say
nearly the same, and one null of twelve came to 7. Loss factors scatter by their logarithm, and what is known of them has a longer
tail than the normal deviate that a fit takes it for."""


def worth(family: str) -> float:
    """[nats] that an effect of `family` must bring to be named."""
    return WORTH_OF.get(family, WORTH)
