//! The order of modules and files: no cycles, and a fixed order where the order is the architecture.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::files::{entries, read, sources};

use super::circles::{Uses, uses_of_files};
use super::imports::{handed_on, module_of, named_paths};

/// Crates whose modules have an order: each uses only those before it.
const ORDERS: [(&str, &[&str]); 2] = [
    (
        "spineline",
        &[
            "number",
            "anatomy",
            "spatial",
            "fault",
            "action",
            "warning",
            "measure",
            "reliability",
            "curve",
            "clinical",
            "chain",
            "motion",
            "least_squares",
            "multibody",
            "response",
            "personalize",
            "evaluate",
            "hypothesis",
            "error",
            "analysis",
            "uncertainty",
            "cohort",
            "prelude",
        ],
    ),
    ("spineline-cli", &["run", "options", "analysis", "commands"]),
];

/// The folder whose modules must not use one another.
const APART: (&str, &str) = ("spineline-cli", "commands");

pub fn check(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let mut folders = entries(&root.join("crates"))?;
    folders.push(root.join("xtask"));
    for folder in folders {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let source = folder.join("src");
        let top = uses(&source, 0)?;
        check_cycles(&name, &top, faults);
        check_cycles(&name, &uses_of_files(&source)?, faults);
        if let Some((_, order)) = ORDERS.iter().find(|(own, _)| *own == name) {
            check_order(&name, order, &top, faults);
        }
        if name == APART.0 {
            let inside = uses(&source, 1)?;
            check_cycles(&name, &inside, faults);
            check_apart(&inside, faults);
        }
    }
    Ok(())
}

/// Modules of the first level below the root (`depth` 0) or of the second (1), and their uses of other modules.
fn uses(source: &Path, depth: usize) -> Result<Uses, String> {
    let mut uses = Uses::new();
    let files = sources(source)?;
    let mut roots = BTreeMap::new();
    let mut modules = BTreeSet::new();
    for file in &files {
        let module = module_of(source, file);
        if module.is_empty() {
            roots.extend(handed_on(&read(file)?));
        }
        modules.extend((module.len() > depth).then(|| module[..=depth].join("::")));
    }
    for file in &files {
        let module = module_of(source, file);
        if module.len() <= depth {
            continue;
        }
        let own = module[..=depth].join("::");
        for mut path in named_paths(&module, &read(file)?) {
            if let Some(from) = roots.get(&path[0]).filter(|_| path.len() == 1) {
                path.insert(0, from.clone());
            }
            let Some(used) = path.get(..=depth).map(|path| path.join("::")) else { continue };
            if used != own && modules.contains(&used) {
                let inside = file.strip_prefix(source).unwrap_or(file).display().to_string();
                uses.entry(own.clone()).or_default().entry(used).or_insert(inside);
            }
        }
    }
    Ok(uses)
}

/// Names the uses of every cycle: those from which a way leads back.
fn check_cycles(name: &str, uses: &Uses, faults: &mut Vec<String>) {
    let reached: BTreeMap<&String, BTreeSet<&String>> =
        uses.keys().map(|module| (module, reached_from(module, uses))).collect();
    for (module, used) in uses {
        let leads_back =
            |other: &String| reached.get(other).is_some_and(|all| all.contains(module));
        for (other, file) in used.iter().filter(|(other, _)| leads_back(other)) {
            faults.push(format!("{name}/src/{file}: `{module}` uses `{other}`, in a cycle"));
        }
    }
}

/// What a module uses, and all that those use.
fn reached_from<'a>(module: &String, uses: &'a Uses) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&String> = uses[module].keys().collect();
    while let Some(next) = open.pop() {
        if reached.insert(next) {
            open.extend(uses.get(next).into_iter().flat_map(BTreeMap::keys));
        }
    }
    reached
}

fn check_order(name: &str, order: &[&str], uses: &Uses, faults: &mut Vec<String>) {
    let place = |module: &str| order.iter().position(|known| *known == module);
    for (module, used) in uses {
        let Some(own) = place(module) else {
            faults.push(format!("{name}: the order does not know the module `{module}`"));
            continue;
        };
        for (other, file) in used {
            if place(other).is_none_or(|other| other > own) {
                let text = format!("`{module}` uses `{other}`, which comes after it");
                faults.push(format!("{name}/src/{file}: {text}"));
            }
        }
    }
}

fn check_apart(uses: &Uses, faults: &mut Vec<String>) {
    let (name, folder) = APART;
    let within = |module: &str| module.starts_with(&format!("{folder}::"));
    for (module, used) in uses.iter().filter(|(module, _)| within(module)) {
        for (other, file) in used.iter().filter(|(other, _)| within(other)) {
            faults.push(format!(
                "{name}/src/{file}: the command `{module}` uses `{other}`; code for both belongs in a lower module"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uses_of(pairs: &[(&str, &str)]) -> Uses {
        let mut uses = Uses::new();
        for (module, used) in pairs {
            let own = uses.entry((*module).to_owned()).or_default();
            own.insert((*used).to_owned(), "file.rs".to_owned());
        }
        uses
    }

    #[test]
    fn a_cycle_is_named() {
        let mut faults = Vec::new();
        check_cycles("c", &uses_of(&[("a", "b"), ("b", "c")]), &mut faults);
        assert!(faults.is_empty(), "{faults:?}");
        check_cycles("c", &uses_of(&[("a", "b"), ("b", "a"), ("c", "a"), ("b", "d")]), &mut faults);
        assert_eq!(faults.len(), 2);
    }

    #[test]
    fn a_use_of_a_later_module_is_a_fault() {
        let mut faults = Vec::new();
        check_order("c", &["a", "b"], &uses_of(&[("b", "a")]), &mut faults);
        assert!(faults.is_empty(), "{faults:?}");
        check_order("c", &["a", "b"], &uses_of(&[("a", "b")]), &mut faults);
        assert_eq!(faults, ["c/src/file.rs: `a` uses `b`, which comes after it"]);
    }
}
