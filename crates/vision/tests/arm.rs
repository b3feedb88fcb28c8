//! The arm in the picture: what it hides is unknown, and so not free.

mod stage;

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::Solid;
use elbowroom_vision::{ArmPart, Change, Point2, Settings, Template};
use stage::{Stage, covers};

fn forearm(tip: Vec3) -> ArmPart {
    ArmPart::Capsule { from: Vec3::new(0.2, 2.5, 1.4), to: tip, radius_m: 0.15 }
}

fn settings() -> Settings {
    Settings { templates: vec![Template::new("crate", 0.6, 0.4, 0.3)], ..Settings::default() }
}

fn crate_at(x: f64) -> Solid {
    Solid::cuboid(Point2::new(x, -0.2), Vec3::new(0.6, 0.4, 0.3), 0.4, 210)
}

#[test]
fn an_arm_over_the_empty_cell_is_no_obstacle() {
    let mut stage = Stage::new(320, 240, settings());
    for i in 0..60 {
        let tip = Vec3::new(-1.2 + 0.04 * f64::from(i), -0.2, 1.0);
        let report = stage.step_with_arm(&[], &[forearm(tip)]);
        assert!(report.obstacles.is_empty(), "frame {i}: {:?}", report.obstacles);
    }
}

#[test]
fn a_thing_that_the_arm_sweeps_over_stays_where_it_is() {
    let mut stage = Stage::new(320, 240, settings());
    let thing = crate_at(0.2);
    let id = stage.step(std::slice::from_ref(&thing)).obstacles[0].id;
    (0..5).for_each(|_| drop(stage.step(std::slice::from_ref(&thing)).obstacles.clone()));
    let (mut hidden, mut moved) = (0, 0);
    for i in 0..90 {
        let tip = Vec3::new(-1.4 + 0.035 * f64::from(i), -0.8, 1.0);
        let report = stage.step_with_arm(std::slice::from_ref(&thing), &[forearm(tip)]);
        assert_eq!(report.obstacles.len(), 1, "frame {i}: {:#?}", report.obstacles);
        let told = &report.obstacles[0];
        assert_eq!(told.id, id);
        assert!(covers(told, &thing), "frame {i}: {told:?}");
        assert!(told.kind.is_some(), "frame {i}");
        hidden += u32::from(told.is_remembered);
        moved += u32::from(told.change == Change::Moved);
    }
    println!("hidden in {hidden} frames, told to have moved in {moved}");
    assert!(hidden > 20 && moved <= 4);
}

#[test]
fn a_thing_wholly_hidden_is_kept_for_as_long_as_it_is_hidden_and_then_found_gone() {
    let mut stage = Stage::new(320, 240, settings());
    let thing = Solid::cuboid(Point2::new(0.2, -0.2), Vec3::new(0.15, 0.15, 0.3), 0.0, 210);
    stage.step(std::slice::from_ref(&thing));
    let arm = [forearm(Vec3::new(0.2, -0.6, 1.0))];
    for i in 0..100 {
        // Taken away meanwhile; nobody can see it.
        let solids = if i < 50 { std::slice::from_ref(&thing) } else { &[] };
        let report = stage.step_with_arm(solids, &arm);
        assert_eq!(report.obstacles.len(), 1, "frame {i}");
        assert!(report.obstacles[0].is_remembered && covers(&report.obstacles[0], &thing));
    }
    let told: Vec<usize> = (0..6).map(|_| stage.step(&[]).obstacles.len()).collect();
    assert_eq!(told, [1, 1, 1, 0, 0, 0]);
}

#[test]
fn a_thing_that_moves_under_the_arm_is_never_uncovered() {
    let mut stage = Stage::new(320, 240, settings());
    let arm = [forearm(Vec3::new(0.2, -0.8, 1.0))];
    for i in 0..100 {
        let thing = crate_at(-1.3 + 0.03 * f64::from(i));
        let report = stage.step_with_arm(std::slice::from_ref(&thing), &arm);
        let seen = stage::cover_together(&report.obstacles, &thing);
        assert!(seen, "frame {i}: {thing:?} {:#?}", report.obstacles);
    }
}

#[test]
fn where_the_arm_was_all_the_time_while_the_background_was_learnt_nothing_is_known() {
    let mut stage = Stage::new(320, 240, settings());
    stage.vision.learn_again();
    let arm = [forearm(Vec3::new(0.2, -0.6, 1.0))];
    for _ in 0..stage.vision.settings().learning_frames {
        stage.step_with_arm(&[], &arm);
    }
    assert!(stage.step_with_arm(&[], &arm).obstacles.is_empty());
    assert_eq!(stage.step(&[]).obstacles.len(), 1);
}
