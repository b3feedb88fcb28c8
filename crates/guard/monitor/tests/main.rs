//! Integration tests of `elbowroom-monitor` in one program: a module per subject, whose first line says what belongs there.

mod access;
mod attached_volumes;
mod common;
mod direction;
mod exchange;
mod faults;
mod granted;
mod guarded_monitor;
mod law;
mod motion_input;
mod rail;
mod region_distance_query;
mod region_sweep;
