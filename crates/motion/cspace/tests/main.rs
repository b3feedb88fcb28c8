//! Integration tests of `elbowroom-cspace` in one program: a module per subject, whose first line says what belongs there.

#[path = "../benches/clock/mod.rs"]
mod clock;
mod common;
mod convex;
mod cover_map;
mod joint_map;
mod long;
mod obstacle_models;
mod real_covers;
mod real_models;
mod real_robots;
mod robot_map;
mod slices;
mod sphere;
