//! Integration tests of `elbowroom-sim` in one program: a module per subject, whose first line says what belongs there.

mod between_ticks;
mod carried_volumes;
mod cell_monitors;
mod cells;
mod common;
mod errors;
mod escape_work;
mod exchange;
mod following;
mod guarded_volumes;
mod held_by_sensors;
mod kept_inside;
mod law;
mod mechanisms;
mod moving_objects;
mod multi_robot_avoidance;
mod overrun;
mod pallet;
mod real;
mod region_constraint;
mod regressions;
mod stopping;
mod tools;
mod why;
