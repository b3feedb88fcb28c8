//! Forces between tool, arm and surroundings, and the motion that follows from them.

mod arm_forces;
mod energy_account;
mod field;
mod impedance_port;
mod law;
mod virtual_body;

pub(crate) use arm_forces::ArmPlace;
pub use arm_forces::{ArmField, ArmForces, FieldPair, Response};
pub use field::FieldSample;
pub use impedance_port::{ImpedancePort, ImpedanceSettings};
pub use law::{Aureole, ForceLaw, ForceProfile};
pub use virtual_body::{BodySettings, VirtualBody};
