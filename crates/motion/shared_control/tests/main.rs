//! Integration tests of `elbowroom-shared_control` in one program: a module per subject, whose first line says what belongs there.

mod common;
mod constraint_projection;
mod entry;
mod forces;
mod guided_arm;
mod guides;
mod refusals;
mod shields;
mod smoothness;
mod surface_navigation;
