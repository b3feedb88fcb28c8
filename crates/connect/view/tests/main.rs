//! Integration tests of `elbowroom-view` in one program: a module per subject, whose first line says what belongs there.

mod browser;
mod common;
mod draw;
mod draw_page;
mod feed;
mod hostile;
mod jog;
