//! The Python package: its wheel, with the program and the browser app inside, and its tests.

use std::env::consts::EXE_EXTENSION;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::checks::native_module;
use crate::command::{run, with_output};
use crate::files::{emptied, entries};
use crate::plan::Plan;
use crate::tools::Tool;
use crate::{python, web};

/// The profile of everything that is given to people.
const PROFILE: &str = "dist";

/// The name of its Python environment.
const ENVIRONMENT: &str = "package";

/// The tests that use the program, by file.
const WHEEL_TESTS: [&str; 3] = ["test_analysis.py", "test_models.py", "test_tables.py"];

/// The interpreter of the environment in which the package is built and tested.
pub fn environment(root: &Path) -> Result<PathBuf, String> {
    python::environment(root, ENVIRONMENT, &root.join("python/tests/requirements.txt"))
}

/// Builds the wheels for users: their program writes typeset reports and connects to encrypted archives.
///
/// One serves every usual Python. An interpreter without the stable ABI, such as a free-threaded one, gets a
/// separate wheel. With a version of the C library they run on every Linux that has it or a later one.
pub fn wheels(root: &Path, arguments: &[String]) -> Result<(), String> {
    let (mut others, mut old) = (Vec::new(), None);
    for pair in arguments.chunks(2) {
        match pair {
            [option, interpreter] if option == "--also" => {
                others.push(interpreter_of(interpreter)?)
            }
            [option, version] if option == "--glibc" => old = Some(Zig::new(root, version)?),
            _ => return Err("`cargo xtask` lists the options".to_owned()),
        }
    }
    wheels_with(root, &["--features", "pdf,https"], &others, old.as_ref()).map(|_| ())
}

/// Zig as the linker: it knows all versions of the C library, so that no container with an old system is needed.
struct Zig {
    interpreter: PathBuf,
    /// Such as `x86_64-unknown-linux-gnu`.
    host: String,
    /// Of the C library, such as `2.28`.
    version: String,
}

impl Zig {
    fn new(root: &Path, version: &str) -> Result<Self, String> {
        let interpreter = python::environment(root, "zig", &root.join("packaging/zig.txt"))?;
        let host = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
        Ok(Self { interpreter, host, version: version.to_owned() })
    }

    /// The search path with its programs first.
    fn path(&self) -> Result<String, String> {
        let own = python::text(self.interpreter.parent().expect("an interpreter in a folder"))?;
        Ok(format!("{own}:{}", std::env::var("PATH").unwrap_or_default()))
    }

    /// The options of maturin for the module.
    fn of_module(&self) -> [String; 5] {
        let tag = format!("manylinux_{}", self.version.replace('.', "_"));
        ["--zig", "--target", &self.host, "--compatibility", &tag].map(str::to_owned)
    }
}

/// An interpreter by its name on the path, or by its path from the folder of the caller: wheels are built in another
/// one.
fn interpreter_of(given: &str) -> Result<String, String> {
    if Path::new(given).components().count() == 1 {
        return Ok(given.to_owned());
    }
    let place = std::path::absolute(given).map_err(|error| format!("{given}: {error}"))?;
    python::text(&place)
}

/// Builds wheels: the browser app if Node is installed, the program with these features, then the native modules.
fn wheels_with(
    root: &Path,
    features: &[&str],
    others: &[String],
    zig: Option<&Zig>,
) -> Result<Vec<PathBuf>, String> {
    let start = Instant::now();
    if Tool::Npm.is_there() {
        web::build(root)?;
    } else {
        println!("Node.js is missing: the program of this wheel lacks the browser app");
    }
    let target = python::target()?;
    let flags = flags_without_places(root, &target)?;
    let path = zig.map(Zig::path).transpose()?;
    let mut variables = vec![("CARGO_ENCODED_RUSTFLAGS", flags.as_str())];
    variables.extend(path.as_deref().map(|path| ("PATH", path)));
    let command = if zig.is_some() { "zigbuild" } else { "build" };
    let mut program = vec![command, "--profile", PROFILE, "--locked", "--package", "spineline-cli"];
    program.extend(features);
    let goal = zig.map(|zig| format!("{}.{}", zig.host, zig.version));
    program.extend(goal.iter().flat_map(|goal| ["--target", goal]));
    run(root, "cargo", &program, &variables)?;
    let scripts = root.join("python/spineline._native.data/scripts");
    let program = Path::new("spineline").with_extension(EXE_EXTENSION);
    fs::create_dir_all(&scripts).map_err(|error| format!("{}: {error}", scripts.display()))?;
    let built = zig.map_or_else(|| target.clone(), |zig| target.join(&zig.host)).join(PROFILE);
    copy(&built.join(&program), &scripts.join(&program))?;
    let wheels = target.join("wheels");
    emptied(&wheels)?;
    let interpreter = match zig {
        Some(zig) => python::text(&zig.interpreter)?,
        None => python::text(&environment(root)?)?,
    };
    let notices = File::create(root.join("python/NOTICES.txt"))
        .map_err(|error| format!("python/NOTICES.txt: {error}"))?;
    let own = python::text(&scripts.join(&program))?;
    with_output(notices, || run(root, &own, &["licences"], &[]))?;
    let (out, folder) = (python::text(&wheels)?, python::text(&target)?);
    let build = ["-m", "maturin", "build", "--profile", PROFILE, "--out", &out];
    let mut arguments = [&build[..], &["--interpreter", &interpreter]].concat();
    arguments.extend(others.iter().map(String::as_str));
    let of_module = zig.map(Zig::of_module);
    arguments.extend(of_module.iter().flatten().map(String::as_str));
    variables.push(("CARGO_TARGET_DIR", &folder));
    run(&root.join("python"), &interpreter, &arguments, &variables)?;
    let module = built.join(python::module_file());
    for file in [&scripts.join(&program), &module] {
        let bytes = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
        check_given(&bytes, &builder(root, &target)?)
            .map_err(|fault| format!("{}: {fault}", file.display()))?;
    }
    let wheels = entries(&wheels)?;
    for wheel in &wheels {
        let bytes =
            fs::metadata(wheel).map_err(|error| format!("{}: {error}", wheel.display()))?.len();
        println!("» {}: {:.1} MB", wheel.display(), bytes as f64 / 1e6);
    }
    println!("» built in {} s", start.elapsed().as_secs());
    Ok(wheels)
}

/// Paths of this machine, with the names that replace them in files for users.
fn builder(root: &Path, target: &Path) -> Result<Vec<(String, &'static str)>, String> {
    let home = std::env::home_dir().ok_or("the home folder is not known")?;
    let cargo = std::env::var_os("CARGO_HOME").map_or_else(|| home.join(".cargo"), PathBuf::from);
    // The last match counts.
    let places = [(home, "home"), (cargo, "cargo"), (root.to_owned(), "spineline")];
    let places = places.into_iter().chain([(target.to_owned(), "target")]);
    // A container may have `/` as its home.
    let places = places.filter(|(place, _)| place.parent().is_some());
    places.map(|(place, name)| Ok((python::text(&place)?, name))).collect()
}

/// Flags of the compiler with which a panic names the file of a crate without the builder's path.
fn flags_without_places(root: &Path, target: &Path) -> Result<String, String> {
    let places = builder(root, target)?.into_iter();
    let given = std::env::var("RUSTFLAGS").unwrap_or_default();
    let given = given.split_whitespace().map(str::to_owned);
    let remapped = places.map(|(place, name)| format!("--remap-path-prefix={place}={name}"));
    // This character separates flags, so that a path may contain blanks.
    Ok(given.chain(remapped).collect::<Vec<_>>().join("\x1f"))
}

/// Checks that a program or module contains no path of its builder and no names of its functions.
fn check_given(bytes: &[u8], builder: &[(String, &'static str)]) -> Result<(), String> {
    let holds = |text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    if let Some((place, _)) = builder.iter().find(|(place, _)| holds(&format!("{place}/"))) {
        return Err(format!("it holds the path {place} of its builder"));
    }
    // Both encodings of function names put the length of a crate's name before it.
    match ["13spineline_cli", "15spineline_files"].into_iter().find(|name| holds(name)) {
        Some(name) => Err(format!("it is not stripped: it holds `{name}`")),
        None => Ok(()),
    }
}

/// Tests the package and its types, with the native module that the tests have built.
pub fn test(plan: &Plan<'_>) -> Result<(), String> {
    let root = plan.root;
    let interpreter = python::text(&environment(root)?)?;
    let staged = staged(plan)?;
    let program = python::target()?.join("debug/spineline").with_extension(EXE_EXTENSION);
    let (path, program) = (python::text(&staged)?, python::text(&program)?);
    let variables = [
        ("PYTHONPATH", path.as_str()),
        ("SPINELINE_PROGRAM", program.as_str()),
        ("PYTHONDONTWRITEBYTECODE", "1"),
    ];
    let folder = root.join("python");
    pytest(root, &staged, &interpreter, &variables, &["."])?;
    run(&folder, &interpreter, &["-m", "mypy"], &[])?;
    run(&folder, &interpreter, &["-m", "pyright", "--pythonpath", &interpreter], &[])?;
    let measure = python::text(&folder.join("tests/measure.py"))?;
    run(&staged, &interpreter, &[&measure], &variables)
}

/// Runs the tests from another folder, so that the sources are not taken for the package.
fn pytest(
    root: &Path,
    from: &Path,
    interpreter: &str,
    variables: &[(&str, &str)],
    files: &[&str],
) -> Result<(), String> {
    let tests = root.join("python/tests");
    let tests: Vec<String> =
        files.iter().map(|file| python::text(&tests.join(file))).collect::<Result<_, _>>()?;
    let config = python::text(&root.join("python/pyproject.toml"))?;
    let mut arguments = vec!["-m", "pytest", "--quiet", "--config-file", &config];
    arguments.extend(tests.iter().map(String::as_str));
    run(from, interpreter, &arguments, variables)
}

/// Builds a wheel, installs it in a separate environment, and returns the interpreter. The wheel lacks the typesetter,
/// which is most of a release build and is covered by other tests.
pub fn with_wheel(root: &Path) -> Result<PathBuf, String> {
    let wheels = wheels_with(root, &[], &[], None)?;
    let wheel = python::text(wheels.first().ok_or("no wheel was built")?)?;
    let requirements = root.join("python/tests/requirements.txt");
    let interpreter = python::environment(root, "wheel", &requirements)?;
    let install = ["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps", &wheel];
    run(root, &python::text(&interpreter)?, &install, &[])?;
    Ok(interpreter)
}

/// Tests the installed wheel: its program and its module. The same sources have passed all tests before.
pub fn test_wheel(root: &Path) -> Result<(), String> {
    let interpreter = python::text(&with_wheel(root)?)?;
    let variables = [("PYTHONDONTWRITEBYTECODE", "1")];
    pytest(root, &python::target()?, &interpreter, &variables, &WHEEL_TESTS)
}

/// Runs the self-test of the module of 3D Slicer on Slicer's own scene.
pub fn test_slicer(plan: &Plan<'_>) -> Result<(), String> {
    let folder = plan.root.join("integrations/slicer");
    let interpreter = python::environment(plan.root, "slicer", &folder.join("requirements.txt"))?;
    let package = python::text(&staged(plan)?)?;
    let variables = [("PYTHONPATH", package.as_str()), ("PYTHONDONTWRITEBYTECODE", "1")];
    run(&folder, &python::text(&interpreter)?, &["selftest.py"], &variables)
}

/// The package with the native module of the tests' build, below the target folder.
pub fn staged(plan: &Plan<'_>) -> Result<PathBuf, String> {
    let module = native_module(plan)?;
    let staged = python::target()?.join("python/staged");
    let (from, to) = (plan.root.join("python/spineline"), staged.join("spineline"));
    emptied(&to)?;
    for path in entries(&from)? {
        if let Some(name) = path.file_name().filter(|_| path.is_file()) {
            copy(&path, &to.join(name))?;
        }
    }
    let end = if cfg!(windows) { "pyd" } else { "abi3.so" };
    copy(&module, &to.join(format!("_native.{end}")))?;
    Ok(staged)
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    fs::copy(from, to).map(|_| ()).map_err(|error| {
        format!("{} could not be copied to {}: {error}", from.display(), to.display())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_for_users_contain_no_path_of_the_builder_and_no_symbols() {
        let builder = [("/home/doe".to_owned(), "home")];
        assert_eq!(check_given(b"..cargo/registry/src/lib.rs..", &builder), Ok(()));
        for bytes in [&b"..\0/home/doe/.cargo/registry"[..], b"_ZN13spineline_cli4main17h0E"] {
            assert!(check_given(bytes, &builder).is_err());
        }
    }

    /// A package with settings in a profile loses `strip` of the profile.
    #[test]
    fn the_program_states_that_it_is_stripped() {
        let manifest = include_str!("../../Cargo.toml");
        let (_, release) = manifest.split_once("[profile.release]").expect("a profile");
        assert!(release.lines().take(5).any(|line| line == "strip = true"));
        let (_, dist) = release.split_once("[profile.dist]").expect("a profile");
        assert!(dist.lines().any(|line| line == "inherits = \"release\""));
        for package in ["spineline-cli = ", "spineline-py = "] {
            let mut own = release.lines().filter(|line| line.starts_with(package));
            assert!(own.all(|line| line.contains("strip = true")), "{package}");
        }
    }

    #[test]
    fn every_build_for_users_hides_the_paths_of_its_builder() {
        for (name, text) in [
            ("Dockerfile", include_str!("../../packaging/Dockerfile")),
            ("recipe.yaml", include_str!("../../packaging/conda/recipe.yaml")),
        ] {
            let before = text.split("cargo build --profile dist").next().expect("a part");
            assert!(before.len() < text.len(), "{name} builds");
            assert!(
                before.contains("--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo"),
                "{name}"
            );
        }
    }
}
