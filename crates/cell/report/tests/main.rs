//! Integration tests of `elbowroom-report` in one program: a module per subject, whose first line says what belongs there.

mod browser;
mod chromium;
mod levels_page;
mod moving_objects;
mod page_data;
mod perceived;
mod report;
mod report_demo;
mod shields;
mod tools_and_parts;
