//! Collision awareness for industrial robot cells: what a Rust user writes in `Cargo.toml`.
//!
//! | room | what happens in it |
//! | --- | --- |
//! | [`spatial`] | poses, motions, boxes, units |
//! | [`proximity`] | shapes and the questions between two of them |
//! | [`kinematics`] | chains of joints: forward, inverse, Jacobian, Denavit-Hartenberg, any point of a surface as the end of a chain |
//! | [`scene`] | robots and objects together |
//! | [`formats`] | URDF, SRDF, STL, OBJ, COLLADA, glTF, PLY, OFF, 3DS |
//! | [`monitor`] | interference regions, checked every control tick |
//! | [`cspace`] | obstacles as blocked cells of joint space |
//! | [`planner`] | ways around, on the joint-space map or in the exact scene |
//! | [`avoidance`] | reacting while moving: fuzzy rules, evasion, the way back |
//! | [`vision`] | camera frames and point clouds to obstacles with an identity |
//! | [`cell`] | a whole cell from one file, run in simulated time, with its report |
//!
//! # A guarded controller
//!
//! A controller ticks a [`monitor::Monitor`] with each joint snapshot and obeys the override it answers:
//!
//! ```
//! use elbowroom::kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
//! use elbowroom::monitor::{Configuration, ConfigurationParts, Guards, Laws, Monitor, Region, Snapshot, Volume};
//! use elbowroom::spatial::{Pose, Rotation, Vec3, units::{deg, mm}};
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
//!         laws: Laws::default(),
//!         chain: scara,
//!     })?,
//!     None,
//! )?;
//! let far = monitor.tick(&Snapshot::still(0.000, &[deg(0.0), deg(0.0)]));
//! assert_eq!(far.speed_override, 1.0);
//! let mut slowest: f64 = 1.0;
//! for i in 1..=50 {
//!     let q = [deg(f64::from(i)), deg(0.0)];
//!     slowest = slowest.min(monitor.tick(&Snapshot::still(0.01 * f64::from(i), &q)).speed_override);
//! }
//! assert!(slowest < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A whole cell
//!
//! [`cell::Cell::load`] reads the cell file of `docs/cell-file.md`; [`cell::simulate`] runs its programs under the
//! monitor. The `elbowroom` command does the same from a shell.
//!
//! This is not a certified safety device.

/// The README's examples must compile.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

pub use elbowroom_avoidance as avoidance;
pub use elbowroom_cell as cell;
pub use elbowroom_cspace as cspace;
pub use elbowroom_formats as formats;
pub use elbowroom_kinematics as kinematics;
pub use elbowroom_monitor as monitor;
pub use elbowroom_planner as planner;
pub use elbowroom_proximity as proximity;
pub use elbowroom_scene as scene;
pub use elbowroom_spatial as spatial;
pub use elbowroom_vision as vision;
