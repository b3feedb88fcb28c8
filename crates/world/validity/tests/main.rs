//! Integration tests of `elbowroom-validity` in one program: a module per subject, whose first line says what belongs there.

mod against_scene;
mod boxes;
mod common;
mod covers;
mod edges_before;
mod extreme_values;
mod instruction_sets;
mod point_clouds;
mod several_edges;
