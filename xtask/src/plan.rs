//! Steps in their order: required tools, concurrent steps, left-out steps, and times.

use std::fs::{self, File};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, ScopedJoinHandle};
use std::time::{Duration, Instant};

use crate::command::with_output;
use crate::python;
use crate::tools::{self, Tool};

/// How much is run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// All except typeset reports, exchange formats and tests that change the machine briefly.
    Usual,
    /// Everything; a missing tool is an error.
    Full,
}

/// A check; the error says what failed.
type Check<'a> = Box<dyn Fn(&Plan<'_>) -> Result<(), String> + Sync + 'a>;

/// A named check and the tools that it needs.
pub struct Step<'a> {
    name: &'static str,
    tools: &'static [Tool],
    extent: Extent,
    place: Place,
    check: Check<'a>,
}

/// When a step runs.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// After the step before it.
    InTurn,
    /// Beside the steps after it, with its output in a file, because it leaves a core free.
    Beside,
    /// After all steps before it have ended: it waits for a browser, which a busy machine slows down.
    Alone,
}

impl<'a> Step<'a> {
    pub fn new(
        name: &'static str,
        tools: &'static [Tool],
        check: impl Fn(&Plan<'_>) -> Result<(), String> + Sync + 'a,
    ) -> Self {
        Self { name, tools, extent: Extent::Usual, place: Place::InTurn, check: Box::new(check) }
    }

    /// The same step, run only by `--full`.
    pub fn full(self) -> Self {
        Self { extent: Extent::Full, ..self }
    }

    /// The same step, run beside those after it.
    pub fn beside(self) -> Self {
        Self { place: Place::Beside, ..self }
    }

    /// The same step, run while nothing else runs.
    pub fn alone(self) -> Self {
        Self { place: Place::Alone, ..self }
    }

    /// The same step, run always.
    pub fn usual(self) -> Self {
        Self { extent: Extent::Usual, ..self }
    }
}

/// What is run where.
pub struct Plan<'a> {
    pub root: &'a Path,
    pub extent: Extent,
    /// Parts of steps that could not run, and why.
    not_run: Mutex<Vec<String>>,
}

/// How a step ended.
struct Ended {
    name: &'static str,
    time: Duration,
    /// Why it was left out, if it was.
    left_out: Option<String>,
    result: Result<(), String>,
}

fn joined(handle: ScopedJoinHandle<'_, Ended>) -> Ended {
    handle.join().expect("a step returns its faults")
}

/// A new file for the output of a step, below the target folder.
pub fn output_file(name: &str) -> Result<(PathBuf, File), String> {
    let folder = python::target()?.join("xtask");
    let path = folder.join(name);
    let file = fs::create_dir_all(&folder).and_then(|()| File::create(&path));
    file.map(|file| (path.clone(), file)).map_err(|error| format!("{}: {error}", path.display()))
}

impl<'a> Plan<'a> {
    pub fn new(root: &'a Path, extent: Extent) -> Self {
        Self { root, extent, not_run: Mutex::default() }
    }

    /// Notes that a part of a step cannot run on this machine; the list at the end names it.
    pub fn note_not_run(&self, what: &str, why: &str) {
        self.not_run_so_far().push(format!("{what}: {why}"));
    }

    fn not_run_so_far(&self) -> MutexGuard<'_, Vec<String>> {
        self.not_run.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// As [`Plan::run`]; parts that cannot run are an error.
    pub fn run_all_of(&self, steps: &[Step<'_>]) -> Result<(), String> {
        self.run(steps)?;
        match self.not_run_so_far().join("; ") {
            missing if missing.is_empty() => Ok(()),
            missing => Err(format!("not everything was run: {missing}")),
        }
    }

    pub fn is_full(&self) -> bool {
        self.extent == Extent::Full
    }

    /// Runs the steps in their order, until one fails; reports the time of each.
    ///
    /// Missing tools are listed first. On a terminal their installation is offered. Steps without their tools are
    /// left out and named; if everything was requested, the run does not start.
    pub fn run(&self, steps: &[Step<'_>]) -> Result<(), String> {
        let steps: Vec<&Step<'_>> =
            steps.iter().filter(|step| self.is_full() || step.extent == Extent::Usual).collect();
        self.provide_tools(&steps)?;
        let start = Instant::now();
        let mut ended = Vec::new();
        let result = thread::scope(|scope| {
            let mut beside: Vec<ScopedJoinHandle<'_, Ended>> = Vec::new();
            for step in steps {
                if step.place == Place::Alone {
                    ended.extend(beside.drain(..).map(joined));
                }
                if ended.iter().any(|step: &Ended| step.result.is_err()) {
                    break;
                }
                if step.place == Place::Beside {
                    beside.push(scope.spawn(move || self.run_beside(step)));
                } else {
                    println!("\n━━ {}", step.name);
                    ended.push(self.run_step(step));
                }
            }
            ended.extend(beside.into_iter().map(joined));
            ended.iter().find_map(|step| step.result.clone().err()).map_or(Ok(()), Err)
        });
        print!("{}", times(&ended, &self.not_run_so_far(), start.elapsed()));
        result
    }

    fn run_step(&self, step: &Step<'_>) -> Ended {
        let missing: Vec<&str> =
            step.tools.iter().filter(|tool| !tool.is_there()).map(|tool| tool.name()).collect();
        let start = Instant::now();
        let mut result = Ok(());
        if missing.is_empty() {
            result = (step.check)(self).map_err(|reason| format!("{}: {reason}", step.name));
        }
        let left_out = (!missing.is_empty()).then(|| missing.join(", "));
        Ended { name: step.name, time: start.elapsed(), left_out, result }
    }

    /// Runs a step with its output in a file, and shows the output at the end.
    fn run_beside(&self, step: &Step<'_>) -> Ended {
        let log = match output_file(&format!("{}.log", step.name)) {
            Ok(log) => log,
            Err(reason) => {
                let result = Err(format!("{}: {reason}", step.name));
                return Ended { name: step.name, time: Duration::ZERO, left_out: None, result };
            }
        };
        let (path, file) = log;
        println!("\n━━ {} (beside the next steps; its output is in {})", step.name, path.display());
        let ended = with_output(file, || self.run_step(step));
        let output = fs::read_to_string(&path).unwrap_or_default();
        println!("\n━━ {}, which ran in the background\n{output}", step.name);
        ended
    }

    fn provide_tools(&self, steps: &[&Step<'_>]) -> Result<(), String> {
        let mut missing: Vec<Tool> = steps
            .iter()
            .flat_map(|step| step.tools)
            .copied()
            .filter(|tool| !tool.is_there() && (self.is_full() || !tool.is_optional()))
            .collect();
        missing.sort_unstable();
        missing.dedup();
        if missing.is_empty() {
            return Ok(());
        }
        println!("missing tools:");
        for tool in &missing {
            println!("  {}: {} ({})", tool.name(), tool.purpose(), tool.install());
        }
        println!("  `cargo xtask setup` installs them all");
        if asked_to_install() {
            return tools::install(self.root, &missing);
        }
        if self.is_full() {
            return Err("everything was requested, and tools are missing".to_owned());
        }
        Ok(())
    }
}

/// Whether a user at the terminal wants the tools installed now.
fn asked_to_install() -> bool {
    if !std::io::stdin().is_terminal() {
        return false;
    }
    print!("Install them now? [y/N] ");
    let mut answer = String::new();
    let read = std::io::stdout().flush().and_then(|()| std::io::stdin().read_line(&mut answer));
    read.is_ok() && answer.trim().eq_ignore_ascii_case("y")
}

/// Time of each step, then the parts that were not run. Concurrent steps are in no sum, so the total is measured
/// separately.
fn times(ended: &[Ended], not_run: &[String], whole: Duration) -> String {
    let mut text = "\n━━ times\n".to_owned();
    let mut left_out = String::new();
    for step in ended {
        match &step.left_out {
            None => text.push_str(&format!("{:>7.1} s  {}\n", step.time.as_secs_f64(), step.name)),
            Some(missing) => {
                left_out.push_str(&format!("NOT RUN    {}: {missing} is missing\n", step.name));
            }
        }
    }
    text.push_str(&format!("{:>7.1} s  all\n", whole.as_secs_f64()));
    left_out.extend(not_run.iter().map(|what| format!("NOT RUN    {what}\n")));
    text + &left_out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_run_stands_at_the_end() {
        let plan = Plan::new(Path::new("."), Extent::Usual);
        let steps = || {
            vec![
                Step::new("first", &[], |plan| {
                    plan.note_not_run("advisories", "no database");
                    Ok(())
                }),
                Step::new("second", &[], |_| Ok(())),
            ]
        };
        assert_eq!(plan.run(&steps()), Ok(()), "tests go on");
        let ended = |name, left_out| Ended { name, time: Duration::ZERO, left_out, result: Ok(()) };
        let ended = [ended("a", None), ended("b", Some("DCMTK".to_owned())), ended("c", None)];
        let text = times(&ended, &plan.not_run_so_far(), Duration::ZERO);
        let end = "NOT RUN    b: DCMTK is missing\nNOT RUN    advisories: no database\n";
        assert!(text.ends_with(&format!("    0.0 s  all\n{end}")), "{text}");
        let error = Plan::new(Path::new("."), Extent::Usual).run_all_of(&steps());
        assert_eq!(error, Err("not everything was run: advisories: no database".to_owned()));
    }
}
