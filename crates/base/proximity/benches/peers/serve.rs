//! The protocol: lists the cells, then times them and returns answers on request.

use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Duration;

use crate::cells::{Cell, all};
use crate::files::Outcome;

pub fn serve(data: &Path, extra: &Path) -> Outcome<()> {
    let mut cells = all(data, extra)?;
    for Cell { lib, set, query, records, size, tolerance, .. } in &cells {
        println!("cell {lib} {set} {query} {records} {size:?} {tolerance:?}");
    }
    println!("ready");
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(|e| e.to_string())?;
        let reply = execute(&line, &mut cells).ok_or_else(|| format!("cannot do `{line}`"))?;
        println!("{reply}");
        std::io::stdout().flush().map_err(|e| e.to_string())?;
    }
    Ok(())
}

fn execute(line: &str, cells: &mut [Cell]) -> Option<String> {
    let words: Vec<&str> = line.split(' ').collect();
    let number = |k: usize| words.get(k)?.parse::<usize>().ok();
    let cell = cells.get_mut(number(1)?)?;
    match words[0] {
        "time" => Some(format!("{:.3}", time(cell, number(2)?.min(cell.records), number(3)?))),
        "answers" => {
            let (from, count) = (number(2)?, number(3)?);
            let all = from..(from + count).min(cell.records);
            let bytes: Vec<u8> = all.flat_map(|i| cell.query_records.answer(i).to_le_bytes()).collect();
            std::fs::write(words.get(4)?, &bytes).ok()?;
            Some(format!("{}", bytes.len() / 8))
        }
        _ => None,
    }
}

/// Processor time of this thread per record, in nanoseconds, after a warm-up of a millisecond or one pass.
fn time(cell: &mut Cell, records: usize, passes: usize) -> f64 {
    let start = processor_time();
    let mut sum = 0.0;
    for record in 0..records {
        sum += cell.query_records.answer(record);
        if since(start).as_micros() >= 1000 {
            break;
        }
    }
    let start = processor_time();
    sum += cell.query_records.pass(records, passes);
    std::hint::black_box(sum);
    since(start).as_nanos() as f64 / (records * passes).max(1) as f64
}

fn since(start: Duration) -> Duration {
    processor_time().saturating_sub(start)
}

#[cfg(unix)]
fn processor_time() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default()
}

/// Wall-clock time, if the system provides no other.
#[cfg(not(unix))]
fn processor_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}
