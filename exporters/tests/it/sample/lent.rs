//! The USD library of a Python interpreter with usd-core, for a program without one.

use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex};

use plume_exporters::ExportError;
use plume_exporters::stage::{Array, Library, SCRIPT};
use serde_json::{Value, json};

/// What the interpreter runs: a call per line, in a folder that the line names.
const DRIVER: &str = include_str!("lent.py");

/// An interpreter that waits for calls.
pub struct Lent(Mutex<Talk>);

struct Talk {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

/// Starts the interpreter `python`.
pub fn lend(python: &Path) -> io::Result<Arc<dyn Library>> {
    let mut command = Command::new(python);
    let mut child = command.args(["-c", DRIVER, SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let piped = child.stdin.take().zip(child.stdout.take());
    let (to, from) = piped.ok_or_else(|| io::Error::other("the interpreter has no pipes"))?;
    Ok(Arc::new(Lent(Mutex::new(Talk { child, to, from: BufReader::new(from) }))))
}

impl Drop for Talk {
    fn drop(&mut self) {
        // It has nothing left to write.
        let _ = self.child.kill().and_then(|()| self.child.wait());
    }
}

impl Library for Lent {
    fn check(&self) -> Result<(), ExportError> {
        Ok(())
    }

    fn call(&self, function: &'static str, spec: &Value, arrays: Vec<(String, Array)>) -> Result<(), ExportError> {
        let folder = tempfile::tempdir()?;
        let mut kinds = Vec::new();
        for (number, (name, array)) in arrays.iter().enumerate() {
            let (kind, width, bytes) = raw(array);
            std::fs::write(folder.path().join(number.to_string()), bytes)?;
            kinds.push(json!([name, kind, width]));
        }
        let call = json!({ "function": function, "spec": spec, "arrays": kinds, "folder": folder.path() });
        let mut talk = self.0.lock().map_err(|_| io::Error::other("another call has failed"))?;
        writeln!(talk.to, "{call}")?;
        talk.to.flush()?;
        let mut answer = String::new();
        talk.from.read_line(&mut answer)?;
        match answer.trim() {
            "done" => Ok(()),
            message => Err(ExportError::Library {
                library: "usd-core",
                path: spec["path"].to_string(),
                message: message.to_owned(),
            }),
        }
    }
}

/// NumPy dtype, numbers per row, and the bytes.
fn raw(array: &Array) -> (&'static str, usize, Vec<u8>) {
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    match array {
        Array::Float3(rows) => ("<f4", 3, floats(rows.as_flattened())),
        Array::Float2(rows) => ("<f4", 2, floats(rows.as_flattened())),
        Array::Index(indices) => ("<i4", 1, indices.iter().flat_map(|index| index.to_le_bytes()).collect()),
    }
}
