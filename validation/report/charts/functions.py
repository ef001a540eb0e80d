"""Curves as one asks for them: form, scale, phase and units of a dynamic mass or a response function; and pairs of modes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from geometry.toml_file import STANDARD_GRAVITY
from identification.campaign import POUND_FORCE
from validation.compare.correlation import GREEN, ModalCorrelation, ModePair, NamedMode
from validation.output import two_digits
from validation.report.charts import spec
from validation.report.charts.figure import Figure, Values
from validation.report.charts.interactive import WIDE, decades, dressed, escaped, magnitude_range, modes, phase

MAGNITUDE, PARTS, NYQUIST = FORMS = ("magnitude", "real, imaginary", "Nyquist")
PHASE, RATIO, COHERENCE = LOWER = ("phase", "ratio", "coherence")

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


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnCurves:
    """Curves of one quantity, to be drawn as `switches` ask.

    Attributes
    ----------
    panel : the measured curve first and the predicted one second
    units : SI, of what is divided and of what it is divided by
    switches : how they are shown
    coherence : (n,) of what is measured; None where it is not known
    modes : that are marked
    marked : [Hz] where a line is drawn
    title : by which a zoom stays
    """

    panel: spec.EntryPanel
    units: tuple[str, str]
    switches: Switches
    coherence: Array | None = None
    modes: Sequence[NamedMode] = ()
    marked: float | None = None
    title: str

    @property
    def unit(self) -> str:
        """In which they are shown."""
        return self.switches.unit(*self.units)[1]

    @property
    def curves(self) -> tuple[spec.Curve, ...]:
        """In that unit."""
        factor = self.switches.unit(*self.units)[0]
        return tuple(
            replace(one, values=one.values * factor, expected=None if one.expected is None else one.expected * factor)
            for one in self.panel.curves
        )

    def figure(self, dark: bool = False) -> Figure:
        """The figure."""
        if self.switches.form == NYQUIST:
            figure = self._nyquist()
        else:
            heights = (0.66, 0.34) if self.switches.form == MAGNITUDE else (0.5, 0.5)
            figure = Figure(rows=2, heights=heights, vertical=0.1, shared=True)
            if self.switches.form == PARTS:
                self._parts(figure)
            else:
                self._magnitudes(figure)
            f = self.panel.curves[0].frequency
            inside = [(one.name, one.frequency) for one in self.modes if f[0] <= one.frequency <= f[-1]]
            if inside:
                figure.add(modes(inside, 0.97, 9, yaxis="y3", xaxis="x", name="modes", legendgroup="modes"))
                figure.update(yaxis3={"overlaying": "y", "range": [0, 1], "visible": False, "fixedrange": True})
            figure.across(range=[float(f[0]), float(f[-1])])
            figure.across(title={"text": "frequency [Hz]"}, row=2, column=1)
            if self.marked is not None:
                figure.rule(x=self.marked, color=spec.COLOURS["limit"][1], width=1.5, dash="dash")
            figure.update(hovermode="x unified")
        return small(figure, f"{self.title} {self.switches.form}", dark)

    def _magnitudes(self, figure: Figure) -> None:
        curves, switches = self.curves, self.switches
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
                more = {"showlegend": False, "hovertemplate": "%{y:.1f}°"} if k else {"hovertemplate": f"%{{y:.4g}} {self.unit}"}
                figure.add({**_look(one), **more, "x": one.frequency, "y": values * (seen if k else 1.0)}, row=1 + k, column=1)
        axis = decades(low, high) if switches.logarithmic else {"range": [0.0, 10**high], "rangemode": "tozero"}
        figure.up(title={"text": f"|H| [{self.unit}]"}, **axis, row=1, column=1)
        below = np.abs(curves[1].values) < 10**low
        if switches.logarithmic and below.any():
            some = f"predicted is below this axis at {below.sum()} of {below.size} lines"
            _say(figure, "predicted is zero here" if below.all() else some)
        if switches.lower == PHASE:
            turns: Values = {} if switches.unwrapped else {"range": [-190, 190], "tickvals": [-180, 0, 180]}
            figure.up(title={"text": "phase [°]"}, **turns, row=2, column=1)
        elif switches.lower == RATIO:
            self._ratios(figure, 10**low)
        else:
            self._coherence(figure)

    def _ratios(self, figure: Figure, nothing: float) -> None:
        measured, *others = self.curves
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
        linear = {"range": [0.0, 1.05 * high]}
        axis = decades(np.log10(low) - 0.05, np.log10(high) + 0.05) if self.switches.logarithmic else linear
        figure.up(title={"text": "measured /<br>predicted [1]"}, **axis, row=2, column=1)
        figure.rule(y=1.0, row=2, column=1, width=1)
        if not len(seen[0]):
            _say(figure, "no ratio: predicted is zero here", lower=True)

    def _coherence(self, figure: Figure) -> None:
        if self.coherence is None:
            _say(figure, "the test states no coherence", lower=True)
        else:
            look = {"type": "scatter", "mode": "lines", "name": "coherence", "showlegend": False}
            line = {"color": spec.COLOURS[spec.MEASURED][1], "width": 1.5}
            shown: Values = {**look, "line": line, "x": self.panel.curves[0].frequency, "y": self.coherence}
            figure.add({**shown, "hovertemplate": "%{y:.3f}"}, row=2, column=1)
        figure.up(title={"text": "coherence [1]"}, range=[0, 1.04], row=2, column=1)

    def _parts(self, figure: Figure) -> None:
        for k, name in enumerate(("real", "imaginary")):
            for one in self.curves:
                values = self.switches.curves(one.values)[k]
                if one.expected is not None:
                    reach = WIDE * one.expected / np.sqrt(2)  # of one part of a complex difference
                    _band(figure, one.frequency, values - reach, values + reach, 1 + k, legend=not k)
                more = {"showlegend": not k, "hovertemplate": f"%{{y:.4g}} {self.unit}"}
                figure.add({**_look(one), **more, "x": one.frequency, "y": values}, row=1 + k, column=1)
            figure.up(title={"text": f"{name}<br>[{self.unit}]"}, zeroline=True, row=1 + k, column=1)

    def _nyquist(self) -> Figure:
        figure = Figure()
        for one in self.curves:
            real, imaginary = self.switches.curves(one.values)
            hover = {"customdata": one.frequency[:, None], "hovertemplate": "%{customdata[0]:.3f} Hz"}
            figure.add({**_look(one), **hover, "x": real, "y": imaginary})
        for one in self.curves if self.marked is not None else ():
            at = int(np.argmin(np.abs(one.frequency - (self.marked or 0.0))))
            look = {"symbol": "circle-open", "size": 13, "color": spec.COLOURS["limit"][1], "line": {"width": 2}}
            place: Values = {"x": [one.values[at].real], "y": [one.values[at].imag]}
            figure.add({"type": "scatter", "mode": "markers", "marker": look, "showlegend": False, "hoverinfo": "skip", **place})
        figure.across(title={"text": f"real [{self.unit}]"}, zeroline=True)
        figure.up(title={"text": f"imaginary [{self.unit}]"}, zeroline=True, scaleanchor="x")
        return figure


def small(figure: Figure, title: str, dark: bool) -> Figure:
    """`figure` in a panel that is narrower and lower than a page: no title, buttons to its right, a legend above the curves."""
    legend = {"orientation": "h", "x": 0, "y": 1, "yref": "container", "yanchor": "top", "xanchor": "left", "font": {"size": 12}}
    figure.across(title={"standoff": 2, "font": {"size": 12}}, tickfont={"size": 11})
    figure.up(title={"font": {"size": 12}}, tickfont={"size": 11})
    margin = {"t": ROOM, "r": ROOM + 6, "b": 40, "l": 64}
    made = dressed(figure, title, 470, dark, legend=legend, margin=margin, uirevision=escaped(title))
    made.update(title={"text": ""}, modebar={"orientation": "v"})
    return made


def _look(one: spec.Curve) -> Values:
    colour = spec.COLOURS[one.role][1]
    name: Values = {"type": "scatter", "name": escaped(one.name), "legendgroup": escaped(one.name)}
    if one.dots:
        return {**name, "mode": "markers", "marker": {"color": colour, "size": 4.5}}
    dash = {} if one.expected is not None else {"dash": "dash"}
    return {**name, "mode": "lines", "line": {"color": colour, "width": 2, **dash}}


def _band(figure: Figure, f: Array, low: Array, high: Array, row: int, *, legend: bool) -> None:
    edge = {"type": "scatter", "mode": "lines", "line": {"width": 0}, "hoverinfo": "skip", "legendgroup": "expected", "x": f}
    fill = {"fill": "tonexty", "fillcolor": "rgba(59,125,221,0.18)", "name": f"± {WIDE:g} σ", "showlegend": legend}
    figure.add({**edge, "y": low, "showlegend": False}, {**edge, **fill, "y": high}, row=row, column=1)


def _say(figure: Figure, text: str, *, lower: bool = False) -> None:
    """Between the panels, where no curve can be: of the upper one to the right, of the `lower` one to the left."""
    place: Values = {"x": 0, "xanchor": "left", "y": 1, "yref": "y2 domain", "yanchor": "bottom"}
    if not lower:
        place = {"x": 1, "xanchor": "right", "y": 0, "yref": "y domain", "yanchor": "top"}
    figure.note(text=text, bgcolor="rgba(128,128,128,0.25)", font={"size": 11}, borderpad=0, xref="paper", **place)


# Modes of a table beside those of a model: a matrix that one clicks, and the shapes of a pair at the sensors.


BLUES = {
    False: [[0.0, "#ffffff"], [0.5, "#a9c6e8"], [1.0, "#20507f"]],
    True: [[0.0, "#171b22"], [0.5, "#2f5d8c"], [1.0, "#b7d8fa"]],
}
"""Colours of a MAC from 0 to 1, by whether the page is dark."""

WRITTEN = 14
"""Modes of the model up to which every cell bears its number."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ShownPair:
    """A mode of a table beside one of the model.

    Attributes
    ----------
    of : all of them
    at : row and column of its MAC
    """

    of: ModalCorrelation
    at: tuple[int, int]

    @classmethod
    def chosen(cls, of: ModalCorrelation, pair: Sequence[int] | None) -> "ShownPair":
        """The `pair`, or the first that was paired where there is no such one."""
        m, q = of.mac.shape
        if pair is not None and 0 <= pair[0] < m and 0 <= pair[1] < q:
            return cls(of=of, at=(int(pair[0]), int(pair[1])))
        return cls(of=of, at=(0, of.modes.index(of.pairs[0].model)))

    @property
    def words(self) -> str:
        """What is to be said of it."""
        one, number, value = self.of.pairs[self.at[0]], self.of.modes[self.at[1]], self.of.mac[self.at]
        alike = f"MAC {value:.2f}, {'alike' if value >= GREEN else 'not alike'}"
        signed = f"{'-' if one.percent < 0 else '+'}{two_digits(abs(one.percent))}"
        if one.model == number:
            return f"{_named(one)}, model {one.model_hz:.4g} Hz ({signed} %): {alike}"
        return f"{_named(one)}, and mode {number} of the model, no pair: {alike}"

    @property
    def scaled(self) -> ComplexArray:
        """(s,) the shape of the table in scale and sign of that of the model, by least squares."""
        measured, model = self.of.measured_shapes[self.at[0]], self.of.model_shapes[self.at[1]]
        return np.asarray(measured * np.vdot(measured, model) / np.vdot(measured, measured), dtype=np.complex128)

    def mac(self, known: Sequence[NamedMode], dark: bool = False) -> Figure:
        """The MAC of every mode of the table and every mode of the model; pairs are framed, the chosen one dotted.

        A click tells [MAC, frequency of the model in Hz, row, column] as `customdata`; `known` are the modes of the model.
        """
        of, (m, q) = self.of, self.of.mac.shape
        paired = {one.model: one.model_hz for one in of.pairs}
        hertz = [paired.get(k, known[k - 1].frequency if 0 < k <= len(known) else np.nan) for k in of.modes]
        rows = [escaped(_named(one)) for one in of.pairs]
        columns = [f"{number}<br>{f:.4g}" for number, f in zip(of.modes, hertz, strict=True)]
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
            "hovertemplate": "%{y}<br>model %{customdata[1]:.4g} Hz: MAC %{z:.3f}<extra></extra>",
            "colorbar": {"title": {"text": "MAC"}, "thickness": 12, "len": 1.0},
        }
        if q <= WRITTEN:
            heat |= {"texttemplate": "%{z:.2f}", "textfont": {"size": 11}}
        figure = Figure(heat)
        frames = [(k, of.modes.index(one.model), False) for k, one in enumerate(of.pairs)]
        for i, j, chosen in [*frames, (*self.at, True)]:
            look = {"width": 3, "dash": "dot" if chosen else "solid"}
            line = {"color": spec.COLOURS["limit" if chosen else spec.FURTHER][1], **look}
            box = {"x0": j - 0.5, "x1": j + 0.5, "y0": i - 0.5, "y1": i + 0.5}
            figure.layout.setdefault("shapes", []).append({"type": "rect", "line": line, **box})
        figure.across(title={"text": "mode of the model [Hz]"}, type="category", showgrid=False)
        upside: Values = {"range": [m - 0.5, -0.5], "type": "category", "categoryarray": rows, "automargin": True}
        figure.up(showgrid=False, **upside)
        made = small(figure, "MAC", dark)
        if q <= WRITTEN:  # wide enough for two lines; else the browser turns what is too wide
            made.across(tickangle=0, tickfont={"size": 10})
        made.update(margin={"r": 10, "b": 54}, modebar={"orientation": "h"})
        return made

    def shapes(self, dark: bool = False) -> Figure:
        """Both, sensor by sensor, each of its largest component."""
        model, names = self.of.model_shapes[self.at[1]], list(self.of.comac)
        test = self.scaled
        largest = max(float(np.abs(one).max()) for one in (test, model)) or 1.0
        text = [escaped(one) for one in names]
        point: Values = {"type": "scatter", "x": list(range(len(names))), "text": text, "hovertemplate": "%{text}: %{y:.3f}"}
        dots = {"mode": "markers", "marker": {"color": spec.COLOURS[spec.MEASURED][1], "size": 7}, "name": "test"}
        line = {"mode": "lines+markers", "line": {"color": spec.COLOURS[spec.PREDICTED][1], "width": 1.5}, "marker": {"size": 4}}
        figure = Figure({**point, **line, "name": "model", "y": model / largest}, {**point, **dots, "y": test.real / largest})
        few, words = len(names) <= WRITTEN, "sensor, in the order of the table"
        ticks: Values = {"tickvals": point["x"], "ticktext": text} if few else {"title": {"text": words}}
        figure.across(showgrid=False, **ticks)
        figure.up(title={"text": "shape [1]"}, zeroline=True, range=[-1.1, 1.1])
        return small(figure, f"{self.at}", dark)


def _named(one: ModePair) -> str:
    """A mode of a table; a resonance is called by its frequency."""
    return one.measured if one.measured.endswith("Hz") else f"{one.measured}, {one.measured_hz:.4g} Hz"
