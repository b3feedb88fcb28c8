//! `elbowroom view`: the cell in a browser, its robots moved by hand.

use elbowroom::cell::Cell;
use elbowroom::view::{Server, ServerSettings, ViewError};

use super::ViewArgs;
use crate::output::{ExitStatus, Failure, note};

/// Serves until Ctrl-C.
pub(crate) fn view(args: &ViewArgs) -> Result<ExitStatus, Failure> {
    let settings = ServerSettings::at(&args.web).map_err(|e| wrong(&e))?;
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let server = Server::jog(&cell, settings).map_err(|e| wrong(&e))?;
    note(server.url());
    server.wait_for_interrupt().map_err(|e| wrong(&e))?;
    server.stop();
    Ok(ExitStatus::Success)
}

fn wrong(error: &ViewError) -> Failure {
    match error {
        ViewError::Cell(e) => Failure::Wrong(e.to_string()),
        e => Failure::Wrong(format!("--web: {e}")),
    }
}
