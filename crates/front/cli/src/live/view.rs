//! `elbowroom view`: the cell in a browser, with robots moved by hand.

use elbowroom::cell::Cell;
use elbowroom::view::{Server, ServerSettings};

use super::ViewArgs;
use super::endpoints::{endpoint, wrong};
use crate::output::{ExitStatus, Failure, note};

/// Serves until Ctrl-C.
pub(crate) fn view(args: &ViewArgs) -> Result<ExitStatus, Failure> {
    let text = args.page.web.as_deref().unwrap_or("127.0.0.1:0");
    let settings = ServerSettings::new(endpoint("--web", text, &args.page)?);
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let server = if args.draw { Server::draw(&cell, settings) } else { Server::jog(&cell, settings) };
    let server = server.map_err(|e| wrong("--web", &e))?;
    note(server.url());
    server.wait_for_interrupt().map_err(|e| wrong("--web", &e))?;
    server.stop();
    Ok(ExitStatus::Success)
}
