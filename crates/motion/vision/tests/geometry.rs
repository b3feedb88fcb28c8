//! Calibration, polygons, blobs and masks compared with naive implementations.

use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::{SplitMix, xorshift};
use elbowroom_vision::{
    ArmPart, Calibration, Camera, ConnectedComponents, FloorHomography, Intrinsics, PixelMask, Point2, polygon,
};
use proptest::prelude::*;

fn p(x: f64, y: f64) -> Point2 {
    Point2::new(x, y)
}

fn point(range: std::ops::Range<f64>) -> impl Strategy<Value = Point2> {
    (range.clone(), range).prop_map(|(x, y)| p(x, y))
}

/// A camera above the floor without a visible horizon.
fn camera() -> impl Strategy<Value = Camera> {
    let eye = (-2.0..2.0, -2.0..2.0, 2.0..6.0).prop_map(|(x, y, z)| Vec3::new(x, y, z));
    (eye, point(-0.7..0.7), 0.6..1.2, -0.15..0.1).prop_map(|(eye, to, view, k1)| {
        let lens = Intrinsics { radial: [k1, 0.02, 0.0], ..Intrinsics::pinhole(640, 480, view) };
        let target = Vec3::new(eye.x + to.x, eye.y + to.y, 0.0);
        Camera::look_at(lens, eye, target, Vec3::new(0.3, 1.0, 0.0)).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn world_to_pixel_and_back(camera in camera(), u in 0.0..640.0, v in 0.0..480.0, z in 0.0..1.0) {
        let on_floor = camera.pixel_to_plane(p(u, v), z).unwrap();
        let seen = camera.world_to_pixel(Vec3::new(on_floor.x, on_floor.y, z)).unwrap();
        prop_assert!((seen - p(u, v)).length() < 1e-8, "{seen:?}");
    }

    #[test]
    fn a_homography_is_exact_on_the_points_of_a_straight_lens(
        camera in camera(),
        seen in prop::collection::vec((0.0..640.0, 0.0..480.0), 6..12),
    ) {
        let straight = Camera::new(
            Intrinsics { radial: [0.0; 3], ..*camera.intrinsics() }, *camera.camera_in_world()).unwrap();
        let seen: Vec<Point2> = seen.into_iter().map(|(x, y)| p(x, y)).collect();
        let at: Vec<Point2> = seen.iter().map(|&s| straight.pixel_to_plane(s, 0.0).unwrap()).collect();
        // Nearly collinear points are rejected or, if accepted, mapped exactly.
        if let Ok(floor) = FloorHomography::from_points(640, 480, &seen, &at) {
            prop_assert!(floor.max_residual_m() < 1e-6, "{}", floor.max_residual_m());
            for &s in &seen {
                let back = floor.floor_to_pixel(floor.pixel_to_floor(s).unwrap()).unwrap();
                prop_assert!((back - s).length() < 1e-6);
            }
        }
    }

    #[test]
    fn four_corners_decide_every_pixel(camera in camera(), u in 0.0..640.0, v in 0.0..480.0) {
        let straight = Camera::new(
            Intrinsics { radial: [0.0; 3], ..*camera.intrinsics() }, *camera.camera_in_world()).unwrap();
        let seen = [p(10.0, 20.0), p(630.0, 5.0), p(600.0, 470.0), p(40.0, 440.0)];
        let at = seen.map(|s| straight.pixel_to_plane(s, 0.0).unwrap());
        let floor = FloorHomography::from_points(640, 480, &seen, &at).unwrap();
        let truth = straight.pixel_to_plane(p(u, v), 0.0).unwrap();
        prop_assert!((floor.pixel_to_floor(p(u, v)).unwrap() - truth).length() < 1e-7 * (1.0 + truth.length()));
    }

    #[test]
    fn points_on_a_line_are_refused(a in point(0.0..600.0), along in point(-1.0..1.0), steps in
        prop::collection::vec(0.0..300.0, 4..9)) {
        let seen: Vec<Point2> = steps.iter().map(|&s| a + along * s).collect();
        let at: Vec<Point2> = seen.iter().map(|&s| s * 0.01).collect();
        prop_assert!(FloorHomography::from_points(640, 480, &seen, &at).is_err());
        // Three of four collinear points are also rejected.
        let mut seen = seen[..3].to_vec();
        seen.push(a + p(-along.y, along.x) * 200.0 + p(3.0, 1.0));
        let at: Vec<Point2> = seen.iter().map(|&s| s * 0.01).collect();
        prop_assert!(FloorHomography::from_points(640, 480, &seen, &at).is_err());
    }

    #[test]
    fn hulls_contain_their_points_and_inflated_polygons_the_disc(
        points in prop::collection::vec(point(-5.0..5.0), 3..40), margin in 0.01..2.0, angle in 0.0..6.3,
    ) {
        let (mut hull, mut grown, mut spare) = (Vec::new(), Vec::new(), Vec::new());
        polygon::convex_hull(&mut points.clone(), &mut hull);
        polygon::inflate(&hull, margin, &mut grown, &mut spare);
        let mut simple = grown.clone();
        polygon::simplify_outward(&mut simple, 6);
        prop_assert!(simple.len() <= 6 && polygon::area(&simple) >= polygon::area(&grown) - 1e-9);
        for &q in &points {
            let edge_slack = polygon::edges(&hull).all(|(a, b)| (b - a).cross(q - a) >= -1e-9);
            prop_assert!(edge_slack);
            let around = q + p(f64::cos(angle), f64::sin(angle)) * (margin * 0.999_999);
            prop_assert!(polygon::convex_contains(&grown, around));
            prop_assert!(polygon::edges(&simple).all(|(a, b)| (b - a).cross(around - a) >= -1e-9));
        }
    }

    #[test]
    fn intersections_agree_with_sampling(a in prop::collection::vec(point(-2.0..2.0), 3..10),
        b in prop::collection::vec(point(-2.0..2.0), 3..10), q in point(-2.0..2.0)) {
        let [mut ha, mut hb, mut both, mut spare] = [const { Vec::new() }; 4];
        polygon::convex_hull(&mut a.clone(), &mut ha);
        polygon::convex_hull(&mut b.clone(), &mut hb);
        polygon::intersection(&ha, &hb, &mut both, &mut spare);
        prop_assert!(polygon::area(&both) <= polygon::area(&ha).min(polygon::area(&hb)) + 1e-9);
        let margin = |hull: &[Point2]| polygon::edges(hull)
            .map(|(s, t)| (t - s).cross(q - s) / (t - s).length().max(1e-12)).fold(f64::INFINITY, f64::min);
        let (in_a, in_b) = (margin(&ha), margin(&hb));
        if in_a > 1e-6 && in_b > 1e-6 {
            prop_assert!(polygon::contains(&both, q) && polygon::touches(&ha, &hb));
        } else if in_a < -1e-6 || in_b < -1e-6 {
            prop_assert!(!polygon::contains(&both, q));
        }
    }

    #[test]
    fn components_agree_with_a_flood_fill(width in 1_usize..40, height in 1_usize..25, share in 1_u64..5, seed in any::<u64>()) {
        let mut state = seed | 1;
        let mut random = || xorshift(&mut state);
        let plane: Vec<u8> = (0..width * height).map(|_| u8::from(random() % 5 < share)).collect();
        let mut components = ConnectedComponents::default();
        components.label(&[1; 50], 10, 1); // memory of another image must not matter
        let found: Vec<_> = components.label(&plane, width, 1)
            .iter().map(|b| (b.area_px, b.columns.clone(), b.rows.clone(), b.centre_px, b.outline_px.clone())).collect();
        let truth = flood_fill(&plane, width);
        prop_assert_eq!(found.len(), truth.len());
        for (blob, pixels) in found.iter().zip(&truth) {
            let xs = || pixels.iter().map(|&i| i % width);
            let ys = || pixels.iter().map(|&i| i / width);
            prop_assert_eq!(blob.0, pixels.len());
            prop_assert_eq!(&blob.1, &(xs().min().unwrap()..xs().max().unwrap() + 1));
            prop_assert_eq!(&blob.2, &(ys().min().unwrap()..ys().max().unwrap() + 1));
            let mean = |sum: usize| sum as f64 / pixels.len() as f64 + 0.5;
            prop_assert!((blob.3 - p(mean(xs().sum()), mean(ys().sum()))).length() < 1e-9);
            let mut corners: Vec<Point2> = pixels.iter()
                .flat_map(|&i| [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(u, v)| p((i % width + u) as f64, (i / width + v) as f64)))
                .collect();
            let mut hull = Vec::new();
            polygon::convex_hull(&mut corners, &mut hull);
            prop_assert_eq!(&blob.4, &hull);
        }
    }

    /// Every point of a capsule appears in a masked pixel.
    #[test]
    fn the_silhouette_of_a_capsule_masks_all_of_it(camera in camera(), a in point(-1.0..1.0), b in point(-1.0..1.0),
        height in 0.2..1.2, radius in 0.02..0.2, along in 0.0..1.0, way in (-1.0..1.0, -1.0..1.0, -1.0..1.0)) {
        let (from, to) = (Vec3::new(a.x, a.y, height), Vec3::new(b.x, b.y, height * 0.7));
        let mut mask = PixelMask::new(640, 480);
        let part = ArmPart::Capsule { from, to, radius_m: radius };
        mask.mask_arm(&Calibration::Camera(camera.clone()), &[part], 0.0).unwrap();
        let direction = Vec3::new(way.0, way.1, way.2).try_normalize().unwrap_or(Vec3::Z);
        // Points behind the camera have no pixel.
        if let Some(seen) = camera.world_to_pixel(from.lerp(to, along) + direction * radius)
            && (0.0..640.0).contains(&seen.x) && (0.0..480.0).contains(&seen.y) {
            prop_assert!(mask.is_masked(seen.x as usize, seen.y as usize), "{seen:?}");
        }
    }
}

fn flood_fill(plane: &[u8], width: usize) -> Vec<Vec<usize>> {
    let height = plane.len() / width;
    let mut taken = vec![false; plane.len()];
    let mut blobs = Vec::new();
    for start in 0..plane.len() {
        if plane[start] == 0 || taken[start] {
            continue;
        }
        taken[start] = true;
        let mut blob = vec![start];
        let mut next = 0;
        while next < blob.len() {
            let (x, y) = (blob[next] % width, blob[next] / width);
            next += 1;
            for v in y.saturating_sub(1)..(y + 2).min(height) {
                for u in x.saturating_sub(1)..(x + 2).min(width) {
                    let i = v * width + u;
                    if plane[i] != 0 && !taken[i] {
                        taken[i] = true;
                        blob.push(i);
                    }
                }
            }
        }
        blobs.push(blob);
    }
    blobs
}

#[test]
fn inconsistent_calibrations_are_refused_with_a_reason() {
    let square = [p(0.0, 0.0), p(1.0, 0.0), p(1.0, 1.0), p(0.0, 1.0)];
    let refuse = |seen: &[Point2], at: &[Point2]| FloorHomography::from_points(9, 9, seen, at).unwrap_err().to_string();
    assert!(refuse(&square[..3], &square[..3]).contains("at least 4"));
    assert!(refuse(&square, &square[..3]).contains("4 pixels but 3 places"));
    assert!(refuse(&[p(1.0, 1.0); 4], &square).contains("coincide"));
    assert!(refuse(&[p(f64::NAN, 1.0), square[1], square[2], square[3]], &square).contains("pair 0"));
    let twisted = [square[0], square[2], square[1], square[3]];
    assert!(refuse(&square, &twisted).contains("horizon"));
}

#[test]
fn a_part_that_is_partly_behind_the_camera_masks_the_whole_image() {
    let lens = Intrinsics::pinhole(64, 48, 1.2);
    let camera = Camera::look_at(lens, Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, Vec3::Y).unwrap();
    let mut mask = PixelMask::new(64, 48);
    let part = |z: f64| ArmPart::Hull(vec![Vec3::new(0.5, 0.0, z), Vec3::new(0.6, 0.0, z), Vec3::new(0.5, 0.1, 3.0)]);
    mask.mask_arm(&camera.clone().into(), &[part(2.5)], 0.01).unwrap();
    assert_eq!(mask.coverage(), 0.0);
    mask.mask_arm(&camera.into(), &[part(1.0)], 0.01).unwrap();
    assert_eq!(mask.coverage(), 1.0);
}

/// Corners on a small grid, so that segments often touch, lie on one line or are points. The oracle solves for the common
/// point in whole numbers, and compares extents along the line where there is none or more than one.
#[test]
fn segments_intersect_where_they_have_a_point_in_common() {
    let mut random = SplitMix(3);
    let mut whole = || (random.between(0.0, 5.0) as i64, random.between(0.0, 5.0) as i64);
    let point = |(x, y): (i64, i64)| p(x as f64, y as f64);
    let (mut met, mut parallel) = (0, 0);
    for _ in 0..50_000 {
        let [a, b, c, d] = [whole(), whole(), whole(), whole()];
        let (r, s, q) = ((b.0 - a.0, b.1 - a.1), (d.0 - c.0, d.1 - c.1), (c.0 - a.0, c.1 - a.1));
        let cross = |u: (i64, i64), v: (i64, i64)| u.0 * v.1 - u.1 * v.0;
        let (all, t, u) = (cross(r, s), cross(q, s), cross(q, r));
        let within = |part: i64| if all > 0 { (0..=all).contains(&part) } else { (all..=0).contains(&part) };
        let expected = if all != 0 {
            within(t) && within(u)
        } else {
            parallel += 1;
            let on = |(from, to): ((i64, i64), (i64, i64)), p: (i64, i64)| {
                let (way, out) = ((to.0 - from.0, to.1 - from.1), (p.0 - from.0, p.1 - from.1));
                let along = way.0 * out.0 + way.1 * out.1;
                cross(way, out) == 0
                    && along >= 0
                    && along <= way.0 * way.0 + way.1 * way.1
                    && (way != (0, 0) || out == (0, 0))
            };
            on((a, b), c) || on((a, b), d) || on((c, d), a) || on((c, d), b)
        };
        let found = polygon::segments_intersect((point(a), point(b)), (point(c), point(d)));
        assert_eq!(found, expected, "{a:?} {b:?} and {c:?} {d:?}");
        met += usize::from(found);
    }
    assert!(met > 5000 && parallel > 5000, "{met} {parallel}");
}
