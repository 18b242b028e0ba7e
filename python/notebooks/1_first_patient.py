# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     name: python3
#     display_name: Python 3
# ---

# %% [markdown]
# # First patient
#
# From films with landmarks to a personalised model and its errors. The patient is **synthetic**: a rod bends a spine of known stiffness, and
# virtual readers place the landmarks with realistic errors.

# %%
import matplotlib.pyplot as plt
import spineline as sl

case = sl.phantom("rod", subject=1)  # your own: sl.read_case("p07/case.json")
case

# %% [markdown]
# Errors and warnings about the films come before any result. This patient has no error.

# %%
check = case.check()
assert check.ok
check

# %% [markdown]
# All steps of the method in one call: curves, inflections, chain, lines of action, fit of the stiffness, prediction of the films that were not
# fitted.

# %%
a = sl.analyze(case)
assert a.is_usable
a

# %% [markdown]
# ## The films
#
# Black squares are measured midpoints. Diamonds are the two inflections of the erect curve, on each film. The lines are the candidate lines of
# action of the bending force.

# %%
panels = a.plot.lines()
assert len(panels) == len(a.films) == 5
assert all(a.curve(film).inflections_mm.shape == (2, 2) for film in a.films)
plt.show()

# %% [markdown]
# ## What the model predicts
#
# `a.fitted` has the films from which the stiffness was found: their errors show how well the model can follow the data. `a.held_out` has the other films:
# only their errors are errors of predictions.

# %%
for name, errors in (("fitted", a.fitted), ("held out", a.held_out)):
    films = ", ".join(dict.fromkeys(errors.films))
    print(f"{name:9} {errors.location_error_mm.mean():.2f} mm  ({films})")
assert set(a.fitted.films).isdisjoint(a.held_out.films)

a.plot.errors()
plt.show()

# %% [markdown]
# How good is that? The inflection line is nearer than every prediction without mechanics (grey) from the location of T2: see
# [Is this line believable?](3_is_this_line_believable.md). `with_tilt=True` compares predictions that know the tilt of T2 too.

# %%
ax = a.plot.predictions()
assert ax.get_yticklabels()[0].get_text() == "inflection line"
plt.show()

# %% [markdown]
# ## The numbers behind it
#
# Every table has one row per thing and a unit in the name of each column; `meanings` explains the columns.

# %%
clinical = a.tables["clinical"]
assert set(clinical.meanings) == set(clinical.columns)
print(clinical.row)
clinical.to_pandas().loc[:5, "posture":"cobb_deg"].round(1)

# %%
multipliers = a.tables["multipliers"].to_pandas()
multipliers[["line", "joints", "multiplier", "at_bound"]]

# %% [markdown]
# ## Save it
#
# The file of the analysis holds the case, the options and every result; `spineline rerun` and `Analysis.from_json` repeat it to the last bit.
# The report is one HTML file.

# %%
path = a.save("patient.json", overwrite=True)
assert sl.Analysis.from_json(path.read_text()) == a
print(path, a.report("patient.html", overwrite=True))
