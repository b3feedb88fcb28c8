//! Integration tests of `elbowroom-formats` in one program: a module per subject, whose first line says what belongs there.

mod any_point;
mod assimp;
mod common;
mod data;
mod dh_of_models;
mod hostile;
mod kr125;
mod loading;
mod meshes;
mod messages;
mod model_robots;
mod odd_files;
#[path = "../benches/any_point/problem.rs"]
mod problem;
#[path = "../benches/any_point/surface.rs"]
mod surface;
mod tds;
mod vrml;
mod vrml_files;
mod vrml_robots;
