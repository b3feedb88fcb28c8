//! Integration tests of `elbowroom-interlock` in one program: a module per subject, whose first line says what belongs there.

mod common;
mod fault_schedules;
mod single_messages;
mod wire;
