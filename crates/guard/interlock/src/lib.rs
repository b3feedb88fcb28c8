//! Interlocks between robots: at most one robot is in an exchange region at any time, whatever happens to processes
//! and messages.
//!
//! Exchange regions that are granted together are a **slot** ([`SlotId`]).
//!
//! Controllers that share memory use a [`ZoneArbiter`]; each controller calls it in its tick. Between processes,
//! each robot has a [`Guard`], which reports where the robot is and learns which slots it holds, and one [`Arbiter`]
//! grants slots. Guard and arbiter are state machines without input or output: time and messages go in, messages
//! come out. So the same code is model-checked, simulated and run. [`wire`] encodes the messages.
//! `docs/interlocks.md` describes the protocol, its invariants and a table of faults.
//!
//! ```
//! use elbowroom_interlock::{Arbiter, ArbiterSettings, Boot, Guard, Micros, Occupancy, RobotSettings, RobotSlot, SlotId};
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
//! times), no robot ever becomes committed to the active regions of a slot while another robot is committed to them
//! or inside them.

mod access_class;
mod connection;
mod exchange_state;
mod network;
mod occupancy;
mod robot_set;
mod shared;
mod slot;
mod slot_grants;
mod wait_for_graph;

pub use access_class::AccessClass;
pub use connection::Interlock;
pub use exchange_state::ExchangeState;
pub use network::{
    Arbiter, ArbiterEvent, ArbiterSettings, Boot, Clock, GrantsMessage, Guard, Ignored, Micros, Outputs, RobotSettings,
    SlotAnswer, SlotReport, StateMessage, Token, frame, wire,
};
pub use occupancy::{Grant, Occupancy};
pub use robot_set::RobotSet;
pub use shared::ZoneArbiter;
pub use slot::{RobotSlot, SlotId};
pub use slot_grants::SlotGrants;
pub use wait_for_graph::WaitForGraph;
