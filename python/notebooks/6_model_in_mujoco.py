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
# # The model in MuJoCo
#
# A personalised model is more useful with muscles, contact or control. Here it is written as MJCF and loaded into MuJoCo, and both engines compute the same
# shape. The patient is **synthetic**.

# %%
import matplotlib.pyplot as plt
import mujoco
import numpy as np
import spineline as sl

a = sl.analyze(sl.phantom("rod", subject=2))
model = a.model("inflection")
path = model.to_mujoco("patient.xml", overwrite=True)
spine = mujoco.MjModel.from_xml_path(str(path))
data = mujoco.MjData(spine)
mujoco.mj_forward(spine, data)
print(f"{spine.nbody} bodies, {spine.nv} degrees of freedom")

# %% [markdown]
# ## The same force in both
#
# A horizontal force on T2, towards the patient's right. MuJoCo simulates until the spine is at rest; Spineline solves for equilibrium.

# %%
push = sl.Force("T2", towards="right", force=8.0)
ours = model.simulate(push).midpoints_mm

force = np.array(push.as_load()["force"])
top = spine.body("T2").id
while data.time < 30:
    data.qfrc_applied[:] = 0
    grown = min(1.0, data.time) * force
    mujoco.mj_applyFT(spine, data, grown, np.zeros(3), data.site("T2_midpoint").xpos, top, data.qfrc_applied)
    mujoco.mj_step(spine, data)
    if data.time > 1 and np.abs(data.qvel).max() < 1e-11:
        break
theirs = 1000 * np.array([data.site(f"{level}_midpoint").xpos for level in model.levels])
assert data.time < 30, "MuJoCo did not come to rest"
print(f"largest difference of a midpoint: {np.abs(theirs - ours).max():.1e} mm")
assert np.abs(theirs - ours).max() < 1e-6

# %%
figure, ax = plt.subplots(figsize=(4.2, 5.5), layout="constrained")
erect = model.midpoints_mm
ax.plot(erect[:, 1], erect[:, 2], "o-", color="grey", markersize=3, label="erect")
ax.plot(ours[:, 1], ours[:, 2], "s-", color="black", markersize=6, label="Spineline")
ax.plot(theirs[:, 1], theirs[:, 2], "x", color="#D55E00", markersize=7, label="MuJoCo")
ax.invert_xaxis()  # seen from behind, the patient's left is on the left
ax.set_aspect("equal", adjustable="datalim")
ax.set(xlabel="patient's left (mm)", ylabel="cranial (mm)", title=f"{a.id} · SYNTHETIC")
figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8)
plt.show()

# %% [markdown]
# Forces are relative here, since all forces are unknown. With `gauge="known-force:left_bending=60"` both engines work in newtons. OpenSim
# (`to_opensim`) and every reader of URDF (`to_urdf`) take the same model.

# %%
absolute = sl.analyze(a.case, gauge="known-force:left_bending=60").model("inflection")
assert absolute.absolute and not model.absolute
