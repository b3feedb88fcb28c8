//! Measurement of every query in every setting, timed one by one.

use std::time::Instant;

use elbowroom_scene::{Checker, CheckerOptions, CheckerStats, Level, Scene, SceneState};

use super::setup::{self, LEFT, RIGHT};

/// The tolerance of the tolerance query, m.
pub const TOLERANCE_M: f64 = 0.05;

/// Kind of query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Query {
    Collision,
    Tolerance,
    Distance,
}

impl Query {
    pub const ALL: [Self; 3] = [Self::Collision, Self::Tolerance, Self::Distance];

    pub fn name(self) -> &'static str {
        match self {
            Self::Collision => "collision",
            Self::Tolerance => "tolerance",
            Self::Distance => "distance",
        }
    }
}

/// Setting in which queries are answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setting {
    /// The coarsest level that may answer.
    pub start: Level,
    pub matrix: bool,
    pub weights: bool,
}

impl Setting {
    /// The setting with everything on.
    pub const FULL: Self = Self { start: Level::L1, matrix: true, weights: true };

    /// Returns all twelve settings.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for start in [Level::L3, Level::L2, Level::L1] {
            for (matrix, weights) in [(false, false), (false, true), (true, false), (true, true)] {
                all.push(Self { start, matrix, weights });
            }
        }
        all
    }

    pub fn levels(self) -> &'static str {
        match self.start {
            Level::L3 => "L3",
            Level::L2 => "L2+L3",
            _ => "L1+L2+L3",
        }
    }

    fn options(self) -> CheckerOptions {
        CheckerOptions { level: Level::Auto, start: self.start, weights: self.weights, matrix: self.matrix }
    }
}

/// Results of one query in one setting over all states.
pub struct Run {
    pub setting: Setting,
    pub query: Query,
    /// Answers per state: metres, or 1 for yes and 0 for no.
    pub answers: Vec<f64>,
    /// Times per query, µs.
    pub times: Times,
    pub counts: CheckerStats,
}

/// Times of one query, µs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    pub mean: f64,
    pub p50: f64,
    pub p99: f64,
}

impl Times {
    fn of(mut nanoseconds: Vec<u64>) -> Self {
        nanoseconds.sort_unstable();
        let at = |share: f64| {
            let index = ((nanoseconds.len() as f64 - 1.0) * share).round() as usize;
            nanoseconds.get(index).map_or(0.0, |ns| *ns as f64 / 1e3)
        };
        let mean = nanoseconds.iter().sum::<u64>() as f64 / nanoseconds.len().max(1) as f64 / 1e3;
        Self { mean, p50: at(0.5), p99: at(0.99) }
    }
}

/// Number of passes over the states, each by a new checker; the least time of each state counts, which excludes most of the
/// load of other programs on the machine.
const PASSES: usize = 3;

/// Makes all passes over the states.
pub fn run(scene: &Scene, states: &[Vec<f64>], setting: Setting, query: Query) -> Result<Run, String> {
    let (mut nanoseconds, answers, counts) = pass(scene, states, setting, query)?;
    for _ in 1..PASSES {
        let (again, _, _) = pass(scene, states, setting, query)?;
        nanoseconds.iter_mut().zip(again).for_each(|(least, ns)| *least = ns.min(*least));
    }
    Ok(Run { setting, query, answers, times: Times::of(nanoseconds), counts })
}

type Pass = (Vec<u64>, Vec<f64>, CheckerStats);

fn pass(scene: &Scene, states: &[Vec<f64>], setting: Setting, query: Query) -> Result<Pass, String> {
    let mut checker = Checker::new(scene, setting.options());
    let mut state = SceneState::new(scene);
    // The first query makes the list of pairs.
    ask(&mut checker, &state, query);
    checker.reset_stats();
    let mut answers = Vec::with_capacity(states.len());
    let mut nanoseconds = Vec::with_capacity(states.len());
    for q in states {
        setup::put(scene, &mut state, q)?;
        let started = Instant::now();
        let answer = ask(&mut checker, &state, query);
        nanoseconds.push(started.elapsed().as_nanos() as u64);
        answers.push(answer);
    }
    Ok((nanoseconds, answers, checker.stats()))
}

fn ask(checker: &mut Checker<'_>, state: &SceneState, query: Query) -> f64 {
    let mut arms = checker.between(RIGHT, LEFT);
    let yes_or_no = |yes: bool| if yes { 1.0 } else { 0.0 };
    match query {
        Query::Collision => yes_or_no(arms.collides(state).is_some()),
        Query::Tolerance => yes_or_no(arms.within(state, TOLERANCE_M).is_some()),
        Query::Distance => arms.distance(state).map_or(f64::NAN, |d| d.metres),
    }
}

/// Counts states whose answer differs from the first run of the same query, and states whose three answers contradict
/// each other.
pub fn disagreements(runs: &[Run]) -> usize {
    let first = |query| runs.iter().find(|run| run.query == query);
    // A NaN is not an answer and equals nothing, not even another NaN.
    let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).filter(|(x, y)| x != y).count();
    let between = runs.iter().filter_map(|run| Some(differ(&first(run.query)?.answers, &run.answers))).sum::<usize>();
    let [Some(hit), Some(near), Some(far)] = Query::ALL.map(first) else { return between };
    let contradicts = |i: &usize| {
        let d = far.answers[*i];
        (hit.answers[*i] > 0.0) != (d <= 0.0) || (near.answers[*i] > 0.0) != (d <= TOLERANCE_M)
    };
    between + (0..far.answers.len()).filter(contradicts).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fake(query: Query, answers: &[f64]) -> Run {
        let (times, counts) = (Times::default(), CheckerStats::default());
        Run { setting: Setting::FULL, query, answers: answers.to_vec(), times, counts }
    }

    #[test]
    fn differing_and_contradicting_answers_are_counted() {
        let runs = |second: &[f64], hit: &[f64]| {
            vec![
                fake(Query::Collision, hit),
                fake(Query::Tolerance, &[1.0, 1.0, 0.0]),
                fake(Query::Distance, &[0.0, 0.02, 0.3]),
                fake(Query::Distance, second),
            ]
        };
        let (same, hit) = ([0.0, 0.02, 0.3], [1.0, 0.0, 0.0]);
        assert_eq!(disagreements(&runs(&same, &hit)), 0);
        assert_eq!(disagreements(&runs(&[0.0, 0.02, 0.300_000_001], &hit)), 1);
        assert_eq!(disagreements(&runs(&[0.0, f64::NAN, 0.3], &hit)), 1);
        assert_eq!(disagreements(&runs(&same, &[1.0, 1.0, 0.0])), 1);
    }

    #[test]
    fn times_are_sorted_before_they_are_read() {
        let times = Times::of((0..100).rev().map(|i| i * 1000).collect());
        assert_eq!((times.p50, times.p99), (50.0, 98.0));
        assert!((times.mean - 49.5).abs() < 1e-9);
    }

    #[test]
    fn a_few_states_give_the_same_answers_in_all_settings() {
        let arm = setup::arm(&crate::workspace_root().unwrap()).unwrap();
        let scene = setup::scene(&arm, 0.6).unwrap();
        let states = setup::states(&arm, 12);
        let mut runs = Vec::new();
        for query in Query::ALL {
            for setting in Setting::all() {
                runs.push(run(&scene, &states, setting, query).unwrap());
            }
        }
        assert_eq!(disagreements(&runs), 0);
    }
}
