//! The thickness given by `check` is sufficient: cells without the stopping-distance law, with exactly that thickness,
//! are never entered.

use std::fmt::Write;

use crate::common::{HEAD, rail};
use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_proximity::{penetration, within};
use elbowroom_sim::check::{check, overruns};
use elbowroom_sim::{PlannedPaths, Recording, RunOptions, simulate};
use proptest::prelude::*;

/// The law approaches the border asymptotically, so the distance is rounded to 0 in the end.
const ROUNDING_M: f64 = 1e-6;

/// Number of random settings: a hundred with `ELBOWROOM_LONG=1`.
fn cases() -> u32 {
    elbowroom_testkit::extent::amount(25, 100)
}

/// A random robot, program and region.
#[derive(Debug, Clone)]
struct Setting {
    /// Joints: prismatic or not, offset (mm), target (fraction of the range, -1..1).
    joints: Vec<(bool, f64, f64)>,
    acceleration_s: f64,
    stop_s: f64,
    tick_ms: u32,
    programmed: u32,
    /// Position of the region on the path of the tip (fraction), and its radius (mm).
    met_at: f64,
    radius: f64,
    linear: bool,
    /// Reaction time, ms; 0 if the file states none.
    reaction_ms: u32,
    /// 1/s; 0 for no limit.
    override_rate: f64,
    direction_aware: bool,
    /// Moves before the last one: fraction of its travel, speed (%), programmed override (%).
    before: Vec<(f64, u32, u32)>,
}

fn settings() -> impl Strategy<Value = Setting> {
    let joint = (any::<bool>(), 200.0..600.0, prop_oneof![-1.0..-0.3, 0.3..1.0]);
    let times = (0.1..0.5_f64, 0.05..1.0_f64, 1..=8_u32, 30..=100_u32);
    let place = (0.3..0.95_f64, 40.0..200.0, any::<bool>());
    let delay = (prop_oneof![Just(0), 0..=60_u32], prop_oneof![2 => Just(0.0), 1 => 0.5..20.0], any::<bool>());
    let before = prop::collection::vec((-0.3..0.9_f64, 10..=100_u32, 30..=100_u32), 0..3);
    (prop::collection::vec(joint, 1..4), times, place, delay, before).prop_map(
        |(
            joints,
            (acceleration_s, stop_s, tick_ms, programmed),
            (met_at, radius, linear),
            (reaction_ms, override_rate, direction_aware),
            before,
        )| Setting {
            joints,
            acceleration_s,
            stop_s,
            tick_ms,
            programmed,
            met_at,
            radius,
            linear,
            reaction_ms,
            override_rate,
            direction_aware,
            before,
        },
    )
}

impl Setting {
    /// The cell, with a region at `centre` (m) and a warning zone of `warning` (m).
    fn text(&self, centre: [f64; 3], warning: f64) -> String {
        let mut dh = String::new();
        let (mut speeds, mut accelerations) = (Vec::new(), Vec::new());
        for (slides, offset, _) in &self.joints {
            let (kind, min, max, speed) =
                if *slides { ("prismatic", -1500, 1500, 1500.0) } else { ("revolute", -170, 170, 150.0) };
            let _ = write!(dh, "{{ kind = \"{kind}\", a = {offset}, alpha = 90, min = {min}, max = {max} }}, ");
            speeds.push(speed);
            accelerations.push(speed / self.acceleration_s);
        }
        let capsule = |(_, offset, _): &(bool, f64, f64)| {
            format!("{{ capsule = {{ from = [0, 0, 0], to = [{}, 0, 0], radius = 40 }} }}", -offset)
        };
        let links: Vec<String> = self.joints.iter().map(capsule).collect();
        let to: Vec<f64> =
            self.joints.iter().map(|(slides, _, share)| share * if *slides { 1400.0 } else { 160.0 }).collect();
        let kind = if self.linear { "linear" } else { "joint" };
        // A linear move is programmed faster than the joints permit: they then move at their limits.
        let speed = if self.linear { ", speed = 3000" } else { "" };
        let mm = centre.map(|m| m * 1000.0);
        let mut steps = String::new();
        for (share, speed, programmed) in &self.before {
            let to: Vec<f64> = to.iter().map(|v| v * share).collect();
            let _ =
                write!(steps, "{{ override = {programmed} }}, {{ move = \"joint\", to = {to:?}, speed = {speed} }}, ");
        }
        let reaction =
            if self.reaction_ms > 0 { format!("reaction_ms = {}\n", self.reaction_ms) } else { String::new() };
        format!(
            "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\ntick_ms = {}\nmax_s = 20\n\
             [monitor]\ndirection_aware = {}\noverride_rate = {}\n{reaction}[robot.a]\ndh = [{dh}]\n\
             links = [{}]\nspeed = {speeds:?}\nacceleration = {accelerations:?}\nstop_time = {}\n\
             [region.z]\nshape = \"sphere\"\ncentre = {mm:?}\nradius = {}\nwarning = {}\n\
             [program.a]\nsteps = [{steps}{{ override = {} }}, {{ move = \"{kind}\", to = {to:?}{speed} }}]\n",
            self.tick_ms,
            self.direction_aware,
            self.override_rate,
            links.join(", "),
            self.stop_s,
            self.radius,
            warning * 1000.0,
            self.programmed,
        )
    }

    /// The TCP at the fraction `met_at` of its unmonitored path; `None` if the program is infeasible.
    fn place(&self) -> Option<[f64; 3]> {
        let cell = Cell::parse("c.toml", &self.text([90.0, 0.0, 0.0], 0.001)).ok()?;
        let run = simulate(&cell, &RunOptions { apply_override: false, ..RunOptions::default() }).ok()?.recording;
        let samples = &run.robots[0].samples;
        Some(samples[(samples.len() as f64 * self.met_at) as usize].tcp.to_array())
    }
}

/// Largest penetration depth (m) of a guarded volume in the region at any tick.
fn deepest(cell: &Cell, run: &Recording) -> f64 {
    let (robot, region) = (&cell.robots[0], &cell.regions[0].region);
    let volumes = robot.guarded_volumes();
    let region_in_world = region.anchor * region.shape_in_anchor;
    let mut state = ChainState::new(&robot.robot.chain);
    let mut deepest = 0.0_f64;
    for sample in &run.robots[0].samples {
        state.q.copy_from_slice(&sample.q);
        robot.robot.chain.forward(&mut state);
        for v in &volumes {
            let in_world = robot.base_in_world * state.link_in_root(v.link) * v.in_link;
            if within(&v.shape, &in_world, &region.shape, &region_in_world, 0.0) {
                let out = penetration(&v.shape, &in_world, &region.shape, &region_in_world);
                deepest = deepest.max(out.map_or(0.0, |out| out.depth));
            }
        }
    }
    deepest
}

/// The cell with exactly the given thickness; `None` if the program is infeasible.
fn with_named_thickness(setting: &Setting) -> Option<(String, f64)> {
    let centre = setting.place()?;
    let cell = Cell::parse("c.toml", &setting.text(centre, 0.001)).unwrap();
    let needed = check(&cell).unwrap()[0].needed_warning_m.unwrap();
    Some((setting.text(centre, needed.max(0.001)), needed))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), ..ProptestConfig::default() })]

    #[test]
    fn the_computed_thickness_is_sufficient(setting in settings()) {
        let Some((text, needed)) = with_named_thickness(&setting) else { return Ok(()) };
        let cell = Cell::parse("c.toml", &text).unwrap();
        let answer = &check(&cell).unwrap()[0];
        prop_assume!(!answer.reason.contains("starts inside"));
        if !answer.excluded {
            // Only the release of leaving robots may prevent the exclusion.
            prop_assert!(setting.direction_aware && answer.reason.contains("`direction_aware` permits"), "{}\n{text}", answer.reason);
            prop_assert!(answer.write_instead.as_ref().unwrap().contains("stopping_distance = true"));
            return Ok(());
        }
        prop_assert!(overruns(&PlannedPaths::new(&cell)).unwrap().is_empty(), "{text}");
        let run = simulate(&cell, &RunOptions::default()).unwrap().recording;
        let deep = deepest(&cell, &run);
        prop_assert!(deep < ROUNDING_M, "needed {needed} m, but it was entered by {deep} m:\n{text}");
    }
}

/// A thick warning zone excludes entry along the program's path, not along a path that the robot plans around what a
/// sensor sees.
#[test]
fn the_zone_of_a_robot_that_plans_around_obstacles_is_never_thick_enough() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("clouds")).unwrap();
    let cloud = "[cloud.mast]\npose = { at = [0, 0, 3000], rpy = [180, 0, 0] }\narea = [[-900, -900], [900, -900], [0, 900]]\n\
                 clouds = \"clouds\"\nrobots = [\"a\"]\n";
    let of = |cloud: &str, laws: &str, to: i32| {
        let text = format!(
            "{HEAD}{}start = [-1500]\n[region.ball]\nshape = \"sphere\"\ncentre = [0, 400, 0]\nradius = 100\nwarning = 3000\n\
             robots = [\"a\"]\n[monitor]\nstopping_distance = {laws}\n{cloud}\
             [program.a]\nsteps = [{{ move = \"joint\", to = [{to}] }}]\n",
            rail("a", 0.0)
        );
        let cell = Cell::parse(dir.path().join("cell.toml"), &text).unwrap_or_else(|e| panic!("{e}"));
        (check(&cell).unwrap()[0].clone(), overruns(&PlannedPaths::new(&cell)).unwrap())
    };
    assert!(of("", "false", 1500).0.excluded);
    let (answer, warnings) = of(cloud, "false", 1500);
    assert!(!answer.excluded && answer.reason.contains("around what sensors see"), "{}", answer.reason);
    assert!(answer.write_instead.unwrap().contains("stopping_distance = true") && warnings.len() == 1);
    // A program that does not move the part does not determine another path.
    assert!(of("", "false", -1500).0.excluded && !of(cloud, "false", -1500).0.excluded);
    let (answer, warnings) = of(cloud, "true", 1500);
    assert!(answer.excluded && warnings.is_empty(), "{}", answer.reason);
}
