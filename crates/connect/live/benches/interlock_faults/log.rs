//! What the processes say, and whether it explains why a robot waited for a free region.

use std::io::{BufRead as _, BufReader, Read};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::cell::{between, name};

/// A pause up to this long needs no explanation.
const PAUSE: Duration = Duration::from_secs(2);
/// What a line explains begins this much before it: whoever is silent is named after a second.
const BEFORE: Duration = Duration::from_millis(1500);
/// Processes connect and report for this long after they are there again.
const AFTER: Duration = Duration::from_secs(3);

/// A wait of a robot for a region.
#[derive(Debug, Clone, Copy)]
pub struct Wait {
    pub robot: usize,
    pub slot: usize,
    pub from: Instant,
    pub to: Instant,
}

/// The lines of all processes, with the times at which they came.
#[derive(Debug, Clone, Default)]
pub struct Log(Arc<Mutex<Vec<(Instant, String)>>>);

/// From, to.
type Span = (Instant, Instant);

impl Log {
    fn lines(&self) -> MutexGuard<'_, Vec<(Instant, String)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads what a process says, until it ends.
    pub fn follow(&self, output: impl Read + Send + 'static) {
        let log = self.clone();
        std::thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                log.lines().push((Instant::now(), line));
            }
        });
    }

    /// How many lines there are.
    pub fn count(&self) -> usize {
        self.lines().len()
    }

    /// The waits with a pause that no line explains.
    pub fn unexplained(&self, waits: &[Wait], end: Instant) -> Vec<Wait> {
        let lines = self.lines();
        waits.iter().copied().filter(|wait| longest_gap(wait, &explained(&lines, wait, end)) > PAUSE).collect()
    }
}

/// What the lines explain, for a wait.
fn explained(lines: &[(Instant, String)], wait: &Wait, end: Instant) -> Vec<Span> {
    let region = between(wait.slot + 1);
    let mut spans = held(lines, &region, &name(wait.robot), end);
    for robot in [wait.slot, wait.slot + 1].map(name) {
        let (gone, here) =
            (format!("robot {robot}: its process is gone"), format!("robot {robot}: its process is there"));
        spans.extend(lasting(lines, &gone, &here, end));
        let (silent, again) = (format!("robot {robot}: not heard"), format!("robot {robot}: heard again"));
        spans.extend(lasting(lines, &silent, &again, end));
        spans.extend(at_once(lines, &format!("{robot}: its guard has started")));
    }
    spans.extend(lasting(lines, "the arbiter's process is gone", "the arbiter's process is there", end));
    spans.extend(at_once(lines, "all temporary regions are on"));
    spans.extend(lines.iter().filter_map(|(at, line)| {
        let gap_s: f64 = line.strip_prefix("the arbiter did not run for ")?.split(' ').next()?.parse().ok()?;
        Some((earlier(*at, BEFORE + Duration::from_secs_f64(gap_s)), *at + AFTER))
    }));
    spans
}

/// Between lines that begin so, and a while before and after.
fn lasting(lines: &[(Instant, String)], begin: &str, over: &str, end: Instant) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut since: Option<Instant> = None;
    for (at, line) in lines {
        if line.starts_with(begin) {
            since = since.or(Some(*at));
        } else if line.starts_with(over)
            && let Some(since) = since.take()
        {
            spans.push((earlier(since, BEFORE), *at + AFTER));
        }
    }
    spans.extend(since.map(|since| (earlier(since, BEFORE), end)));
    spans
}

fn at_once(lines: &[(Instant, String)], begin: &str) -> Vec<Span> {
    lines
        .iter()
        .filter(|(_, line)| line.starts_with(begin))
        .map(|(at, _)| (earlier(*at, BEFORE), *at + AFTER))
        .collect()
}

/// When another robot had the region.
fn held(lines: &[(Instant, String)], region: &str, robot: &str, end: Instant) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut since: Option<Instant> = None;
    for (at, line) in lines {
        let what = line.strip_prefix(region).and_then(|rest| rest.strip_prefix(": "));
        let is_taken = what.is_some_and(|what| {
            what.strip_prefix("granted to ").is_some_and(|who| who != robot)
                || what.split_once(" was found inside").is_some_and(|(who, _)| who != robot)
        });
        let is_over = what.is_some_and(|what| what.starts_with("released by ") || what.starts_with("granted to "))
            || line.starts_with("all temporary regions are on");
        if is_over && let Some(since) = since.take() {
            spans.push((since, *at));
        }
        if is_taken {
            since = since.or(Some(*at));
        }
    }
    spans.extend(since.map(|since| (since, end)));
    spans
}

fn earlier(at: Instant, by: Duration) -> Instant {
    at.checked_sub(by).unwrap_or(at)
}

/// The longest part of a wait that no span covers.
fn longest_gap(wait: &Wait, spans: &[Span]) -> Duration {
    let mut spans = spans.to_vec();
    spans.sort();
    let (mut covered, mut longest) = (wait.from, Duration::ZERO);
    for (from, to) in spans.into_iter().chain([(wait.to, wait.to)]) {
        longest = longest.max(from.min(wait.to).saturating_duration_since(covered));
        covered = covered.max(to);
    }
    longest
}
