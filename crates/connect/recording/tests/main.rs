//! Integration tests of `elbowroom-recording` in one program: a module per subject, whose first line says what belongs there.

mod common;
mod granted_from_outside;
mod hostile_recordings;
mod joint_recording;
mod python_readers;
mod recorder;
mod replay_of_runs;
