//! Random cells with robots that play recordings, or repeat their programs.

use super::settings::{Places, laws, settings};
use super::{moving, rail, region, robot};
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{
    CellSpec, DhRow, Model, RecordingLayout, RecordingSpec, RegionSpec, RobotSpec, StepSpec,
};

/// Largest number of rows of a recording.
const MOST_ROWS: usize = 3000;

/// Makes a cell with forbidden regions near a recording, or near a program that runs several times.
pub fn cell(random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = CellSpec { max_s: 12.0, ..settings(random) };
    laws(&mut spec, random);
    let mut one = if random.percent(30) { rail::slide(random) } else { robot::jointed(random) };
    if random.percent(70)
        && let Model::Dh { rows, .. } = &one.model
    {
        let harder = if random.percent(50) { 0.8 } else { random.scaled(0.3, 4.0) };
        let recorded = recording(&one, rows, harder, random);
        play(&mut one, recorded);
    }
    match random.whole(0, 3) {
        0 => one.program.repeat = 2,
        1 => spec.repeat = random.whole(2, 3) as u32,
        _ => {}
    }
    if random.percent(25) {
        return way_back(spec, random, places);
    }
    spec.robots.push(one);
    let regions = random.whole(1, 3);
    let mut spec = with_regions(spec, places, regions, |_, _| {}, random);
    moving::some(&mut spec, random);
    spec
}

/// Makes a slow recording, and puts a region on the faster way back from its end to its start, with a zone that is
/// thick enough for the recording alone.
fn way_back(spec: CellSpec, random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = CellSpec { max_s: 40.0, stopping_distance: false, direction_aware: false, repeat: 2, ..spec };
    // With a single move the way back equals the way there.
    let moves = |r: &RobotSpec| r.program.steps.iter().filter(|s| matches!(s, StepSpec::Joint { .. })).count();
    let mut one = robot::jointed(random);
    while moves(&one) < 2 {
        one = robot::jointed(random);
    }
    let share = random.scaled(0.08, 0.5);
    if let Model::Dh { rows, .. } = &one.model {
        let slow = recording(&one, rows, share, random);
        play(&mut one, slow);
    }
    spec.robots.push(one);
    with_regions(spec, places, 1, |region, random| region.warning = random.scaled(0.01, 0.15), random)
}

fn play(robot: &mut RobotSpec, recording: RecordingSpec) {
    robot.start.clone_from(&recording.rows[0].1);
    (robot.program.steps, robot.program.recording) = (Vec::new(), Some(recording));
}

fn with_regions(
    mut spec: CellSpec,
    places: &Places<'_>,
    count: usize,
    change: impl Fn(&mut RegionSpec, &mut Random),
    random: &mut Random,
) -> CellSpec {
    let Ok(cell) = spec.parse(places.cells) else { return spec };
    for i in 0..count {
        let mut region = region::on_the_path(&spec, &cell, &format!("g{i}"), random);
        if let Some(region) = &mut region {
            change(region, random);
        }
        spec.regions.extend(region);
    }
    spec
}

/// Makes a recording of the robot's moves; it may exceed the joints' stated limits, and begin or end in motion.
fn recording(robot: &RobotSpec, joints: &[DhRow], harder: f64, random: &mut Random) -> RecordingSpec {
    let period_s = random.one(&[0.002, 0.004, 0.01, 0.02, 0.05]);
    let is_smooth = random.percent(75);
    let mut rows = vec![(0.0, robot.start.clone())];
    for step in &robot.program.steps {
        let (StepSpec::Joint { to, .. } | StepSpec::Linear { to, .. }) = step else { continue };
        let (begin_s, from) = rows[rows.len() - 1].clone();
        let duration_s =
            from.iter().zip(to).zip(joints).map(|((a, b), j)| duration(b - a, j)).fold(0.02, f64::max) / harder;
        // The joints move in straight lines between rows, or by a polynomial without jumps of the acceleration.
        let count =
            if is_smooth { ((duration_s / period_s) as usize).clamp(4, MOST_ROWS / 4) } else { random.whole(1, 4) };
        for i in 1..=count {
            let share = i as f64 / count as f64;
            let s = if is_smooth { share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share) } else { share };
            let q = from.iter().zip(to).map(|(a, b)| a + (b - a) * s).collect();
            rows.push((rounded_time(begin_s + duration_s * share), q));
        }
    }
    if random.percent(35) {
        let first = rows.len() * random.whole(5, 45) / 100;
        rows.drain(..first.min(rows.len().saturating_sub(2)));
    }
    if random.percent(25) {
        rows.truncate((rows.len() * random.whole(50, 95) / 100).max(2));
    }
    let begin_s = rows[0].0;
    for (t_s, _) in &mut rows {
        *t_s = rounded_time(*t_s - begin_s);
    }
    let mut recording = RecordingSpec { rows, layout: None };
    if random.percent(50) {
        let layout = layout(joints, random);
        if let Some(period_ms) = layout.period_ms {
            recording.rows = every(period_ms / 1000.0, &recording.rows);
        }
        recording.layout = Some(layout);
    }
    recording
}

/// Chooses how the file of a recording says its rows.
fn layout(joints: &[DhRow], random: &mut Random) -> RecordingLayout {
    RecordingLayout {
        slides: joints.iter().map(|j| j.slides).collect(),
        in_degrees: random.percent(50),
        length: random.one(&[("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254)]),
        time_unit: random.one(&[("s", 1.0), ("ms", 1e-3), ("us", 1e-6)]),
        renames: random.percent(50),
        separator: random.one(&[',', ';', '\t']),
        offset_s: if random.percent(50) { random.between(0.05, 1.5) } else { 0.0 },
        period_ms: random.percent(40).then(|| random.one(&[4.0, 8.0, 12.0, 40.0])),
    }
}

/// Returns rows at equal times, on the straight lines between these rows.
fn every(period_s: f64, rows: &[(f64, Vec<f64>)]) -> Vec<(f64, Vec<f64>)> {
    let end_s = rows[rows.len() - 1].0;
    let count = ((end_s / period_s) as usize).clamp(1, MOST_ROWS);
    let at = |i: usize| {
        let t_s = i as f64 * period_s;
        let next = rows.partition_point(|row| row.0 <= t_s).clamp(1, rows.len() - 1);
        let ((t0, a), (t1, b)) = (&rows[next - 1], &rows[next]);
        let share = ((t_s - t0) / (t1 - t0)).clamp(0.0, 1.0);
        (t_s, a.iter().zip(b).map(|(a, b)| a + (b - a) * share).collect())
    };
    (0..=count).map(at).collect()
}

/// Returns the time (s) that a joint needs for the polynomial by its speed and acceleration.
fn duration(way: f64, joint: &DhRow) -> f64 {
    (1.875 * way.abs() / joint.speed).max((5.78 * way.abs() / joint.acceleration).sqrt())
}

/// Rounds a time to a microsecond.
fn rounded_time(t_s: f64) -> f64 {
    rounded(t_s * 100.0) / 100.0
}
