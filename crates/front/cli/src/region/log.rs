//! `elbowroom region log`: every edit of a sealed cell.

use std::fmt::Write as _;

use elbowroom::cell::access::{Change, LogEntry};
use elbowroom::cell::seal::{self, History};
use serde_json::json;

use super::args::LogArgs;
use crate::output::{ExitStatus, Failure, note, print, print_json};

/// Most changes printed per entry; the JSON document has all of them.
const MOST: usize = 12;

pub(crate) fn log(args: &LogArgs) -> Result<ExitStatus, Failure> {
    let history = seal::history(&args.cell)?;
    let good = history.unsealed.is_empty();
    if args.json {
        print_json(&document(&history))?;
    } else {
        for e in &history.entries {
            print(&entry(e, &name(&history, e)))?;
        }
        if good {
            print("The cell is as it was sealed.\n")?;
        }
    }
    if !good {
        note(format_args!("{}: is not as it was sealed:\n{}", args.cell.display(), lines(&history.unsealed)));
    }
    Ok(if good { ExitStatus::Success } else { ExitStatus::NegativeResult })
}

fn document(history: &History) -> serde_json::Value {
    let entries: Vec<_> = history.entries.iter().map(|e| with_name(e, &name(history, e))).collect();
    json!({
        "trusted_keys": history.trusted.file.display().to_string(),
        "sealed": history.unsealed.is_empty(),
        "unsealed": history.unsealed,
        "entries": entries,
    })
}

fn with_name(entry: &LogEntry, name: &str) -> serde_json::Value {
    let mut value = json!(entry);
    value["name"] = name.into();
    value
}

fn name(history: &History, entry: &LogEntry) -> String {
    history.trusted.get(&entry.key).map(|k| k.name.clone()).unwrap_or_default()
}

/// Formats an entry as text.
pub(super) fn entry(e: &LogEntry, name: &str) -> String {
    let mut text = format!("{:>4}  {}  {} ({}, key {}): {}", e.sequence, e.time, name, e.class, e.key, e.action);
    if let Some(note) = &e.note {
        let _ = write!(text, " - {note}");
    }
    format!("{text}\n{}", lines(&e.changes))
}

fn lines(changes: &[Change]) -> String {
    let shown = seal::shown(changes);
    let mut text = shown.iter().take(MOST).map(|c| format!("      {c}\n")).collect::<Vec<_>>().concat();
    if shown.len() > MOST {
        let _ = writeln!(text, "      and {} more", shown.len() - MOST);
    }
    text
}
