//! Collision awareness for industrial robot cells: the crate that a Rust user names in `Cargo.toml`.
//!
//! [`prelude`] has the names that most programs need. Everything else is in one module per crate of the workspace:
//!
//! | module or type | contents |
//! | --- | --- |
//! | [`spatial`] | poses, frame motions, bounding boxes, units |
//! | [`proximity`] | shapes, and collision, distance, penetration and continuous collision detection between two of them |
//! | [`kinematics`] | joint chains: forward, inverse, Jacobian, Denavit-Hartenberg, any surface point as end effector |
//! | [`robot`] | a robot as data: chain, colliders, disabled pairs |
//! | [`scene`] | robots and objects together: collision and distance queries, allowed collision matrix |
//! | [`Diagnostic`] | an error or a warning of a file: what is wrong, where, and what to write instead |
//! | [`formats`] | URDF, SRDF, STL, OBJ, COLLADA, glTF, PLY, OFF, 3DS, VRML |
//! | [`monitor`] | interference regions, checked in every control tick |
//! | [`interlock`] | exchange regions between controllers on a network: arbiter, guards, messages |
//! | [`cspace`] | obstacles as occupied cells of joint space |
//! | [`planner`] | paths on the joint-space map or in the exact scene, replanning, time parametrization |
//! | [`avoidance`] | reactive avoidance: fuzzy rules, least-squares evasion, return to the path |
//! | [`cooperation`] | several arms that carry one work-piece as one robot |
//! | [`vision`] | tracked obstacles from camera frames and point clouds |
//! | [`perception`] | a joint-space map from camera frames, and a replanned motion from the map |
//! | [`cell`] | the cell file and the model it describes |
//! | [`sim`] | simulation of the programs of a cell under the monitors; analysis of whether the laws exclude entry |
//! | [`query`] | collision and distance queries, joint-space maps and planned paths of a cell at its initial state |
//! | [`inspect`] | the contents of a robot model or mesh file |
//! | [`report`] | HTML reports, plots, images, and the text summary of a run |
//!
//! With the feature `live`: `live` (the service on a network), `view` (the cell in a browser), `recording` (MCAP recordings),
//! `ros2` (messages and keys of ROS 2), `status` (the data that a monitored robot publishes).
//!
//! # A guarded controller
//!
//! A controller calls [`monitor::Monitor::tick`] with each joint snapshot and applies the returned speed override:
//!
//! ```
//! use elbowroom::kinematics::{JointKind, Limits, dh::ClassicalRow};
//! use elbowroom::prelude::*;
//!
//! let row = |joint: &str, a: f64| ClassicalRow {
//!     joint: joint.into(), kind: JointKind::Revolute, a, alpha: 0.0, d: 0.0, theta: 0.0,
//!     limits: Limits::symmetric(deg(170.0)),
//! };
//! let scara = Chain::from_dh("scara", &[row("shoulder", mm(400.0)), row("elbow", mm(300.0))])?;
//! let column = Region::cylinder("column", Vec3::new(0.5, 0.5, -0.5), mm(100.0), mm(1000.0), Rotation::IDENTITY)
//!     .warning(mm(200.0))
//!     .guards(Guards::TCP);
//! let mut monitor = Monitor::new(
//!     Configuration::new(ConfigurationParts {
//!         robot: "scara".into(),
//!         base_in_world: Pose::IDENTITY,
//!         volumes: vec![Volume::tcp(scara.tip(), Vec3::ZERO)],
//!         regions: vec![column],
//!         sources: vec![],
//!         grids: vec![],
//!         laws: Laws::default(),
//!         chain: scara,
//!     })?,
//!     None,
//! )?;
//! let far = monitor.tick(&Snapshot::stationary(0.000, &[deg(0.0), deg(0.0)]));
//! assert_eq!(far.speed_override, 1.0);
//! let mut slowest: f64 = 1.0;
//! for i in 1..=50 {
//!     let q = [deg(f64::from(i)), deg(0.0)];
//!     slowest = slowest.min(monitor.tick(&Snapshot::stationary(0.01 * f64::from(i), &q)).speed_override);
//! }
//! assert!(slowest < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Collision and distance
//!
//! A [`scene::Scene`] is constant and shared between threads; each thread has its own [`scene::SceneState`] and
//! [`scene::Checker`]:
//!
//! ```
//! use elbowroom::prelude::*;
//! use elbowroom::robot::example;
//!
//! let mut builder = Scene::builder();
//! builder.robot("arm", example::arm()?, Pose::IDENTITY);
//! let scene = builder.build()?;
//! let state = SceneState::new(&scene);
//! let mut checker = Checker::new(&scene, CheckerOptions::default());
//! assert!(checker.collides(&state).is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A collision-free path
//!
//! RRT-Connect plans for any number of joints in the exact scene; continuous collision detection proves every segment:
//!
//! ```
//! use elbowroom::prelude::*;
//! use elbowroom::robot::example;
//!
//! let mut builder = Scene::builder();
//! let arm = builder.robot("arm", example::arm()?, Pose::IDENTITY);
//! let scene = builder.build()?;
//! let state = SceneState::new(&scene);
//! let path = RrtConnect::new(&scene, arm)?.plan(&state, &[0.5, 0.4, 0.3], &RrtConnectSettings::default())?;
//! assert_eq!(path.waypoints.last().unwrap(), &[0.5, 0.4, 0.3]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A whole cell
//!
//! [`cell::Cell::load`] reads a cell file (`docs/cell-file.md`); [`sim::simulate`] runs its programs under the monitor. The
//! `elbowroom` command does the same from a shell.
//!
//! ```
//! use elbowroom::prelude::*;
//!
//! let cell = Cell::parse("rail.toml", r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.rail]
//! dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
//! [region.end]
//! shape = "plane"
//! origin = [0, 0, 1000]
//! x = [0, 1, 1000]
//! y = [1, 0, 1000]
//! warning = 300
//! guards = ["tcp"]
//! [program.rail]
//! steps = [{ move = "joint", to = [1500], speed = 50 }]
//! "#)?;
//! let run = simulate(&cell, &RunOptions::default())?.recording;
//! assert!(!run.robots[0].finished && !run.regions[0].entered); // stopped at the border
//! println!("{}", elbowroom::report::summary(&run, 80, false));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The folder `examples` of the crate has whole programs: `1_distance`, `2_monitor`, `3_plan`, `4_joint_map`, `5_exchange`
//! (`cargo run --release -p elbowroom --example 1_distance`).
//!
//! This is not a certified safety device.
//!
//! **Invariant.** Without the feature `live`, no crate that opens a network connection is ever linked.

pub mod prelude;

/// The README's examples must compile.
#[cfg(doctest)]
#[doc = include_str!("../../../../README.md")]
struct Readme;

pub use elbowroom_avoidance as avoidance;
pub use elbowroom_cell as cell;
pub use elbowroom_cooperation as cooperation;
pub use elbowroom_cspace as cspace;
pub use elbowroom_formats as formats;
pub use elbowroom_formats::Diagnostic;
pub use elbowroom_inspect as inspect;
pub use elbowroom_interlock as interlock;
pub use elbowroom_kinematics as kinematics;
#[cfg(feature = "live")]
pub use elbowroom_live as live;
pub use elbowroom_monitor as monitor;
pub use elbowroom_perception as perception;
pub use elbowroom_planner as planner;
pub use elbowroom_proximity as proximity;
pub use elbowroom_query as query;
#[cfg(feature = "live")]
pub use elbowroom_recording as recording;
pub use elbowroom_report as report;
pub use elbowroom_robot as robot;
#[cfg(feature = "live")]
pub use elbowroom_ros2 as ros2;
pub use elbowroom_scene as scene;
pub use elbowroom_shared_control as shared_control;
pub use elbowroom_sim as sim;
pub use elbowroom_spatial as spatial;
#[cfg(feature = "live")]
pub use elbowroom_status as status;
#[cfg(feature = "live")]
pub use elbowroom_view as view;
pub use elbowroom_vision as vision;
