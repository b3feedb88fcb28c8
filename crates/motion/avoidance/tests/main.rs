//! Integration tests of `elbowroom-avoidance` in one program: a module per subject, whose first line says what belongs there.

mod avoider;
mod common;
mod escape;
mod fuzzy;
mod hostile;
mod least_squares;
