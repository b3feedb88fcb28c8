//! Affine transforms of mesh files. Unlike a pose, they may scale, shear and mirror.

use elbowroom_spatial::{Pose, Vec3};

use crate::mesh_data::MeshData;

/// The transform `p ↦ rows · [p, 1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Affine(pub(crate) [[f64; 4]; 3]);

impl Affine {
    pub(crate) const IDENTITY: Self = Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    pub(crate) fn translation([x, y, z]: [f64; 3]) -> Self {
        Self([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]])
    }

    pub(crate) fn scale([x, y, z]: [f64; 3]) -> Self {
        Self([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]])
    }

    pub(crate) fn rotation(rows: [[f64; 3]; 3]) -> Self {
        Self(rows.map(|[x, y, z]| [x, y, z, 0.0]))
    }

    /// The composition: `inner` is applied first.
    pub(crate) fn after(&self, inner: &Self) -> Self {
        let mut out = [[0.0; 4]; 3];
        for (row, left) in out.iter_mut().zip(&self.0) {
            for (c, cell) in row.iter_mut().enumerate() {
                *cell = (0..3).map(|k| left[k] * inner.0[k][c]).sum::<f64>() + if c == 3 { left[3] } else { 0.0 };
            }
        }
        Self(out)
    }

    pub(crate) fn point(&self, p: Vec3) -> Vec3 {
        Vec3::from(self.0.map(|[x, y, z, t]| x * p.x + y * p.y + z * p.z + t))
    }

    pub(crate) fn is_mirror(&self) -> bool {
        let row = |i: usize| Vec3::new(self.0[i][0], self.0[i][1], self.0[i][2]);
        row(0).dot(row(1).cross(row(2))) < 0.0
    }

    /// The transform with its linear part transposed and the origin unchanged.
    pub(crate) fn transposed(&self) -> Self {
        Self::rotation([0, 1, 2].map(|c| self.column(c).to_array())).with_origin(self.column(3))
    }

    pub(crate) fn column(&self, c: usize) -> Vec3 {
        Vec3::from(self.0.map(|row| row[c]))
    }

    /// The inverse; `None` if the linear part is singular or nearly singular.
    ///
    /// Nearly singular means that the volume of its axes is at most 1e-9 of the product of their lengths.
    pub(crate) fn inverse(&self) -> Option<Self> {
        let (x, y, z) = (self.column(0), self.column(1), self.column(2));
        let volume = x.dot(y.cross(z));
        if !(volume.abs() > 1e-9 * x.length() * y.length() * z.length()) || !volume.is_normal() {
            return None;
        }
        let rows = [y.cross(z), z.cross(x), x.cross(y)].map(|v| (v * (1.0 / volume)).to_array());
        let linear = Self::rotation(rows);
        linear.0.iter().flatten().all(|n| n.is_finite()).then(|| {
            let origin = linear.point(-self.column(3));
            linear.with_origin(origin)
        })
    }

    fn with_origin(mut self, origin: Vec3) -> Self {
        self.0.iter_mut().zip(origin.to_array()).for_each(|(row, o)| row[3] = o);
        self
    }

    /// Transforms a mesh. A mirroring transform reverses the winding.
    pub(crate) fn apply(&self, mesh: &mut MeshData) {
        mesh.vertices.iter_mut().for_each(|v| *v = self.point(*v));
        if self.is_mirror() {
            mesh.flip();
        }
    }
}

impl From<&Pose> for Affine {
    fn from(pose: &Pose) -> Self {
        Self(pose.to_rows())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(a: &Affine, b: &Affine) -> f64 {
        a.0.iter().flatten().zip(b.0.iter().flatten()).fold(0.0, |most, (a, b)| (a - b).abs().max(most))
    }

    #[test]
    fn the_inverse_undoes_scale_shear_and_mirror() {
        let map = Affine([[0.5, 0.2, 0.0, 3.0], [0.0, -2.0, 0.1, 4.0], [0.3, 0.0, 7.0, -5.0]]);
        let back = map.inverse().unwrap();
        assert!(difference(&back.after(&map), &Affine::IDENTITY) < 1e-12);
        assert!(difference(&map.after(&back), &Affine::IDENTITY) < 1e-12);
        assert!(Affine::scale([1.0, 0.0, 1.0]).inverse().is_none());
        assert!(Affine::scale([1e-300, 1e-300, 1e-300]).inverse().is_none());
        assert!(Affine([[1.0, 2.0, 3.0, 0.0]; 3]).inverse().is_none());
    }
}
