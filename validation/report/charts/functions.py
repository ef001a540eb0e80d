"""Curves as one asks for them: form, scale, phase and units of a dynamic mass or a response function; and pairs of modes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.campaign import POUND_FORCE, STANDARD_GRAVITY
from identification.files.files import Samples
from validation.compare.correlation import GREEN, ModalCorrelation
from validation.compare.maps import Map, NamedMode
from validation.report.charts import spec
from validation.report.charts.figure import Figure, Values
from validation.report.charts.interactive import WIDE, decades, dressed, escaped, magnitude_range, modes, phase

MAGNITUDE, PARTS, NYQUIST = FORMS = ("magnitude", "real and imaginary", "Nyquist")
PHASE, RATIO, COHERENCE = LOWER = ("phase", "measured / predicted", "coherence")

INCH = 0.0254
"""[m], by definition."""

SYSTEMS: Mapping[str, Mapping[str, tuple[float, str]]] = MappingProxyType(
    {
        "SI": {},
        "g": {"m/s²": (1 / STANDARD_GRAVITY, "g")},
        "in-lbf": {
            "N": (1 / POUND_FORCE, "lbf"),
            "N m": (1 / (POUND_FORCE * INCH), "in lbf"),
            "m/s²": (1 / STANDARD_GRAVITY, "g"),
            "m/s": (1 / INCH, "in/s"),
            "m": (1 / INCH, "in"),
        },
    }
)
"""By system how many of its units are one SI unit, and what they are called."""

IN_SI = {"N/(m/s²)": "kg", "N/(rad/s²)": "kg m", "N m/(m/s²)": "kg m", "N m/(rad/s²)": "kg m²"}
"""What SI calls quotients of a load and a motion."""

RATIOS = 30.0
"""Beyond this factor to either side a ratio is off the page."""

ROOM = 34
"""[pixels] above the curves for a legend, which has no title above it here, and to their right for the buttons."""


@dataclass(frozen=True, kw_only=True)
class Switches:
    """How curves are shown.

    Attributes
    ----------
    form : of `FORMS`
    lower : of `LOWER`, below a magnitude
    logarithmic : magnitudes and ratios
    unwrapped : a phase without jumps
    units : of `SYSTEMS`
    """

    form: str = MAGNITUDE
    lower: str = PHASE
    logarithmic: bool = True
    unwrapped: bool = False
    units: str = "SI"

    def unit(self, above: str, below: str) -> tuple[float, str]:
        """Of a quotient of the SI units `above` and `below`: the factor to the units asked for, and their name."""
        known = SYSTEMS[self.units]
        (up, over), (down, under) = (known.get(one, (1.0, one)) for one in (above, below))
        name = f"{over}/({under})" if "/" in under else f"{over}/{under}"
        return up / down, IN_SI.get(name, name)

    def curves(self, values: ComplexArray) -> list[Array]:
        """What the panels show of one curve (n,), from top to bottom; of a phase what is not jumped over."""
        if self.form != MAGNITUDE:
            return [values.real, values.imag]
        angle = np.degrees(np.unwrap(np.angle(values))) if self.unwrapped else phase(values)
        return [np.abs(values), angle] if self.lower == PHASE else [np.abs(values)]


def functions_of(of: Map, run: int, channel: int, further: Mapping[str, ComplexArray]) -> spec.EntryPanel:
    """One response function of `of`, and what else is predicted by name (r, n, c)."""
    whole = of.functions
    if whole is None:
        raise ValueError("`of` must have functions")

    def curve(name: str, values: ComplexArray, role: str, **more: Any) -> spec.Curve:
        return spec.Curve(name=name, frequency=of.frequency, values=values[run, :, channel], role=role, **more)

    measured = curve("measured", whole.measured, spec.MEASURED, dots=True)
    predicted = curve("predicted", whole.predicted, spec.PREDICTED, expected=whole.expected[run, :, channel])
    others = [curve(name, values, spec.FURTHER) for name, values in further.items()]
    return spec.EntryPanel(unit=whole.unit, curves=(measured, predicted, *others))


def shown(
    panel: spec.EntryPanel,
    units: tuple[str, str],
    switches: Switches,
    *,
    coherence: Array | None = None,
    named: Sequence[NamedMode] = (),
    marked: float | None = None,
    title: str,
    dark: bool = False,
) -> Figure:
    """The curves of `panel`, the measured one first and the predicted one second, as `switches` ask.

    Parameters
    ----------
    units : SI, of what is divided and of what it is divided by
    coherence : (n,) of what is measured; None where it is not known
    named : modes that are marked
    marked : [Hz] where a line is drawn
    title : by which a zoom stays
    """
    factor, unit = switches.unit(*units)
    curves = [
        replace(one, values=one.values * factor, expected=None if one.expected is None else one.expected * factor)
        for one in panel.curves
    ]
    if switches.form == NYQUIST:
        figure = _nyquist(curves, unit, marked)
    else:
        figure = Figure(rows=2, heights=(0.66, 0.34) if switches.form == MAGNITUDE else (0.5, 0.5), vertical=0.05, shared=True)
        if switches.form == PARTS:
            _parts(figure, curves, unit)
        else:
            _magnitudes(figure, curves, unit, switches)
            if switches.lower == RATIO:
                _ratios(figure, curves, switches)
            elif switches.lower == COHERENCE:
                _coherence(figure, curves[0].frequency, coherence)
        f = curves[0].frequency
        inside = [(one.name, one.frequency) for one in named if f[0] <= one.frequency <= f[-1]]
        if inside:
            figure.add(modes(inside, 1.0, 9, yaxis="y3", xaxis="x", name="modes", legendgroup="modes"))
            figure.update(yaxis3={"overlaying": "y", "range": [0, 1], "visible": False, "fixedrange": True})
        figure.across(range=[float(f[0]), float(f[-1])])
        figure.across(title={"text": "frequency [Hz]", "standoff": 4}, row=2, column=1)
        if marked is not None:
            figure.rule(x=marked, color=spec.COLOURS["limit"][1], width=1.5, dash="dash")
        figure.update(hovermode="x unified")
    legend = {"orientation": "h", "x": 0, "y": 1, "yref": "container", "yanchor": "top", "xanchor": "left", "font": {"size": 12}}
    look = {"margin": {"t": ROOM, "r": ROOM + 6, "b": 38}, "uirevision": escaped(f"{title} {switches.form}")}
    made = dressed(figure, title, 470, dark, legend=legend, **look)
    made.update(title={"text": ""}, modebar={"orientation": "v"})
    return made


def _look(one: spec.Curve) -> Values:
    colour = spec.COLOURS[one.role][1]
    name = {"type": "scatter", "name": escaped(one.name), "legendgroup": escaped(one.name)}
    if one.dots:
        return {**name, "mode": "markers", "marker": {"color": colour, "size": 4.5}}
    return {
        **name,
        "mode": "lines",
        "line": {"color": colour, "width": 2} | ({} if one.expected is not None else {"dash": "dash"}),
    }


def _band(figure: Figure, f: Array, low: Array, high: Array, row: int, *, legend: bool) -> None:
    edge = {"type": "scatter", "mode": "lines", "line": {"width": 0}, "hoverinfo": "skip", "legendgroup": "expected", "x": f}
    fill = {"fill": "tonexty", "fillcolor": "rgba(59,125,221,0.18)", "name": f"± {WIDE:g} σ", "showlegend": legend}
    figure.add({**edge, "y": low, "showlegend": False}, {**edge, **fill, "y": high}, row=row, column=1)


def _magnitudes(figure: Figure, curves: Sequence[spec.Curve], unit: str, switches: Switches) -> None:
    sizes = [np.abs(one.values) for one in curves]
    bands = [size + WIDE * one.expected for one, size in zip(curves, sizes, strict=True) if one.expected is not None]
    low, high = magnitude_range([sizes[0], *bands, *sizes[1:]])
    bottom = 10**low if switches.logarithmic else 0.0
    for one, size in zip(curves, sizes, strict=True):
        if one.expected is not None:
            edges = np.maximum(size - WIDE * one.expected, bottom), size + WIDE * one.expected
            _band(figure, one.frequency, *edges, 1, legend=True)
    for one in curves:
        # An angle of next to nothing means nothing
        seen = np.where(np.abs(one.values) >= 10**low, 1.0, np.nan)
        for k, values in enumerate(switches.curves(one.values)):
            more = {"showlegend": False, "hovertemplate": "%{y:.1f}°"} if k else {"hovertemplate": f"%{{y:.4g}} {unit}"}
            figure.add({**_look(one), **more, "x": one.frequency, "y": values * (seen if k else 1.0)}, row=1 + k, column=1)
    axis = decades(low, high) if switches.logarithmic else {"range": [0.0, 10**high], "rangemode": "tozero"}
    figure.up(title={"text": f"|H| [{unit}]"}, **axis, row=1, column=1)
    if switches.lower == PHASE:
        turns = {} if switches.unwrapped else {"range": [-190, 190], "tickvals": [-180, -90, 0, 90, 180]}
        figure.up(title={"text": "phase [°]"}, **turns, row=2, column=1)
    below = np.abs(curves[1].values) < 10**low
    if switches.logarithmic and below.any():
        what = "predicted is zero here" if below.all() else f"predicted is below this axis at {below.sum()} of {below.size} lines"
        _said(figure, what, "y domain")


def _said(figure: Figure, text: str, yref: str) -> None:
    place: dict[str, Any] = {"x": 1, "xref": "paper", "xanchor": "right", "y": 0.02, "yref": yref, "yanchor": "bottom"}
    figure.note(text=text, bgcolor="rgba(128,128,128,0.25)", font={"size": 12}, **place)


def _ratios(figure: Figure, curves: Sequence[spec.Curve], switches: Switches) -> None:
    measured, *others = curves
    nothing = 10 ** magnitude_range([one.values for one in curves])[0]
    seen: list[Array] = []
    for one in others:
        size = np.abs(one.values)
        known = size >= nothing
        ratio = np.where(known, np.abs(measured.values) / np.where(known, size, 1.0), np.nan)
        seen.append(ratio[np.isfinite(ratio) & (ratio > 0)])
        look = {"mode": "markers", "marker": {"color": spec.COLOURS[one.role][1], "size": 4}}
        told: Values = {"type": "scatter", "name": f"over {escaped(one.name)}", "showlegend": False, **look}
        figure.add({**told, "x": one.frequency, "y": ratio, "hovertemplate": "%{y:.4g}"}, row=2, column=1)
    every = np.concatenate([*seen, np.array([0.5, 2.0])])
    low, high = max(float(every.min()), 1 / RATIOS), min(float(every.max()), RATIOS)
    axis = decades(np.log10(low) - 0.05, np.log10(high) + 0.05) if switches.logarithmic else {"range": [0.0, 1.05 * high]}
    figure.up(title={"text": "measured /<br>predicted [1]"}, **axis, row=2, column=1)
    figure.rule(y=1.0, row=2, column=1, width=1)
    if not len(seen[0]):
        _said(figure, "no ratio: predicted is zero here", "y2 domain")


def _coherence(figure: Figure, f: Array, coherence: Array | None) -> None:
    if coherence is None:
        _said(figure, "the test states no coherence", "y2 domain")
    else:
        look = {"type": "scatter", "mode": "lines", "name": "coherence", "showlegend": False}
        line = {"color": spec.COLOURS[spec.MEASURED][1], "width": 1.5}
        figure.add({**look, "line": line, "x": f, "y": coherence, "hovertemplate": "%{y:.3f}"}, row=2, column=1)
    figure.up(title={"text": "coherence [1]"}, range=[0, 1.04], row=2, column=1)


def _parts(figure: Figure, curves: Sequence[spec.Curve], unit: str) -> None:
    for k, name in enumerate(("real", "imaginary")):
        for one in curves:
            values = Switches(form=PARTS).curves(one.values)[k]
            if one.expected is not None:
                reach = WIDE * one.expected / np.sqrt(2)  # of one part of a complex difference
                _band(figure, one.frequency, values - reach, values + reach, 1 + k, legend=not k)
            more = {"showlegend": not k, "hovertemplate": f"%{{y:.4g}} {unit}"}
            figure.add({**_look(one), **more, "x": one.frequency, "y": values}, row=1 + k, column=1)
        figure.up(title={"text": f"{name}<br>[{unit}]"}, zeroline=True, row=1 + k, column=1)


def _nyquist(curves: Sequence[spec.Curve], unit: str, marked: float | None) -> Figure:
    figure = Figure()
    for one in curves:
        real, imaginary = Switches(form=NYQUIST).curves(one.values)
        told = {"customdata": one.frequency[:, None], "hovertemplate": "%{customdata[0]:.3f} Hz"}
        figure.add({**_look(one), **told, "x": real, "y": imaginary})
    for one in curves if marked is not None else ():
        at = int(np.argmin(np.abs(one.frequency - (marked or 0.0))))
        look = {"symbol": "circle-open", "size": 13, "color": spec.COLOURS["limit"][1], "line": {"width": 2}}
        place = {"x": [one.values[at].real], "y": [one.values[at].imag]}
        figure.add({"type": "scatter", "mode": "markers", "marker": look, "showlegend": False, "hoverinfo": "skip", **place})
    figure.across(title={"text": f"real [{unit}]", "standoff": 4}, zeroline=True)
    figure.up(title={"text": f"imaginary [{unit}]"}, zeroline=True, scaleanchor="x")
    return figure


# Modes of a table beside those of a model: a matrix that one clicks, and the shapes of a pair at the sensors.


BLUES = {
    False: [[0.0, "#ffffff"], [0.5, "#a9c6e8"], [1.0, "#20507f"]],
    True: [[0.0, "#171b22"], [0.5, "#2f5d8c"], [1.0, "#b7d8fa"]],
}
"""Colours of a MAC from 0 to 1, by whether the page is dark."""

WRITTEN = 14
"""Modes of the model up to which every cell bears its number."""


def mac(of: ModalCorrelation, hertz: Sequence[float], at: tuple[int, int] | None, dark: bool = False) -> Figure:
    """The MAC of every mode of the table and every mode of the model; pairs are framed, the chosen one dashed.

    A click tells [MAC, frequency of the model in Hz, row, column] as `customdata`.

    Parameters
    ----------
    hertz : (q,) of the modes of the model
    at : row and column of the pair that is chosen
    """
    rows = [escaped(f"{one.measured}, {one.measured_hz:.4g} Hz") for one in of.pairs]
    columns = [f"{number}: {f:.4g} Hz" for number, f in zip(of.modes, hertz, strict=True)]
    m, q = of.mac.shape
    custom = np.stack([of.mac, np.tile(hertz, (m, 1)), *np.meshgrid(np.arange(m), np.arange(q), indexing="ij")], axis=2)
    heat: Values = {
        "type": "heatmap",
        "x": columns,
        "y": rows,
        "z": of.mac,
        "zmin": 0,
        "zmax": 1,
        "customdata": custom,
        "colorscale": BLUES[dark],
        "xgap": 1,
        "ygap": 1,
        "meta": "MAC",
        "hovertemplate": "%{y}<br>model %{x}: MAC %{z:.3f}<extra></extra>",
        "colorbar": {"title": {"text": "MAC"}, "thickness": 12, "len": 1.0},
    }
    if q <= WRITTEN:
        heat |= {"texttemplate": "%{z:.2f}", "textfont": {"size": 11}}
    figure = Figure(heat)
    frames = [(k, of.modes.index(one.model), False) for k, one in enumerate(of.pairs)]
    for i, j, chosen in [*frames, *([(*at, True)] if at else [])]:
        line = {"color": spec.COLOURS["limit" if chosen else spec.FURTHER][1], "width": 3, "dash": "dot" if chosen else "solid"}
        box = {"x0": j - 0.5, "x1": j + 0.5, "y0": i - 0.5, "y1": i + 0.5}
        figure.layout.setdefault("shapes", []).append({"type": "rect", "line": line, **box})
    figure.across(title={"text": "mode of the model", "standoff": 4}, type="category", showgrid=False, tickfont={"size": 10})
    upside: dict[str, Any] = {"range": [m - 0.5, -0.5], "type": "category", "categoryarray": rows, "automargin": True}
    figure.up(showgrid=False, tickfont={"size": 11}, **upside)
    made = dressed(figure, "MAC", 300, dark, margin={"t": 30, "b": 40, "r": 10, "l": 90})
    made.update(title={"text": ""})
    return made


def scaled(measured: Samples, model: Array) -> ComplexArray:
    """`measured` (s,) in the scale and with the sign of the shape of the `model` (s,), by least squares."""
    return np.asarray(measured * np.vdot(measured, model) / np.vdot(measured, measured), dtype=np.complex128)


def pair_of_shapes(of: ModalCorrelation, at: tuple[int, int], dark: bool = False) -> Figure:
    """The shapes of a mode of the table and one of the model, sensor by sensor, each of its largest component."""
    i, j = at
    model, names = of.model_shapes[j], list(of.comac)
    both = scaled(of.measured_shapes[i], model), model
    largest = max(float(np.abs(one).max()) for one in both) or 1.0
    x = list(range(len(names)))
    point = {"type": "scatter", "x": x, "text": [escaped(one) for one in names], "hovertemplate": "%{text}: %{y:.3f}"}
    dots = {"mode": "markers", "marker": {"color": spec.COLOURS[spec.MEASURED][1], "size": 7}, "name": "test"}
    line = {"mode": "lines+markers", "line": {"color": spec.COLOURS[spec.PREDICTED][1], "width": 1.5}, "marker": {"size": 4}}
    figure = Figure(
        {**point, **line, "name": "model", "y": model / largest},
        {**point, **dots, "y": both[0].real / largest},
    )
    few = len(names) <= WRITTEN
    ticks: Values = (
        {"tickvals": x, "ticktext": point["text"]} if few else {"title": {"text": "sensor, in the order of the table"}}
    )
    figure.across(showgrid=False, tickfont={"size": 10}, **ticks)
    figure.up(title={"text": "shape [1]"}, zeroline=True, range=[-1.1, 1.1])
    legend = {"orientation": "h", "x": 0, "y": 1, "yref": "container", "yanchor": "top", "font": {"size": 12}}
    named = f"{of.pairs[i].measured} and {of.modes[j]}"
    made = dressed(figure, named, 300, dark, legend=legend, margin={"t": ROOM, "r": ROOM + 6, "b": 40})
    made.update(title={"text": ""}, modebar={"orientation": "v"}, hovermode="closest")
    return made


def told(of: ModalCorrelation, at: tuple[int, int]) -> str:
    """What is to be said of a pair, in words."""
    one, number, value = of.pairs[at[0]], of.modes[at[1]], of.mac[at]
    alike = "alike" if value >= GREEN else "not alike"
    if one.model == number:
        both = f"{one.measured}, {one.measured_hz:.4g} Hz, model {one.model_hz:.4g} Hz ({one.percent:+.2g} %)"
        return f"{both}: MAC {value:.2f}, {alike}"
    return f"{one.measured}, {one.measured_hz:.4g} Hz, and mode {number} of the model, no pair: MAC {value:.2f}, {alike}"
