//! Paths and programs that several chores use.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

/// The workspace's folder.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// Where other people's programs are installed: `.interop/`, or the folder that GENESCAPE_INTEROP names.
pub fn interop() -> PathBuf {
    std::env::var_os("GENESCAPE_INTEROP").map_or_else(|| root().join(".interop"), PathBuf::from)
}

/// Python with bpy and f3d.
pub fn python() -> PathBuf {
    interop().join("venv/bin/python")
}

/// One of our scripts.
pub fn script(name: &str) -> PathBuf {
    root().join("tests/interop").join(name)
}

/// Whether a program is on the path.
pub fn is_installed(program: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|folder| folder.join(program).is_file())
}

/// The cargo that runs us, in the workspace's folder.
pub fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// A program in the workspace's folder, with its packages found.
pub fn program(name: impl AsRef<std::ffi::OsStr>) -> Command {
    let mut command = Command::new(name);
    command.current_dir(root()).env("INTEROP", interop());
    command
}

/// Gives windows the folder that they complain about the lack of.
pub fn in_a_session(command: &mut Command) -> &mut Command {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", root().join("target"));
    }
    command
}

/// Runs a command, its output going to ours; an error unless it succeeds.
pub fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot start {:?}", command.get_program()))?;
    ensure!(status.success(), "{:?} ended with {status}", command.get_program());
    Ok(())
}

/// Builds a program in release and says where it is.
pub fn release(package: &str, name: &str) -> Result<PathBuf> {
    run(&mut cargo(&["build", "--release", "--quiet", "--package", package, "--bin", name]))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    Ok(target.join("release").join(format!("{name}{}", std::env::consts::EXE_SUFFIX)))
}

/// A folder that isn't there any more.
pub fn fresh(folder: PathBuf) -> Result<PathBuf> {
    if folder.exists() {
        std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    Ok(folder)
}

/// Files below a folder whose names end in one of `endings`, sorted; an error if there are none. Hidden folders and
/// cargo's `target` are left out.
pub fn files(folder: &Path, endings: &[&str]) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut todo = vec![folder.to_owned()];
    while let Some(folder) = todo.pop() {
        let entries = std::fs::read_dir(&folder);
        for entry in entries.with_context(|| format!("cannot read {}", folder.display()))? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if !path.is_dir() {
                found.extend(endings.iter().any(|ending| name.ends_with(ending)).then(|| path.clone()));
            } else if name != "target" && !name.starts_with('.') {
                todo.push(path);
            }
        }
    }
    found.sort();
    ensure!(!found.is_empty(), "no {} below {}", endings.join(" or "), folder.display());
    Ok(found)
}
