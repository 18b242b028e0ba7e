//! The version of Node that the packages of the browser app require.

use std::path::Path;
use std::process::Command;

use crate::files::read;

/// Refuses a Node that `engines` in `web/package.json` does not allow, before npm is started.
pub fn check(root: &Path) -> Result<(), String> {
    let path = root.join("web/package.json");
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = read(&path)?;
    let package: serde_json::Value = serde_json::from_str(&text).map_err(|error| fail(&error))?;
    let range = package["engines"]["node"].as_str().ok_or_else(|| fail(&"no engines.node"))?;
    let answer = Command::new("node").arg("--version").output();
    let found = answer
        .ok()
        .filter(|output| output.status.success())
        .map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    let help = "\n  help: Debian's package nodejs, or https://nodejs.org";
    match found {
        None => Err(format!("the browser app needs Node {range}, and `node` was not found{help}")),
        Some(version) => match allows(range, &version) {
            Some(true) => Ok(()),
            Some(false) => {
                Err(format!("the browser app needs Node {range}; this is {version}{help}"))
            }
            None => Err(fail(&format!("`{range}` and `{version}` cannot be compared"))),
        },
    }
}

/// Whether a range such as `^20.19 || >=24` contains a version such as `v20.20.2`; `None` if one of them is not
/// understood.
fn allows(range: &str, version: &str) -> Option<bool> {
    let version = numbers(version.strip_prefix('v')?)?;
    let mut is_allowed = false;
    for part in range.split("||").map(str::trim) {
        is_allowed |= if let Some(least) = part.strip_prefix(">=") {
            version >= numbers(least)?
        } else {
            let least = numbers(part.strip_prefix('^')?)?;
            version[0] == least[0] && version >= least
        };
    }
    Some(is_allowed)
}

/// Major, minor and patch; missing parts are 0.
fn numbers(text: &str) -> Option<[u32; 3]> {
    let mut numbers = [0; 3];
    let parts: Vec<&str> = text.trim().split('.').collect();
    if parts.len() > numbers.len() {
        return None;
    }
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = part.parse().ok()?;
    }
    Some(numbers)
}

#[cfg(test)]
mod tests {
    use super::allows;

    #[test]
    fn versions_are_compared_number_by_number() {
        let range = "^20.19 || ^22.12 || >=24";
        for version in ["v20.19.0", "v20.20.2", "v22.12.0", "v22.100.1", "v24.0.0", "v100.0.0"] {
            assert_eq!(allows(range, version), Some(true), "{version}");
        }
        for version in ["v18.20.8", "v20.9.0", "v20.18.3", "v21.7.3", "v22.2.0", "v23.11.0"] {
            assert_eq!(allows(range, version), Some(false), "{version}");
        }
    }

    #[test]
    fn unknown_versions_are_not_allowed() {
        for (range, version) in [
            ("~20.19", "v20.19.0"),
            ("^20.x", "v20.19.0"),
            ("", "v20.19.0"),
            ("^20.19", "20.19.0"),
            ("^20.19", "v20.19.0-pre"),
            ("^20.19", "v1.2.3.4"),
        ] {
            assert_eq!(allows(range, version), None, "{range} {version}");
        }
    }
}
