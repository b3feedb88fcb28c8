//! Several arms act as one: who holds the work-piece, when it is handed over, and where the others wait.
//!
//! | | |
//! | --- | --- |
//! | [`VirtualRobot`] | one step: moves all arms, with the work-piece on its desired path |
//! | [`Member`], [`Grasp`] | an arm, and how it can grasp the work-piece |
//! | [`CooperationSettings`] | distances, speeds and times |
//! | [`CooperationStep`] | what a step did, and why the work-piece stands |
//!
//! The idea is the virtual robot of Giralt and others (*Robotic Proximity Queries Library for Online Motion Planning
//! Applications*). README.md in this folder says how the
//! decisions are made.
//!
//! A monitor of interference regions scales the motion of every arm, and never depends on this crate.
//!
//! ```
//! use elbowroom_cooperation::{CooperationSettings, Grasp, Member, VirtualRobot};
//! use elbowroom_formats::{LoadOptions, robot};
//! use elbowroom_kinematics::JointLimits;
//! use elbowroom_proximity::{Cuboid, Shape};
//! use elbowroom_robot::{GeometryId, ObjectId};
//! use elbowroom_scene::{Object, Scene, SceneState};
//! use elbowroom_spatial::{Pose, Rotation, Vec3};
//! let arm = robot::load(&elbowroom_testkit::folder::model("rx60b"), &LoadOptions::default())?.robot;
//! let (limits, tip) = (JointLimits::of_chain(&arm.chain, 0.3, 0.3, 2.0), arm.chain.link("tool0").unwrap());
//! // A bar of 0.3 m; both arms can take it at either end.
//! let end = |z: Vec3| Grasp { tool_in_part: Pose::new(Rotation::from_z(-z), z * 0.15), approach: z * -0.06 };
//! let grasps = vec![end(Vec3::Z), end(-Vec3::Z)];
//! let mut builder = Scene::builder();
//! let facing = Pose::new(Rotation::from_axis_angle(Vec3::Z, std::f64::consts::PI), Vec3::X * 1.2);
//! let robots = [("left", Pose::IDENTITY), ("right", facing)].map(|(name, base)| builder.robot(name, arm.clone(), base));
//! let bar = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.02, 0.02, 0.15) });
//! builder.object(Object { name: "bar".into(), shape: bar, in_world: Pose::IDENTITY });
//! let scene = builder.build()?;
//! let mut state = SceneState::new(&scene);
//! state.set_q(&scene, robots[0], &[0.0, 0.6, 1.5, 0.0, -0.5, 0.0])?;
//! state.set_q(&scene, robots[1], &[0.0, -0.3, 1.9, 0.0, 0.5, 0.0])?;
//! // The bar is in the hand of the left arm.
//! let tool = state.pose(&scene, GeometryId::Link { robot: robots[0], link: tip }).unwrap();
//! state.place(&scene, ObjectId(0), tool * grasps[1].tool_in_part.inverse())?;
//! let member = |robot| Member {
//!     robot,
//!     tip,
//!     tool_in_tip: Pose::IDENTITY,
//!     limits: limits.clone(),
//!     hand: vec![tip, arm.chain.link("link_6").unwrap()],
//!     grasps: grasps.clone(),
//! };
//! let members = robots.map(member).to_vec();
//! let mut pair = VirtualRobot::new(&scene, state, ObjectId(0), members, (0, 1), CooperationSettings::default())?;
//! let start = pair.part_in_world();
//! for k in 0..500 {
//!     let t_s = 0.004 * f64::from(k);
//!     // The desired pose: 20 mm to the side in a second.
//!     pair.desire(t_s, &Pose::new(start.rotation, start.translation + Vec3::Y * (0.02 * t_s.min(1.0))))?;
//!     pair.step(0.004, &[1.0, 1.0]);
//! }
//! assert!((pair.part_in_world().translation - start.translation - Vec3::Y * 0.02).length() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** The work-piece is always held, by one arm or by two, and always on its desired path: what stands in the
//! way makes it slower, never makes it deviate.

mod advance;
mod carried;
mod decision;
mod decision_memory;
mod desired_path;
mod error;
mod forecast;
mod free_arm;
mod hand_over;
mod hold_limit;
mod holding;
mod look_ahead;
mod member;
mod proceed;
mod settings;
mod step;
mod trace;
mod view;
mod virtual_robot;

pub use error::{CooperationError, PoseRefusal};
pub use hand_over::HandOverPhase;
pub use hold_limit::HoldLimit;
pub use member::{Grasp, Member};
pub use settings::CooperationSettings;
pub use step::{CooperationStep, HandOverReason, HandedOver, Hold};
pub use virtual_robot::VirtualRobot;
