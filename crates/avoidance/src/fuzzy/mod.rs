//! Fuzzy control in general: variables with named sets, rules as sentences, Mamdani inference, control surfaces.
//!
//! The usual choices, named: degrees are trapezoids; "and" is the minimum; a rule cuts its conclusion off at its own
//! strength (minimum); conclusions about one output are joined by the maximum; the output is the centre of gravity of what
//! results (Mamdani and Assilian 1975). Inference does not allocate.

mod controller;
mod file;
mod picture;
mod rule;
mod set;
mod surface;
mod variable;

pub use controller::{Controller, FuzzyError};
pub use rule::Rule;
pub use set::Set;
pub use surface::Surface;
pub use variable::Variable;
