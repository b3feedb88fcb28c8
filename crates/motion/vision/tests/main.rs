//! Integration tests of `elbowroom-vision` in one program: a module per subject, whose first line says what belongs there.

mod arm;
mod bad_input;
mod clouds;
mod geometry;
mod homography;
mod plain_floors;
mod random_scenes;
mod sequences;
mod synthetic;
