//! Audit for tests: compares decisions in single precision, row by row, with double precision.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::arc_intervals;
use super::context::{ConvexContext, Outlines, PlaneRows};
use super::outline::Outline;
use crate::RowSpan;

/// Number of rows compared.
pub(super) static ROWS: AtomicUsize = AtomicUsize::new(0);

/// Compares the spans with the outlines moved inward by half of the margin. Panics if the spans do not contain an angle
/// that double precision finds blocked.
pub(super) fn compare(context: &ConvexContext, outlines: &Outlines, plane: &PlaneRows, spans: &[RowSpan]) {
    if !outlines.wrist.exists {
        return;
    }
    let (fore, wrist) = (moved_inward(context, &outlines.fore), moved_inward(context, &outlines.wrist));
    let (upper, length) = (context.arm.upper_length_m, context.arm.fore_length_m);
    for row in 0..plane.count {
        if plane.full[row / 16] >> (row % 16) & 1 == 1 {
            continue;
        }
        ROWS.fetch_add(1, Ordering::Relaxed);
        let [cos, sin] = [f64::from(plane.middles.cos[row]), f64::from(plane.middles.sin[row])];
        let elbow = [cos * upper, sin * upper];
        let here: Vec<&RowSpan> = spans.iter().filter(|span| span.row as usize == plane.first + row).collect();
        let zero = f64::from(plane.middles.zero[row]);
        let check = |lo: f64, hi: f64| {
            for angle in [lo, (lo + hi) * 0.5, hi] {
                let found = context.spans.contains(&here, angle, zero);
                assert!(found, "elbow {elbow:?}, angle {angle} of {lo}..{hi}, spans {here:?}");
            }
        };
        arc_intervals::for_each_inside(&wrist, &outlines.normals, elbow, length, check);
        let inside = (0..outlines.normals.count).all(|k| {
            let normals = &outlines.normals;
            f64::from(normals.x[k]) * elbow[0] + f64::from(normals.y[k]) * elbow[1] <= f64::from(fore.far[k])
        });
        if outlines.fore.exists && inside {
            check(-3.0, 3.0);
        } else if outlines.fore.exists
            && let Some((lo, hi)) = arc_intervals::visible_interval(&fore, &outlines.normals, elbow, length)
        {
            check(lo, hi);
        }
    }
}

/// The lines of an outline, moved inward by half of the margin; between the old corners they are inside the old
/// outline.
fn moved_inward(context: &ConvexContext, outline: &Outline) -> Outline {
    let mut inner = outline.clone();
    inner.far.iter_mut().for_each(|far| *far -= 0.5 * context.margin);
    inner
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Pose, Vec3};

    use super::*;
    use crate::{ConvexObstacle, Grid, GridAxis, Layer, PlanarArm, PlanarMapBuilder};
    use elbowroom_testkit::random::Xorshift;

    /// Numbers in 0..1 that are equal on every machine.
    #[test]
    fn a_million_rows_are_decided_as_in_double_precision() {
        let mut random = Xorshift(0x2545_f491_4f6c_dd1d);
        let axis = |name: &str, half: f64| GridAxis::from_degrees(name, -half, half, 2.0).unwrap();
        let grid = Grid::new([axis("a", 170.0), axis("b", 90.0), axis("c", 140.0)]).unwrap();
        let arms =
            [PlanarArm::KR125_SIZED, PlanarArm { wrist_radius_m: 0.0, fore_radius_m: 0.01, ..PlanarArm::KR125_SIZED }];
        let mut builders = arms.map(|arm| PlanarMapBuilder::new(arm, &grid).unwrap());
        let mut layer = Layer::new();
        let start = ROWS.load(Ordering::Relaxed);
        for round in 0.. {
            let at = Vec3::new(random.between(-2.2, 2.2), random.between(-2.2, 2.2), random.between(-0.5, 2.5));
            let rpy = Vec3::from(random.within(3.0));
            let half = Vec3::from(random.within([0.01, 0.3, 0.6, 1.0][round % 4])).abs();
            let pose = Pose::from_xyz_rpy([at.x, at.y, at.z], [rpy.x, rpy.y, rpy.z]);
            builders[round % 2].build_layer(&ConvexObstacle::cuboid(pose, half).unwrap(), &mut layer);
            if ROWS.load(Ordering::Relaxed) - start > 1_000_000 {
                break;
            }
        }
    }
}
