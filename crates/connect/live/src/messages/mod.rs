//! The bytes between a controller and its node: little-endian, with a version and a CRC-32. `docs/live.md` has the layout.

mod joint_state;
mod override_answer;
mod protocol;

pub use elbowroom_interlock::frame::MessageError;
pub use joint_state::{AttachedVolume, JointState, MAX_ATTACHED, MAX_JOINT_STATE_BYTES, MAX_JOINTS};
pub use override_answer::{OVERRIDE_ANSWER_BYTES, OverrideAnswer};
