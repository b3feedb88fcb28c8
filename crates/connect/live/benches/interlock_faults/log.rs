//! Log of the processes' messages, and whether it explains why a robot waited for a free region.

use std::io::{BufRead as _, BufReader, Read};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::cell::{between, name};

/// Longest pause that needs no explanation.
const PAUSE: Duration = Duration::from_secs(2);
/// Time before a line that the line explains: silence is reported after a second.
const BEFORE: Duration = Duration::from_millis(1500);
/// Time for which processes connect and report after their return.
const AFTER: Duration = Duration::from_secs(3);
/// Beginning of the nodes' lines about the arbiter.
const ARBITER: &str = "the arbiter's process is ";
/// Beginning of the arbiter's first line.
const STARTED: &str = "all temporary regions are on";

/// A wait of a robot for a region.
#[derive(Debug, Clone, Copy)]
pub struct Wait {
    pub robot: usize,
    pub slot: usize,
    pub from: Instant,
    pub to: Instant,
}

/// Speaker of a line: a node, by its robot, or the arbiter.
pub type Speaker = Option<usize>;

/// A line, with its time of arrival.
#[derive(Debug, Clone)]
struct Line {
    at: Instant,
    speaker: Speaker,
    text: String,
}

/// The credible lines: those of the arbiter, and those of nodes about the arbiter. A node that is cut off reports all
/// others as gone.
#[derive(Debug, Clone, Default)]
pub struct Log(Arc<Mutex<Vec<Line>>>);

/// Begin and end.
type Span = (Instant, Instant);

impl Log {
    fn lines(&self) -> MutexGuard<'_, Vec<Line>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads the lines of a process until it ends.
    pub fn follow(&self, speaker: Speaker, output: impl Read + Send + 'static) {
        let log = self.clone();
        std::thread::spawn(move || {
            for text in BufReader::new(output).lines().map_while(Result::ok) {
                if speaker.is_none() || text.starts_with(ARBITER) {
                    log.lines().push(Line { at: Instant::now(), speaker, text });
                }
            }
        });
    }

    /// Number of lines.
    pub fn count(&self) -> usize {
        self.lines().len()
    }

    /// Returns the waits with a pause that no line explains.
    pub fn unexplained(&self, waits: &[Wait], end: Instant) -> Vec<Wait> {
        let lines = self.lines();
        waits.iter().copied().filter(|wait| longest_gap(wait, &explained(&lines, wait, end)) > PAUSE).collect()
    }
}

/// Returns the spans of a wait that the lines explain.
fn explained(lines: &[Line], wait: &Wait, end: Instant) -> Vec<Span> {
    let (of_arbiter, of_nodes): (Vec<_>, Vec<_>) = lines.iter().partition(|line| line.speaker.is_none());
    let region = between(wait.slot + 1);
    let mut spans = held(&of_arbiter, &region, &name(wait.robot), end);
    for robot in [wait.slot, wait.slot + 1] {
        let own: Vec<_> = of_nodes.iter().copied().filter(|line| line.speaker == Some(robot)).collect();
        spans.extend(lasting(&own, &format!("{ARBITER}gone"), &[&format!("{ARBITER}there")], end));
        let robot = name(robot);
        let about = |what: &str| format!("robot {robot}: {what}");
        spans.extend(lasting(
            &of_arbiter,
            &about("its process is gone"),
            &[&about("its process is there"), STARTED],
            end,
        ));
        spans.extend(lasting(&of_arbiter, &about("not heard"), &[&about("heard"), STARTED], end));
        spans.extend(at_once(&of_arbiter, &format!("{robot}: its guard has started")));
    }
    spans.extend(at_once(&of_arbiter, STARTED));
    spans.extend(of_arbiter.iter().filter_map(|line| {
        let gap = line.text.strip_prefix("the arbiter did not run for ")?.split(' ').next()?;
        Some((earlier(line.at, BEFORE + Duration::from_secs_f64(gap.parse().ok()?)), line.at + AFTER))
    }));
    spans
}

/// Returns the spans between lines with these beginnings, extended before and after.
fn lasting(lines: &[&Line], begin: &str, over: &[&str], end: Instant) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut since: Option<Instant> = None;
    for line in lines {
        if line.text.starts_with(begin) {
            since = since.or(Some(line.at));
        } else if over.iter().any(|over| line.text.starts_with(over))
            && let Some(since) = since.take()
        {
            spans.push((earlier(since, BEFORE), line.at + AFTER));
        }
    }
    spans.extend(since.map(|since| (earlier(since, BEFORE), end)));
    spans
}

fn at_once(lines: &[&Line], begin: &str) -> Vec<Span> {
    let begun = lines.iter().filter(|line| line.text.starts_with(begin));
    begun.map(|line| (earlier(line.at, BEFORE), line.at + AFTER)).collect()
}

/// Returns the spans in which another robot had the region.
fn held(lines: &[&Line], region: &str, robot: &str, end: Instant) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut since: Option<Instant> = None;
    for line in lines {
        let what = line.text.strip_prefix(region).and_then(|rest| rest.strip_prefix(": "));
        let is_taken = what.is_some_and(|what| {
            what.strip_prefix("granted to ").is_some_and(|who| who != robot)
                || what.split_once(" was found inside").is_some_and(|(who, _)| who != robot)
        });
        let is_over = what.is_some_and(|what| what.starts_with("released by ") || what.starts_with("granted to "))
            || line.text.starts_with(STARTED);
        if is_over && let Some(since) = since.take() {
            spans.push((since, line.at));
        }
        if is_taken {
            since = since.or(Some(line.at));
        }
    }
    spans.extend(since.map(|since| (since, end)));
    spans
}

fn earlier(at: Instant, by: Duration) -> Instant {
    at.checked_sub(by).unwrap_or(at)
}

/// Returns the longest part of a wait that no span covers.
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
