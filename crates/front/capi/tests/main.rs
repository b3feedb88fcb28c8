//! Integration tests of `elbowroom-capi` in one program: a module per subject, whose first line says what belongs there.

mod calls;
mod header;
