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
# # Is this line believable?
#
# A model can fit its films well and still be wrong. Three questions help: does a prediction without mechanics do as well, how wide are the intervals, and do the
# films contradict the model? Here we know the answer, because the two patients are **synthetic**: in one a force through the inflections of the curve
# bends the spine (`rod`), in the other a horizontal force at T2 (`pull`).

# %%
import matplotlib.pyplot as plt
import spineline as sl

patients = {name: sl.analyze(sl.phantom(name, subject=3)) for name in ("rod", "pull")}
for name, a in patients.items():
    print(f"--- {name}")
    print("\n".join(a.verdict))

# %% [markdown]
# ## Baselines
#
# A bend is left out, the model is fitted to the other films, and the bend is predicted. The figure also has predictions without mechanics: the
# other bend mirrored, and the mobility of healthy spines from the literature, both scaled so that they meet T2.

# %%
figure, axes = plt.subplots(2, 1, figsize=(7, 5.4), sharex=True, layout="constrained")
for ax, a in zip(axes, patients.values()):
    a.plot.predictions("left_out_bend", ax=ax)
axes[0].set_xlabel("")
plt.show()

# %% [markdown]
# If a line does not beat the grey bars, its prediction does not need mechanics. The estimated line takes two more numbers from
# each predicted film, and the distribution of rotations with tilt takes one: compare bars with equal numbers.
#
# ## Intervals
#
# Landmarks have noise. Replicates analyse the case again with perturbed landmarks; each number then has a spread. 1000 replicates give stable intervals;
# 100 are enough to see their size.

# %%
for name, a in patients.items():
    replicates = sl.replicates(a, n=100, noise="measured", seed=1)
    name_of_value = f"{name:5} multiplier of the main thoracic joints"
    if replicates["multiplier.main_thoracic"].at_bound:
        print(f"{name_of_value}: at its bound, not identified")
    else:
        low, high = replicates.interval("multiplier.main_thoracic")
        print(f"{name_of_value}: 95 % interval if the model is exact {low:.2f} to {high:.2f}")

# %% [markdown]
# ## Contradictions
#
# A contradiction is a warning that the films contradict a line beyond noise. In the `rod` patient all of them are about the iliac line, which is
# wrong there; in the `pull` patient most are about the line through the inflections.

# %%
for name, a in patients.items():
    print(f"--- {name}")
    for warning in a.warnings:
        if warning.severity == "contradiction":
            print(f"{warning.film or 'all films'}: {warning.text}")

# %% [markdown]
# The line of best fit to the rotations (*estimated line*) beside the candidates, film by film. In the bends it lies where the pull at T2 was, far from the
# inflections:

# %%
patients["pull"].plot.lines()
plt.show()
