//! Lower bound on the distance of two oriented boxes by separating axes (Gottschalk, Lin, Manocha, "`OBBTree`", 1996).

use elbowroom_spatial::Obb;

/// Allowance for rounding, as a fraction of the largest coordinate.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Lower bound (m) on the distance of two boxes in one common frame.
///
/// It is the widest gap along the face normals of the boxes and the cross products of their edges. 0 or less if no axis
/// separates them; NaN bounds nothing.
pub(crate) fn obb_gap(a: &Obb, b: &Obb) -> f64 {
    let r = (a.pose.rotation.inverse() * b.pose.rotation).rows();
    let t = a.pose.rotation.inverse_rotate(b.pose.translation - a.pose.translation).to_array();
    let (ha, hb) = (a.half_extents.to_array(), b.half_extents.to_array());
    let m: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| r[i][j].abs()));
    let mut widest = f64::NEG_INFINITY;
    for i in 0..3 {
        widest = widest.max(t[i].abs() - ha[i] - (m[i][0] * hb[0] + m[i][1] * hb[1] + m[i][2] * hb[2]));
        let along = t[0] * r[0][i] + t[1] * r[1][i] + t[2] * r[2][i];
        widest = widest.max(along.abs() - hb[i] - (m[0][i] * ha[0] + m[1][i] * ha[1] + m[2][i] * ha[2]));
    }
    for i in 0..3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            let squared = 1.0 - r[i][j] * r[i][j];
            // Nearly parallel edges add nothing to the face normals, and would divide rounding errors by almost zero.
            if squared < 1e-4 {
                continue;
            }
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            let apart = (t[i2] * r[i1][j] - t[i1] * r[i2][j]).abs();
            let reach = ha[i1] * m[i2][j] + ha[i2] * m[i1][j] + hb[j1] * m[i][j2] + hb[j2] * m[i][j1];
            widest = widest.max((apart - reach) / squared.sqrt());
        }
    }
    let place = a.pose.translation.abs() + b.pose.translation.abs() + a.half_extents + b.half_extents;
    // At most 100 times the rounding of the numerator, for nearly parallel edges.
    let rounding = 100.0 * ROUNDING * (place.x + place.y + place.z);
    // `max` ignores NaN; the sum of the matrix entries does not.
    let certain = widest - rounding;
    if (r[0][0] + r[1][1] + r[2][2] + r[0][1] + r[1][2] + r[2][0]).is_nan() { f64::NAN } else { certain }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_proximity::{Cuboid, Shape, separation};
    use elbowroom_spatial::{Pose, Vec3};
    use proptest::prelude::*;

    fn any_obb() -> impl Strategy<Value = Obb> {
        let c = -1.0..1.0_f64;
        let a = -3.0..3.0_f64;
        ((c.clone(), c.clone(), c), (a.clone(), a.clone(), a), (0.0..0.5_f64, 0.0..0.5_f64, 0.0..0.5_f64)).prop_map(
            |(c, a, h)| Obb {
                pose: Pose::from_xyz_rpy([c.0, c.1, c.2], [a.0, a.1, a.2]),
                half_extents: Vec3::new(h.0, h.1, h.2),
            },
        )
    }

    proptest! {
        #[test]
        fn never_above_the_distance_and_above_zero_when_apart(a in any_obb(), b in any_obb()) {
            let shape = |o: &Obb| Shape::Cuboid(Cuboid { half_extents: o.half_extents });
            let exact = separation(&shape(&a), &a.pose, &shape(&b), &b.pose);
            let bound = obb_gap(&a, &b);
            prop_assert!(bound <= exact.distance, "{bound} {exact:?}");
            // Separating axes decide exactly whether boxes are separated.
            if exact.lower_bound > 1e-9 {
                prop_assert!(bound > 0.0, "{bound} {exact:?}");
            }
        }
    }

    #[test]
    fn nan_bounds_nothing() {
        let a = Obb { pose: Pose::IDENTITY, half_extents: Vec3::splat(0.1) };
        let b = Obb { pose: Pose::from_translation(Vec3::X * f64::NAN), ..a };
        assert!(obb_gap(&a, &b).is_nan());
    }
}
