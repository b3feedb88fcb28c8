//! Integration tests of `elbowroom-robot` in one program: a module per subject, whose first line says what belongs there.

mod joint_contacts;
mod pairs;
