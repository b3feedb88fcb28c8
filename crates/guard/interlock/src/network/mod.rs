//! Interlock of robots whose controllers are different processes: an arbiter, a guard per robot, and their messages.

mod arbiter;
mod clock;
mod event;
pub mod frame;
mod guard;
mod message;
#[cfg(test)]
mod model;
mod settings;
mod slot_record;
mod time;
mod token;
pub mod wire;

pub use arbiter::{Arbiter, Outputs};
pub use clock::Clock;
pub use event::ArbiterEvent;
pub use guard::{Guard, Ignored};
pub use message::{GrantsMessage, SlotAnswer, SlotReport, StateMessage};
pub use settings::{ArbiterSettings, RobotSettings};
pub use time::Micros;
pub use token::{Boot, Token};
