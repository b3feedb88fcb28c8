//! Comparison of elbowroom's answers with those of the reference.

use std::sync::Arc;
use std::time::Instant;

use elbowroom_proximity::advanced::{MeshFeatures, colliding_triangles, mesh_separation};
use elbowroom_proximity::tessellate::tessellate;
use elbowroom_proximity::{Shape, TriMesh, Workspace};
use elbowroom_robot::RobotId;
use elbowroom_robot::{Collider, GeometryId};
use elbowroom_scene::{Checker, CheckerOptions, PairDistance, Scene, SceneState};

use super::reference::Answers;
use super::world;

/// Largest relative difference of equal distances; [`ABSOLUTE_M`] is the absolute one.
const RELATIVE: f64 = 1e-9;
const ABSOLUTE_M: f64 = 1e-12;

/// Results of one scene over all states.
#[derive(Debug, Default)]
pub struct Comparison {
    pub states: usize,
    pub pairs: usize,
    pub contacts: usize,
    /// States in which one closed mesh lies wholly inside another: a contact for elbowroom, a gap to the hollow surface
    /// for Coal.
    pub contained: usize,
    /// States in which a primitive is nearest, and the difference is within the error of Coal's iteration.
    pub iterated: usize,
    /// States with another answer that nothing above explains; `first` describes the first of them.
    pub disagreements: usize,
    pub first: Vec<String>,
    /// Greatest relative difference of equal distances.
    pub worst: f64,
    /// Time per state, µs: joint values set and distance computed.
    pub distance_us: f64,
    /// Time per state, µs: joint values set and collision computed.
    pub collide_us: f64,
}

/// Largest error of Coal's GJK for a pair with a primitive, m and relative.
const ITERATED: f64 = 2e-6;

/// Queries elbowroom's checker in every state and compares.
pub fn compare(scene: &Scene, states: &[Vec<f64>], theirs: &Answers) -> Result<Comparison, String> {
    let (ours, distance_us) = timed(scene, states, Checker::distance)?;
    let (hits, collide_us) = timed(scene, states, |checker, state| checker.collides(state).is_some())?;
    let mut comparison =
        Comparison { states: states.len(), pairs: theirs.pairs, distance_us, collide_us, ..Comparison::default() };
    let mut state = SceneState::new(scene);
    for (i, q) in states.iter().enumerate() {
        let gap = theirs.least[i].max(0.0);
        let Some(found) = ours[i] else { continue };
        comparison.contacts += usize::from(hits[i]);
        if hits[i] != (found.metres == 0.0) {
            comparison.wrong(i, &format!("our own answers contradict each other: {} and {} m", hits[i], found.metres));
            continue;
        }
        let difference = (found.metres - gap).abs();
        let same = difference <= RELATIVE * gap + ABSOLUTE_M;
        if same && hits[i] == theirs.collides[i] {
            comparison.worst = comparison.worst.max(if gap > 0.0 { difference / gap } else { 0.0 });
            continue;
        }
        state.set_q(scene, RobotId(0), q).map_err(|e| e.to_string())?;
        let free_for_them = gap > 0.0 && !theirs.collides[i];
        // At contact or very close to it the two answers of the reference need not agree with each other.
        let touching = difference > 0.0 && found.metres.max(gap) <= ITERATED;
        let same_comparison = hits[i] == theirs.collides[i] || touching;
        if found.metres == 0.0 && free_for_them && is_contained(scene, &state, &found) {
            comparison.contained += 1;
        } else if same_comparison && difference <= ITERATED * (1.0 + gap) && iterated(scene, &state, &found) {
            comparison.iterated += 1;
        } else {
            let names = [found.a, found.b].map(|m| scene.name(m)).join(" and ");
            let said = (hits[i], found.metres, theirs.collides[i], gap);
            comparison.wrong(i, &format!("{names}: we {} {:e} m, they {} {:e} m", said.0, said.1, said.2, said.3));
        }
    }
    Ok(comparison)
}

impl Comparison {
    fn wrong(&mut self, state: usize, what: &str) {
        self.disagreements += 1;
        if self.first.len() < 10 {
            self.first.push(format!("state {state}, {what}"));
        }
    }
}

/// Number of passes over all states, of which the fastest counts: the queries are so short that one interruption by another
/// program would dominate the measurement.
const PASSES: usize = 5;

/// Returns the answers, and the time per state, µs.
fn timed<'s, T>(
    scene: &'s Scene,
    states: &[Vec<f64>],
    mut query: impl FnMut(&mut Checker<'s>, &SceneState) -> T,
) -> Result<(Vec<T>, f64), String> {
    let mut least = f64::INFINITY;
    let mut answers = Vec::new();
    for _ in 0..PASSES {
        let mut checker = Checker::new(scene, CheckerOptions::default());
        let mut state = SceneState::new(scene);
        query(&mut checker, &state);
        answers = Vec::with_capacity(states.len());
        let started = Instant::now();
        for q in states {
            state.set_q(scene, RobotId(0), q).map_err(|e| e.to_string())?;
            answers.push(query(&mut checker, &state));
        }
        least = least.min(started.elapsed().as_secs_f64());
    }
    Ok((answers, least * 1e6 / states.len().max(1) as f64))
}

/// Whether no surface of the pair touches the other, but a solid lies inside another.
fn is_contained(scene: &Scene, state: &SceneState, found: &PairDistance) -> bool {
    let mut workspace = Workspace::new();
    let mut inside = false;
    for a in world::colliders(scene, found.a) {
        for b in world::colliders(scene, found.b) {
            let (a_in_world, b_in_world) = (placed(scene, state, found.a), placed(scene, state, found.b));
            let (Some(pose_a), Some(pose_b)) = (a_in_world, b_in_world) else { return false };
            let (pose_a, pose_b) = (pose_a * a.in_link, pose_b * b.in_link);
            match (&a.shape, &b.shape) {
                (Shape::Mesh(x), Shape::Mesh(y)) => match colliding_triangles(x, &pose_a, y, &pose_b, &mut workspace) {
                    Some(MeshFeatures::Containment) => inside = true,
                    Some(_) => return false,
                    None => {}
                },
                // The surface of a primitive whose centre is in the mesh may touch or not; Coal treats the primitive as
                // solid.
                (Shape::Mesh(x), _) => inside |= x.contains(pose_a.inverse().transform_point(pose_b.translation)),
                (_, Shape::Mesh(y)) => inside |= y.contains(pose_b.inverse().transform_point(pose_a.translation)),
                _ => {}
            }
        }
    }
    inside
}

fn placed(scene: &Scene, state: &SceneState, id: GeometryId) -> Option<elbowroom_spatial::Pose> {
    state.pose(scene, id)
}

/// Whether a primitive is nearest and Coal's iteration explains the difference. For a box, its twelve triangles must
/// have the distance that elbowroom reports: between triangles both libraries agree to the last digits, so the
/// difference is Coal's iteration.
fn iterated(scene: &Scene, state: &SceneState, found: &PairDistance) -> bool {
    let [a, b] = [found.a, found.b].map(|m| world::colliders(scene, m));
    let is_mesh = |collider: &&Collider| matches!(collider.shape, Shape::Mesh(_));
    if a.iter().chain(&b).all(|collider| is_mesh(&collider)) {
        return false;
    }
    let [Some(pose_a), Some(pose_b)] = [found.a, found.b].map(|m| state.pose(scene, m)) else { return false };
    let mut workspace = Workspace::new();
    let mut least = f64::INFINITY;
    for (x, y) in a.iter().flat_map(|x| b.iter().map(move |y| (x, y))) {
        let (Some(p), Some(q)) = (triangles(&x.shape), triangles(&y.shape)) else { return true };
        let separation = mesh_separation(&p, &(pose_a * x.in_link), &q, &(pose_b * y.in_link), &mut workspace).distance;
        least = least.min(separation);
    }
    (least - found.metres).abs() <= RELATIVE * least + ABSOLUTE_M
}

/// Returns the exact surface of meshes and boxes.
fn triangles(shape: &Shape) -> Option<Arc<TriMesh>> {
    match shape {
        Shape::Mesh(mesh) => Some(Arc::clone(mesh)),
        Shape::Cuboid(_) => {
            let (vertices, triangles) = tessellate(shape, 1e-3);
            TriMesh::new(vertices, triangles).ok().map(Arc::new)
        }
        _ => None,
    }
}
