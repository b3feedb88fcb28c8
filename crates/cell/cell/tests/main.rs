//! Integration tests of `elbowroom-cell` in one program: a module per subject, whose first line says what belongs there.

mod cell_units;
mod common;
mod controller_zone_gaps;
mod controller_zones;
mod drawn_fixture;
mod errors;
mod grids;
mod guarded_volumes;
mod joint_contacts;
mod kept_inside;
mod keys;
mod mechanisms;
mod planning_scene;
mod seal;
mod sealed_cell;
mod shared_models;
mod tools;
