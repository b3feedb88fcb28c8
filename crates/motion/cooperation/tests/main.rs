//! Integration tests of `elbowroom-cooperation` in one program: a module per subject, whose first line says what belongs there.

mod carrying;
mod common;
mod in_view;
mod refusals;
mod yielding;
