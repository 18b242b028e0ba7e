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
# # What if: pads and rods
#
# A personalised model shows how the spine would move under new loads. The patient is **synthetic**, and the model has relative
# stiffness: forces are ratios until a force is known (`gauge="known-force:…"`).

# %%
import matplotlib.pyplot as plt
import numpy as np
import spineline as sl

a = sl.analyze(sl.phantom("rod", subject=1))
model = a.model("inflection")
model

# %% [markdown]
# ## Where would a pad act best?
#
# A pad pushes one vertebra at a time to either side, always with the same force. The erect main thoracic curve is convex to the patient's right: its
# Cobb angle is negative. The figure has the change of its size, so that below zero the curve is straighter. Pushes towards the left make it larger,
# pushes towards the right smaller, and the more so the higher the pad: the base is fixed and the top is free.

# %%
erect = model.simulate(sl.Pad("T9", towards="left", force=0.0)).cobb_deg["main_thoracic"]
levels = [level for level in model.levels if level.startswith("T")]
changes = {}
for side in ("left", "right"):
    found = [model.simulate(sl.Pad(level, towards=side, force=4.0), allow_unusable=True) for level in levels]
    changes[side] = np.array([abs(r.cobb_deg["main_thoracic"]) - abs(erect) if r.is_usable else np.nan for r in found])
assert erect < 0
assert (changes["left"] > 0).all() and (np.diff(changes["left"]) > 0).all()
assert (changes["right"] < 0).all() and (np.diff(changes["right"]) < 0).all()

figure, ax = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
for side, marker in (("left", "<"), ("right", ">")):
    ax.plot(levels, changes[side], marker=marker, label=f"towards the patient's {side}")
ax.axhline(0, color="grey", linewidth=0.8)
ax.set(xlabel="vertebra under the pad", ylabel="change of the size of the Cobb angle (°)\nbelow zero: straighter", title=f"{a.id} · SYNTHETIC, erect {erect:.1f}°")
ax.legend(frameon=False)
plt.show()

# %% [markdown]
# If a search ends without a result, the curve has a gap: the program gives no number there, and says why. Here every search has a result.
#
# ## A rod
#
# A rod between T5 and L1 keeps the two in their pose relative to each other. Under the same side force the main thoracic curve, which it spans, changes
# by less than 0.2°, without the rod by more than 1°.

# %%
push = sl.Force("T2", towards="right", force=8.0)
free = model.simulate(push)
instrumented = model.simulate(push, sl.Rod("L1", "T5", timing="held"))
for name, r in (("free", free), ("with a rod", instrumented)):
    print(f"{name:11} {r.status:10} lateral tilt {r.lateral_tilt_deg:6.2f}°, main thoracic {r.cobb_deg['main_thoracic']:6.2f}°")
bottom, top = (model.levels.index(level) for level in ("L1", "T5"))
length = [np.linalg.norm(points[top] - points[bottom]) for points in (model.midpoints_mm, instrumented.midpoints_mm)]
assert abs(length[1] - length[0]) < 0.1
assert abs(instrumented.cobb_deg["main_thoracic"] - erect) < 0.2 < 1 < abs(free.cobb_deg["main_thoracic"] - erect)

figure, ax = plt.subplots(figsize=(4.2, 5.5), layout="constrained")
for name, points, colour in (
    ("erect", model.midpoints_mm, "black"),
    ("pushed", free.midpoints_mm, "#0072B2"),
    ("pushed, with a rod", instrumented.midpoints_mm, "#D55E00"),
):
    ax.plot(points[:, 1], points[:, 2], "s-", color=colour, markersize=4, label=name)
ax.invert_xaxis()
ax.set_aspect("equal", adjustable="datalim")
ax.set(xlabel="patient's left (mm)", ylabel="cranial (mm)", title=f"{a.id} · SYNTHETIC")
figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
plt.show()

# %% [markdown]
# ## How far, instead of how hard
#
# Give a lateral tilt, and the search finds the force.

# %%
for tilt in (5, 10, 15):
    r = model.simulate(sl.Force("T2", towards="right", force=1.0), amplitude_deg=tilt, towards="right")
    print(f"{tilt:2}° to the right: {r.status}, main thoracic {r.cobb_deg['main_thoracic']:.1f}°")
    assert abs(r.lateral_tilt_deg - tilt) < 1e-6
