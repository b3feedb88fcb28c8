//! Integration tests of `elbowroom-kinematics` in one program: a module per subject, whose first line says what belongs there.

mod arm_configuration;
mod common;
mod dh;
mod dh_forms;
mod errors;
mod ik_table;
mod inverse;
mod motion;
mod motion_bound;
mod pinocchio;
mod surface_ik;
