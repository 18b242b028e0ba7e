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
# # A cohort on Dask
#
# Case files go in, Parquet files come out, and only a small row per part comes back. The executor is Dask's here; a process pool or executorlib
# (which has executors for Slurm) work the same way. All patients are **synthetic**.

# %%
import pathlib

import matplotlib.pyplot as plt
import spineline as sl
from distributed import Client, LocalCluster

folder = pathlib.Path("cases")
folder.mkdir(exist_ok=True)
for scenario in ("rod", "bend", "pull"):
    for subject in range(1, 7):
        sl.phantom(scenario, subject=subject).save(folder / f"{scenario}-{subject:02}.json", overwrite=True)
(folder / "broken.json").write_text("{")  # a file that was cut off
cohort = sl.Cohort.glob("cases/*.json")
len(cohort)

# %% [markdown]
# On a real cluster, `chunk` cases should take 10 to 60 s. If a worker is killed, its part is made again.

# %%
with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
    run = cohort.analyze(executor=client.get_executor(), out="results", chunk=5)
assert run.is_complete and sum(part.failed for part in run.parts) == 1
len(run.parts)

# %% [markdown]
# A case that cannot be analysed is a row with its error. No case is dropped silently.

# %%
cases = run.read("cases").to_pandas()
assert len(cases) == len(cohort)
cases.loc[cases.status != "ok", ["file", "status", "error"]]

# %% [markdown]
# Run it again: every part already exists, since files are named by a hash of program, options and cases.

# %%
again = cohort.analyze(out="results", chunk=5)
assert all(part.was_there for part in again.parts)

# %% [markdown]
# ## Errors over patients
#
# The patient is the unit: first a mean per patient, then a box plot over patients.

# %%
vertebrae = run.read("vertebrae").to_pandas()
predicted = vertebrae[~vertebrae.fitted.fillna(True).astype(bool) & vertebrae.location_error_mm.notna()]
predicted = predicted.assign(scenario=predicted.case_id.str.split("-").str[1])
means = predicted.groupby(["scenario", "line", "case_id"]).location_error_mm.mean()

figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), sharey=True, layout="constrained")
for ax, scenario in zip(axes, ("rod", "bend", "pull")):
    lines = means[scenario].index.get_level_values("line").unique()
    ax.boxplot([means[scenario][line] for line in lines], tick_labels=[line.removesuffix("_line") for line in lines])
    ax.set_title(f"{scenario} · SYNTHETIC")
axes[0].set_ylabel("error on held-out films,\nmean of a patient (mm)")
plt.show()

# %% [markdown]
# The scenario that made the films decides how well a line predicts them. The inflection line is right in `rod`, where the force runs through the
# inflections (0.4 mm), and nearly as wrong as the iliac line elsewhere (4 to 11 mm). The estimated line stays below 1 mm in all scenarios, but takes
# two more numbers from each predicted film.

# %%
mean = means.groupby(["scenario", "line"]).mean().unstack("line")
assert mean.inflection_line["rod"] < 1 < mean.iliac_line["rod"]
assert (mean.loc[["bend", "pull"], ["inflection_line", "iliac_line"]] > 3).all(axis=None)
assert (mean.estimated_line < 1).all()
mean.round(1)

# %% [markdown]
# Statistics of the cohort with tests by patient come from the program: `spineline analyze cases --cohort cohort.json`.
