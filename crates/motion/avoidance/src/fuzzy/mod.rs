//! General fuzzy control: variables with named sets, rules as sentences, Mamdani inference, control surfaces.
//!
//! Membership functions are trapezoids; "and" is the minimum; a rule clips its conclusion at its strength (minimum);
//! conclusions about one output are joined by the maximum; the output is the centre of gravity of the result (Mamdani and
//! Assilian 1975, "An experiment in linguistic synthesis with a fuzzy logic controller"). Inference does not allocate.

mod controller;
mod fuzzy_error;
mod rule;
mod set;
mod surface;
mod svg;
mod toml_format;
mod variable;

pub use controller::Controller;
pub use fuzzy_error::FuzzyError;
pub use rule::Rule;
pub use set::Set;
pub use surface::Surface;
pub use variable::Variable;
