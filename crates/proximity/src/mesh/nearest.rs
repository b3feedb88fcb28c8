//! Distance and tolerance: what may be asked, and what is answered.

use elbowroom_spatial::{Pose, Vec3};

use super::placement::{Pairing, apart};
use super::scratch::{Scratch, Visits};
use super::search::{Start, promising_pair, search};
use super::swallowed::swallowed;
use super::touch::{Pair, collide};
use crate::TriMesh;

/// How far apart two meshes are, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Metres; 0 on contact, and where one mesh lies inside the other.
    pub distance: f64,
    /// Proven: the exact distance is not below this, metres.
    pub lower_bound: f64,
    /// Nearest point of the first mesh, in the world. Inside: a point of the inner mesh, twice.
    pub on_a: Vec3,
    /// Nearest point of the second mesh, in the world.
    pub on_b: Vec3,
    /// The nearest triangles.
    pub pair: Pair,
    /// Where to begin when the same two meshes have moved a little.
    pub hint: Hint,
}

/// A pair of triangles that was nearest once. With other meshes than those it came from it is only a bad beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hint {
    pub(super) a: u32,
    pub(super) b: u32,
    /// How far apart they were, units of A.
    pub(super) distance: f32,
}

impl Default for Hint {
    /// Knows nothing.
    fn default() -> Self {
        Self { a: u32::MAX, b: u32::MAX, distance: 0.0 }
    }
}

/// Distance of two meshes.
///
/// ```
/// use elbowroom_proximity::{TriMesh, mesh::{Scratch, distance}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
/// let there = Pose::from_translation(Vec3::X * 1.5);
/// let near = distance(&mesh, &Pose::IDENTITY, &mesh, &there, &mut Scratch::new());
/// assert!((near.distance - 0.5).abs() < 1e-12 && near.lower_bound <= near.distance);
/// assert!((near.on_a - Vec3::X).length() < 1e-12);
/// ```
pub fn distance(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose, scratch: &mut Scratch) -> Nearest {
    let found = distance_at(a, a_in_world, b, b_in_world, f64::INFINITY, None, scratch);
    found.unwrap_or_else(|| unknown(a_in_world, b_in_world))
}

/// Like [`distance`], or `None` where the meshes are certainly farther apart than `limit` metres; `hint` is the
/// [`Nearest::hint`] of an earlier answer for the same meshes and changes the time only, never the answer.
pub fn distance_at(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    limit: f64,
    hint: Option<Hint>,
    scratch: &mut Scratch,
) -> Option<Nearest> {
    scratch.visits = Visits::default();
    if apart(&a.tree, a_in_world, &b.tree, b_in_world, limit) {
        return None;
    }
    let pairing = Pairing::new(&a.tree, a_in_world, &b.tree, b_in_world);
    if !pairing.is_usable() {
        return Some(unknown(a_in_world, b_in_world));
    }
    let unit = a.tree.frame.unit;
    let radius = limit.max(0.0) / unit + pairing.slack;
    let level = scratch.level();
    // Where a limit is known, most meshes are beyond it, and the descent says so soonest.
    let start = if radius < f64::INFINITY { Start::Descent } else { Start::Landmarks(DISTANCE_WIDTH) };
    let found = search(level, a, b, &pairing, (radius, pairing.slack), (hint, start), scratch);
    if scratch.stack.overflown() {
        return Some(unknown(a_in_world, b_in_world));
    }
    let touching = found.is_some_and(|f| f.distance <= pairing.slack);
    if !touching && let Some(p) = swallowed(a, a_in_world, b, b_in_world) {
        let hint = found.map_or(Hint::default(), |f| f.hint);
        return Some(Nearest { distance: 0.0, lower_bound: 0.0, on_a: p, on_b: p, pair: Pair::Inside, hint });
    }
    let found = found?;
    let to_world = |p: Vec3| a_in_world.transform_point(p * unit + a.tree.frame.center);
    let measured = if touching { 0.0 } else { found.distance * unit };
    Some(Nearest {
        distance: measured,
        lower_bound: (measured - pairing.slack * unit).max(0.0),
        on_a: to_world(found.near.on_a),
        on_b: to_world(found.near.on_b),
        pair: Pair::Triangles(found.triangles.0, found.triangles.1),
        hint: found.hint,
    })
}

/// The distance, metres, of a pair of triangles that looks nearest, and where it is: an upper bound of the distance, and
/// often the distance itself, for a small part of its price. Infinite where a pose is not finite. With the `hint` of an
/// answer of a moment ago it costs a single pair of triangles.
///
/// Of several pairs of meshes, the least of these is a limit for all of them.
///
/// ```
/// use elbowroom_proximity::{TriMesh, mesh::{Scratch, distance_at, guess}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5));
/// let mut scratch = Scratch::new();
/// let (metres, hint) = guess(&mesh, &here, &mesh, &there, None, &mut scratch);
/// let near = distance_at(&mesh, &here, &mesh, &there, metres, Some(hint), &mut scratch).expect("it is no farther");
/// assert!(near.distance <= metres);
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn guess(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    hint: Option<Hint>,
    scratch: &mut Scratch,
) -> (f64, Hint) {
    scratch.visits = Visits::default();
    let pairing = Pairing::new(&a.tree, a_in_world, &b.tree, b_in_world);
    let unknown = (f64::INFINITY, Hint::default());
    if !pairing.is_usable() {
        return unknown;
    }
    let found = promising_pair(scratch.level(), a, b, &pairing, (hint, Start::Landmarks(GUESS_WIDTH)), scratch);
    found.map_or(unknown, |best| ((best.distance + pairing.slack) * a.tree.frame.unit, best.hint))
}

/// Pairs of nodes that landmarks follow in search of the nearest pair, and of one that is near enough.
const DISTANCE_WIDTH: usize = 4;
const WITHIN_WIDTH: usize = 2;
const GUESS_WIDTH: usize = 2;

/// A pair of triangles no farther apart than `tolerance` metres, or `None` where the meshes certainly are.
///
/// A NaN or negative tolerance counts as 0; a mesh inside a closed one is near. Which pair is found is unspecified.
/// Looks first where the surfaces seem nearest; of meshes that mostly are farther apart, [`farther`] asks sooner.
///
/// ```
/// use elbowroom_proximity::{TriMesh, mesh::{Scratch, within}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5));
/// assert!(within(&mesh, &here, &mesh, &there, 0.51, &mut Scratch::new()).is_some());
/// assert!(within(&mesh, &here, &mesh, &there, 0.49, &mut Scratch::new()).is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn within(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    scratch: &mut Scratch,
) -> Option<Pair> {
    near(a, a_in_world, b, b_in_world, tolerance, Start::Landmarks(WITHIN_WIDTH), scratch)
}

/// True where two meshes are certainly farther apart than `tolerance` metres: the opposite of [`within`], quicker where
/// that is what is expected.
///
/// ```
/// use elbowroom_proximity::{TriMesh, mesh::{Scratch, farther}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X * 1.5));
/// assert!(farther(&mesh, &here, &mesh, &there, 0.49, &mut Scratch::new()));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn farther(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    scratch: &mut Scratch,
) -> bool {
    near(a, a_in_world, b, b_in_world, tolerance, Start::Descent, scratch).is_none()
}

fn near(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    tolerance: f64,
    start: Start,
    scratch: &mut Scratch,
) -> Option<Pair> {
    if !(tolerance > 0.0) {
        return collide(a, a_in_world, b, b_in_world, scratch);
    }
    scratch.visits = Visits::default();
    if apart(&a.tree, a_in_world, &b.tree, b_in_world, tolerance) {
        return None;
    }
    let pairing = Pairing::new(&a.tree, a_in_world, &b.tree, b_in_world);
    if !pairing.is_usable() {
        return Some(Pair::Unknown);
    }
    let radius = tolerance / a.tree.frame.unit + pairing.slack;
    let level = scratch.level();
    let found = search(level, a, b, &pairing, (radius, radius), (None, start), scratch);
    match found {
        Some(best) => Some(Pair::Triangles(best.triangles.0, best.triangles.1)),
        None if scratch.stack.overflown() => Some(Pair::Unknown),
        None => swallowed(a, a_in_world, b, b_in_world).map(|_| Pair::Inside),
    }
}

fn unknown(a_in_world: &Pose, b_in_world: &Pose) -> Nearest {
    Nearest {
        distance: 0.0,
        lower_bound: 0.0,
        on_a: a_in_world.translation,
        on_b: b_in_world.translation,
        pair: Pair::Unknown,
        hint: Hint::default(),
    }
}
