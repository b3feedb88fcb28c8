//! The arm in the image: the space that it occludes is unknown and therefore not free.

use crate::synthetic;
use crate::synthetic::{SyntheticScene, covers};
use elbowroom_spatial::Vec3;
use elbowroom_vision::render::RenderedSolid;
use elbowroom_vision::{ArmPart, CameraTrackerSettings, ObstacleChange, Point2, Template};

fn forearm(tip: Vec3) -> ArmPart {
    ArmPart::Capsule { from: Vec3::new(0.2, 2.5, 1.4), to: tip, radius_m: 0.15 }
}

fn settings() -> CameraTrackerSettings {
    CameraTrackerSettings { templates: vec![Template::new("crate", 0.6, 0.4, 0.3)], ..CameraTrackerSettings::default() }
}

fn crate_at(x: f64) -> RenderedSolid {
    RenderedSolid::cuboid(Point2::new(x, -0.2), Vec3::new(0.6, 0.4, 0.3), 0.4, 210)
}

#[test]
fn an_arm_over_the_empty_cell_is_no_obstacle() {
    let mut scene = SyntheticScene::new(320, 240, settings());
    for i in 0..60 {
        let tip = Vec3::new(-1.2 + 0.04 * f64::from(i), -0.2, 1.0);
        let report = scene.step_with_arm(&[], &[forearm(tip)]);
        assert!(report.obstacles.is_empty(), "frame {i}: {:?}", report.obstacles);
    }
}

#[test]
fn an_object_that_the_arm_sweeps_over_does_not_move() {
    let mut scene = SyntheticScene::new(320, 240, settings());
    let object = crate_at(0.2);
    let id = scene.step(std::slice::from_ref(&object)).obstacles[0].id;
    (0..5).for_each(|_| drop(scene.step(std::slice::from_ref(&object)).obstacles.clone()));
    let (mut occluded, mut moved) = (0, 0);
    for i in 0..90 {
        let tip = Vec3::new(-1.4 + 0.035 * f64::from(i), -0.8, 1.0);
        let report = scene.step_with_arm(std::slice::from_ref(&object), &[forearm(tip)]);
        assert_eq!(report.obstacles.len(), 1, "frame {i}: {:#?}", report.obstacles);
        let reported = &report.obstacles[0];
        assert_eq!(reported.id, id);
        assert!(covers(reported, &object), "frame {i}: {reported:?}");
        assert!(reported.kind.is_some(), "frame {i}");
        occluded += u32::from(reported.is_unobserved);
        moved += u32::from(reported.change == ObstacleChange::Moved);
    }
    println!("occluded in {occluded} frames, reported to have moved in {moved}");
    assert!(occluded > 20 && moved <= 4);
}

#[test]
fn an_occluded_object_is_kept_until_it_is_observed_to_be_gone() {
    let mut scene = SyntheticScene::new(320, 240, settings());
    let object = RenderedSolid::cuboid(Point2::new(0.2, -0.2), Vec3::new(0.15, 0.15, 0.3), 0.0, 210);
    scene.step(std::slice::from_ref(&object));
    let arm = [forearm(Vec3::new(0.2, -0.6, 1.0))];
    for i in 0..100 {
        // The object is removed in between, without being observed.
        let solids = if i < 50 { std::slice::from_ref(&object) } else { &[] };
        let report = scene.step_with_arm(solids, &arm);
        assert_eq!(report.obstacles.len(), 1, "frame {i}");
        assert!(report.obstacles[0].is_unobserved && covers(&report.obstacles[0], &object));
    }
    let reported: Vec<usize> = (0..6).map(|_| scene.step(&[]).obstacles.len()).collect();
    assert_eq!(reported, [1, 1, 1, 0, 0, 0]);
}

#[test]
fn an_object_that_moves_under_the_arm_is_always_covered() {
    let mut scene = SyntheticScene::new(320, 240, settings());
    let arm = [forearm(Vec3::new(0.2, -0.8, 1.0))];
    for i in 0..100 {
        let object = crate_at(-1.3 + 0.03 * f64::from(i));
        let report = scene.step_with_arm(std::slice::from_ref(&object), &arm);
        let is_covered = synthetic::cover_together(&report.obstacles, &object);
        assert!(is_covered, "frame {i}: {object:?} {:#?}", report.obstacles);
    }
}

#[test]
fn pixels_that_were_always_masked_while_learning_are_obstacles() {
    let mut scene = SyntheticScene::new(320, 240, settings());
    scene.tracker.relearn();
    let arm = [forearm(Vec3::new(0.2, -0.6, 1.0))];
    for _ in 0..scene.tracker.settings().learning_frames {
        scene.step_with_arm(&[], &arm);
    }
    assert!(scene.step_with_arm(&[], &arm).obstacles.is_empty());
    assert_eq!(scene.step(&[]).obstacles.len(), 1);
}
