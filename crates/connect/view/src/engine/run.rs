//! Loop of the engine's thread.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::ws::Utf8Bytes;
use elbowroom_cell::configure::{self, MonitorSetup};
use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_scene::Scene;
use elbowroom_status::CellStatus;
use tokio::sync::watch;

use super::distances::Distances;
use crate::frame::ViewFrame;
use crate::history::History;
use crate::inbox::Inbox;
use crate::source::ViewSource;

/// Time between two frames while no page is open.
const IDLE_PERIOD: Duration = Duration::from_millis(200);
/// Longest wait for something to do.
const WAIT: Duration = Duration::from_secs(1);

/// Models that the engine measures with.
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) cell: Arc<Cell>,
    pub(crate) setups: Arc<Vec<MonitorSetup>>,
    query: QueryModel,
    scene: Scene,
}

/// A frame in the form in which it is sent.
#[derive(Debug, Clone, Default)]
pub(crate) struct SentFrame {
    pub(crate) number: u64,
    pub(crate) text: Utf8Bytes,
}

impl Model {
    pub(crate) fn of(cell: &Cell) -> Result<Self, Diagnostic> {
        let query = QueryModel::of_cell(cell);
        Ok(Self {
            setups: Arc::new(configure::setups(cell)?),
            scene: query.scene(OutOfReachProofs::Compute)?,
            cell: Arc::new(cell.clone()),
            query,
        })
    }
}

/// Makes frames until the inbox is stopped.
pub(crate) fn run(
    model: &Model,
    source: &mut dyn ViewSource,
    inbox: &Inbox,
    history: &History,
    frames: &watch::Sender<SentFrame>,
    period: Duration,
) {
    let mut distances = Distances::new(&model.cell, &model.query, &model.setups, &model.scene);
    let mut last: Option<CellStatus> = None;
    let mut message = String::new();
    let mut number = 0;
    let mut is_first = true;
    loop {
        let taken = inbox.take(if is_first { Duration::ZERO } else { WAIT });
        if taken.stopped {
            return;
        }
        let begin = Instant::now();
        let is_commanded = !taken.commands.is_empty();
        for command in taken.commands {
            message = source.command(command).err().map_or_else(String::new, |why| why.to_string());
        }
        let own = if is_commanded || is_first { source.status() } else { None };
        let own = own.map(|(status, events)| {
            inbox.add_events(events);
            status
        });
        // Before the first status the page draws the cell at its start; a refused command is answered with the last status.
        let nothing = if is_first { Some(CellStatus::default()) } else { None };
        is_first = false;
        let again = || nothing.or_else(|| last.clone().filter(|_| is_commanded));
        let Some(status) = own.or(taken.status).or_else(again) else { continue };
        number += 1;
        let frame = ViewFrame { number, message: message.clone(), ..measured(&mut distances, &status) };
        last = Some(status);
        match serde_json::to_string(&frame) {
            Ok(text) => {
                let text = Utf8Bytes::from(text);
                history.add(frame.t_s, &text);
                frames.send_replace(SentFrame { number, text });
            }
            Err(_) => continue, // a map with keys that are no texts: there is none
        }
        // One receiver is the server's own.
        let period = if frames.receiver_count() <= 1 && !is_commanded { IDLE_PERIOD } else { period };
        std::thread::sleep(period.saturating_sub(begin.elapsed()));
    }
}

fn measured(distances: &mut Distances<'_>, status: &CellStatus) -> ViewFrame {
    let begin = Instant::now();
    let frame = distances.frame(status.clone());
    ViewFrame { measured_in_s: begin.elapsed().as_secs_f64(), ..frame }
}
