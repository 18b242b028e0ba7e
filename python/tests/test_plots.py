"""Figures with matplotlib and plotly."""

from __future__ import annotations

import json

import pytest

import spineline as sl


def test_lines_are_drawn_on_own_and_on_given_axes(analysis: sl.Analysis) -> None:
    whole = json.loads(analysis.case.to_json())
    whole["films"] = [film for film in whole["films"] if film["posture"] in ("erect", "left_bending")]
    two_films = sl.Case.from_json(json.dumps(whole))
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    panels = analysis.plot.lines()
    assert isinstance(panels, list) and len(panels) == len(analysis.films)
    assert all(panel.xaxis_inverted() for panel in panels), "the patient's left is on the left"
    figure = panels[0].figure
    figure.canvas.draw()
    assert "SYNTHETIC" in figure.get_suptitle()
    ax = plt.subplots()[1]
    assert analysis.plot.lines("left_bending", ax=ax) is ax
    place = {text.get_text(): text.get_position()[0] for text in ax.texts}
    assert place["L"] < place["R"] and ax.xaxis_inverted()
    assert ax.get_title() == f"{analysis.id} · SYNTHETIC: left bending"
    assert "inflection line" in [text.get_text() for text in ax.get_legend().get_texts()]
    assert analysis.plot.errors().get_ylabel() == "location error (mm)"
    with pytest.raises(sl.InputError):
        analysis.plot.lines("lateral")
    ax = analysis.plot.predictions()
    names = [label.get_text() for label in ax.get_yticklabels()]
    assert "inflection line" in names and "mirrored bend" in names
    assert "estimated line (3 parameters per film)" in names
    assert "cubic" not in names
    with_tilt = analysis.plot.predictions(with_tilt=True)
    names = [label.get_text() for label in with_tilt.get_yticklabels()]
    assert {"inflection line", "estimated line", "cubic", "rotation prior"} <= set(names)
    assert "mirrored bend" not in names
    assert "SYNTHETIC" in ax.get_title()
    widths = [bar.get_width() for bar in ax.patches]
    assert widths == sorted(widths)
    with pytest.raises(sl.InputError, match="held_out"):
        sl.analyze(two_films).plot.predictions("held_out")
    plt.close("all")


def test_the_model_is_drawn_in_space(analysis: sl.Analysis) -> None:
    pytest.importorskip("plotly")
    loaded = analysis.model().simulate(sl.Pad("T9", towards="left", force=10))
    figure = analysis.plot.model3d(simulation=loaded)
    assert len(figure.data) == 2 and "SYNTHETIC" in figure.layout.title.text
