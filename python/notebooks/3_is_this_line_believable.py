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
# each predicted film: compare bars with equal numbers. In each patient the line that moved the spine beats every grey bar; the other candidate does
# not.

# %%
for name, right, wrong in (("rod", "inflection_line", "iliac_line"), ("pull", "iliac_line", "inflection_line")):
    compared = patients[name].data["comparison"]
    baselines = (compared["baselines_mm"][name] for name in ("mirrored_bend", "published_mobility"))
    grey = [films["left_out_bend"] for films in baselines]
    errors = {line: found["errors"]["left_out_bend"]["location_mm"] for line, found in compared["lines"].items()}
    assert errors[right] < min(grey) < errors[wrong]

# %% [markdown]
# ## Intervals
#
# Landmarks have noise. Replicates analyse the case again with perturbed landmarks; each number then has a spread. 1000 replicates give stable intervals;
# 100 are enough to see their size. In the `pull` patient the multiplier of the line through the inflections is at a bound of the fit: it has no
# interval, since the films do not identify it.

# %%
for name, a in patients.items():
    replicates = sl.replicates(a, n=100, noise="measured", seed=1)
    name_of_value = f"{name:5} multiplier of the main thoracic joints"
    if replicates["multiplier.main_thoracic"].at_bound:
        print(f"{name_of_value}: at its bound, not identified")
    else:
        low, high = replicates.interval("multiplier.main_thoracic")
        assert low < replicates["multiplier.main_thoracic"].value < high
        print(f"{name_of_value}: 95 % interval if the model is exact {low:.2f} to {high:.2f}")
    assert replicates["multiplier.main_thoracic"].at_bound == (name == "pull")

# %% [markdown]
# ## Contradictions
#
# The bends test each candidate. In the `rod` patient they keep the inflection line and reject the iliac line, which is wrong there; in the `pull`
# patient it is the other way round. A contradiction is a warning that another film contradicts a line beyond noise.

# %%
for name, kept in (("rod", "through the inflections"), ("pull", "along the iliac line")):
    print(f"--- {name}")
    for sentence in patients[name].verdict:
        if sentence.startswith("A single force"):
            print(sentence)
            assert ("is kept by" if kept in sentence else "is rejected by") in sentence
    for warning in patients[name].warnings:
        if warning.severity == "contradiction":
            print(f"{warning.film or 'all films'}: {warning.text}")

# %% [markdown]
# The line of best fit to the rotations (*estimated line*) beside the candidates, film by film. In the bends it lies where the pull at T2 was, far from the
# inflections:

# %%
a = patients["pull"]
for film in ("left_bending", "right_bending"):
    line = a.data["models"]["estimated_line"]["postures"][film]["line"]
    (dy, dz), curve = line["direction"], a.curve(film)
    distances = [abs(dz * (y - line["point_mm"][0]) - dy * (z - line["point_mm"][1])) for y, z in
                 (curve.locations_mm[-1], *curve.inflections_mm)]
    print(f"{film}: {distances[0]:.0f} mm from T2, {min(distances[1:]):.0f} mm from the nearest inflection")
    assert curve.levels[-1] == "T2" and distances[0] < 0.5 * min(distances[1:])
a.plot.lines()
plt.show()
