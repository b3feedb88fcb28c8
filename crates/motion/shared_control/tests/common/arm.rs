//! A six-axis arm with a tool, guided above a block, that tests share.
#![allow(dead_code, reason = "every program uses a part of it")]

use std::sync::Arc;

use elbowroom_formats::{LoadOptions, robot};
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::{Cuboid, Shape, TriMesh};
use elbowroom_robot::{Collider, Robot, RobotId};
use elbowroom_scene::{Object, Scene, SceneState};
use elbowroom_shared_control::{GuidedArm, NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};

use super::block;

/// Joint values at the start, rad.
pub const START: [f64; 6] = [0.0, 0.0, 0.0, 0.0, 0.6, 0.0];
/// Duration of a step, s.
pub const DT_S: f64 = 0.002;

/// A six-axis arm with a tool of 8 by 8 by 100 mm; its tool point is at the tip.
pub fn arm() -> (Robot, LinkId, Pose, Arc<TriMesh>) {
    let file = elbowroom_testkit::folder::model("ns16");
    let mut robot = robot::load(&file, &LoadOptions::default()).unwrap().robot;
    let flange = robot.chain.link("tool0").unwrap();
    let tcp_in_flange = Pose::from_translation(Vec3::Z * 0.1);
    let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.004, 0.004, 0.05) });
    robot.colliders[flange.0].push(Collider {
        name: "tool".into(),
        shape,
        in_link: Pose::from_translation(Vec3::Z * 0.05),
    });
    let tool = block(Vec3::new(0.008, 0.008, 0.1));
    let vertices = tool.vertices().iter().map(|v| *v - Vec3::Z * 0.05).collect();
    let tool = Arc::new(TriMesh::new(vertices, tool.triangles().to_vec()).unwrap());
    (robot, flange, tcp_in_flange, tool)
}

/// A scene with the arm, and a block below its tool point if a gap (m) is given.
pub fn scene(gap_m: Option<f64>) -> (Scene, Pose) {
    let (robot, flange, tcp_in_flange, _) = arm();
    let mut state = ChainState::new(&robot.chain);
    state.q.copy_from_slice(&START);
    robot.chain.forward(&mut state);
    let tool_in_world = state.link_in_root(flange) * tcp_in_flange;
    let mut builder = Scene::builder();
    builder.robot("arm", robot, Pose::IDENTITY);
    if let Some(gap_m) = gap_m {
        let below = tool_in_world.translation - Vec3::Z * (0.05 + gap_m);
        let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.2, 0.2, 0.05) });
        builder.object(Object { name: "work".into(), shape, in_world: Pose::from_translation(below) });
    }
    (builder.build().unwrap(), tool_in_world)
}

/// The arm, guided; the block is protected, or stops the arm.
pub fn guided(scene: &Scene, tool_in_world: Pose, protect: bool) -> GuidedArm<'_> {
    let (robot, flange, tcp_in_flange, tool) = arm();
    let surfaces = if protect {
        let work = &scene.objects()[0];
        vec![ProtectedSurface::new(block(Vec3::new(0.4, 0.4, 0.1)), work.in_world).unwrap()]
    } else {
        vec![]
    };
    let navigator = SurfaceNavigator::new(tool, surfaces, tool_in_world, NavigatorSettings::default()).unwrap();
    let solver = IkSolver::new(&robot.chain, flange, tcp_in_flange, IkOptions::default());
    let mut state = SceneState::new(scene);
    state.set_q(scene, RobotId(0), &START).unwrap();
    GuidedArm::new(navigator, solver, (scene, RobotId(0)), state, vec![1.5; 6]).unwrap()
}
