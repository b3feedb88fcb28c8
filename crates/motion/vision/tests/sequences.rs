//! Rendered sequences with ground truth: objects that enter, cross, touch, separate and leave.

use crate::synthetic;
use crate::synthetic::{SyntheticScene, cover_together, covers, median, middle};
use elbowroom_spatial::Vec3;
use elbowroom_vision::render::RenderedSolid;
use elbowroom_vision::{
    Camera, CameraTrackerSettings, Channels, Intrinsics, ObstacleChange, ObstacleId, Point2, ShadowSettings, Template,
    TrackSettings,
};

const CRATE: Vec3 = Vec3::new(0.6, 0.4, 0.3);

fn templates() -> Vec<Template> {
    vec![Template::new("crate", 0.6, 0.4, 0.3), Template::cylinder("drum", 0.5, 0.6)]
}

fn settings() -> CameraTrackerSettings {
    CameraTrackerSettings {
        templates: templates(),
        shadows: Some(ShadowSettings::default()),
        ..CameraTrackerSettings::default()
    }
}

#[test]
fn noisy_frames_of_the_empty_cell_give_no_obstacle_while_the_light_drifts() {
    for (channels, frames) in [(Channels::Grey, 200), (Channels::Rgb, 100)] {
        let mut scene = SyntheticScene::with_camera(synthetic::camera(320, 240), channels, settings());
        for i in 0..frames {
            let t = f64::from(i) / f64::from(frames);
            scene.conditions.noise = 4.0;
            scene.conditions.gain = 1.0 + 0.4 * (t * 9.0).sin();
            scene.conditions.offset = 15.0 * (t * 5.0).sin();
            scene.conditions.slope = 0.15 * t;
            let report = scene.step(&[]);
            assert!(report.obstacles.is_empty(), "frame {i}: {:?}", report.obstacles);
            assert_eq!(report.status, elbowroom_vision::FrameStatus::Accepted);
        }
    }
}

/// One object enters, crosses and leaves: one identity, always covered, its position within a pixel or two.
fn crosses(mut scene: SyntheticScene, make: impl Fn(Point2, f64) -> RenderedSolid, max_error_m: f64) {
    let (mut ids, mut entered, mut left, mut covered, mut errors) = (vec![], 0, 0, 0, vec![]);
    let mut in_view = 0;
    for i in 0..84 {
        let x = -3.2 + 0.08 * f64::from(i);
        let object = make(Point2::new(x, -0.2 + 0.1 * x), 0.03 * f64::from(i));
        let report = scene.step(std::slice::from_ref(&object));
        assert!(report.obstacles.len() <= 1, "frame {i}: {:?}", report.obstacles);
        let reported = report.obstacles.first();
        entered += usize::from(reported.is_some_and(|o| o.change == ObstacleChange::Entered));
        left += usize::from(reported.is_some_and(|o| o.change == ObstacleChange::Left));
        ids.extend(reported.map(|o| o.id));
        if (-1.5..1.9).contains(&x) {
            in_view += 1;
            let Some(reported) = reported else { continue };
            covered += usize::from(covers(reported, &object));
            if x > -1.2 {
                assert_eq!(reported.kind.is_some(), max_error_m < 0.1, "frame {i}: {reported:?}");
            } else if reported.kind.is_none() {
                continue;
            }
            errors.push((reported.centre_m - middle(&object)).length());
        }
    }
    ids.dedup();
    assert_eq!((ids.len(), entered, left), (1, 1, 1));
    assert_eq!(covered, in_view, "recall");
    let worst = errors.iter().fold(0.0_f64, |s, &e| s.max(e));
    let usual = median(&mut errors);
    eprintln!("recall {covered}/{in_view}, position: median {:.1} mm, worst {:.1} mm", usual * 1e3, worst * 1e3);
    assert!(worst < max_error_m, "{worst}");
}

#[test]
fn a_crate_with_a_template_crosses() {
    crosses(SyntheticScene::new(640, 480, settings()), |p, angle| RenderedSolid::cuboid(p, CRATE, angle, 210), 0.02);
}

#[test]
fn a_dark_drum_with_a_template_crosses() {
    crosses(SyntheticScene::new(640, 480, settings()), |p, _| RenderedSolid::cylinder(p, 0.25, 0.6, 20), 0.02);
}

#[test]
fn an_object_without_a_template_crosses_and_is_unbounded() {
    // 1.1 m high and viewed obliquely: the centre of the projected outline differs from the centre of the object.
    let column = |p, angle| RenderedSolid::cuboid(p, Vec3::new(0.3, 0.25, 1.1), angle, 200);
    crosses(SyntheticScene::new(320, 240, settings()), column, 0.6);
}

#[test]
fn lens_distortion_changes_nothing() {
    let lens = Intrinsics { radial: [-0.18, 0.03, 0.0], ..Intrinsics::pinhole(640, 480, 1.1) };
    let camera = Camera::look_at(lens, Vec3::new(0.2, -0.3, 4.0), Vec3::new(0.2, -0.2, 0.0), Vec3::Y).unwrap();
    let scene = SyntheticScene::with_camera(camera, Channels::Rgb, settings());
    crosses(scene, |p, angle| RenderedSolid::cuboid(p, CRATE, angle, 210), 0.02);
}

/// Two objects on given paths: both are covered in every frame, and each has the same identity in the first and last
/// frame.
fn check_identities(paths: impl Fn(f64) -> [RenderedSolid; 2], frames: u32) {
    let mut scene = SyntheticScene::new(320, 240, settings());
    let mut ids: Option<[ObstacleId; 2]> = None;
    let mut merged = 0;
    for i in 0..frames {
        let truth = paths(f64::from(i) / f64::from(frames - 1));
        let report = scene.step(&truth);
        let obstacles: Vec<_> = report.obstacles.iter().filter(|o| o.change != ObstacleChange::Left).cloned().collect();
        for solid in &truth {
            assert!(cover_together(&obstacles, solid), "frame {i}: {solid:?} in {obstacles:#?}");
        }
        assert_eq!(obstacles.len(), 2, "frame {i}: {obstacles:#?}");
        let nearest = |solid: &RenderedSolid| {
            let distance = |p: Point2| (p - middle(solid)).length();
            obstacles.iter().min_by(|a, b| distance(a.centre_m).total_cmp(&distance(b.centre_m))).unwrap().id
        };
        let now = [nearest(&truth[0]), nearest(&truth[1])];
        merged += u32::from(scene.tracker.foreground().contains(&1) && one_blob(&scene));
        if i == 0 {
            ids = Some(now);
        }
        if i == frames - 1 {
            assert_eq!(Some(now), ids, "identities swapped");
            assert_ne!(now[0], now[1]);
        }
    }
    eprintln!("merged in {merged} of {frames} frames");
    assert!(merged > 3, "they never touched");
}

fn one_blob(scene: &SyntheticScene) -> bool {
    let mut components = elbowroom_vision::ConnectedComponents::default();
    components.label(scene.tracker.foreground(), 320, 30).len() == 1
}

#[test]
fn two_crates_touch_stay_together_and_separate() {
    check_identities(
        |t| {
            let gap = 0.6 + 0.8 * ((t - 0.5).abs() * 2.0 - 0.25).max(0.0);
            let at = |x: f64| Point2::new(0.2 + x, -0.3);
            [
                RenderedSolid::cuboid(at(-gap / 2.0), CRATE, 0.0, 205),
                RenderedSolid::cuboid(at(gap / 2.0), CRATE, 0.0, 215),
            ]
        },
        120,
    );
}

#[test]
fn two_crates_pass_each_other_side_by_side() {
    check_identities(
        |t| {
            let x = 2.4 * (t - 0.5);
            let a = RenderedSolid::cuboid(Point2::new(0.2 + x, -0.1), CRATE, 0.0, 205);
            [a, RenderedSolid::cuboid(Point2::new(0.2 - x, -0.51), CRATE, 0.0, 205)]
        },
        100,
    );
}

#[test]
fn a_light_and_a_dark_object_touch_and_rotate_about_each_other() {
    check_identities(
        |t| {
            let turn = std::f64::consts::PI * ((t - 0.25) * 2.0).clamp(0.0, 1.0);
            let gap = 0.31 + 0.6 * ((t - 0.5).abs() * 2.0 - 0.6).max(0.0);
            let (sin, cos) = turn.sin_cos();
            let arm = Point2::new(cos * gap, sin * gap);
            let here = Point2::new(0.2, -0.3);
            [RenderedSolid::cylinder(here + arm, 0.3, 0.3, 230), RenderedSolid::cylinder(here - arm, 0.3, 0.3, 15)]
        },
        140,
    );
}

#[test]
fn a_stationary_object_never_becomes_background() {
    let track = TrackSettings { hysteresis_m: 0.02, ..TrackSettings::default() };
    let mut scene = SyntheticScene::new(320, 240, CameraTrackerSettings { track, ..settings() });
    let faint = RenderedSolid::cuboid(Point2::new(0.3, 0.2), Vec3::new(0.8, 0.8, 0.05), 0.2, 145);
    let first = scene.step(std::slice::from_ref(&faint)).clone();
    assert_eq!(first.obstacles.len(), 1);
    let mut unchanged = 0;
    for i in 0..400 {
        let report = scene.step(std::slice::from_ref(&faint));
        assert_eq!(report.obstacles.len(), 1, "frame {i}");
        assert!(covers(&report.obstacles[0], &faint), "frame {i}");
        unchanged += u32::from(report.obstacles[0].change == ObstacleChange::Unchanged);
    }
    assert!(unchanged > 395, "a stationary object moved in {} of 400 frames", 400 - unchanged);
    let mut last = scene.step(&[]).clone();
    for _ in 0..5 {
        last = if last.obstacles.is_empty() { last } else { scene.step(&[]).clone() };
    }
    assert!(last.obstacles.is_empty());
}

#[test]
fn a_shadow_is_an_obstacle_only_without_shadow_detection() {
    let light = Some(Vec3::new(0.9, 0.3, -1.0));
    let crate_here = RenderedSolid::cuboid(Point2::new(0.0, 0.0), CRATE, 0.3, 210);
    // An object outside the image casts a shadow into it.
    let mut lamp_post = RenderedSolid::cuboid(Point2::new(-2.2, -0.9), Vec3::new(0.5, 0.5, 0.1), 0.0, 200);
    (lamp_post.z_from_m, lamp_post.z_to_m) = (5.0, 5.1);
    let mut areas = Vec::new();
    for shadows in [Some(ShadowSettings::default()), None] {
        let mut scene = SyntheticScene::new(320, 240, CameraTrackerSettings { shadows, ..settings() });
        scene.conditions.light = light;
        let post = scene.step(std::slice::from_ref(&lamp_post)).obstacles.len();
        assert_eq!(post, usize::from(shadows.is_none()));
        let mut scene = SyntheticScene::new(320, 240, CameraTrackerSettings { shadows, ..settings() });
        scene.conditions.light = light;
        for _ in 0..8 {
            scene.step(std::slice::from_ref(&crate_here));
        }
        let report = scene.step(std::slice::from_ref(&crate_here));
        assert_eq!(report.obstacles.len(), 1);
        assert!(covers(&report.obstacles[0], &crate_here));
        areas.push(elbowroom_vision::polygon::area(&report.obstacles[0].footprint_m));
    }
    println!("crate of 0.240 m²: {:.3} m² reported, with its shadow {:.3} m²", areas[0], areas[1]);
    assert!(areas[0] < 0.40 && areas[1] > 1.2 * areas[0], "{areas:?}");
}

#[test]
fn objects_in_a_permanent_shadow_are_detected() {
    let mut lamp_post = RenderedSolid::cuboid(Point2::new(-2.2, -0.9), Vec3::new(2.0, 2.0, 0.1), 0.0, 200);
    (lamp_post.z_from_m, lamp_post.z_to_m) = (5.0, 5.1);
    let in_shadow = RenderedSolid::cuboid(Point2::new(1.7, 0.2), CRATE, 0.3, 150);
    for frames in [15, 40, 80, 160] {
        let mut scene = SyntheticScene::new(320, 240, settings());
        scene.conditions.light = Some(Vec3::new(0.9, 0.3, -1.0));
        for i in 0..frames {
            let reported = scene.step(std::slice::from_ref(&lamp_post)).obstacles.len();
            assert_eq!(reported, 0, "frame {i}");
        }
        let report = scene.step(&[lamp_post.clone(), in_shadow.clone()]);
        assert_eq!(report.obstacles.len(), 1, "after {frames} frames");
        assert!(covers(&report.obstacles[0], &in_shadow), "after {frames} frames: {:#?}", report.obstacles);
    }
}

#[test]
fn objects_outside_the_monitored_area_are_ignored_until_they_reach_into_it() {
    let area_m = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Point2::new(x, y)).to_vec();
    let track = TrackSettings { area_m, ..TrackSettings::default() };
    let mut scene = SyntheticScene::new(320, 240, CameraTrackerSettings { track, ..settings() });
    let mut first_reported = None;
    for i in 0..60 {
        let x = 2.0 - 0.02 * f64::from(i);
        let object = RenderedSolid::cuboid(Point2::new(x, 0.0), CRATE, 0.0, 210);
        if !scene.step(std::slice::from_ref(&object)).obstacles.is_empty() && first_reported.is_none() {
            first_reported = Some(x - 0.3);
        }
    }
    // The side of the object reaches the border at 1.0; its upper edge is projected up to 7 cm farther out.
    let reported = first_reported.unwrap();
    assert!((0.99..1.05).contains(&reported), "{reported}");
}

#[test]
fn the_same_frames_give_the_same_answers() {
    let run = || {
        let mut scene = SyntheticScene::new(320, 240, settings());
        let mut reported = Vec::new();
        for i in 0..30 {
            let object = RenderedSolid::cuboid(Point2::new(0.02 * f64::from(i), 0.1), CRATE, 0.1 * f64::from(i), 40);
            reported.extend(scene.step(&[object]).obstacles.clone());
        }
        reported
    };
    assert_eq!(run(), run());
}
