//! Check of how much of a work-piece robots hide from a camera, with points, a projection and lines of sight of its own.

use elbowroom_cell::{Cell, CellVirtualRobot, WorkPieceView};
use elbowroom_proximity::Shape;
use elbowroom_sim::{Recording, VirtualRobotSummary, VirtualRobotTrack};
use elbowroom_spatial::Vec3;

use super::arm::Arm;
use super::findings::{Finding, Findings};
use super::frame::Frame;
use super::guarded::Guarded;

/// Instants that are compared, spread over the run: each takes as long as many ticks of the run.
const INSTANTS: usize = 40;
/// Points on the surface of a box.
const POINTS: f64 = 300.0;
/// A line of sight that is nearer to a part than this is hidden, m.
const HIDDEN_M: f64 = 1e-7;
/// Share of the surface in view below which the points of the checked code are too few to be compared.
const LEAST_IN_VIEW: f64 = 0.1;
/// Largest difference of two shares, because of the points.
const TOLERANCE: f64 = 0.15;

/// The arms of a virtual robot at one instant: per arm its links' frames, and its solids.
type Placed<'a> = Vec<(Vec<Frame>, &'a [Guarded])>;

/// Compares the recorded shares with those of a box as a work-piece.
pub fn check(
    cell: &Cell,
    spec: &CellVirtualRobot,
    recording: &Recording,
    track: &VirtualRobotTrack,
    arms: &[Arm],
    findings: &mut Findings,
) {
    let (Some(view), Shape::Cuboid(cuboid)) = (&spec.view, &cell.objects[spec.work_piece.0].shape) else { return };
    let points = box_points(cuboid.half_extents);
    let solids: Vec<Vec<Guarded>> = spec.members.iter().map(|m| Guarded::all(&cell.robots[m.robot.0])).collect();
    let every = track.samples.len().div_ceil(INSTANTS).max(1);
    'samples: for (k, sample) in track.samples.iter().enumerate().step_by(every) {
        let mut placed: Placed<'_> = Vec::new();
        for (m, solids) in spec.members.iter().zip(&solids) {
            // The sample is the end of the tick; the last one has no state.
            let Some(state) = recording.robots[m.robot.0].samples.get(k + 1) else { break 'samples };
            placed.push((arms[m.robot.0].frames(&state.q), solids));
        }
        let (in_view, hidden) = count(view, &points, &Frame::of(&sample.part_in_world), &placed);
        let share = hidden as f64 / in_view.max(1) as f64;
        let is_comparable = in_view as f64 > LEAST_IN_VIEW * POINTS;
        if is_comparable && !sample.hidden_share.is_some_and(|recorded| (recorded - share).abs() <= TOLERANCE) {
            findings.list.push(Finding::WrongView { t_s: sample.t_s, share, recorded: sample.hidden_share });
            return;
        }
    }
    let counts = |share: Option<f64>| share.is_some_and(|share| share > spec.settings.hidden_share);
    let hidden_s = track.samples.iter().filter(|s| counts(s.hidden_share)).count() as f64 * recording.tick_s;
    let told_s = VirtualRobotSummary::new(track, recording.tick_s).view.map(|view| view.hidden_s);
    if !told_s.is_some_and(|told_s| (told_s - hidden_s).abs() < 1e-9) {
        findings.list.push(Finding::WrongView { t_s: hidden_s, share: spec.settings.hidden_share, recorded: told_s });
    }
}

/// Points and outward normals on the faces of a box, as many per face as its area demands.
fn box_points(half: Vec3) -> Vec<(Vec3, Vec3)> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let area = |axis: usize| half[(axis + 1) % 3] * half[(axis + 2) % 3];
    let total: f64 = 2.0 * (0..3).map(area).sum::<f64>();
    let mut points = Vec::new();
    for axis in 0..3 {
        let [u, v] = [1, 2].map(|next| axes[(axis + next) % 3] * half[(axis + next) % 3]);
        let count = (POINTS * area(axis) / total).round() as usize;
        for side in [-1.0, 1.0] {
            let at = |k: usize| {
                let [a, b] = [radical_inverse(k, 2), radical_inverse(k, 3)].map(|x| 2.0 * x - 1.0);
                (axes[axis] * (side * half[axis]) + u * a + v * b, axes[axis] * side)
            };
            points.extend((1..=count).map(at));
        }
    }
    points
}

/// The digits of a number after the point, in reverse order (Halton, 1960).
fn radical_inverse(mut k: usize, base: usize) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while k > 0 {
        digit /= base as f64;
        value += (k % base) as f64 * digit;
        k /= base;
    }
    value
}

/// Numbers of points in view, and of those that the arms hide.
fn count(view: &WorkPieceView, points: &[(Vec3, Vec3)], part: &Frame, arms: &Placed<'_>) -> (usize, usize) {
    let eye = Frame::of(view.visibility.camera().camera_in_world()).at;
    let (mut in_view, mut hidden) = (0, 0);
    for (at, normal) in points {
        let (at, normal) = (part.point(*at), part.vector(*normal));
        if (eye - at).dot(normal) <= 0.0 || !is_in_picture(view, at) {
            continue;
        }
        in_view += 1;
        hidden += usize::from(arms.iter().any(|(frames, solids)| is_hidden(eye, at, frames, solids)));
    }
    (in_view, hidden)
}

fn is_in_picture(view: &WorkPieceView, p: Vec3) -> bool {
    let camera = view.visibility.camera();
    let (lens, frame) = (camera.intrinsics(), Frame::of(camera.camera_in_world()));
    let seen = frame.vector_back(p - frame.at);
    let (x, y) = (seen.x / seen.z, seen.y / seen.z);
    let s = x * x + y * y;
    let [k1, k2, k3] = lens.radial;
    let stretch = 1.0 + k1 * s + k2 * s * s + k3 * s * s * s;
    let (column, row) = (lens.fx * stretch * x + lens.cx, lens.fy * stretch * y + lens.cy);
    seen.z > 0.0 && column.clamp(0.0, lens.width as f64) == column && row.clamp(0.0, lens.height as f64) == row
}

/// Whether the line of sight from a point to the camera meets a part of an arm.
fn is_hidden(eye: Vec3, at: Vec3, frames: &[Frame], solids: &[Guarded]) -> bool {
    let along = eye - at;
    solids.iter().any(|solid| {
        let link = frames[solid.link].at;
        let share = ((link - at).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let near = link.distance(at + along * share) <= solid.radius_m + HIDDEN_M;
        near && solid.is_crossed(frames, [at, eye], HIDDEN_M)
    })
}
