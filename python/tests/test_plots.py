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
    assert analysis.plot.lines("left-bending", ax=ax) is ax and analysis.curve("left-bending").film == "left_bending"
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


def test_changed_data_do_not_change_a_figure(case: sl.Case) -> None:
    pytest.importorskip("matplotlib").use("agg")
    import matplotlib.pyplot as plt

    found = sl.analyze(case)
    before = [bar.get_width() for bar in found.plot.predictions().patches]
    for baseline in found.data["comparison"]["baselines_mm"].values():
        baseline.clear()
    found.data["models"].clear()
    assert [bar.get_width() for bar in found.plot.predictions().patches] == before
    ax = plt.subplots()[1]
    found.plot.lines("left_bending", ax=ax)
    assert "inflection line" in ax.get_legend_handles_labels()[1]
    plt.close("all")


def without_spacing(case: sl.Case) -> sl.Case:
    whole = json.loads(case.to_json())
    for film in whole["films"]:
        film["image"] = {key: value for key, value in film["image"].items() if "spacing" not in key}
    return sl.Case.from_json(json.dumps(whole))


def test_without_a_model_errors_and_predictions_say_what_a_model_needs(case: sl.Case) -> None:
    found = sl.analyze(without_spacing(case))
    assert "left_bending" in found.films and found.lines == [] and not found.is_usable
    readers = [found.plot.errors, found.plot.predictions, found.model, lambda: found.held_out]
    for read in (*readers, lambda: found.fitted, lambda: found.model("iliac")):
        with pytest.raises(sl.InputError, match="the analysis has no model") as caught:
            read()
        assert "scale of every film" in caught.value.help


def test_errors_of_other_lines_are_read_without_a_line_through_inflections(case: sl.Case) -> None:
    pytest.importorskip("matplotlib").use("agg")
    import matplotlib.pyplot as plt

    found = sl.analyze(case, min_curve=80)
    assert "inflection_line" not in found.lines and found.lines
    for errors in (found.held_out, found.fitted):
        assert errors.line == found.lines[0] and len(errors) > 0
        assert len(errors.of(found.lines[-1])) > 0
    names = [label.get_text() for label in found.plot.errors().get_xticklabels()]
    assert names[0].startswith(found.lines[0].replace("_", " "))
    plt.close("all")


def test_the_model_is_drawn_in_space(analysis: sl.Analysis) -> None:
    pytest.importorskip("plotly")
    loaded = analysis.model().simulate(sl.Pad("T9", towards="left", force=10))
    figure = analysis.plot.model3d(simulation=loaded)
    assert len(figure.data) == 2 and "SYNTHETIC" in figure.layout.title.text
    other = analysis.model("iliac").simulate(sl.Pad("T9", towards="left", force=10))
    assert "iliac line" in analysis.plot.model3d(simulation=other).layout.title.text
    with pytest.raises(sl.InputError, match="the simulation is of .* with the iliac line"):
        analysis.plot.model3d("inflection", simulation=other)
