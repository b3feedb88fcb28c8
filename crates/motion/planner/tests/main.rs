//! Integration tests of `elbowroom-planner` in one program: a module per subject, whose first line says what belongs there.

mod clearance;
mod common;
mod cover_rrt_connect;
mod disconnection;
mod goals;
mod grid_planner;
mod path_constraint;
mod rrt_connect;
mod separating_value;
mod several_robots;
mod table1;
mod time_optimal;
mod timing;
