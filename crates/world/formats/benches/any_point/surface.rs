//! Random points on a link's surface.

use elbowroom_proximity::tessellate::tessellate;
use elbowroom_robot::Collider;
use elbowroom_spatial::Vec3;
pub use elbowroom_testkit::random::SplitMix;

/// The triangles of a link, in its frame, sampled by area.
pub struct Surface {
    triangles: Vec<[Vec3; 3]>,
    /// Cumulative area including each triangle, m².
    area_up_to: Vec<f64>,
}

impl Surface {
    pub fn of(colliders: &[Collider]) -> Self {
        let (mut triangles, mut area_up_to, mut area) = (Vec::new(), Vec::new(), 0.0);
        for collider in colliders {
            let (vertices, corners) = tessellate(&collider.shape, 1e-3);
            for corners in corners {
                let t = corners.map(|i| collider.in_link.transform_point(vertices[i as usize]));
                let twice = (t[1] - t[0]).cross(t[2] - t[0]).length();
                if twice > 0.0 {
                    area += 0.5 * twice;
                    triangles.push(t);
                    area_up_to.push(area);
                }
            }
        }
        Self { triangles, area_up_to }
    }

    /// Draws a point, uniform over the surface, with its normal; `None` for a link without colliders.
    pub fn draw(&self, random: &mut SplitMix) -> Option<(Vec3, Vec3)> {
        let at = random.unit() * self.area_up_to.last()?;
        let index = self.area_up_to.partition_point(|&a| a < at).min(self.triangles.len() - 1);
        let [a, b, c] = self.triangles[index];
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let normal = (b - a).cross(c - a).try_normalize()?;
        Some((a + (b - a) * u + (c - a) * v, normal))
    }
}
