//! Integration tests of `elbowroom-live` in one program: a module per subject, whose first line says what belongs there.

mod authenticated;
mod c_client;
mod common;
mod control;
mod doubtful_input;
mod followed;
mod mechanisms;
mod node;
mod overshoot;
mod region_changes;
mod region_table;
mod restarts;
mod ros2;
mod ros2_peer;
mod simulated;
