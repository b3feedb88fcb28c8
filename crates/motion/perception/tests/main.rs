//! Integration tests of `elbowroom-perception` in one program: a module per subject, whose first line says what belongs there.

mod watcher;
