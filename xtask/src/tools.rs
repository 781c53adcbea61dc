//! Finding, installing and running foreign programs.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Errors are read by a person, never matched on.
pub type Result<T> = std::result::Result<T, String>;

/// The folder of the workspace.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().expect("xtask lies in the workspace").to_owned()
}

/// Runs a command; returns stdout, or the error with all output.
pub fn run(command: &mut Command) -> Result<String> {
    let output = output(command)?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    if output.status.success() {
        return Ok(stdout);
    }
    let said = [stdout, stderr].join("\n");
    Err(format!("`{}`: {}\n{}", name(command), output.status, said.trim()))
}

/// Runs a command with visible output.
pub fn show(command: &mut Command) -> Result<()> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{}`: {status}", name(command))),
        Err(error) => Err(format!("cannot run `{}`: {error}", name(command))),
    }
}

/// Installs the missing ones of these Debian packages, if this is Debian and we have the permission.
pub fn ensure_debian(packages: &[&str]) -> Result<()> {
    let missing: Vec<&str> = packages.iter().copied().filter(|package| !is_installed(package)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    if run(Command::new("id").arg("-u"))? != "0" {
        return Err(format!("missing; run `sudo apt-get install {}`", missing.join(" ")));
    }
    eprintln!("installing {}", missing.join(" "));
    run(Command::new("apt-get").args(["update", "-q"]))?;
    let install = ["install", "-q", "-y", "--no-install-recommends"];
    run(Command::new("apt-get").env("DEBIAN_FRONTEND", "noninteractive").args(install).args(missing))?;
    Ok(())
}

/// Installs exactly the versions in the lock file of a folder, once.
pub fn ensure_npm(folder: &Path) -> Result<()> {
    let lock = std::fs::read(folder.join("package-lock.json")).map_err(|e| e.to_string())?;
    let stamp = folder.join("node_modules/.installed");
    if std::fs::read(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    eprintln!("installing the packages of {}", folder.display());
    run(Command::new("npm").arg("ci").current_dir(folder))?;
    std::fs::write(stamp, lock).map_err(|error| error.to_string())
}

/// Has cargo install this version of a program below `target/tools`, once, and returns its path.
pub fn ensure_cargo(name: &str, version: &str) -> Result<PathBuf> {
    let tools = root().join("target/tools");
    let program = tools.join("bin").join(name).with_extension(std::env::consts::EXE_EXTENSION);
    let said = run(Command::new(&program).arg("--version")).unwrap_or_default();
    if said.split_whitespace().any(|word| word.trim_start_matches('v') == version) {
        return Ok(program);
    }
    eprintln!("installing {name} {version}");
    let mut install = Command::new(env!("CARGO"));
    install.args(["install", "--locked", "--quiet", "--root"]).arg(&tools).args([name, "--version", version]);
    run(&mut install)?;
    Ok(program)
}

fn is_installed(package: &str) -> bool {
    let query = ["-W", "-f", "${db:Status-Status}"];
    run(Command::new("dpkg-query").args(query).arg(package)).is_ok_and(|text| text == "installed")
}

fn output(command: &mut Command) -> Result<Output> {
    command.output().map_err(|error| format!("cannot run `{}`: {error}", name(command)))
}

fn name(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}
