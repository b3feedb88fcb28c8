//! Rigid frames of the oracle, without any pose arithmetic of the checked code.

use elbowroom_spatial::{Pose, Vec3};

/// Columns of a rotation matrix, and a translation in m.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    x: Vec3,
    y: Vec3,
    z: Vec3,
    /// Origin, m.
    pub at: Vec3,
}

impl Frame {
    pub const IDENTITY: Self = Self { x: Vec3::X, y: Vec3::Y, z: Vec3::Z, at: Vec3::ZERO };

    pub fn of(pose: &Pose) -> Self {
        let r = pose.to_rows();
        let column = |i: usize| Vec3::new(r[0][i], r[1][i], r[2][i]);
        Self { x: column(0), y: column(1), z: column(2), at: column(3) }
    }

    pub fn shift(by: Vec3) -> Self {
        Self { at: by, ..Self::IDENTITY }
    }

    /// Rotation about a unit vector, rad (Rodrigues).
    pub fn turn(axis: Vec3, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let turned = |v: Vec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
        Self { x: turned(Vec3::X), y: turned(Vec3::Y), z: turned(Vec3::Z), at: Vec3::ZERO }
    }

    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    pub fn point(&self, p: Vec3) -> Vec3 {
        self.vector(p) + self.at
    }

    pub fn vector_back(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// Composes frames: `inner`, given in this frame, in the frame in which this frame is given.
    pub fn then(&self, inner: &Self) -> Self {
        let v = |v: Vec3| self.vector(v);
        Self { x: v(inner.x), y: v(inner.y), z: v(inner.z), at: self.point(inner.at) }
    }

    /// Half-extents of an axis-aligned box around a box of these half-extents.
    pub fn extents(&self, half: Vec3) -> Vec3 {
        self.x.abs() * half.x + self.y.abs() * half.y + self.z.abs() * half.z
    }

    /// This frame, expressed in another.
    pub fn seen_from(&self, other: &Self) -> Self {
        let v = |v: Vec3| other.vector_back(v);
        Self { x: v(self.x), y: v(self.y), z: v(self.z), at: v(self.at - other.at) }
    }

    /// The rotation from this frame's axes to another's, as a vector along its axis, rad; less than half a turn.
    pub fn turn_to(&self, other: &Self) -> Vec3 {
        // Entry (i, j) of `other · selfᵀ` is the sum over the columns.
        let entry = |row: Vec3, column: Vec3| {
            other.x.dot(row) * self.x.dot(column)
                + other.y.dot(row) * self.y.dot(column)
                + other.z.dot(row) * self.z.dot(column)
        };
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let sine = Vec3::new(entry(z, y) - entry(y, z), entry(x, z) - entry(z, x), entry(y, x) - entry(x, y)) * 0.5;
        let cosine = (entry(x, x) + entry(y, y) + entry(z, z) - 1.0) * 0.5;
        sine.try_normalize().map_or(Vec3::ZERO, |axis| axis * sine.length().atan2(cosine))
    }

    /// Interpolates by a fraction of the way to another frame: the origin moves in a straight line, the axes turn about
    /// one axis.
    pub fn moved_towards(&self, other: &Self, share: f64) -> Self {
        let turn = self.turn_to(other);
        let turned = turn.try_normalize().map_or(*self, |axis| Self::turn(axis, turn.length() * share).then(self));
        Self { at: self.at + (other.at - self.at) * share, ..turned }
    }
}
