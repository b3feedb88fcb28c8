//! Numbers of any bit pattern and sizes of any magnitude.

use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere, penetration, separation, separation_within};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use proptest::prelude::*;

fn shape(kind: u8, x: f64, y: f64, z: f64) -> Shape {
    match kind % 4 {
        0 => Shape::Sphere(Sphere { radius: x }),
        1 => Shape::Capsule(Capsule { half_length: x, radius: y }),
        2 => Shape::Cylinder(Cylinder { half_length: x, radius: y }),
        _ => Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) }),
    }
}

/// Sizes; half of them are 0 or down to 1e-12 m.
fn size() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), (-12.0_f64..0.0).prop_map(|e| 10_f64.powf(e)), 0.01..1.0, 0.01..1.0]
}

fn place() -> impl Strategy<Value = Pose> {
    let turn = prop_oneof![Just(0.0), -1e-8..1e-8, -3.0..3.0];
    ([-2.0..2.0, -2.0..2.0, -2.0..2.0], [turn.clone(), turn.clone(), turn])
        .prop_map(|(t, r)| Pose::new(Rotation::from_rotation_vector(r.into()), t.into()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bits_answer(kinds: [u8; 2], bits: [u64; 15]) {
        let v = bits.map(f64::from_bits);
        let (a, b) = (shape(kinds[0], v[0], v[1], v[2]), shape(kinds[1], v[3], v[4], v[5]));
        let pa = Pose::new(Rotation::from_rpy(v[6], v[7], v[8]), Vec3::new(v[9], v[10], v[11]));
        let pb = Pose::from_translation(Vec3::new(v[12], v[13], v[14]));
        let s = separation(&a, &pa, &b, &pb);
        prop_assert!(s.lower_bound >= 0.0 && s.lower_bound <= s.distance && s.distance.is_finite());
        prop_assert_eq!(penetration(&a, &pa, &b, &pb).is_some(), s.lower_bound <= 0.0);
    }

    #[test]
    fn degenerate_sizes_bracket_the_distance(
        kinds: [u8; 2], d in [size(), size(), size()], e in [size(), size(), size()], pa in place(), pb in place(),
    ) {
        let (a, b) = (shape(kinds[0], d[0], d[1], d[2]), shape(kinds[1], e[0], e[1], e[2]));
        let s = separation(&a, &pa, &b, &pb);
        prop_assert!(s.distance - s.lower_bound <= 1e-11 || s.lower_bound == 0.0 && s.distance <= 1e-9, "{:?}", s);
        let limited = separation_within(&a, &pa, &b, &pb, 0.2);
        let right = if s.distance > 0.2 + 1e-11 { limited.is_none() } else { s.lower_bound > 0.2 || limited.is_some() };
        prop_assert!(right, "{:?} {:?}", s, limited);
    }
}
