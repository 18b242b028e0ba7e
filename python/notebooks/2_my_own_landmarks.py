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
import matplotlib.pyplot as plt
import pandas as pd
import spineline as sl

sl.phantom("bend", subject=4).landmarks.to_pandas().to_csv("landmarks.csv", index=False)

# %% [markdown]
# ## The table
#
# One row per vertebra and reading. *Left* and *right* are the patient's. Rows and columns are in pixels of the film.

# %%
landmarks = pd.read_csv("landmarks.csv")
landmarks.head(3)

# %%
case = sl.Case.from_landmarks(landmarks, mm_per_px=0.14, plane="detector", case_id="P07", synthetic=True)
assert case.check().ok and len(case.films) == landmarks.posture.nunique()
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
    raise AssertionError("the swap was not found")
except sl.InputError as error:
    print(error)
    print("film:", error.film, "| vertebra:", error.level)
    assert (error.film, error.level) == ("erect", "T9")

# %% [markdown]
# A smaller error, a corner of one reading that is 8 mm (60 px) off, is a warning: the analysis runs, and every output repeats the warning. Half of
# this distance is not found: it is as likely as other differences between readers.

# %%
def with_a_corner_off(rows: int) -> sl.Case:
    moved = landmarks.copy()
    moved.loc[at, "superior_left_row_px"] -= rows
    return sl.Case.from_landmarks(moved, mm_per_px=0.14, case_id="P07", synthetic=True)


def warned(findings) -> list[tuple[str, str]]:
    return [(one.code, one.level) for one in findings if one.severity == "warning" and one.film == "erect"]


assert warned(with_a_corner_off(60).check()) == [("corner_far_from_readings", "T9")]
assert ("corner_far_from_readings", "T9") in warned(sl.analyze(with_a_corner_off(60)).warnings)
assert warned(with_a_corner_off(30).check()) == []
with_a_corner_off(60).check()

# %% [markdown]
# ## How well do the readers agree?
#
# If a film was read more than once, the readings show how large the noise is: here below one millimetre.

# %%
a = sl.analyze(case)
reliability = a.tables["reliability"].to_pandas()
noise = reliability.loc[reliability.statistic == "sem_agreement", ["quantity", "design", "value", "unit"]]
assert (noise[noise.unit == "mm"].value < 1).all()
noise.round(3)

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
# T2 is on the left of L4 in the left bend, and on the right in the right one.
assert a.curve("left_bending").locations_mm[-1, 0] > 0 > a.curve("right_bending").locations_mm[-1, 0]
ax.invert_xaxis()  # seen from behind, the patient's left is on the left
ax.set(aspect="equal", xlabel="patient's left (mm)", ylabel="cranial (mm)", title="P07 · SYNTHETIC")
figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
plt.show()
