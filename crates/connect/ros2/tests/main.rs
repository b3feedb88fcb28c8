//! Integration tests of `elbowroom-ros2` in one program: a module per subject, whose first line says what belongs there.

mod hashes;
mod hostile_bytes;
mod natnet_zenoh;
mod nearest_points;
