//! Pairs that no joint values within the limits bring together: proven, not sampled.
//!
//! First by balls: whatever a link does, it stays in a ball around its first moving joint. Then, for pairs that few
//! joints move against each other, by branch and bound over the joint values: at the middle of a cell the solids are
//! measured; no point moves farther on the way to the cell's rim than the levers times the cell's half widths; so where
//! the solids are farther apart than that, the whole cell is clear, and where not, the cell is split.

use elbowroom_kinematics::{Chain, JointId, JointKind};
use elbowroom_proximity::{Shape, Sphere, separation_within};
use elbowroom_spatial::{Pose, Vec3};

use super::{PairMatrix, PairState, Reason};
use crate::checker::narrow::{Narrow, Placed};
use crate::model::Solid;
use crate::pairs::{joints_between, motion_bound};
use crate::{Level, Member, Scene, SceneState};

/// Clearance (m) beyond the margin that is asked for, so that rounding of poses cannot matter.
const CLEARANCE: f64 = 1e-3;
/// Joints that branch and bound goes over, at most.
const JOINTS: usize = 3;
/// Cells that one pair may take.
const CELLS: usize = 4000;

/// Marks what is proven out of reach.
pub(crate) fn prove(scene: &Scene, mut matrix: PairMatrix) -> PairMatrix {
    let mut search = Search { scene, state: SceneState::new(scene), narrow: Narrow::new(scene) };
    for entry in matrix.entries_mut().iter_mut().filter(|e| e.state == PairState::Tested) {
        let wanted = entry.margin_m + CLEARANCE;
        let least = balls(scene, entry.a, entry.b, wanted).or_else(|| search.cells(entry.a, entry.b, wanted));
        if let Some(least_m) = least {
            (entry.state, entry.reason) = (PairState::Skipped, Reason::OutOfReach { least_m });
        }
    }
    matrix
}

/// Where a member can be, in the frame of a common ancestor or the world.
enum Reach<'s> {
    Ball(Vec3, f64),
    Still(&'s [Solid], Pose),
}

fn balls(scene: &Scene, a: Member, b: Member, wanted: f64) -> Option<f64> {
    let least = match (reach(scene, a, b)?, reach(scene, b, a)?) {
        (Reach::Ball(p, r), Reach::Ball(q, s)) => (p.distance(q) - r - s) * (1.0 - 1e-12),
        (Reach::Ball(p, radius), Reach::Still(solids, in_frame))
        | (Reach::Still(solids, in_frame), Reach::Ball(p, radius)) => {
            let ball = Shape::Sphere(Sphere { radius });
            let at = Pose::from_translation(p);
            let gap = |s: &Solid| {
                let found = separation_within(&ball, &at, &s.shape, &(in_frame * s.in_member), f64::INFINITY);
                found.map_or(0.0, |s| s.lower_bound)
            };
            solids.iter().map(gap).fold(f64::INFINITY, f64::min)
        }
        // Nothing moves: no pair in the first place.
        (Reach::Still(..), Reach::Still(..)) => return None,
    };
    (least > wanted && least.is_finite()).then_some(least)
}

/// Where `member` can be as seen from what it shares with `other`.
fn reach(scene: &Scene, member: Member, other: Member) -> Option<Reach<'_>> {
    let model = &scene.models[scene.model_of(member)?];
    let Member::Link { robot, .. } = member else {
        let Member::Object(o) = member else { return None };
        return Some(Reach::Still(&model.exact, scene.objects[o].in_world));
    };
    let r = &scene.robots[robot];
    let chain = &r.robot.chain;
    let mut in_frame = match other {
        Member::Link { robot: same, .. } if same == robot => Pose::IDENTITY,
        _ => r.base_in_world,
    };
    let own = own_joints(scene, member, other);
    let Some(first) = own.iter().position(|j| chain.joints()[j.0].kind.moves()) else {
        for j in &own {
            in_frame = in_frame * chain.joints()[j.0].origin;
        }
        return Some(Reach::Still(&model.exact, in_frame));
    };
    for j in &own[..=first] {
        in_frame = in_frame * chain.joints()[j.0].origin;
    }
    let mut radius = model.radius();
    for (i, j) in own.iter().enumerate().skip(first) {
        let joint = &chain.joints()[j.0];
        radius += if i > first { joint.origin.translation.length() } else { 0.0 };
        if joint.kind == JointKind::Prismatic {
            radius += stroke(chain, *j);
        }
    }
    // A hair more for the sum's rounding. Infinity and NaN are no ball.
    radius.is_finite().then_some(Reach::Ball(in_frame.translation, radius * (1.0 + 1e-12)))
}

/// Largest distance (m) of a slide from its zero.
fn stroke(chain: &Chain, joint: JointId) -> f64 {
    let (source, scale, offset) =
        chain.mimic_source(joint).map_or((joint, 1.0, 0.0), |m| (m.joint, m.multiplier, m.offset));
    let limits = chain.joints()[source.0].limits;
    limits.lower.abs().max(limits.upper.abs()) * scale.abs() + offset.abs()
}

/// Joints from what a link shares with the other member to the link, outwards.
fn own_joints(scene: &Scene, member: Member, other: Member) -> Vec<JointId> {
    let Member::Link { robot, link } = member else { return Vec::new() };
    let chain = &scene.robots[robot].robot.chain;
    let path = chain.path(link);
    match other {
        Member::Link { robot: same, link: other } if same == robot => {
            let between = joints_between(chain, link, other);
            path.into_iter().filter(|j| between.contains(j)).collect()
        }
        _ => path,
    }
}

/// A joint value that moves the pair.
#[derive(Clone, Copy)]
struct Axis {
    robot: usize,
    index: usize,
    /// Metres per rad or m that any point of one moves against the other, at most.
    lever: f64,
}

#[derive(Clone, Copy)]
struct Cell {
    middle: [f64; JOINTS],
    half: [f64; JOINTS],
}

struct Search<'s> {
    scene: &'s Scene,
    state: SceneState,
    narrow: Narrow,
}

impl Search<'_> {
    /// `wanted` metres, where every cell is that clear.
    fn cells(&mut self, a: Member, b: Member, wanted: f64) -> Option<f64> {
        let (model_a, model_b) = (self.scene.model_of(a)?, self.scene.model_of(b)?);
        let axes = self.axes(a, b)?;
        let mut stack = vec![self.whole(&axes)?];
        let mut looked = 0;
        while let Some(cell) = stack.pop() {
            looked += 1;
            if looked > CELLS {
                return None;
            }
            self.go(&axes, &cell);
            let moves: Vec<f64> = axes.iter().zip(cell.half).map(|(x, half)| x.lever * half).collect();
            let (x, y) = (Placed::new(self.scene, &self.state, model_a), Placed::new(self.scene, &self.state, model_b));
            let clear = |narrow: &mut Narrow, limit: f64| {
                narrow.cleared_coarsely(&x, &y, limit).is_some() || !narrow.touch(&x, &y, Level::L3, limit)
            };
            let rim = wanted + moves.iter().sum::<f64>() * (1.0 + 1e-9);
            if clear(&mut self.narrow, rim) {
                continue;
            }
            // No cell around this point can be clear.
            if !clear(&mut self.narrow, wanted) {
                return None;
            }
            let widest = (0..axes.len()).max_by(|i, j| moves[*i].total_cmp(&moves[*j]))?;
            for sign in [-0.5, 0.5] {
                let mut half = cell;
                half.half[widest] *= 0.5;
                half.middle[widest] += sign * cell.half[widest];
                stack.push(half);
            }
        }
        Some(wanted)
    }

    /// Whatever moves the pair; `None` where that is too much to go through.
    fn axes(&self, a: Member, b: Member) -> Option<Vec<Axis>> {
        let mut axes: Vec<Axis> = Vec::new();
        for (member, other) in [(a, b), (b, a)] {
            let Member::Link { robot, link } = member else { continue };
            let chain = &self.scene.robots[robot].robot.chain;
            let radius = self.scene.models[self.scene.model_of(member)?].radius();
            for (index, lever) in motion_bound(chain, link, radius, &own_joints(self.scene, member, other)) {
                match axes.iter_mut().find(|x| (x.robot, x.index) == (robot, index)) {
                    Some(known) => known.lever += lever,
                    None => axes.push(Axis { robot, index, lever }),
                }
            }
        }
        let usable = !axes.is_empty() && axes.len() <= JOINTS && axes.iter().all(|x| x.lever.is_finite());
        usable.then_some(axes)
    }

    /// All values within the limits; a full turn for joints without.
    fn whole(&self, axes: &[Axis]) -> Option<Cell> {
        let mut cell = Cell { middle: [0.0; JOINTS], half: [0.0; JOINTS] };
        for (i, x) in axes.iter().enumerate() {
            let chain = &self.scene.robots[x.robot].robot.chain;
            let id = chain.active_joints()[x.index];
            let joint = &chain.joints()[id.0];
            let (lower, upper) = (joint.limits.lower, joint.limits.upper);
            if lower <= upper && lower.is_finite() && upper.is_finite() {
                (cell.middle[i], cell.half[i]) = (0.5 * (lower + upper), 0.5 * (upper - lower) * (1.0 + 1e-12));
                continue;
            }
            // One turn is all turns, unless something else follows at another rate.
            let followed =
                (0..chain.joints().len()).any(|j| chain.mimic_source(JointId(j)).is_some_and(|m| m.joint == id));
            if !joint.kind.turns() || followed {
                return None;
            }
            (cell.middle[i], cell.half[i]) = (0.0, std::f64::consts::PI * (1.0 + 1e-12));
        }
        Some(cell)
    }

    fn go(&mut self, axes: &[Axis], cell: &Cell) {
        for (i, x) in axes.iter().enumerate() {
            self.state.chains[x.robot].q[x.index] = cell.middle[i];
        }
        for (i, x) in axes.iter().enumerate() {
            if axes[..i].iter().all(|y| y.robot != x.robot) {
                self.scene.robots[x.robot].robot.chain.forward(&mut self.state.chains[x.robot]);
                self.state.moved(self.scene, x.robot);
            }
        }
    }
}
