//! Test that steps of a navigator and of a guided arm do not allocate.
//!
//! It runs without the test harness, whose threads allocate too: the counter is for the whole process.
mod common;

use common::{arm, ball, block, point, relief};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Selection;
use elbowroom_shared_control::force::{ArmField, ArmForces, BodySettings, FieldPair, ForceLaw, Response, VirtualBody};
use elbowroom_shared_control::{Guide, NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::random::SplitMix;

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let plate = ProtectedSurface::new(block(Vec3::new(0.3, 0.3, 1e-4)), Pose::from_translation(Vec3::Z * 0.06));
    let surfaces = vec![ProtectedSurface::new(relief(24), Pose::IDENTITY).unwrap(), plate.unwrap()];
    let start = Pose::from_translation(Vec3::Z * 0.03);
    let settings = NavigatorSettings { speed_m_s: 2.0, ..Default::default() };
    let mut navigator = SurfaceNavigator::new(ball(0.01, 3), surfaces, start, settings).unwrap();
    let mut random = SplitMix(1);
    let mut in_contact = 0;
    for _ in 0..300 {
        let desired = Pose::from_translation(point(&mut random, 0.1) - Vec3::Z * 0.05);
        let counter = AllocationCounter::start();
        for _ in 0..20 {
            in_contact += usize::from(navigator.step(&desired, 1e-3).active_rows > 0);
        }
        assert_eq!(counter.changes(), 0);
    }
    assert!(in_contact > 500, "{in_contact} of 6000 steps in contact");
    whole_arm();
    point_of_entry();
}

/// An arm whose shaft glides at a point of entry.
fn point_of_entry() {
    let (scene, start) = arm::scene(Some(0.03));
    let mut guided = arm::guided(&scene, start, true);
    let at = start.translation - start.rotation * Vec3::Z * 0.06;
    guided.set_guide(Some(Guide::entry(at, Vec3::Z, 0.0, (0.02, 0.1)).unwrap()));
    let mut random = SplitMix(3);
    let (mut moved, mut velocities) = (0.0, [0.0; 6]);
    for k in 0..100 {
        let desired = Pose::new(start.rotation, start.translation + point(&mut random, 0.05) - Vec3::Z * 0.03);
        let (before, counter) = (guided.tool_in_world(), AllocationCounter::start());
        for _ in 0..20 {
            guided.step(Some(&desired), arm::DT_S, 1.0);
            guided.intent(Some(&desired), arm::DT_S, &mut velocities);
        }
        assert!(k == 0 || counter.changes() == 0, "{} in round {k}", counter.changes());
        moved += (guided.tool_in_world().rotation * before.rotation.inverse()).angle();
    }
    assert!(moved > 0.5, "{moved} rad");
}

/// An arm with a virtual mass, a field around the tool, one around the arm, and a guide.
fn whole_arm() {
    let (scene, start) = arm::scene(Some(0.03));
    let mut guided = arm::guided(&scene, start, true);
    let (_, flange, tcp_in_flange, _) = arm::arm();
    let robot = RobotId(0);
    let whole = FieldPair::Scene(Selection::Robot(robot), Selection::Object(ObjectId(0)));
    let field = |pair| ArmField::new(ForceLaw::spring(0.02, 2000.0), pair).unwrap();
    let fields = vec![field(FieldPair::Surface(0)), field(whole)];
    let body = Response::Admittance(VirtualBody::new(BodySettings::default()).unwrap());
    guided.set_forces(ArmForces::new(body, fields, (&scene, robot), (flange, tcp_in_flange.translation)));
    guided.set_guide(Some(Guide::plane(start.translation, Vec3::X).unwrap()));
    let mut random = SplitMix(2);
    let (mut pushed, mut velocities) = (0, [0.0; 6]);
    for k in 0..200 {
        let to = start.translation + point(&mut random, 0.05) - Vec3::Z * 0.03;
        let desired = Pose::new(start.rotation, to);
        let counter = AllocationCounter::start();
        for _ in 0..20 {
            guided.step(Some(&desired), arm::DT_S, 1.0);
            guided.intent(Some(&desired), arm::DT_S, &mut velocities);
            pushed += usize::from(guided.forces().is_some_and(|f| f.sample().force_n.length() > 0.0));
        }
        // Lists of pairs are made in the first steps.
        assert!(k == 0 || counter.changes() == 0, "{} in round {k}", counter.changes());
    }
    assert!(pushed > 500, "{pushed} of 4000 steps with a force");
}
