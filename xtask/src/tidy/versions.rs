//! One version everywhere: the workspace states it, and files for other tools repeat it.

use std::path::Path;

use crate::files::read;

/// Files that state the version, each with the text around it.
const STATED: [(&str, &str, &str); 4] = [
    ("CITATION.cff", "\nversion: ", "\n"),
    ("codemeta.json", "\"version\": \"", "\""),
    ("packaging/conda/recipe.yaml", "\n  version: ", "\n"),
    ("web/package.json", "\"version\": \"", "\""),
];

pub fn check(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let manifest = read(&root.join("Cargo.toml"))?;
    let version = between(&manifest, "\nversion = \"", "\"").unwrap_or_default().to_owned();
    for (file, before, after) in STATED {
        let text = read(&root.join(file))?;
        let stated = between(&text, before, after).unwrap_or("none");
        if stated != version {
            faults
                .push(format!("{file}: states version {stated}, and the workspace has {version}"));
        }
    }
    Ok(())
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(before)?;
    Some(rest.split_once(after)?.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_version_stands_between_its_marks() {
        assert_eq!(
            between("name: a\nversion: 1.2.3\nlicense: b", "\nversion: ", "\n"),
            Some("1.2.3")
        );
        assert_eq!(between("name: a", "\nversion: ", "\n"), None);
    }
}
