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
# # My own landmarks
#
# Many groups keep corners of vertebrae in a table. This notebook reads such a CSV file, finds what is wrong with it, and analyses it. The numbers are
# **synthetic**; the notebook writes the file itself, so that it runs anywhere.

# %%
import json

import matplotlib.pyplot as plt
import pandas as pd
import spineline as sl

CORNERS = ("superior_left", "superior_right", "inferior_left", "inferior_right")
rows = []
for film in json.loads(sl.phantom("bend", subject=4).to_json())["films"]:
    for reading in film["readings"]:
        for level, corners in reading["vertebrae"].items():
            row = {"posture": film["posture"], "observer": reading["observer"]}
            row |= {"repeat": reading["repeat"], "vertebra": level}
            for corner in CORNERS:
                row[f"{corner}_column_px"], row[f"{corner}_row_px"] = corners[corner]
            rows.append(row)
pd.DataFrame(rows).to_csv("landmarks.csv", index=False)

# %% [markdown]
# ## The table
#
# One row per vertebra and reading. *Left* and *right* are the patient's. Rows and columns are in pixels of the film.

# %%
landmarks = pd.read_csv("landmarks.csv")
landmarks.head(3)

# %%
case = sl.Case.from_landmarks(landmarks, mm_per_px=0.14, plane="detector", case_id="P07", synthetic=True)
case

# %% [markdown]
# ## Landmarks have errors
#
# Swap two corners of one vertebra by mistake. The program does not guess: it says which film, which vertebra, and what to do.

# %%
slipped = landmarks.copy()
at = slipped.index[(slipped.posture == "erect") & (slipped.vertebra == "T9")][0]
left, right = ([f"superior_{side}_{axis}_px" for axis in ("column", "row")] for side in ("left", "right"))
slipped.loc[at, left + right] = slipped.loc[at, right + left].to_numpy()
try:
    sl.Case.from_landmarks(slipped, mm_per_px=0.14, case_id="P07", synthetic=True)
except sl.InputError as error:
    print(error)
    print("film:", error.film, "| vertebra:", error.level)

# %% [markdown]
# A smaller error, a corner that is 4 mm off, is a warning: the analysis runs, and every output repeats the warning.

# %%
moved = landmarks.copy()
moved.loc[at, "superior_left_row_px"] -= 30
sl.Case.from_landmarks(moved, mm_per_px=0.14, case_id="P07", synthetic=True).check()

# %% [markdown]
# ## How well do the readers agree?
#
# If a film was read more than once, the readings show how large the noise is.

# %%
a = sl.analyze(case)
reliability = a.tables["reliability"].to_pandas()
reliability.loc[reliability.statistic == "sem_agreement", ["quantity", "design", "value", "unit"]].round(3)

# %% [markdown]
# ## The curve, with your own axes
#
# NumPy arrays, in mm from the midpoint of L4: y to the patient's left, z cranial.

# %%
figure, ax = plt.subplots(figsize=(4.2, 5.5), layout="constrained")
for film, colour in (("erect", "black"), ("left_bending", "#0072B2"), ("right_bending", "#D55E00")):
    curve = a.curve(film)
    ax.plot(*curve.points_mm.T, color=colour, label=film.replace("_", " "))
    ax.plot(*curve.locations_mm.T, "s", color=colour, markersize=3)
ax.invert_xaxis()  # seen from behind, the patient's left is on the left
ax.set(aspect="equal", xlabel="patient's left (mm)", ylabel="cranial (mm)", title="P07 · SYNTHETIC")
figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
plt.show()
