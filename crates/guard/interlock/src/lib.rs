//! Interlocks between robot controllers on a network: regions that at most one robot is in at any time, whatever happens
//! to processes and messages. `docs/interlocks.md` has the protocol, its invariants and a table of faults.
//!
//! Each robot has a [`Guard`], which reports where the robot is and learns which slots it holds. One [`Arbiter`] grants slots. Both
//! are state machines without input or output: time and messages go in, messages come out, so that the same code is
//! model-checked, simulated and run. [`wire`] has the bytes of the messages.
//!
//! ```
//! use elbowroom_interlock::{Arbiter, ArbiterSettings, Boot, Guard, Micros, RobotSettings};
//! use elbowroom_monitor::{Occupancy, RobotSlot, SlotId};
//!
//! let robot = |name: &str| RobotSettings::new(name, [SlotId(0)]);
//! let settings = ArbiterSettings::new(vec![robot("left"), robot("right")], 1);
//! let mut arbiter = Arbiter::new(settings, Boot(1));
//! let mut guards = [Guard::new(RobotSlot(0), 1, 0, Boot(1)), Guard::new(RobotSlot(1), 1, 0, Boot(1))];
//!
//! let mut now = Micros(0);
//! for _ in 0..3 {
//!     now = now + Micros(10_000);
//!     for guard in &mut guards {
//!         let near = guard.robot() == RobotSlot(0);
//!         guard.observe(SlotId(0), if near { Occupancy::Warning } else { Occupancy::Outside });
//!     }
//!     for g in 0..2 {
//!         let state = guards[g].state(now);
//!         for grants in arbiter.receive(&state, now).replies {
//!             guards[grants.robot.0].receive(&grants);
//!         }
//!     }
//! }
//! assert!(guards[0].may_enter(SlotId(0), now));
//! assert!(!guards[1].may_enter(SlotId(0), now));
//! // Without a fresh confirmation a grant is of no use.
//! assert!(!guards[0].may_enter(SlotId(0), now + Micros(60_000)));
//! ```
//!
//! **Invariant.** Under the assumptions of `docs/interlocks.md` (guards report truly, robots stop in their stopping
//! times), no robot ever becomes committed to the active regions of a slot while another one is committed to them or
//! inside.

mod arbiter;
mod clock;
mod event;
pub mod frame;
mod guard;
mod guarded_monitor;
mod message;
#[cfg(test)]
mod model;
mod settings;
mod slot_record;
mod time;
mod token;
mod wait_for;
pub mod wire;

pub use arbiter::{Arbiter, Outputs};
pub use clock::Clock;
pub use event::ArbiterEvent;
pub use guard::{Guard, Ignored};
pub use guarded_monitor::{GuardedMonitor, NotObeyed};
pub use message::{GrantsMessage, SlotAnswer, SlotReport, StateMessage};
pub use settings::{ArbiterSettings, RobotSettings};
pub use time::Micros;
pub use token::{Boot, Token};
