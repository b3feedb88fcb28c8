//! Motion-based face culling: only faces whose outward normal has a component along their motion can touch first.

use elbowroom_spatial::Vec3;

use crate::TriMesh;
use crate::ccd::{ConstantTwist, RigidMotion};
use crate::repair::Shells;
use crate::shape::topology::is_degenerate;

/// The velocity of a mesh relative to another body during some time, in the mesh's frame.
///
/// ```
/// use elbowroom_proximity::ccd::ConstantTwist;
/// use elbowroom_proximity::motion_culling::RelativeTwist;
/// use elbowroom_spatial::{Pose, Vec3};
/// let falling = ConstantTwist::linear(Pose::IDENTITY, Vec3::Z * -2.0);
/// let floor = ConstantTwist::linear(Pose::IDENTITY, Vec3::ZERO);
/// assert_eq!(RelativeTwist::between(&falling, &floor, 0.0, 1.0), RelativeTwist::constant(Vec3::Z * -2.0, Vec3::ZERO));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeTwist {
    /// Velocity of the mesh's origin relative to the other body, mesh frame, metres per unit of time.
    pub velocity: Vec3,
    /// Angular velocity of the mesh relative to the other body, mesh frame, radians per unit of time.
    pub angular_velocity: Vec3,
    /// Largest deviation from `velocity`, metres per unit of time.
    pub velocity_slack: f64,
    /// Largest deviation from `angular_velocity`, radians per unit of time.
    pub angular_slack: f64,
}

impl RelativeTwist {
    /// A twist that is constant over time.
    pub fn constant(velocity: Vec3, angular_velocity: Vec3) -> Self {
        Self { velocity, angular_velocity, velocity_slack: 0.0, angular_slack: 0.0 }
    }

    /// Encloses all twists of `mesh` relative to `other` between the times `from` and `to`, in the mesh's own frame. A
    /// screw motion relative to a body at rest has a constant twist; then the slack is only rounding.
    pub fn between(mesh: &ConstantTwist, other: &ConstantTwist, from: f64, to: f64) -> Self {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let pose = mesh.pose(middle);
        let origin = pose.translation;
        let velocity = mesh.velocity_at(origin, middle) - other.velocity_at(origin, middle);
        let travel = mesh.velocity - other.velocity;
        let (own, foreign) = (mesh.rotation.length(), other.rotation.length());
        let speed = travel.length() + (mesh.velocity_at(origin, middle) - mesh.velocity).length();
        let arm = (origin - other.pivot - other.velocity * middle).length() + half * speed;
        // Derivative of Rᵀ(V_A − V_B) at the mesh's origin; R rotates with the mesh.
        let change = mesh.rotation.cross(travel).length() + foreign * speed + own * foreign * arm;
        Self {
            velocity: pose.inverse_transform_vector(velocity),
            angular_velocity: pose.inverse_transform_vector(mesh.rotation - other.rotation),
            velocity_slack: half * change,
            angular_slack: half * mesh.rotation.cross(other.rotation).length(),
        }
    }
}

/// The outward normals of a mesh, prepared for culling.
///
/// If two bodies are apart and then touch for the first time, the contact lies on a face of the mesh whose outward
/// normal N has N · V ≥ 0 at some point of the face, where V is that point's velocity relative to the other body. At
/// an edge or a corner this holds for one of the faces that meet there. All other faces need not be tested
/// (Reichenbach and Kovačić 2003).
///
/// Faces whose outward side is uncertain are never culled: open and one-sided surfaces, faces without area, closed
/// surfaces of inconsistent orientation (see [`orient`](crate::repair::orient)), cavities inside others. A closed
/// surface that intersects itself so that a part of it is inside out is used with its given orientation.
///
/// ```
/// use elbowroom_proximity::motion_culling::{FaceCulling, RelativeTwist};
/// use elbowroom_proximity::{Cuboid, Shape, TriMesh, tessellate::tessellate};
/// use elbowroom_spatial::Vec3;
/// let (corners, faces) = tessellate(&Shape::Cuboid(Cuboid { half_extents: Vec3::splat(1.0) }), 0.01);
/// let cube = TriMesh::new(corners, faces).unwrap();
/// let culling = FaceCulling::of(&cube);
/// let kept = culling.kept_faces(&RelativeTwist::constant(Vec3::new(1.0, 1.0, 1.0), Vec3::ZERO));
/// assert_eq!((kept.count(), cube.triangles().len()), (6, 12)); // three of six sides
/// ```
#[derive(Debug, Clone)]
pub struct FaceCulling {
    faces: Vec<Face>,
    /// Largest distance of a vertex from the origin, metres.
    radius: f64,
}

#[derive(Debug, Clone, Copy)]
struct Face {
    /// Outward normal with a length of twice the area; zero if unknown.
    normal: Vec3,
    /// p × N of the corners, because N · (ω × p) = ω · (p × N).
    moments: [Vec3; 3],
    length: f64,
    /// Largest error of `normal`.
    error: f64,
}

impl Face {
    const UNKNOWN: Self = Self { normal: Vec3::ZERO, moments: [Vec3::ZERO; 3], length: 0.0, error: 0.0 };

    fn new(corners: [Vec3; 3], sign: f64) -> Self {
        let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
        let normal = e1.cross(e2) * sign;
        let error = 16.0 * f64::EPSILON * e1.length() * e2.length();
        Self { normal, moments: corners.map(|p| p.cross(normal)), length: normal.length(), error }
    }
}

impl FaceCulling {
    /// Determines the outward side of every face, in time linear in the number of faces.
    pub fn of(mesh: &TriMesh) -> Self {
        let mut faces = vec![Face::UNKNOWN; mesh.triangles().len()];
        let shells = Shells::of(mesh.vertices(), mesh.triangles());
        let agree = shells.agree();
        for (number, shell) in shells.list.iter().enumerate() {
            let solid = shell.consistent && shell.faces.iter().all(|&f| mesh.in_closed_component[f as usize]);
            let Some(volume) = shell.volume.filter(|_| solid) else { continue };
            if !(agree || shells.is_alone(number)) {
                continue;
            }
            let sign = volume.signum();
            for &f in &shell.faces {
                let corners = mesh.corners(f as usize);
                if !is_degenerate(corners) {
                    faces[f as usize] = Face::new(corners, sign);
                }
            }
        }
        let radius = mesh.vertices().iter().fold(0.0, |r: f64, v| r.max(v.length()));
        Self { faces, radius }
    }

    /// The faces that may be the first to touch during a motion with these twists. A NaN keeps all faces.
    pub fn kept_faces(&self, twist: &RelativeTwist) -> KeptFaces {
        let (v, w) = (twist.velocity, twist.angular_velocity);
        let slack = twist.velocity_slack + twist.angular_slack * self.radius;
        let speed = v.length() + w.length() * self.radius + slack;
        let mut bits = vec![0_u64; self.faces.len().div_ceil(64)];
        for (i, face) in self.faces.iter().enumerate() {
            let [a, b, c] = face.moments.map(|m| m.dot(w));
            let advance = face.normal.dot(v) + a.max(b).max(c);
            let recedes = advance + face.length * (slack + 1e-13 * speed) + face.error * speed < 0.0;
            bits[i / 64] |= u64::from(!recedes) << (i % 64);
        }
        KeptFaces { bits, triangles: self.faces.len() }
    }
}

/// The triangles of a mesh that culling keeps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeptFaces {
    bits: Vec<u64>,
    triangles: usize,
}

impl KeptFaces {
    /// True if the triangle is in the set; false for an index beyond the mesh's last triangle.
    pub fn contains(&self, triangle: usize) -> bool {
        self.bits.get(triangle / 64).is_some_and(|word| word >> (triangle % 64) & 1 == 1)
    }

    /// Number of triangles in the set.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The triangles of the set, in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.triangles).filter(|&t| self.contains(t))
    }
}
