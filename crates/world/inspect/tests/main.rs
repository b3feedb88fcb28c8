//! Integration tests of `elbowroom-inspect` in one program: a module per subject, whose first line says what belongs there.

mod units;
