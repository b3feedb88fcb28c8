//! Recall, position error and swapped identities on rendered sequences with noise, shadows, drifting light, objects
//! that touch and separate, and an arm over them; prints one table.
//!
//! `cargo bench -p elbowroom-vision --bench tracking_quality`

#![expect(clippy::print_stdout, reason = "a program for people")]

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::{RenderConditions, RenderedSolid};
use elbowroom_vision::{
    ArmPart, CameraTrackerSettings, Channels, ObstacleChange, ObstacleId, Point2, ShadowSettings, Template,
    TrackSettings, polygon,
};
use synthetic::{SyntheticScene, cover_together, median, middle};

const CRATE: Vec3 = Vec3::new(0.6, 0.4, 0.3);
const FRAMES: u32 = 200;
const SEEDS: u64 = 5;

/// A sequence: objects, illumination and arm at a time from 0 to 1.
struct Sequence {
    name: &'static str,
    solids: fn(f64) -> Vec<RenderedSolid>,
    conditions: fn(f64) -> RenderConditions,
    arm: Option<fn(f64) -> ArmPart>,
    shadows: bool,
}

/// Results of a sequence.
#[derive(Default)]
struct Count {
    wanted: usize,
    covered: usize,
    false_alarms: usize,
    swaps: usize,
    errors_m: Vec<f64>,
    /// Ratios of reported area to true area.
    areas: Vec<f64>,
}

fn main() {
    println!(
        "{FRAMES} frames of 640 x 480, grey, {SEEDS} seeds of the noise; camera 4 m above the floor, a pixel is 7.7 mm"
    );
    println!(
        "{:34} {:>13} {:>8} {:>9} {:>9} {:>6} {:>6}",
        "sequence", "recall", "false", "place mm", "worst mm", "area", "swaps"
    );
    for sequence in sequences() {
        let mut count = Count::default();
        for seed in 1..=SEEDS {
            run(&sequence, seed, &mut count);
        }
        // An object together with its shadow matches no template.
        count.errors_m.extend(count.errors_m.is_empty().then_some(f64::NAN));
        let worst = count.errors_m.iter().copied().fold(f64::NAN, f64::max);
        println!(
            "{:34} {:>6}/{:<6} {:>8} {:9.1} {:9.1} {:6.2} {:6}",
            sequence.name,
            count.covered,
            count.wanted,
            count.false_alarms,
            median(&mut count.errors_m) * 1e3,
            worst * 1e3,
            median(&mut count.areas),
            count.swaps
        );
    }
    println!(
        "recall: fully visible objects whose footprint and height lie within the obstacles; false: obstacles that no \
         object is near; place: error of the centre where a template matches; area: reported over true, inflated by {:.0} mm",
        (TrackSettings::default().uncertainty_m + TrackSettings::default().hysteresis_m) * 1e3
    );
}

fn run(sequence: &Sequence, seed: u64, count: &mut Count) {
    let settings = CameraTrackerSettings {
        templates: vec![Template::new("crate", 0.6, 0.4, 0.3), Template::cylinder("drum", 0.5, 0.6)],
        shadows: sequence.shadows.then(ShadowSettings::default),
        ..CameraTrackerSettings::default()
    };
    let mut scene = SyntheticScene::with_camera(synthetic::camera(640, 480), Channels::Grey, settings);
    let mut ids: Vec<Option<ObstacleId>> = Vec::new();
    for i in 0..FRAMES {
        let t = f64::from(i) / f64::from(FRAMES - 1);
        let solids = (sequence.solids)(t);
        ids.resize(solids.len(), None);
        let noise = scene.conditions.seed.max(seed * 1000);
        scene.conditions = RenderConditions { seed: noise, ..(sequence.conditions)(t) };
        let arm: Vec<ArmPart> = sequence.arm.map(|arm| arm(t)).into_iter().collect();
        let report = scene.step_with_arm(&solids, &arm);
        let reported: Vec<_> = report.obstacles.iter().filter(|o| o.change != ObstacleChange::Left).cloned().collect();
        for (solid, known) in solids.iter().zip(&mut ids) {
            let in_view = |p: &Point2| (-1.75..2.15).contains(&p.x) && (-1.55..1.0).contains(&p.y);
            if !solid.footprint_m.iter().all(in_view) {
                continue;
            }
            count.wanted += 1;
            count.covered += usize::from(cover_together(&reported, solid));
            let far = |o: &&elbowroom_vision::Obstacle| (o.centre_m - middle(solid)).length();
            let Some(mine) = reported.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else { continue };
            if mine.kind.is_some() && !mine.is_unobserved {
                count.errors_m.push(far(&mine));
            }
            if !mine.is_unobserved {
                count.areas.push(polygon::area(&mine.footprint_m) / polygon::area(&solid.footprint_m));
            }
            count.swaps += usize::from(known.is_some_and(|id| id != mine.id));
            *known = Some(mine.id);
        }
        let is_near = |o: &&elbowroom_vision::Obstacle| solids.iter().any(|s| (middle(s) - o.centre_m).length() < 1.0);
        count.false_alarms += reported.iter().filter(|o| !is_near(o)).count();
    }
}

fn crossing(t: f64) -> Vec<RenderedSolid> {
    let x = -2.6 + 5.2 * t;
    vec![RenderedSolid::cuboid(Point2::new(x, -0.2 + 0.1 * x), CRATE, 3.0 * t, 210)]
}

/// Two crates touch, stay together for a while and separate.
fn meeting(t: f64) -> Vec<RenderedSolid> {
    let gap = 0.6 + 0.8 * ((t - 0.5).abs() * 2.0 - 0.25).max(0.0);
    let at = |x: f64| Point2::new(0.2 + x, -0.3);
    vec![RenderedSolid::cuboid(at(-gap / 2.0), CRATE, 0.0, 205), RenderedSolid::cuboid(at(gap / 2.0), CRATE, 0.0, 215)]
}

/// Two crates pass side by side, nearly touching.
fn passing(t: f64) -> Vec<RenderedSolid> {
    let x = 2.4 * (t - 0.5);
    vec![
        RenderedSolid::cuboid(Point2::new(0.2 + x, -0.1), CRATE, 0.0, 205),
        RenderedSolid::cuboid(Point2::new(0.2 - x, -0.51), CRATE, 0.0, 205),
    ]
}

fn plain(_: f64) -> RenderConditions {
    RenderConditions::default()
}

fn sequences() -> Vec<Sequence> {
    let sequence = |name, solids, conditions| Sequence { name, solids, conditions, arm: None, shadows: false };
    let noisy: fn(f64) -> RenderConditions = |_| RenderConditions { noise: 5.0, ..RenderConditions::default() };
    let drifting: fn(f64) -> RenderConditions = |t| RenderConditions {
        gain: 1.0 + 0.35 * (t * 9.0).sin(),
        offset: 15.0 * (t * 5.0).sin(),
        slope: 0.15 * t,
        ..RenderConditions::default()
    };
    let lit: fn(f64) -> RenderConditions =
        |_| RenderConditions { light: Some(Vec3::new(0.9, 0.3, -1.0)), ..RenderConditions::default() };
    let sweep: fn(f64) -> ArmPart = |t| ArmPart::Capsule {
        from: Vec3::new(0.2, 1.6, 1.2),
        to: Vec3::new(0.2 + 1.5 * (6.0 * t).sin(), -0.6, 0.9),
        radius_m: 0.12,
    };
    vec![
        sequence("a crate crosses, turning", crossing, plain),
        sequence("… noise of 5 grey levels", crossing, noisy),
        sequence("… light drifts by ±35 %, ±15 levels", crossing, drifting),
        Sequence { shadows: true, ..sequence("… shadows, detection on", crossing, lit) },
        sequence("… shadows, detection off", crossing, lit),
        Sequence { arm: Some(sweep), ..sequence("… the arm sweeps over it", crossing, plain) },
        sequence("two crates touch and separate", meeting, plain),
        sequence("… noise of 5 grey levels", meeting, noisy),
        sequence("two crates pass side by side", passing, plain),
    ]
}
