//! Two arms of seven links, and their poses.

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;
use std::f64::consts::PI;
use std::path::Path;

use crate::files::{Outcome, rounded, write_mesh, write_poses};
use crate::surfaces::Tube;

pub const LINKS: usize = 7;
/// Metres between the bases, as in the file names.
pub const DISTANCES: [&str; 5] = ["0.6", "1.0", "1.4", "1.8", "2.2"];
const STATES: usize = 5000;
const HARD: usize = 2000;

/// Rings and sectors of each link: 23,012 triangles in all.
const GRID: [[usize; 2]; LINKS] = [[50, 36], [50, 36], [60, 40], [56, 36], [40, 32], [40, 32], [31, 30]];
/// Offsets from one joint to the next, metres; the last from the sixth joint to the tip.
const STEPS: [[f64; 3]; LINKS] = [
    [0.0, 0.0, 0.13],
    [0.0, 0.08, 0.07],
    [0.0, -0.03, 0.35],
    [0.0, -0.02, 0.19],
    [0.0, 0.0, 0.15],
    [0.0, 0.03, 0.07],
    [0.0, 0.0, 0.07],
];
/// Radius of each link at its beginning, metres.
const RADII: [f64; LINKS + 1] = [0.078, 0.062, 0.052, 0.044, 0.04, 0.037, 0.03, 0.028];
/// Axis of each joint (1 is y, 2 is z) and largest turn in either direction, radians.
const JOINTS: [(usize, f64); LINKS - 1] = [(2, PI), (1, 2.2), (1, 2.4), (2, PI), (1, 2.0), (2, PI)];

pub fn generate(folder: &Path) -> Outcome<()> {
    let mut random = SplitMix(7);
    let mut boxes = Vec::new();
    for link in 0..LINKS {
        let mesh = link_mesh(link, &mut random)?;
        write_mesh(&folder.join(format!("robot_link{link}.stl")), &mesh)?;
        boxes.push(*mesh.aabb());
    }
    for name in DISTANCES {
        let apart: f64 = name.parse().map_err(|e| format!("{name}: {e}"))?;
        let all: Vec<Pose> = (1..=STATES).flat_map(|n| two_arms(n, apart)).collect();
        write_poses(&folder.join(format!("robots_{name}.pose")), 2 * LINKS, &all)?;
    }
    let overlapping = |poses: &[Pose; 2 * LINKS]| {
        let placed: [_; 2 * LINKS] = std::array::from_fn(|k| boxes[k % LINKS].transformed(&poses[k]));
        placed[..LINKS].iter().any(|a| placed[LINKS..].iter().any(|b| a.overlaps(b)))
    };
    let hard: Vec<Pose> = (1..).map(|n| two_arms(n, 0.6)).filter(overlapping).take(HARD).flatten().collect();
    write_poses(&folder.join("robots_hard.pose"), 2 * LINKS, &hard)
}

fn link_mesh(link: usize, random: &mut SplitMix) -> Outcome<TriMesh> {
    let [rings, sectors] = GRID[link];
    let (step, from, to) = (Vec3::from(STEPS[link]), RADII[link], RADII[link + 1]);
    let direction = step.try_normalize().unwrap_or(Vec3::Z);
    // The ends extend beyond the joints, so that neighbours overlap as castings do.
    let axis = |s: f64| {
        let bend = Vec3::X * (0.25 * from * (PI * s).sin());
        step * s + bend + direction * ((s - 1.0) * from * 0.8 + s * to * 0.8)
    };
    let radius = |s: f64| (from + (to - from) * s) * (0.85 + 0.15 * (2.0 * PI * s).cos());
    let flanges = [[0.16, 0.05, 0.09 * from], [0.84, 0.05, 0.09 * to]];
    let tube = Tube { axis: &axis, radius: &radius, flanges: &flanges, ripple: 0.35, rings, sectors };
    rounded(&tube.surface(random))
}

/// Equidistributed configurations, by the additive recurrence of the generalized golden ratio in twelve dimensions
/// (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn two_arms(n: usize, apart: f64) -> [Pose; 2 * LINKS] {
    const AXES: usize = 2 * JOINTS.len();
    // The root of x¹³ = x + 1.
    let golden = (0..60).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / (AXES as f64 + 1.0)));
    let q: [f64; AXES] = std::array::from_fn(|k| {
        let share = (0.5 + n as f64 / golden.powf(k as f64 + 1.0)).fract();
        (2.0 * share - 1.0) * JOINTS[k % JOINTS.len()].1
    });
    let mut poses = [Pose::IDENTITY; 2 * LINKS];
    for arm in 0..2 {
        let mut joint = Pose::from_translation(Vec3::X * (arm as f64 * apart));
        for link in 0..LINKS {
            if link > 0 {
                let axis = if JOINTS[link - 1].0 == 1 { Vec3::Y } else { Vec3::Z };
                let turn = Rotation::from_axis_angle(axis, q[arm * JOINTS.len() + link - 1]);
                joint.rotation = joint.rotation * turn;
            }
            poses[arm * LINKS + link] = joint;
            joint.translation = joint.transform_point(Vec3::from(STEPS[link]));
        }
    }
    poses
}
