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
# A pad pushes one vertebra at a time to either side, always with the same force. The change of the main thoracic Cobb angle shows where it
# works.

# %%
erect = model.simulate(sl.Pad("T9", towards="left", force=0.0)).cobb_deg["main_thoracic"]
levels = [level for level in model.levels if level.startswith("T")]
changes = {}
for side in ("left", "right"):
    found = [model.simulate(sl.Pad(level, towards=side, force=4.0), allow_unusable=True) for level in levels]
    changes[side] = [r.cobb_deg["main_thoracic"] - erect if r.is_usable else np.nan for r in found]

figure, ax = plt.subplots(figsize=(5.5, 3.2), layout="constrained")
for side, marker in (("left", "<"), ("right", ">")):
    ax.plot(levels, changes[side], marker=marker, label=f"towards the patient's {side}")
ax.axhline(0, color="grey", linewidth=0.8)
ax.set(xlabel="vertebra under the pad", ylabel="change of the Cobb angle (°)", title=f"{a.id} · SYNTHETIC, erect {erect:.1f}°")
ax.legend(frameon=False)
plt.show()

# %% [markdown]
# If a search ends without a result, the curve has a gap: the program gives no number there, and says why.
#
# ## A rod
#
# A rod between T5 and L1 keeps this part rigid. Under the same side force only the rest of the spine moves.

# %%
push = sl.Force("T2", towards="right", force=8.0)
free = model.simulate(push)
instrumented = model.simulate(push, sl.Rod("L1", "T5", timing="held"))
for name, r in (("free", free), ("with a rod", instrumented)):
    print(f"{name:11} {r.status:10} lateral tilt {r.lateral_tilt_deg:6.2f}°, main thoracic {r.cobb_deg['main_thoracic']:6.2f}°")

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
