//! Collision, distance and tolerance for many states of a cell or of one robot: the `query` verb.
//!
//! A [`Subject`] is what is asked about, [`States`] are the joint values, [`answer`] gives one [`Row`] per state, in order,
//! on as many threads as there are cores. A row depends on nothing but its state and the rows before it in its block of
//! [`BLOCK`], so that the answers are the same on any number of threads.
//!
//! ```
//! use elbowroom_cell::Cell;
//! use elbowroom_cell::query::{Ask, Level, States, Subject, answer};
//! let cell = Cell::parse("c.toml", r#"
//! version = 1
//! units = { length = "m", angle = "rad" }
//! [robot.arm]
//! dh = [{ a = 1, min = -3, max = 3, speed = 1 }]
//! links = [{ capsule = { from = [-1, 0, 0], to = [0, 0, 0], radius = 0.1 } }]
//! [object.ball]
//! shape = "sphere"
//! at = [2, 0, 0]
//! radius = 0.5
//! "#)?;
//! let subject = Subject::of_cell(&cell);
//! let states = States::parse("s.csv".as_ref(), "joint_1\n0\n1.5\n", &subject)?;
//! let mut rows = Vec::new();
//! answer(&subject.scene(false)?, &states, Ask::Distance, Level::Auto, &mut |block| {
//!     rows.extend_from_slice(block);
//!     true
//! })?;
//! assert!((rows[0].distance_m.unwrap() - 0.4).abs() < 1e-9); // 2 - 0.5 - 1 - 0.1
//! assert!(rows[1].distance_m > rows[0].distance_m);
//! # Ok::<(), elbowroom_formats::FormatError>(())
//! ```

mod ask;
mod row;
mod states;
mod subject;
mod threads;

pub use ask::{Ask, UnknownAsk};
pub use elbowroom_scene::Level;
pub use row::{Row, Written};
pub use states::States;
pub use subject::{Subject, SubjectRobot};
pub use threads::{BLOCK, answer};
