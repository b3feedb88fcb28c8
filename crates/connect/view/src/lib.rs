//! Cell in a browser: the page, its server, and the shown data.
//!
//! [`Server::watch`] shows a running cell: the caller publishes a [`CellStatus`](elbowroom_status::CellStatus) whenever
//! it has one, and is never delayed by a browser. [`Server::jog`] shows a cell at rest, whose robots a person moves in
//! the page (`elbowroom view`); with [`Server::draw`] a person also draws targets of virtual fixtures there, which are
//! written into the cell file. All compute the shown distances with the engine, from the joint values of the status,
//! so that they equal the distances of `elbowroom query`. `docs/view.md` describes the page and its protection.
//!
//! ```
//! use elbowroom_cell::Cell;
//! use elbowroom_status::{CellStatus, RobotStatus};
//! use elbowroom_view::{Server, ServerSettings, StatusFeed};
//! let cell = Cell::parse("rail.toml", r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.rail]
//! dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
//! links = [{ sphere = { radius = 50 } }]
//! "#)?;
//! let feed = StatusFeed::new();
//! let server = Server::watch(&cell, &feed, ServerSettings::at("127.0.0.1:0")?)?;
//! assert!(server.url().starts_with("http://127.0.0.1:"));
//! let rail = RobotStatus { robot: "rail".into(), q: vec![0.5], speed_override: 1.0, ..RobotStatus::default() };
//! feed.publish(CellStatus { t_s: 0.1, robots: vec![rail], ..CellStatus::default() });
//! server.stop();
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** Whatever browsers do, [`StatusFeed::publish`] never waits for one of them.

mod drawing;
mod engine;
mod error;
mod event_log;
mod feed;
mod frame;
mod geometry;
mod history;
pub mod http;
mod inbox;
mod server;
mod settings;
mod source;

pub use error::ViewError;
pub use feed::StatusFeed;
pub use frame::{FrameRobot, PairSeparation, RegionDistance, ViewFrame};
pub use server::Server;
pub use settings::{ClientLimits, ServerSettings};
