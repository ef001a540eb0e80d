"""The dynamic mass that `massline dynamic-mass` shows, over a band and about a point; and how far two of them are apart."""

from dataclasses import dataclass

import numpy as np

from geometry.articles import NAMES, built_in
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, Pose
from validation.flexible.model import Flexible, FlexibleOptions, flexible, require_base, require_model, require_used
from validation.output import derived, entry, shown, unwritten

UNITS = ("kg", "kg", "kg", "kg m²", "kg m²", "kg m²")
"""Of effective masses, by axis."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Curves:
    """The answer: a dynamic mass for each model, all on the same lines about the same point.

    Attributes
    ----------
    article : as it was asked for; in JSON by the name that its model has
    about : name of the reference point
    rigid : (6, 6) rigid mass matrix about it, of the first model
    apart : how far each further model is from the first
    """

    article: str = unwritten()
    about: str = unwritten()
    models: tuple[Flexible, ...] = unwritten()
    masses: tuple[DynamicMass, ...] = unwritten()
    rigid: Array = unwritten()
    apart: "tuple[tuple[Apart, ...], ...]" = unwritten()
    warnings: tuple[str, ...] = unwritten()

    @property
    def peaks(self) -> "tuple[Peak, ...]":
        """Of the first model."""
        return peaks(self.masses[0], np.diag(self.rigid))

    @property
    @derived("")
    def figures(self) -> dict[str, object]:
        """The dynamic mass of the first model, and how far the second is from it, by their keys in JSON."""
        H = self.masses[0]
        compared = {"against": self.models[1].model, "apart": self.apart[0]} if self.apart else {}
        return {
            "article": self.models[0].article,
            "model": self.models[0].model,
            "frequency_hz": H.frequency,
            "re": H.matrix.real,
            "im": H.matrix.imag,
            "about": self.about,
            "reference_point_mm": 1e3 * H.reference_point,
            "order": MOTIONS,
            "peaks": self.peaks,
            **compared,
        }


BAND = (4.0, 32.0)
STEP = 0.05
"""Band and distance of lines [Hz] of the paper's tests: 561 lines."""

MOST_LINES = 50_000

FORCE, COUPLING, MOMENT = (slice(0, 3), slice(0, 3)), (slice(0, 3), slice(3, 6)), (slice(3, 6), slice(3, 6))
BLOCKS = {"forces from translations [kg]": FORCE, "coupling [kg m]": COUPLING, "moments from rotations [kg m²]": MOMENT}
"""Parts of H that have one unit each."""

NEAR = 0.03
"""A line closer to an eigenfrequency than this share of it is at resonance: there two models with eigenfrequencies 1 % apart
differ by as much as the peak is high."""


@dataclass(frozen=True, kw_only=True)
class Apart:
    """How far one block of two dynamic masses is apart, relative to its largest entry at the same line.

    Attributes
    ----------
    block : its name and unit
    off_resonance, off_frequency : greatest difference [1] away from any resonance of either, and where [Hz]; None without a line
    at_resonance, at_frequency : the same near one
    """

    block: str
    off_resonance: float | None = entry(
        "off_resonance_percent", unit="%", write=lambda share: None if share is None else 100 * share
    )
    off_frequency: float | None = entry("off_resonance_hz", unit="Hz")
    at_resonance: float | None = entry(
        "at_resonance_percent", unit="%", write=lambda share: None if share is None else 100 * share
    )
    at_frequency: float | None = entry("at_resonance_hz", unit="Hz")


def lines(band: tuple[float, float], step: float) -> Array:
    """Frequencies (n,) [Hz] from one end of the band to the other, `step` [Hz] apart.

    Raises
    ------
    BadInput : the band is reversed, negative or no number, the step not positive, or there would be more than `MOST_LINES`.
    """
    low, high = band
    if not (np.isfinite(low) and np.isfinite(high) and 0 <= low < high):
        problem = f"a band goes from 0 Hz or more up to a higher frequency, found {low:g} to {high:g} Hz"
        raise BadInput("--band", "", problem, "Give the lower end first: --band 4 32")
    if not (np.isfinite(step) and 0 < step <= high - low):
        problem = f"must be positive and fit into the band, found {step:g} Hz"
        raise BadInput("--step", "", problem, "Write for example --step 0.05")
    count = round((high - low) / step) + 1
    if count > MOST_LINES:
        raise BadInput("--step", "", f"would make {count} lines", f"At most {MOST_LINES} are computed")
    return np.linspace(low, high, count)


def reference_point(about: str, article: str) -> tuple[str, Array]:
    """Name and place (3,) [m], in the article's frame, of the point that `about` means: ``article``, ``F`` or ``"0 0 45 mm"``.

    F is the centre of the FMD's force-measuring plane: the origin of a stack that stands on one, and as far below every other
    article as the built-in FMD holds it above.

    Raises
    ------
    BadInput : none of these.
    """
    if about == "article":
        return about, np.zeros(3)
    if about == "F":
        seat = built_in("fmd").seat or Pose()
        on_fmd = article.split("+")[0] == "fmd" and set(article.split("+")) <= set(NAMES)
        return about, np.zeros(3) if on_fmd else seat.inverse.position
    from validation.reference.statement import position

    try:
        return "point", position(about, "--about", "")
    except BadInput as error:
        raise BadInput("--about", "", error.problem, 'Give F, article, or a point such as "0 0 45 mm"') from None


def dynamic_mass(model: Flexible, frequency: Array, about: Array) -> DynamicMass:
    """H of `model` at `frequency` (n,) [Hz] about the point `about` (3,) [m]."""
    from fem.dynamic_mass import modal

    return modal(model.modes, frequency).about(about)


def apart(first: DynamicMass, second: DynamicMass, resonances: Array, rigid_mass: Array) -> tuple[Apart, ...]:
    """How far `first` and `second` are apart, on the same lines about the same point; `resonances` (k,) [Hz] are of both.

    `rigid_mass` (6, 6), about that point too, is what a difference is measured with where the dynamic mass itself is smaller: at
    an antiresonance next to nothing is left to divide by.
    """
    f, found = first.frequency, []
    near = np.any(np.abs(f[:, None] - resonances) < NEAR * resonances, axis=1) if len(resonances) else np.zeros(len(f), bool)
    for name, block in BLOCKS.items():
        # Largest difference (n,), line by line, over the largest entry there or in the rigid mass, the larger of both
        a, b = (H.matrix[:, block[0], block[1]].reshape(len(f), -1) for H in (first, second))
        scale = np.maximum(np.abs(a).max(axis=1), max(np.abs(rigid_mass[block]).max(), np.finfo(np.float64).tiny))
        difference = np.abs(a - b).max(axis=1) / scale
        worst: list[tuple[float | None, float | None]] = []
        for where in (np.flatnonzero(~near), np.flatnonzero(near)):
            k = where[np.argmax(difference[where])] if len(where) else None
            worst.append((None, None) if k is None else (float(difference[k]), float(f[k])))
        (off, off_at), (on, on_at) = worst
        found.append(Apart(block=name, off_resonance=off, off_frequency=off_at, at_resonance=on, at_frequency=on_at))
    return tuple(found)


PROMINENCE = 0.05
"""Decades by which a peak must stand out on both sides to be listed."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A maximum of one diagonal entry.

    Attributes
    ----------
    axis : index of the entry
    frequency : of the line [Hz]
    magnitude : |H| there [kg, kg m²]
    amplification : over the rigid body's [1]
    """

    axis: int = entry(write=MOTIONS.__getitem__)
    frequency: float = entry("frequency_hz", unit="Hz")
    magnitude: float
    amplification: float = unwritten()

    @property
    @derived("magnitude_unit")
    def unit(self) -> str:
        """Of the magnitude."""
        return UNITS[self.axis]


def peaks(H: DynamicMass, rigid: Array) -> tuple[Peak, ...]:
    """The maxima of the diagonal of `H` by axis and frequency; `rigid` (6,) is the diagonal of the rigid body."""
    from scipy.signal import find_peaks

    found = []
    for axis in range(6):
        size = np.abs(H.matrix[:, axis, axis])
        for k in find_peaks(np.log10(np.maximum(size, 1e-300)), prominence=PROMINENCE)[0]:
            times = float(size[k] / rigid[axis]) if rigid[axis] > 0 else float("nan")
            found.append(Peak(axis=axis, frequency=float(H.frequency[k]), magnitude=float(size[k]), amplification=times))
    return tuple(found)


@dataclass(frozen=True, kw_only=True)
class DynamicMassOptions:
    """Article, models (the first is the one asked for, the others stand beside it), band and step [Hz], reference point."""

    article: str
    models: tuple[str, ...]
    band: tuple[float, float]
    step: float
    about: str
    asked: FlexibleOptions


def curves(question: DynamicMassOptions, *, quiet: bool = False) -> Curves:
    """Answer `question`.

    Raises
    ------
    BadInput : something in it cannot be; everything that can be checked is, before anything is computed.
    """
    names = [
        require_model(question.article, m, option) for m, option in zip(question.models, ("--model", "--against"), strict=False)
    ]
    require_used(question.article, names, question.asked)
    frequency = lines(question.band, question.step)
    about, point = reference_point(question.about, question.article)
    models, masses = [], []
    for name, model in zip(names, question.models, strict=True):
        with shown(f"dynamic mass of {question.article}, {name} model", quiet=quiet):
            models.append(flexible(question.article, model, question.asked))
            require_base(models[-1])
            masses.append(dynamic_mass(models[-1], frequency, point))
    resonances = np.concatenate([m.modes.frequency for m in models])
    rigid = DynamicMass(
        frequency=np.zeros(1),
        matrix=models[0].modes.rigid_mass[None].astype(complex),
        reference_point=models[0].modes.reference_point,
    )
    rigid_mass = np.asarray(rigid.about(point).matrix[0].real)
    # Where the band reaches beyond the last mode that was kept
    said, high = [], question.band[1]
    for kept in (model.modes.frequency for model in models):
        if len(kept) >= question.asked.count and len(kept) and high > kept[-1]:
            said.append(
                f"the band reaches to {high:g} Hz, but the last of {len(kept)} modes kept lies at {kept[-1]:.4g} Hz: "
                "beyond it resonances are missing; keep more with --modes"
            )
    return Curves(
        article=question.article,
        about=about,
        models=tuple(models),
        masses=tuple(masses),
        rigid=rigid_mass,
        apart=tuple(apart(masses[0], other, resonances, rigid_mass) for other in masses[1:]),
        warnings=tuple(dict.fromkeys(said)),
    )
