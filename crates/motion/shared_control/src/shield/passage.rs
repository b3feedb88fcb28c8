//! Whether a tool passes the opening of a shield.

use elbowroom_proximity::ccd::{CcdOptions, ConstantTwist, time_of_impact};
use elbowroom_proximity::{Shape, project_point, tessellate::tessellate};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::generate::Shield;
use super::settings::ShieldSettings;

/// Turns of the tool about its axis that are tried.
const TURNS: usize = 12;
/// Largest number of points of the target at which the tool is tried, evenly spread.
const MOST_POINTS: usize = 200;
/// Heights above a point of the target at which the width of the opening is measured.
const WIDTH_HEIGHTS: usize = 3;
/// Directions across the axis in which the width is measured, over half a turn.
const WIDTH_DIRECTIONS: usize = 8;
/// Most steps to a wall.
const WIDTH_STEPS: usize = 64;
/// Chord error of curved tools, metres.
const TOOL_CHORD_M: f64 = 1e-4;

/// How a tool fits an opening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Smallest width of the opening above the protected surface, metres.
    pub narrowest_m: f64,
    /// Largest width of the part of the tool that enters the opening, metres.
    pub tool_width_m: f64,
    /// A point of the target that the tool does not reach, in the frame of the protected mesh; `None` if it reaches
    /// all that were tried.
    pub blocked_at: Option<Vec3>,
}

impl Shield {
    /// Smallest width of the opening along the whole target, between the protected surface and the shield, metres; at most
    /// four times the width at its ground.
    pub fn narrowest_m(&self, settings: &ShieldSettings) -> f64 {
        let shield = Shape::Mesh(self.mesh.clone());
        let most_m = 2.0 * settings.width_m;
        let step = self.passage.len().div_ceil(MOST_POINTS).max(1);
        let width = |(foot, axis): &(Vec3, Vec3)| {
            // The ground of a shallow opening may be as high as the tolerance.
            let lowest = settings.tolerance_m.min(settings.offset_m);
            let share = |k: usize| k as f64 / (WIDTH_HEIGHTS - 1) as f64;
            let heights = (0..WIDTH_HEIGHTS).map(|k| lowest + (settings.offset_m - lowest) * share(k));
            heights.map(|z| chord_m(&shield, *foot + *axis * z, *axis, most_m)).fold(f64::INFINITY, f64::min)
        };
        self.passage.iter().step_by(step).map(width).fold(f64::INFINITY, f64::min)
    }

    /// Tries the tool along the axis of the opening at points of the target, at the full depth less the tolerance.
    ///
    /// The z axis of the tool point looks into the solid, and twelve turns about it are tried. What counts is the shield
    /// alone, not the arm behind the tool.
    pub fn passage_of(&self, tool: &Shape, tool_in_tcp: &Pose, settings: &ShieldSettings) -> Passage {
        let step = self.passage.len().div_ceil(MOST_POINTS).max(1);
        let blocked = |(foot, axis): &&(Vec3, Vec3)| !self.admits(tool, tool_in_tcp, (*foot, *axis), settings);
        Passage {
            narrowest_m: self.narrowest_m(settings),
            tool_width_m: width_at_tip(tool, tool_in_tcp, settings.depth_m + settings.offset_m),
            blocked_at: self.passage.iter().step_by(step).find(blocked).map(|(foot, _)| *foot),
        }
    }

    fn admits(&self, tool: &Shape, tool_in_tcp: &Pose, (foot, axis): (Vec3, Vec3), settings: &ShieldSettings) -> bool {
        let shield = Shape::Mesh(self.mesh.clone());
        // The ground of a shallow opening may be above the surface by the tolerance.
        let ground = foot - axis * (settings.depth_m - settings.tolerance_m).max(-settings.offset_m);
        // From outside of the shield's box, wherever the tool's point is.
        let bounds = tool.aabb(tool_in_tcp);
        let reach = bounds.min.length().max(bounds.max.length());
        let way = axis * (self.mesh.aabb().extent().length() + reach + (foot - ground).length());
        let down = Rotation::from_z(-axis);
        let options = CcdOptions { tolerance: 1e-6, ..CcdOptions::default() };
        (0..TURNS).any(|k| {
            let turn = Rotation::from_axis_angle(Vec3::Z, std::f64::consts::TAU * k as f64 / TURNS as f64);
            let start = Pose::new(down * turn, ground + way) * *tool_in_tcp;
            let motion = ConstantTwist::linear(start, -way);
            time_of_impact(tool, &motion, &shield, &Pose::IDENTITY, &options).is_none()
        })
    }
}

/// The shortest chord of the free space around a point across an axis, metres. It is at most twice `most_m`; 0 inside.
fn chord_m(shield: &Shape, point: Vec3, axis: Vec3, most_m: f64) -> f64 {
    let (u, v) = (axis.any_perpendicular(), axis.cross(axis.any_perpendicular()));
    let wall = |direction: Vec3| {
        // Sphere tracing: nothing is nearer than the distance.
        let mut gone = 0.0;
        for _ in 0..WIDTH_STEPS {
            let free = project_point(shield, &Pose::IDENTITY, point + direction * gone).signed_distance;
            gone += free.max(0.0);
            if free < 1e-3 * most_m || gone > most_m {
                break;
            }
        }
        gone.min(most_m)
    };
    let chords = (0..WIDTH_DIRECTIONS).map(|k| {
        let (sin, cos) = (std::f64::consts::PI * k as f64 / WIDTH_DIRECTIONS as f64).sin_cos();
        let direction = u * cos + v * sin;
        wall(direction) + wall(-direction)
    });
    chords.fold(f64::INFINITY, f64::min)
}

/// Twice the largest distance from the tool's axis among the points of the tool up to `length_m` behind its tip, metres.
fn width_at_tip(tool: &Shape, tool_in_tcp: &Pose, length_m: f64) -> f64 {
    let (vertices, triangles) = tessellate(tool, TOOL_CHORD_M);
    let in_tcp: Vec<Vec3> = vertices.iter().map(|p| tool_in_tcp.transform_point(*p)).collect();
    let mut widest: f64 = 0.0;
    for t in &triangles {
        for k in 0..3 {
            let (p, q) = (in_tcp[t[k] as usize], in_tcp[t[(k + 1) % 3] as usize]);
            // The part of the edge in front of the plane.
            let (behind_p, behind_q) = (-length_m - p.z, -length_m - q.z);
            if behind_p <= 0.0 {
                widest = widest.max(p.x.hypot(p.y));
            }
            if (behind_p > 0.0) != (behind_q > 0.0) {
                let cut = p.lerp(q, behind_p / (behind_p - behind_q));
                widest = widest.max(cut.x.hypot(cut.y));
            }
        }
    }
    2.0 * widest
}
