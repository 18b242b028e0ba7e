"""Figures of an analysis with matplotlib and plotly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from ._analysis import check_models
from ._errors import InputError
from ._extras import extra
from ._html import marked

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._analysis import Analysis
    from ._model import Simulation

# Okabe and Ito, as in the figures of the program.
_FILMS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7")
_LINES = {
    "inflection_line": ("#0072B2", "dashed"),
    "iliac_line": ("#D55E00", "dotted"),
    "estimated_line": ("#009E73", "dashdot"),
    "given_line": ("#CC79A7", "solid"),
}
_OTHER_LINE = ("#56B4E9", "solid")
# Predictions without mechanics that know the tilt of T2.
_WITH_TILT = ("rotation_prior_with_tilt", "learned_with_tilt", "cubic")


class Plot:
    """Figures of one analysis. Frontal figures show the patient from behind: the patient's left is on the left.

    Examples
    --------
    >>> import spineline as sl
    >>> sl.analyze(sl.phantom("rod", subject=1)).plot.errors().get_ylabel()
    'location error (mm)'
    """

    __slots__ = ("_analysis",)

    def __init__(self, analysis: Analysis) -> None:
        self._analysis = analysis

    def lines(self, film: str | None = None, *, ax: Axes | None = None) -> Axes | list[Axes]:
        """Draws vertebrae, fitted curve, inflections and the candidate lines of action, in mm. Needs matplotlib.

        Parameters
        ----------
        film
            One film; by default all.
        ax
            Axes to draw on; several films are drawn over each other. By default every film gets a panel of a new figure.

        Returns
        -------
        The axes: a list if there are several.

        Raises
        ------
        InputError
            If the film is missing, or a film has no spacing.
        """
        films = self._analysis.films if film is None else [self._analysis.curve(film).film]
        if ax is not None:
            for number, one in enumerate(films):
                self._draw(ax, one, _FILMS[number % len(_FILMS)])
            names = ", ".join(_words(one) for one in films)
            self._finish(ax, f"{self._title()}: {names}")
            if ax.get_legend_handles_labels()[0]:
                ax.legend(frameon=False)
            return ax
        with extra("plot"):
            import matplotlib.pyplot as plt

        figure, panels = plt.subplots(
            1,
            len(films),
            sharex=True,
            sharey=True,
            squeeze=False,
            figsize=(2.6 * len(films) + 0.6, 6.0),
            layout="constrained",
        )
        axes: list[Axes] = list(panels[0])
        for panel, one in zip(axes, films, strict=True):
            self._draw(panel, one, _FILMS[0])
            self._finish(panel, _words(one), is_inverted=panel is not axes[0])
            panel.label_outer()
        figure.suptitle(self._title())
        handles, labels = axes[-1].get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
        return axes[0] if len(axes) == 1 else axes

    def errors(self, *, ax: Axes | None = None) -> Axes:
        """Draws the location errors of every model in mm, on fitted and on held-out films. Needs matplotlib.

        Raises
        ------
        InputError
            If the analysis has no model.
        """
        analysis = self._analysis
        check_models(analysis)
        ax = ax or _new_axes(1.0 + 1.1 * 2 * len(analysis.lines), 4.0)
        samples, names = [], []
        for line in analysis.lines:
            for kind, errors in (("fitted", analysis.fitted), ("held out", analysis.held_out)):
                values = errors.of(line).location_error_mm
                if len(values):
                    samples.append(values)
                    names.append(f"{_words(line)}\n{kind}")
        ax.boxplot(samples)
        ax.set_xticks(range(1, len(names) + 1), names)
        ax.set_ylim(bottom=0.0)
        ax.set_ylabel("location error (mm)")
        ax.set_title(self._title())
        return ax

    def predictions(
        self,
        films: Literal["left_out_bend", "held_out"] = "left_out_bend",
        *,
        with_tilt: bool = False,
        ax: Axes | None = None,
    ) -> Axes:
        """Draws the mean location error of every model on films that were not fitted, beside predictions without mechanics on the
        same films, in mm. Needs matplotlib.

        Parameters
        ----------
        films
            Bends, each left out of the fit in turn, or neutral and traction films.
        with_tilt
            Predictions from the location and the tilt of T2, instead of its location alone.

        Raises
        ------
        InputError
            If the analysis has no model, or no film of this kind is predicted.
        """
        check_models(self._analysis)
        compared = self._analysis._own_data["comparison"]
        bars: list[tuple[float, str, str]] = []
        for line, found in compared["lines"].items():
            by_location = found["errors"].get(films, {}).get("location_mm")
            error = found["with_tilt_mm"].get(films) if with_tilt else by_location
            if error is not None:
                parameters = 1 if with_tilt else found["numbers"]["per_predicted_film"]
                more = f" ({parameters} parameters per film)" if parameters > 1 else ""
                bars.append((error, f"{_words(line)}{more}", _LINES.get(line, _OTHER_LINE)[0]))
        for name, by_films in compared["baselines_mm"].items():
            if films in by_films and (name in _WITH_TILT) == with_tilt:
                bars.append((by_films[films], _words(name).removesuffix(" with tilt"), "#999999"))
        if not bars:
            raise InputError(
                f"{self._analysis.id}: no film of the kind `{films}` is predicted",
                help="bends left out need two bending films, held-out films a neutral or traction one",
            )
        ax = ax or _new_axes(6.4, 0.5 + 0.4 * len(bars))
        bars.sort()
        ax.barh(
            [name for _, name, _ in bars],
            [error for error, *_ in bars],
            color=[colour for *_, colour in bars],
        )
        ax.invert_yaxis()
        kind = "bends left out" if films == "left_out_bend" else "held-out films"
        tilt = " with the tilt of T2" if with_tilt else ""
        ax.set_xlabel(f"mean location error, {kind}{tilt} (mm)")
        ax.set_title(f"{self._title()} (grey: without mechanics)")
        return ax

    def model3d(self, line: str | None = None, *, simulation: Simulation | None = None) -> Any:
        """The model in space as a plotly figure, which turns with the mouse. Needs plotly (the extra ``model3d``).

        Parameters
        ----------
        line
            The line of action with which the model was fitted; by default the line of the simulation, or else ``"inflection"``.
        simulation
            A loaded shape of this model to draw beside the erect one.

        Raises
        ------
        InputError
            If the analysis has no model with this line, or the simulation is of another case or line.
        NotAResultError
            If the simulation has no shape to show.
        """
        with extra("model3d"):
            import plotly.graph_objects as go

        drawn = None if simulation is None else simulation._model
        model = self._analysis.model(line or ("inflection" if drawn is None else drawn.line))
        if drawn is not None and (drawn.id, drawn.line) != (model.id, model.line):
            raise InputError(
                f"the simulation is of {drawn.id} with the {_words(drawn.line)}, and the model of {model.id} with the {_words(model.line)}",
                help="simulate the loads on the model of this analysis",
            )
        shapes = [("erect", model.midpoints_mm, "#000000")]
        if simulation is not None:
            shapes.append((f"loaded ({simulation.status})", simulation.midpoints_mm, "#D55E00"))
        figure = go.Figure()
        for name, points, colour in shapes:
            figure.add_trace(
                go.Scatter3d(
                    x=points[:, 0],
                    y=points[:, 1],
                    z=points[:, 2],
                    text=model.levels,
                    name=name,
                    mode="lines+markers",
                    line={"color": colour, "width": 6},
                    marker={"color": colour, "size": 5, "symbol": "square"},
                )
            )
        figure.update_layout(
            title=f"{self._title()}: {_words(model.line)}",
            scene={
                "xaxis_title": "anterior (mm)",
                "yaxis_title": "patient's left (mm)",
                "zaxis_title": "cranial (mm)",
                "aspectmode": "data",
                "camera": {"eye": {"x": -2.2, "y": 0.0, "z": 0.3}},
            },
        )
        return figure

    def _title(self) -> str:
        return marked(self._analysis.id, synthetic=self._analysis.synthetic)

    def _draw(self, ax: Axes, film: str, colour: str) -> None:
        curve = self._analysis.curve(film)
        points, locations = curve.points_mm, curve.locations_mm
        ax.plot(points[:, 0], points[:, 1], color=colour, alpha=0.6, linewidth=1.5)
        ax.plot(locations[:, 0], locations[:, 1], "s", color=colour, markersize=4)
        inflections = curve.inflections_mm
        if inflections is not None:
            ax.plot(
                inflections[:, 0], inflections[:, 1], "D", color="#E69F00", markersize=7, zorder=3
            )
        for line, model in self._analysis._own_data["models"].items():
            simulated = model["postures"].get(film)
            if simulated is None:
                continue
            hue, dashes = _LINES.get(line, _OTHER_LINE)
            (y, z), (dy, dz) = simulated["line"]["point_mm"], simulated["line"]["direction"]
            known = ax.get_legend_handles_labels()[1]
            label = None if _words(line) in known else _words(line)
            ax.axline(
                (y, z), (y + dy, z + dz), color=hue, linestyle=dashes, linewidth=1.2, label=label
            )

    def _finish(self, ax: Axes, title: str, *, is_inverted: bool = False) -> None:
        ax.set_title(title)
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlabel("patient's left (mm)")
        ax.set_ylabel("cranial (mm)")
        # From behind, the patient's left is on the left; shared axes are inverted once.
        if not is_inverted and not ax.xaxis_inverted():
            ax.invert_xaxis()
        for x, name, side in ((0.02, "L", "left"), (0.98, "R", "right")):
            ax.text(x, 0.98, name, transform=ax.transAxes, ha=side, va="top", weight="bold")


def _new_axes(width: float, height: float) -> Axes:
    """The axes of a new figure, with its size in inches."""
    with extra("plot"):
        import matplotlib.pyplot as plt
    axes: Axes = plt.subplots(figsize=(width, height), layout="constrained")[1]
    return axes


def _words(name: str) -> str:
    return name.replace("_", " ")
