//! Affine maps of mesh files: unlike a pose they may scale, shear and mirror.

use elbowroom_spatial::Vec3;

use crate::mesh::MeshData;

/// `p ↦ rows · [p, 1]`.
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

    /// First `inner`, then this one.
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

    /// The mesh moved; under a mirror image its outside stays outside.
    pub(crate) fn apply(&self, mesh: &mut MeshData) {
        mesh.vertices.iter_mut().for_each(|v| *v = self.point(*v));
        if self.is_mirror() {
            mesh.flip();
        }
    }
}
