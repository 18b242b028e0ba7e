//! How the test of every claim ended.

use std::collections::BTreeMap;
use std::fmt;

#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
enum Ending {
    #[default]
    Passed,
    Failed,
    /// It needs data that this machine does not have.
    Skipped,
}

/// Endings of tests, by crate and name, and of comparisons with other programs.
#[derive(Debug, Default)]
pub struct Outcomes {
    tests: BTreeMap<(String, String), Ending>,
    comparisons: BTreeMap<String, Ending>,
}

impl Outcomes {
    /// From the log of `cargo nextest run`, with the output of tests that passed.
    pub fn of_log(log: &str) -> Self {
        let mut outcomes = Self::default();
        let mut shown = None;
        for line in log.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let ending = match words.first() {
                Some(&"PASS") => Ending::Passed,
                Some(&("FAIL" | "TIMEOUT" | "SIGABRT" | "SIGSEGV" | "SIGKILL")) => Ending::Failed,
                _ if line.trim_start().starts_with("skipped: ") => Ending::Skipped,
                _ => continue,
            };
            if ending != Ending::Skipped {
                let [.., binary, name] = words[..] else { continue };
                let package = binary.split("::").next().unwrap_or(binary);
                // The tests of another file than `it` are named by it.
                let file =
                    binary.split_once("::").map(|(_, file)| file).filter(|file| *file != "it");
                let name = file.map_or_else(|| name.to_owned(), |file| format!("{file}::{name}"));
                shown = Some((package.to_owned(), name));
            }
            if let Some(test) = &shown {
                let known = outcomes.tests.entry(test.clone()).or_default();
                if *known == Ending::Passed {
                    *known = ending;
                }
            }
        }
        outcomes
    }

    pub fn is_empty(&self) -> bool {
        self.tests.is_empty()
    }

    /// Notes how a comparison with another program ended.
    pub fn comparison(&mut self, name: &str, result: &Result<(), String>) {
        let ending = if result.is_ok() { Ending::Passed } else { Ending::Failed };
        self.comparisons.insert(name.to_owned(), ending);
    }

    fn all(&self) -> impl Iterator<Item = Ending> {
        self.tests.values().chain(self.comparisons.values()).copied()
    }

    pub fn failed(&self) -> usize {
        self.all().filter(|ending| *ending == Ending::Failed).count()
    }

    /// The tables of claims whose last column names tests, with one column more: how they ended.
    pub fn beside(&self, claims: &str) -> String {
        let mut is_claims = false;
        let mut lines = Vec::new();
        for line in claims.lines() {
            let Some(row) = line.strip_suffix('|').filter(|row| row.starts_with('|')) else {
                is_claims = false;
                lines.push(line.to_owned());
                continue;
            };
            let test = row.rsplit('|').next().unwrap_or_default().trim();
            let more = match test {
                "test" => {
                    is_claims = true;
                    "outcome".to_owned()
                }
                _ if !is_claims => {
                    lines.push(line.to_owned());
                    continue;
                }
                "---" => "---".to_owned(),
                named => self.of_row(named),
            };
            lines.push(format!("{line} {more} |"));
        }
        lines.join("\n") + "\n"
    }

    /// How the tests of a row ended, by the files that it names in backticks.
    fn of_row(&self, named: &str) -> String {
        let files: Vec<&str> = named.split('`').skip(1).step_by(2).collect();
        let of_file = |file: &&str| self.of_file(file);
        let endings: Vec<Ending> = files.iter().flat_map(of_file).collect();
        let count = |wanted| endings.iter().filter(|ending| **ending == wanted).count();
        let (failed, skipped) = (count(Ending::Failed), count(Ending::Skipped));
        let without = files.iter().filter(|file| file.contains('/') || file.contains(".rs"));
        let without = without.filter(|file| self.of_file(file).is_empty()).count();
        let mut words = match (endings.len(), failed) {
            (0, _) => return "not run".to_owned(),
            (_, 0) => format!("passed: {}", endings.len() - skipped),
            (_, failed) => format!("**failed: {failed}**"),
        };
        for (number, why) in [(skipped, "without data"), (without, "files not run")] {
            if number > 0 {
                words.push_str(&format!(", {why}: {number}"));
            }
        }
        words
    }

    fn of_file(&self, file: &str) -> Vec<Ending> {
        if let Some(name) = file.strip_prefix("validation/") {
            return self.comparisons.get(name).copied().into_iter().collect();
        }
        let Some(path) = file.strip_suffix(".rs") else { return Vec::new() };
        let (package, path) = match path.split_once('/') {
            Some((package, path)) if package.starts_with("spineline") => (package, path),
            _ => ("spineline", path),
        };
        let path = path.trim_start_matches("src/").trim_start_matches("tests/it/");
        let module = path.trim_end_matches("/mod").replace('/', "::");
        let is_in = |name: &str| match module.strip_suffix('*') {
            Some(start) => name.starts_with(start),
            None => name.strip_prefix(module.as_str()).is_some_and(|rest| rest.starts_with("::")),
        };
        let tests = self.tests.iter();
        tests
            .filter(|((of, name), _)| of == package && is_in(name))
            .map(|(_, ending)| *ending)
            .collect()
    }
}

impl fmt::Display for Outcomes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |wanted| self.all().filter(|ending| *ending == wanted).count();
        let [passed, failed, skipped] =
            [Ending::Passed, Ending::Failed, Ending::Skipped].map(count);
        write!(f, "{passed} tests passed, {failed} failed, {skipped} lacked their data.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "
        PASS [   0.170s] ( 1/6) spineline evaluate::statistics::tests::a_mean
        PASS [   0.170s] ( 2/6) spineline::it oracle::a_march
        FAIL [   0.170s] ( 3/6) spineline::it oracle::a_force
        PASS [   0.170s] ( 4/6) spineline::allocations nothing_is_allocated
        PASS [   0.170s] ( 5/6) spineline-files::it public_cases::real_patients
  stdout ───
    skipped: SPINELINE_DATA is not set
        PASS [   0.170s] ( 6/6) spineline-files::it oracle::another_crate
";

    #[test]
    fn every_row_has_the_outcome_of_its_files() {
        let mut outcomes = Outcomes::of_log(LOG);
        outcomes.comparison("engines", &Ok(()));
        assert_eq!(outcomes.failed(), 1);
        for (named, outcome) in [
            ("`evaluate/statistics.rs`", "passed: 1"),
            ("`oracle.rs`", "**failed: 1**"),
            ("`allocations.rs`", "passed: 1"),
            ("`spineline-files/tests/it/public_cases.rs`", "passed: 0, without data: 1"),
            ("`spineline-files/tests/it/oracle.rs`, `validation/engines`", "passed: 2"),
            ("`evaluate/statistics.rs`, `validation/exchange`", "passed: 1, files not run: 1"),
            ("`validation/landmarks`", "not run"),
            ("`eval*.rs`", "passed: 1"),
        ] {
            assert_eq!(outcomes.of_row(named), outcome, "{named}");
        }
        assert_eq!(outcomes.to_string(), "5 tests passed, 1 failed, 1 lacked their data.");
    }

    #[test]
    fn only_tables_of_tests_get_outcomes() {
        let outcomes = Outcomes::of_log(LOG);
        let text = "| question | page |\n|---|---|\n| a | b |\n\n| claim | test |\n|---|---|\n| a | `allocations.rs` |\n";
        let expected = "| question | page |\n|---|---|\n| a | b |\n\n| claim | test | outcome |\n|---|---| --- |\n| a | `allocations.rs` | passed: 1 |\n";
        assert_eq!(outcomes.beside(text), expected);
    }
}
