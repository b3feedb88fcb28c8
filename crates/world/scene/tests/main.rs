//! Integration tests of `elbowroom-scene` in one program: a module per subject, whose first line says what belongs there.

mod approaching;
mod attach;
mod box_depths;
mod carried_first_contacts;
mod collision_point;
mod common;
mod distances_within;
mod first_contacts;
mod level_of_detail;
mod matrix;
mod merge_robots;
mod moved_base;
mod out_of_reach;
mod pair_rules;
mod queries;
mod sweep;
