//! Point clouds: files, noise, the arm, invalid points.

use std::path::Path;

use elbowroom_formats::image::{ImageHeader, PixelFormat};
use elbowroom_formats::png;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::folder;
use elbowroom_testkit::random::Xorshift;
use elbowroom_vision::cloud::{CloudStatus, CloudTracker, CloudTrackerSettings, PointCloud};
use elbowroom_vision::{
    ArmPart, Camera, Intrinsics, Obstacle, ObstacleChange, Point2, TrackSettings, polygon, read_grey16,
};
use proptest::prelude::*;

/// A box given by two corners.
type Cuboid = (Vec3, Vec3);

/// The points that a sensor at `eye` measures on floor, boxes and a capsule, with noise and invalid points; world frame.
fn scan(eye: Vec3, boxes: &[Cuboid], arm: Option<(Vec3, Vec3, f64)>, rays: usize, seed: u64) -> Vec<Vec3> {
    let mut random = Xorshift(seed | 1);
    (0..rays)
        .map(|_| {
            let target = Vec3::new(random.between(-1.5, 1.5), random.between(-1.2, 1.2), 0.0);
            let (mut best, toward) = (1.0, target - eye);
            for &(low, high) in boxes {
                best = first_hit(eye, toward, low, high).map_or(best, |t| t.min(best));
            }
            if let Some((a, b, radius)) = arm {
                best = march(eye, toward, a, b, radius).map_or(best, |t| t.min(best));
            }
            if random.unit() < 0.02 {
                return Vec3::new(f64::NAN, 0.0, 0.0);
            }
            let noise = (random.unit() + random.unit() + random.unit() - 1.5) * 0.004;
            eye + toward * (best + noise / toward.length())
        })
        .collect()
}

fn first_hit(eye: Vec3, toward: Vec3, low: Vec3, high: Vec3) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let [o, d, l, h] = [eye, toward, low, high].map(|v| v.to_array()[axis]);
        let (a, b) = ((l - o) / d, (h - o) / d);
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    (enter <= leave).then_some(enter)
}

fn march(eye: Vec3, toward: Vec3, a: Vec3, b: Vec3, radius: f64) -> Option<f64> {
    let length = toward.length();
    let mut t = 0.0;
    for _ in 0..60 {
        let p = eye + toward * t;
        let s = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        let gap = p.distance(a.lerp(b, s)) - radius;
        if gap < 1e-3 {
            return Some(t);
        }
        t += gap / length;
        if t > 1.0 {
            return None;
        }
    }
    None
}

const EYE: Vec3 = Vec3::new(0.1, -0.2, 3.0);
const ARM: (Vec3, Vec3, f64) = (Vec3::new(0.3, 1.5, 1.2), Vec3::new(0.3, 0.0, 1.0), 0.1);

/// A sensor at the ceiling, pointing down.
fn sensor_in_world() -> Pose {
    Pose::new(Rotation::from_rpy(std::f64::consts::PI, 0.0, 0.4), EYE)
}

fn settings() -> CloudTrackerSettings {
    CloudTrackerSettings { sensor_in_world: sensor_in_world(), voxel_m: 0.06, ..CloudTrackerSettings::default() }
}

fn cloud(points_in_world: &[Vec3], stamp_s: f64) -> PointCloud {
    let mut cloud = PointCloud { stamp_s, ..PointCloud::default() };
    let to_sensor = sensor_in_world().inverse();
    cloud.fill(points_in_world.iter().map(|&p| to_sensor.transform_point(p)));
    cloud
}

fn covers(obstacles: &[Obstacle], (low, high): Cuboid) -> bool {
    obstacles.iter().any(|o| {
        let corners = [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)];
        o.z_from_m <= low.z
            && o.z_to_m >= high.z
            && corners.iter().all(|&(x, y)| polygon::convex_contains(&o.footprint_m, Point2::new(x, y)))
    })
}

fn box_at(x: f64, y: f64) -> Cuboid {
    (Vec3::new(x - 0.2, y - 0.15, 0.0), Vec3::new(x + 0.2, y + 0.15, 0.4))
}

#[test]
fn boxes_are_detected_and_the_arm_is_filtered() {
    let mut tracker = CloudTracker::new(settings()).unwrap();
    let truth = [box_at(-0.7, 0.2), box_at(0.8, -0.5)];
    let arm = ArmPart::Capsule { from: ARM.0, to: ARM.1, radius_m: ARM.2 };
    let mut times = Vec::new();
    for i in 0..20 {
        let points = scan(EYE, &truth, Some(ARM), 60_000, 5 + i);
        let report = tracker.process(&cloud(&points, 0.1 * i as f64), std::slice::from_ref(&arm)).unwrap();
        assert_eq!((report.status, report.obstacles.len()), (CloudStatus::Valid, 2), "{:#?}", report.obstacles);
        assert!(report.arm_points > 500);
        for solid in truth {
            assert!(covers(&report.obstacles, solid), "cloud {i}: {solid:?} {:#?}", report.obstacles);
        }
        let ids: Vec<u64> = report.obstacles.iter().map(|o| o.id.0).collect();
        assert_eq!(ids, [1, 2]);
        times.push(report.timings.total());
    }
    times.sort();
    println!("60,000 points: {:.2} ms", times[10].as_secs_f64() * 1e3);
    let unchanged = tracker.report().obstacles.iter().all(|o| o.change == ObstacleChange::Unchanged);
    assert!(unchanged, "noise must not move objects: {:#?}", tracker.report().obstacles);
    // If its parts are not given, the arm is an obstacle, down to the floor.
    let points = scan(EYE, &truth, Some(ARM), 60_000, 99);
    assert!(tracker.process(&cloud(&points, 10.0), &[]).unwrap().obstacles.len() > 2);
}

#[test]
fn a_moving_box_keeps_its_identity_and_leaves_once() {
    let mut tracker = CloudTracker::new(settings()).unwrap();
    let (mut ids, mut left, mut worst) = (vec![], 0, 0.0_f64);
    for i in 0..60 {
        let x = -0.9 + 0.05 * f64::from(i);
        let truth = [box_at(x, 0.3)];
        let points = scan(EYE, if x < 1.1 { &truth } else { &[] }, None, 30_000, 7 + i as u64);
        let report = tracker.process(&cloud(&points, 0.1 * f64::from(i)), &[]).unwrap();
        assert!(report.obstacles.len() <= 1);
        for o in &report.obstacles {
            ids.push(o.id);
            left += u32::from(o.change == ObstacleChange::Left);
            if x < 1.1 {
                assert!(covers(&report.obstacles, truth[0]), "{i}");
                worst = worst.max((o.centre_m - Point2::new(x, 0.3)).length());
            }
        }
    }
    ids.dedup();
    println!("largest position error {:.1} mm", worst * 1e3);
    assert_eq!((ids.len(), left), (1, 1));
    assert!(worst < 0.03);
}

#[test]
fn points_too_sparse_for_their_voxels_are_counted_as_noise() {
    let mut tracker =
        CloudTracker::new(CloudTrackerSettings { voxel_m: 0.01, ..CloudTrackerSettings::default() }).unwrap();
    let mut cloud = PointCloud { stamp_s: 1.0, ..PointCloud::default() };
    cloud.fill((0..100).map(|i| Vec3::new(f64::from(i) * 0.1, 0.0, 0.5)));
    let report = tracker.process(&cloud, &[]).unwrap();
    assert_eq!((report.obstacles.len(), report.noise_points), (0, 100));
}

#[test]
fn an_occluded_object_is_kept() {
    let mut tracker = CloudTracker::new(settings()).unwrap();
    let small = (Vec3::new(0.4, 0.5, 0.0), Vec3::new(0.5, 0.6, 0.3));
    let free = scan(EYE, &[small], None, 60_000, 3);
    assert_eq!(tracker.process(&cloud(&free, 0.0), &[]).unwrap().obstacles.len(), 1);
    let arm = (Vec3::new(0.42, 1.5, 1.0), Vec3::new(0.3, -0.4, 1.0), 0.3);
    let part = ArmPart::Capsule { from: arm.0, to: arm.1, radius_m: arm.2 };
    for i in 1..20 {
        let points = scan(EYE, &[small], Some(arm), 60_000, 3 + i);
        let report = tracker.process(&cloud(&points, i as f64), std::slice::from_ref(&part)).unwrap();
        assert_eq!(report.obstacles.len(), 1, "{i}");
        assert!(report.obstacles[0].is_unobserved && covers(&report.obstacles, small), "{i}");
    }
    for i in 20..24 {
        tracker.process(&cloud(&scan(EYE, &[], None, 60_000, i), i as f64), &[]).unwrap();
    }
    assert!(tracker.report().obstacles.is_empty());
}

#[test]
fn a_cloud_without_valid_points_changes_no_obstacle() {
    let mut tracker = CloudTracker::new(settings()).unwrap();
    assert_eq!(tracker.process(&cloud(&[], 0.0), &[]).unwrap().age_s, f64::INFINITY);
    let truth = [box_at(0.0, 0.0)];
    tracker.process(&cloud(&scan(EYE, &truth, None, 30_000, 1), 1.0), &[]).unwrap();
    for (i, nothing) in [vec![], vec![Vec3::splat(f64::NAN); 1000]].into_iter().enumerate() {
        let stamp_s = 2.0 + i as f64;
        let report = tracker.process(&cloud(&nothing, stamp_s), &[]).unwrap();
        assert_eq!(report.status, CloudStatus::Empty { points: 0, dropped: nothing.len() });
        assert!((report.age_s - (stamp_s - 1.0)).abs() < 1e-12);
        assert!(covers(&report.obstacles, truth[0]) && report.obstacles[0].is_unobserved);
    }
    assert!(tracker.process(&cloud(&[], 2.0), &[]).unwrap_err().to_string().contains("in order"));
    assert!(tracker.process(&cloud(&[], f64::NAN), &[]).is_err());
}

#[test]
fn clusters_agree_with_a_naive_search() {
    // Points in a sparse block of voxels; expected clusters by comparing all pairs of voxels.
    let mut random = Xorshift(77);
    for round in 0..30 {
        let n = 20 + round * 4;
        let cubes: Vec<[i32; 3]> = (0..n).map(|_| std::array::from_fn(|_| (random.unit() * 8.0) as i32 - 4)).collect();
        let mut group: Vec<usize> = (0..n).collect();
        for _ in 0..n {
            for a in 0..n {
                for b in 0..n {
                    if (0..3).all(|k| (cubes[a][k] - cubes[b][k]).abs() <= 1) {
                        let least = group[a].min(group[b]);
                        (group[a], group[b]) = (least, least);
                    }
                }
            }
        }
        group.sort_unstable();
        group.dedup();
        let settings = CloudTrackerSettings {
            track: TrackSettings { floor_z_m: -10.0, ..CloudTrackerSettings::default().track },
            ceiling_m: 20.0,
            voxel_m: 0.1,
            min_points: 1,
            min_voxels: 1,
            ..CloudTrackerSettings::default()
        };
        let mut tracker = CloudTracker::new(settings).unwrap();
        let mut cloud = PointCloud { stamp_s: 1.0, ..PointCloud::default() };
        // Two points per voxel, because a single point has no outline.
        let at =
            |c: &[i32; 3], d: f64| Vec3::new(f64::from(c[0]) + d, f64::from(c[1]) + d, f64::from(c[2]) + 0.5) * 0.1;
        cloud.fill(cubes.iter().flat_map(|c| [at(c, 0.3), at(c, 0.6)]));
        assert_eq!(tracker.process(&cloud, &[]).unwrap().obstacles.len(), group.len());
    }
}

fn pcd(data: &str) -> Vec<u8> {
    format!("# .PCD v.7\nVERSION .7\nFIELDS x y z rgb\nSIZE 4 8 2 4\nTYPE F F I U\nCOUNT 1 1 1 2\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA {data}\n")
        .into_bytes()
}

fn binary() -> Vec<u8> {
    let mut bytes = pcd("binary");
    for (x, y, z) in [(1.5_f32, -2.0_f64, 3_i16), (f32::NAN, 0.0, 0)] {
        bytes.extend(x.to_le_bytes());
        bytes.extend(y.to_le_bytes());
        bytes.extend(z.to_le_bytes());
        bytes.extend([0; 8]);
    }
    bytes
}

#[test]
fn ascii_and_binary_pcd_of_any_type_is_read() {
    let mut text = pcd("ascii");
    text.extend(b"1.5 -2 3 0 0\n\nnan 0 0 0 0\n");
    for bytes in [text, binary()] {
        let mut cloud = PointCloud::default();
        cloud.decode(&bytes, Path::new("a.pcd")).unwrap();
        assert_eq!((&cloud.points[..], cloud.dropped), (&[Vec3::new(1.5, -2.0, 3.0)][..], 1));
    }
}

#[test]
fn truncated_or_inconsistent_files_are_refused_with_a_reason() {
    let mut cloud = PointCloud::default();
    let mut refuse = |bytes: &[u8], name: &str| cloud.decode(bytes, Path::new(name)).unwrap_err().to_string();
    let whole = binary();
    for length in 0..whole.len() {
        assert!(refuse(&whole[..length], "a.pcd").starts_with("a.pcd:"), "{length}");
    }
    let change = |from: &str, to: &str| String::from_utf8(pcd("ascii")).unwrap().replace(from, to).into_bytes();
    assert!(refuse(&change("POINTS 2", "POINTS 99999999999999999999"), "a.pcd").contains("is no count"));
    assert!(refuse(&change("POINTS 2", "POINTS 9999999999999"), "a.pcd").contains("are announced"));
    assert!(refuse(&change("FIELDS x y z rgb", "FIELDS x y w rgb"), "a.pcd").contains("have no z"));
    assert!(refuse(&change("SIZE 4 8 2 4", "SIZE 4 8 3 4"), "a.pcd").contains("`z`"));
    assert!(refuse(&change("SIZE 4 8 2 4", "SIZE 4 8"), "a.pcd").contains("4 fields, 2 sizes"));
    assert!(refuse(&change("DATA ascii", "DATA zip"), "a.pcd").contains("DATA binary"));
    let mut short = pcd("ascii");
    short.extend(b"1 2 3 0 0\n1 two 3 0 0\n");
    assert!(refuse(&short, "a.pcd").contains("a.pcd:12: `1 two 3 0 0` is no point"));
    assert!(refuse(b"solid", "a.stl").contains("a .pcd or a .ply"));
    assert!(refuse(&pcd("binary_compressed"), "a.pcd").contains("damaged or cut off"));
}

#[test]
fn invalid_points_of_ply_files_are_counted() {
    let text = b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\nnan nan nan\n";
    let mut cloud = PointCloud::default();
    cloud.decode(text, Path::new("a.ply")).unwrap();
    assert_eq!((&cloud.points[..], cloud.dropped), (&[Vec3::new(1.0, 2.0, 3.0)][..], 1));
}

#[test]
fn a_depth_image_gives_the_points_of_the_floor() {
    let lens = Intrinsics { radial: [-0.1, 0.0, 0.0], ..Intrinsics::pinhole(32, 24, 1.0) };
    let camera = Camera::look_at(lens, Vec3::new(0.0, 0.5, 2.0), Vec3::ZERO, Vec3::X).unwrap();
    let mut depths = Vec::new();
    for i in 0..32 * 24 {
        let seen = Point2::new(f64::from(i % 32) + 0.5, f64::from(i / 32) + 0.5);
        let at = camera.pixel_to_plane(seen, 0.0).unwrap();
        let depth = camera.camera_in_world().inverse_transform_point(Vec3::new(at.x, at.y, 0.0)).z;
        depths.push(if i == 5 { 0 } else { (depth * 1e3).round() as u16 });
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("depth.png");
    let bytes: Vec<u8> = depths.iter().flat_map(|d| d.to_be_bytes()).collect();
    let header = ImageHeader { width: 32, height: 24, format: PixelFormat::Grey16 };
    png::write(std::fs::File::create(&path).unwrap(), &header, &bytes).unwrap();
    let (width, height, read) = read_grey16(&path).unwrap();
    assert_eq!((width, height, &read), (32, 24, &depths));
    let mut cloud = PointCloud::default();
    cloud.fill_from_grey16(&camera, &read, 0.001).unwrap();
    assert_eq!((cloud.points.len(), cloud.dropped), (32 * 24 - 1, 1));
    for &p in &cloud.points {
        assert!(camera.camera_in_world().transform_point(p).z.abs() < 1e-3);
    }
    assert!(cloud.fill_from_grey16(&camera, &read, 0.0).unwrap_err().to_string().contains("unit_m"));
    assert!(cloud.fill_from_grey16(&camera, &read[1..], 0.001).is_err() && cloud.points.is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_clouds_never_panic(at in any::<prop::sample::Index>(), to in any::<u8>(), kind in 0..3) {
        let mut bytes = match kind {
            0 => binary(),
            1 => [pcd("ascii"), b"1 2 3 0 0\n4 5 6 0 0\n".to_vec()].concat(),
            _ => [pcd("binary_compressed"), vec![4, 0, 0, 0, 44, 0, 0, 0, 0, 0, 224, 33, 0]].concat(),
        };
        let i = at.index(bytes.len());
        bytes[i] = to;
        let mut cloud = PointCloud::default();
        if cloud.decode(&bytes, Path::new("a.pcd")).is_err() {
            prop_assert!(cloud.points.is_empty());
        }
    }
}

/// Recorded clouds, if the data set is present.
#[test]
fn real_clouds_are_read_and_clustered() {
    let Some(clouds) = folder::data_part("clouds") else { return };
    let known = [
        ("pcl_room_and_lamp/lamppost.pcd", 1771),
        ("pcl_room_and_lamp/min_cut_segmentation_tutorial.pcd", 9311),
        ("pcl_room_and_lamp/room_scan1.pcd", 112_586),
        ("pcl_table_mug_stereo/table_scene_mug_stereo_textured.pcd", 307_200),
        ("tesseract_octomap_pcd/box_pcd.pcd", 8000),
    ];
    for (name, count) in known {
        let mut cloud = PointCloud::default();
        cloud.read(&clouds.join(name)).unwrap();
        assert_eq!(cloud.points.len() + cloud.dropped, count, "{name}");
        let (low, high) =
            cloud.points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |s, p| (s.0.min(p.z), s.1.max(p.z)));
        // Two of them are sparse: a point every 10 cm or so.
        let voxel_m = if [9311, 8000].contains(&count) { 0.3 } else { 0.03 };
        let settings = CloudTrackerSettings {
            track: TrackSettings { floor_z_m: low - 1.0, ..CloudTrackerSettings::default().track },
            ceiling_m: high - low + 2.0,
            voxel_m,
            ..CloudTrackerSettings::default()
        };
        let mut tracker = CloudTracker::new(settings).unwrap();
        let mut times = Vec::new();
        for i in 0..5 {
            cloud.stamp_s = f64::from(i) * 0.1;
            times.push(tracker.process(&cloud, &[]).unwrap().timings.total());
        }
        let report = tracker.report();
        times.sort();
        let (found, ms) = (report.obstacles.len(), times[2].as_secs_f64() * 1e3);
        println!("{name}: {} points, {} dropped, {found} obstacles, {ms:.2} ms", cloud.points.len(), cloud.dropped);
        assert!(found > 0);
    }
}
