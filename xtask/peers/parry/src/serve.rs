//! Protocol with xtask, the same as that of the other runners (`xtask/peers/README.md`).

use std::io::{BufRead, Write};
use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// Returns the answer for a record: 0 or 1, or metres.
pub trait Query {
    fn answer(&mut self, record: usize) -> f64;
    /// Runs the whole loop, so that the query can be inlined into it.
    fn pass(&mut self, records: usize, passes: usize) -> f64;
}

impl<F: FnMut(usize) -> f64> Query for F {
    fn answer(&mut self, record: usize) -> f64 {
        self(record)
    }

    fn pass(&mut self, records: usize, passes: usize) -> f64 {
        let mut sum = 0.0;
        for _ in 0..passes {
            for record in 0..records {
                sum += self(record);
            }
        }
        sum
    }
}

#[derive(Default)]
pub struct Cell {
    pub lib: String,
    pub set: String,
    pub query: &'static str,
    pub records: usize,
    pub size: f64,
    pub tolerance: f64,
    pub run: Option<Box<dyn Query>>,
}

impl Cell {
    /// Returns the cell of one query on this set.
    pub fn with(&self, lib: &str, query: &'static str, records: usize, run: Box<dyn Query>) -> Self {
        let (lib, set) = (lib.to_owned(), self.set.clone());
        Self { lib, set, query, records, size: self.size, tolerance: self.tolerance, run: Some(run) }
    }
}

pub fn yes(answer: bool) -> f64 {
    f64::from(u8::from(answer))
}

pub fn serve(mut cells: Vec<Cell>) {
    for Cell { lib, set, query, records, size, tolerance, .. } in &cells {
        println!("cell {lib} {set} {query} {records} {size:?} {tolerance:?}");
    }
    println!("ready");
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        let Some(reply) = obey(&line, &mut cells) else {
            eprintln!("error: cannot do `{line}`");
            std::process::exit(2);
        };
        println!("{reply}");
        let _ = std::io::stdout().flush();
    }
}

fn obey(line: &str, cells: &mut [Cell]) -> Option<String> {
    let words: Vec<&str> = line.split(' ').collect();
    let number = |k: usize| words.get(k)?.parse::<usize>().ok();
    let cell = cells.get_mut(number(1)?)?;
    let records = cell.records;
    let run = cell.run.as_mut()?;
    let (first, second) = (number(2)?, number(3)?);
    if words[0] == "time" {
        return Some(format!("{:.3}", time(&mut **run, first.min(records), second)));
    }
    let all = first..(first + second).min(records);
    let bytes: Vec<u8> = all.flat_map(|i| run.answer(i).to_le_bytes()).collect();
    std::fs::write(words.get(4)?, &bytes).ok()?;
    Some(format!("{}", bytes.len() / 8))
}

/// Processor time of this thread per record, ns, after a warm-up of a millisecond or one pass.
fn time(run: &mut dyn Query, records: usize, passes: usize) -> f64 {
    let start = processor_time();
    let mut sum = 0.0;
    for record in 0..records {
        sum += run.answer(record);
        if (processor_time() - start).as_micros() >= 1000 {
            break;
        }
    }
    let start = processor_time();
    sum += run.pass(records, passes);
    std::hint::black_box(sum);
    (processor_time() - start).as_nanos() as f64 / (records * passes).max(1) as f64
}

fn processor_time() -> Duration {
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default()
}
