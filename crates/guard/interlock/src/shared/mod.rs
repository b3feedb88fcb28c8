//! The arbiter of robots whose controllers share memory: locks and published occupancies.
//!
//! In each tick every controller publishes its robot's occupancy of every slot, and then requests the slots in whose
//! warning zone the robot is. A slot is granted to one robot at a time, in the order of requests, and only while
//! every other robot is known to be outside and able to stop outside: an unknown occupancy counts as occupied. Only
//! a robot that is outside and can stop outside releases a slot. A robot that becomes silent while it holds a slot
//! keeps it until the integrator clears it. A robot that becomes silent without holding the slot blocks further
//! grants until it publishes again or is cleared.
//!
//! Robots that declare their needs are granted a slot only while all of them can still get what they need in some
//! order (`safe_order.rs`). All operations are sequences of single atomic steps: they never lock or wait, and after
//! construction they never allocate. `docs/laws.md`, section 11, states the guarantees and the results of the model
//! check (`check`).
//!
//! ```
//! use elbowroom_interlock::{Grant, Occupancy, RobotSlot, SlotId, ZoneArbiter};
//! let arbiter = ZoneArbiter::new(&["left", "right"], &["exchange"]);
//! let (left, right, slot) = (RobotSlot(0), RobotSlot(1), SlotId(0));
//! arbiter.register(slot, left);
//! arbiter.register(slot, right);
//! arbiter.publish(slot, left, Occupancy::Warning, 0.0);
//! assert_eq!(arbiter.request(slot, left, 0.0), Grant::Unknown(right)); // `right` has not published its occupancy
//! arbiter.publish(slot, right, Occupancy::Outside, 0.0);
//! assert_eq!(arbiter.request(slot, left, 0.0), Grant::Held);
//! arbiter.publish(slot, right, Occupancy::Warning, 0.0);
//! assert_eq!(arbiter.request(slot, right, 0.0), Grant::Waiting(left));
//! ```

#[cfg(test)]
mod check;
mod safe_order;
mod shared_state;
#[cfg(test)]
mod tests;
mod zone_arbiter;

pub use zone_arbiter::ZoneArbiter;
