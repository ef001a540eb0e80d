"""A prediction that was asked already: what else wants to know it need not ask again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.engine.measured import Measured
from validation.engine.parameter import Parameter
from validation.engine.prediction import Lines, Offsets, Predicted, Wanted


@dataclass(frozen=True, eq=False, kw_only=True)
class Answered:
    """What a `Prediction` said at some lines; it is one itself, at any of these lines and without derivatives.

    Attributes
    ----------
    measured : the data
    parameters : of the prediction
    lines : (m,) indices that were asked for, ascending
    said : there
    """

    measured: Measured
    parameters: tuple[Parameter, ...]
    lines: Lines
    said: Predicted

    def on(self, runs: Sequence[str]) -> Answered:
        """Of the runs named alone."""
        kept = [k for k, run in enumerate(self.measured.runs) if run in runs]
        rows, noise = self.said.rows, self.said.noise
        said = Predicted(rows=rows if rows.ndim == 3 else rows[kept], noise=None if noise is None else noise[kept])
        return Answered(measured=self.measured.on(runs), parameters=self.parameters, lines=self.lines, said=said)

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """At the `lines` (indices), which were asked for; `offsets` are those of then.

        Raises
        ------
        ValueError : a line that was not asked for, or derivatives.
        """
        asked = np.arange(len(self.measured.frequency), dtype=np.int64) if lines is None else lines
        if derivatives or not np.isin(asked, self.lines).all():
            raise ValueError("derivatives and other lines are to be asked of the prediction itself")
        at, noise = np.searchsorted(self.lines, asked), self.said.noise
        rows = self.said.rows[at] if self.said.rows.ndim == 3 else self.said.rows[:, at]
        return Predicted(rows=rows, noise=None if noise is None else noise[:, at])
