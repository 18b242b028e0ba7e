//! Puts the notices of all crates in the program and in the Python module into the program.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::{env, fs};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use license_fetcher::prelude::{
    CargoDirectiveList, ConfigBuilder, Package, package_list_with_licenses,
};

/// Licences that `license-fetcher` does not find: of the fonts in a crate, and in another spelling.
const OTHERS: [(&str, &str); 2] =
    [("dejavu", "assets/dejavu-fonts-ttf-2.37/LICENSE"), ("plist", "LICENCE")];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../../Cargo.lock");
    let packages = packages().unwrap_or_else(|error| {
        println!("cargo::warning=the program lacks the notices of its crates: {error}");
        Vec::new()
    });
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(notices(&packages).as_bytes())?;
    let folder = env::var("OUT_DIR")?;
    fs::write(Path::new(&folder).join("notices.zlib"), encoder.finish()?)?;
    Ok(())
}

/// Crates of others in the program with its features, and in the Python module.
fn packages() -> Result<Vec<Package>, Box<dyn Error>> {
    let mut all = Vec::new();
    let own = env::var("CARGO_CFG_FEATURE").unwrap_or_default();
    for (folder, features) in [(".", own), ("../spineline-py", String::new())] {
        let config = ConfigBuilder::from_build_env()
            .manifest_dir(Path::new(&env::var("CARGO_MANIFEST_DIR")?).join(folder))
            .cargo_directives(CargoDirectiveList::prefer_locked())
            .enabled_features(features)
            .build()?;
        for mut package in package_list_with_licenses(&config)?.0 {
            if let Some((_, file)) = OTHERS.iter().find(|(name, _)| *name == package.name) {
                let name = format!("{}-{}", package.name, package.version);
                for registry in fs::read_dir(config.cargo_home_dir.join("registry/src"))? {
                    let text = fs::read_to_string(registry?.path().join(&name).join(file));
                    package.license_texts.extend(text.map(|text| ((*file).to_owned(), text)));
                }
            }
            all.push(package);
        }
    }
    all.retain(|package| !package.name.starts_with("spineline"));
    Ok(all)
}

/// Every text once, below the crates that have it; a crate without a text has its authors and the name of its licence.
fn notices(packages: &[Package]) -> String {
    let mut users: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in packages {
        let mut texts: Vec<&str> =
            package.license_texts.iter().map(|(_, text)| text.trim()).collect();
        let licence = package.license_identifier.as_deref().unwrap_or("not stated");
        let named = format!("Licence: {licence}. Authors: {}", package.authors.join(", "));
        if texts.is_empty() {
            texts.push(&named);
        }
        for text in texts {
            let name = format!("crate {} {}\n", package.name, package.version);
            users.entry(text.to_owned()).or_default().insert(name);
        }
    }
    let mut groups: Vec<_> = users.into_iter().map(|(text, crates)| (crates, text)).collect();
    groups.sort();
    let [heavy, light] = ["=", "-"].map(|line| line.repeat(80));
    let group = |(crates, text): (BTreeSet<String>, String)| {
        format!("{heavy}\n{}{light}\n{text}\n\n", crates.into_iter().collect::<String>())
    };
    groups.into_iter().map(group).collect()
}
