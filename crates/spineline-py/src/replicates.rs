//! Monte Carlo replicates with perturbed landmarks.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use spineline::analysis::{Analysis as Found, Case};
use spineline::uncertainty::{
    AnalysisQuantity, MonteCarlo, MultiplierSpread, Replicate, Uncertainty,
};
use spineline_files::method_text::noise;
use spineline_files::{
    FilmOrigin, Provenance, Replicates as Asked, Request, results_text, text_with_hash,
};
use spineline_tables::{Patient, tables};

use crate::analysis::Analysis;
use crate::fault::Fault;
use crate::patient::run;
use crate::table::Table;
use crate::wait::apart_with;

/// Replicates per thread that are computed before they are added in order.
const BLOCK: u64 = 16;

/// The effect of landmark noise on every number of an analysis.
#[pyclass(frozen, module = "spineline._native")]
pub struct Replicates {
    of: Py<Analysis>,
    asked: Asked,
    found: Uncertainty,
    provenance: Provenance,
}

#[pymethods]
impl Replicates {
    /// Runs replicates on this number of threads; 0 for all cores. The number does not change the results. `progress` is called with
    /// the number of finished replicates.
    #[new]
    #[expect(clippy::too_many_arguments, reason = "Python hands on what its own keywords are")]
    fn new(
        py: Python<'_>,
        of: Py<Analysis>,
        count: u64,
        noise_text: &str,
        seed: u64,
        threads: usize,
        command: Vec<String>,
        date_utc: String,
        progress: Py<PyAny>,
    ) -> PyResult<Self> {
        let asked = asked(count, noise_text, seed)?;
        let (nominal, pool) = (of.clone_ref(py), pool(threads)?);
        // One replicate takes seconds where other loads are compared.
        let done = Arc::new(AtomicU64::new(0));
        let (counted, mut shown) = (Arc::clone(&done), None);
        let show = |py: Python<'_>| {
            let now = Some(done.load(Ordering::Relaxed));
            if std::mem::replace(&mut shown, now) == now {
                Ok(())
            } else {
                progress.call1(py, (now,)).map(drop)
            }
        };
        let found = apart_with(py, show, move |stop| {
            let Analysis { case, analysis, .. } = nominal.get();
            run_replicates(case, analysis, &asked, &pool, stop, &counted)
        })??;
        if shown != Some(count) {
            progress.call1(py, (count,))?;
        }
        let analysis = of.get();
        let films = FilmOrigin::of([analysis.case.synthetic]);
        let inputs = analysis.provenance.inputs.clone();
        let request = Request { replicates: Some(asked), ..analysis.request.clone() };
        let provenance = Provenance::new(run(command, date_utc), films, inputs);
        let provenance = provenance.of_cases([analysis.case.id.clone()]).asking(&request);
        Ok(Self { of, asked, found, provenance })
    }

    /// Replicates that were run.
    #[getter]
    fn count(&self) -> u64 {
        self.asked.count
    }

    /// Replicates whose analysis stopped with an error.
    #[getter]
    fn failed(&self) -> u64 {
        self.found.failed
    }

    /// The noise on the landmarks, in sentences.
    #[getter]
    fn noise(&self) -> Vec<String> {
        self.found.noise_words()
    }

    /// SHA-256 of every known file that the analysis was made from.
    #[getter]
    fn sources(&self) -> Vec<String> {
        self.of.get().sources()
    }

    /// The distribution of every number, by its name.
    fn spreads<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let analysis = &self.of.get().analysis;
        let all = PyDict::new(py);
        for one in &self.found.quantities {
            let name = name(one.quantity, analysis);
            let unit = one.quantity.unit(analysis).key();
            let numbers = Numbers {
                unit,
                value: one.nominal.ok(),
                mean: one.spread.map(|spread| spread.mean),
                sd: one.spread.and_then(|spread| spread.sd),
                // Without an interval, quantiles are left out too.
                quantiles: one.interval_95().and(one.spread).map(|spread| spread.quantiles),
                at_bound: one.at_bound,
                replicates_at_bound: one.replicates_at_bound,
                grows_with_noise: one.quantity.kind.grows_with_noise(),
                count: one.count,
            };
            if let (Some(rest), Some(ratio)) =
                (name.strip_prefix("log_multiplier."), one.multiplier())
            {
                let MultiplierSpread { value, quantiles } = ratio;
                let ratio = Numbers { value, quantiles, mean: None, sd: None, ..numbers };
                all.set_item(format!("multiplier.{rest}"), ratio)?;
            }
            all.set_item(&name, numbers)?;
        }
        Ok(all)
    }

    /// The table of the distributions.
    fn table(&self) -> PyResult<Table> {
        let of = self.of.get();
        let patient = Patient {
            analysis: &of.analysis,
            subject: &of.case.subject,
            identifiability: None,
            uncertainty: Some(&self.found),
        };
        let table = tables(&[patient]).into_iter().find(|table| table.name == "uncertainty");
        let missing = || PyRuntimeError::new_err("a fault of the program: no table of uncertainty");
        table.map(Table::new).ok_or_else(missing)
    }

    /// The text of the file of the analysis with the distributions.
    fn to_json(&self, py: Python<'_>) -> String {
        let of = self.of.get();
        py.detach(|| {
            let file = of.stored(&self.provenance);
            text_with_hash(results_text(&file.with_uncertainty(&of.analysis, Some(&self.found))))
        })
    }
}

/// Checks a request for replicates.
///
/// # Errors
/// If their number or the noise is out of range.
pub fn asked(count: u64, noise_text: &str, seed: u64) -> Result<Asked, Fault> {
    if !(2..=10_000_000).contains(&count) {
        let text = format!("{count} replicates: their number must be from 2 to 10000000");
        return Err(Fault::new(text, "give 1000 for intervals"));
    }
    let noise = noise(noise_text)
        .map_err(|reason| Fault::new(format!("noise is `{noise_text}`"), reason))?;
    Ok(Asked { count, noise, seed })
}

/// Threads for replicates; 0 for all cores.
///
/// # Errors
/// If they could not be started.
pub fn pool(threads: usize) -> PyResult<ThreadPool> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("threads could not be started: {error}")))
}

/// Runs all replicates, or those before the flag is set, and counts the finished ones.
pub fn run_replicates(
    case: &Case,
    nominal: &Found,
    asked: &Asked,
    pool: &ThreadPool,
    stop: &AtomicBool,
    done: &AtomicU64,
) -> Result<Uncertainty, Fault> {
    let monte_carlo = MonteCarlo::new(case, nominal, asked.noise, asked.seed)
        .map_err(|error| Fault::of(&error))?;
    let block = BLOCK.saturating_mul(pool.current_num_threads() as u64);
    let mut tally = monte_carlo.tally();
    let mut next = 0;
    while next < asked.count && !stop.load(Ordering::Relaxed) {
        let end = asked.count.min(next.saturating_add(block));
        // An incomplete block is dropped.
        let one = |index| {
            let found = (!stop.load(Ordering::Relaxed)).then(|| monte_carlo.replicate(index));
            done.fetch_add(u64::from(found.is_some()), Ordering::Relaxed);
            found
        };
        let found: Option<Vec<Replicate>> =
            pool.install(|| (next..end).into_par_iter().map(one).collect());
        let Some(found) = found else { break };
        // In order, so that the bytes are the same for any number of threads.
        found.iter().for_each(|replicate| tally.add(replicate));
        next = end;
    }
    Ok(tally.finish(asked.count))
}

/// The name of a number: its kind, then film, vertebra, group, end and line, if it has them. The line through the
/// inflections is not named.
fn name(quantity: AnalysisQuantity, analysis: &Found) -> String {
    let line = quantity.line.map(|line| line.key().to_owned());
    let parts = [
        Some(quantity.kind.key().to_owned()),
        quantity.posture.map(|posture| posture.key().to_owned()),
        quantity.level.map(|level| level.to_string()),
        quantity.group(analysis),
        quantity.end_name().map(str::to_owned),
        line.filter(|line| line != "inflection_line"),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(".")
}

/// The statistics of one number.
#[derive(Clone, Copy, IntoPyObject)]
struct Numbers {
    unit: &'static str,
    value: Option<f64>,
    mean: Option<f64>,
    sd: Option<f64>,
    quantiles: Option<[f64; 5]>,
    at_bound: bool,
    replicates_at_bound: u64,
    grows_with_noise: bool,
    count: u64,
}
