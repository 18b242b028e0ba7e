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
# Errors and warnings about the films come before any result.

# %%
case.check()

# %% [markdown]
# All steps of the method in one call: curves, inflections, chain, lines of action, fit of the stiffness, prediction of the films that were not
# fitted.

# %%
a = sl.analyze(case)
a

# %% [markdown]
# ## The films
#
# Black squares are measured midpoints. Diamonds are the two inflections of the erect curve, on each film. The lines are the candidate lines of
# action of the bending force.

# %%
a.plot.lines()
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

a.plot.errors()
plt.show()

# %% [markdown]
# How good is that? Compare with predictions without mechanics: see [Is this line believable?](3_is_this_line_believable.md).

# %%
a.plot.predictions()
plt.show()

# %% [markdown]
# ## The numbers behind it
#
# Every table has one row per thing and a unit in the name of each column; `meanings` explains the columns.

# %%
clinical = a.tables["clinical"]
print(clinical.row)
clinical.to_pandas().loc[:5, "posture":"cobb_deg"].round(1)

# %%
multipliers = a.tables["multipliers"].to_pandas()
multipliers[["line", "joints", "multiplier", "at_bound"]]

# %% [markdown]
# ## Save it
#
# The file of the analysis holds the case, the options and every result; `spineline rerun` repeats it to the last bit. The report is one HTML file.

# %%
print(a.save("patient.json", overwrite=True), a.report("patient.html", overwrite=True))
