//! Runner: a library's program, bound to one core, that answers queries.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use super::workload::Workload;
use crate::native;

/// One query on one set, as a runner offers it.
#[derive(Debug, Clone)]
pub struct Cell {
    pub lib: String,
    pub set: String,
    pub query: String,
    pub records: usize,
    /// Largest extent of a mesh, m.
    pub size: f64,
    /// Tolerance of the query `tolerance`, m.
    pub tolerance: f64,
}

pub struct Runner {
    pub cells: Vec<Cell>,
    name: String,
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    failure: Option<String>,
}

impl Runner {
    /// Starts the program and waits until it has read everything.
    pub fn start(
        name: &str,
        command: &[String],
        workload: &Workload,
        root: &Path,
        core: Option<usize>,
    ) -> Result<Self, String> {
        let mut words: Vec<String> = Vec::new();
        if let Some(core) = core.filter(|_| native::exists("taskset")) {
            words.extend(["taskset".into(), "-c".into(), core.to_string()]);
        }
        words.extend(command.iter().cloned());
        words.extend([&workload.data, &workload.extra].map(|folder| folder.display().to_string()));
        let mut start = Command::new(&words[0]);
        start.args(&words[1..]).current_dir(root).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = start.spawn().map_err(|e| format!("cannot start `{}`: {e}", words[0]))?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(format!("`{}` has no standard input and output", words[0]));
        };
        let mut runner =
            Self { cells: Vec::new(), name: name.into(), child, input, output: BufReader::new(output), failure: None };
        loop {
            match runner.read()?.split(' ').collect::<Vec<_>>()[..] {
                ["ready"] => return Ok(runner),
                ["cell", lib, set, query, records, size, tolerance] => {
                    let cell = cell([lib, set, query], [records, size, tolerance]);
                    runner.cells.push(cell.ok_or_else(|| format!("{name}: numbers expected for {lib} {set} {query}"))?);
                }
                ref other => return Err(format!("{name}: `{}` is no cell", other.join(" "))),
            }
        }
    }

    /// Time per record over the first `records`, `passes` times, ns; `None` once the program has failed.
    pub fn time(&mut self, cell: usize, records: usize, passes: usize) -> Option<f64> {
        let reply = self.ask(&format!("time {cell} {records} {passes}"))?;
        self.number(&reply)
    }

    /// Returns at most `count` answers, from record `from` on.
    pub fn answers(&mut self, cell: usize, from: usize, count: usize, folder: &Path) -> Option<Vec<f64>> {
        let file = folder.join(format!("{}.answers", self.name));
        let reply = self.ask(&format!("answers {cell} {from} {count} {}", file.display()))?;
        let written = self.number(&reply)? as usize;
        let bytes = std::fs::read(&file).unwrap_or_default();
        let numbers: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        if numbers.len() != written {
            self.fail(&format!("{} answers written, {} read", written, numbers.len()));
            return None;
        }
        Some(numbers)
    }

    /// Why it was dropped from the measurement.
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    fn ask(&mut self, line: &str) -> Option<String> {
        if self.failure.is_some() {
            return None;
        }
        let sent = writeln!(self.input, "{line}").and_then(|()| self.input.flush());
        match sent.map_err(|e| e.to_string()).and_then(|()| self.read()) {
            Ok(reply) => Some(reply),
            Err(e) => {
                self.fail(&format!("`{line}`: {e}"));
                None
            }
        }
    }

    fn read(&mut self) -> Result<String, String> {
        let mut line = String::new();
        match self.output.read_line(&mut line) {
            Ok(0) => Err(format!("{} ended; what it said is above", self.name)),
            Ok(_) => Ok(line.trim_end().to_owned()),
            Err(e) => Err(format!("{}: {e}", self.name)),
        }
    }

    fn number(&mut self, reply: &str) -> Option<f64> {
        let number = reply.parse().ok();
        if number.is_none() {
            self.fail(&format!("`{reply}` is no number"));
        }
        number
    }

    fn fail(&mut self, what: &str) {
        eprintln!("{} failed: {what}", self.name);
        self.failure = Some(format!("{} failed on the way: {what}", self.name));
    }
}

impl Drop for Runner {
    fn drop(&mut self) {
        // The end of its input would be enough, unless the program hangs.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn cell([lib, set, query]: [&str; 3], [records, size, tolerance]: [&str; 3]) -> Option<Cell> {
    let (records, size, tolerance) = (records.parse().ok()?, size.parse().ok()?, tolerance.parse().ok()?);
    Some(Cell { lib: lib.into(), set: set.into(), query: query.into(), records, size, tolerance })
}
