//! Integration tests of `elbowroom-query` in one program: a module per subject, whose first line says what belongs there.

mod box_depths;
mod common;
mod cover_cache;
mod inspected_robots;
mod map;
mod path_query;
mod plan;
mod plan_on_map;
mod problems;
mod query;
mod reach;
mod region_constraint;
mod several_robots;
mod weights;
mod weights_real;
