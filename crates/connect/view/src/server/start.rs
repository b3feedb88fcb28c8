//! Server from the view of its caller.

use std::net::SocketAddr;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use elbowroom_cell::Cell;
use tokio::sync::{Semaphore, watch};

use super::assets;
use super::routes::routes;
use super::shared::Shared;
use super::token::Token;
use crate::drawing::TargetDrawing;
use crate::engine::{self, JogCell, Model, SentFrame};
use crate::feed::StatusFeed;
use crate::geometry;
use crate::history::History;
use crate::http::{Hosts, HttpServer};
use crate::inbox::Inbox;
use crate::source::{RunningCell, ViewSource};
use crate::{ServerSettings, ViewError};

/// Longest time of a request in a server where shields are made: fine ones take minutes.
const SHIELD_TIME: Duration = Duration::from_mins(10);

/// A cell in a browser, until it is stopped or dropped. It has its own threads; its caller is not async.
#[derive(Debug)]
pub struct Server {
    token: Token,
    inbox: Arc<Inbox>,
    engine: Option<JoinHandle<()>>,
    http: HttpServer,
    scheme: &'static str,
}

impl Server {
    /// Shows a running cell: the statuses that are published through the feed.
    ///
    /// # Errors
    /// [`ViewError`] if the server cannot listen at the address, or the cell has no model.
    pub fn watch(cell: &Cell, feed: &StatusFeed, settings: ServerSettings) -> Result<Self, ViewError> {
        Self::start(Model::of(cell)?, RunningCell, feed.inbox.clone(), settings, None)
    }

    /// Shows a cell at rest; its robots are moved in the page.
    ///
    /// # Errors
    /// As [`Self::watch`].
    pub fn jog(cell: &Cell, settings: ServerSettings) -> Result<Self, ViewError> {
        let model = Model::of(cell)?;
        let source = JogCell::new(model.cell.clone(), model.setups.clone())?;
        Self::start(model, source, Arc::default(), settings, None)
    }

    /// Shows a cell at rest, in whose page targets of virtual fixtures are drawn and written into the file of the cell.
    ///
    /// # Errors
    /// As [`Self::watch`]; [`ViewError::DrawnFromElsewhere`] for an address that other computers reach, and
    /// [`ViewError::Cell`] if the file of the cell cannot be read.
    pub fn draw(cell: &Cell, mut settings: ServerSettings) -> Result<Self, ViewError> {
        let address = settings.endpoint.address();
        if !address.ip().is_loopback() {
            return Err(ViewError::DrawnFromElsewhere(address));
        }
        settings.limits.request = settings.limits.request.max(SHIELD_TIME);
        let model = Model::of(cell)?;
        let source = JogCell::new(model.cell.clone(), model.setups.clone())?;
        let drawing = Arc::new(TargetDrawing::new(&model.cell)?);
        Self::start(model, source, Arc::default(), settings, Some(drawing))
    }

    fn start(
        model: Model,
        mut source: impl ViewSource + Send + 'static,
        inbox: Arc<Inbox>,
        settings: ServerSettings,
        drawing: Option<Arc<TargetDrawing>>,
    ) -> Result<Self, ViewError> {
        let ServerSettings { endpoint, limits } = settings;
        let (token, draws) = (Token::random()?, drawing.is_some());
        let (frame_sender, frames) = watch::channel(SentFrame::default());
        let history = Arc::new(History::default());
        let shared = |hosts: &Hosts| -> Result<Shared, ViewError> {
            Ok(Shared {
                token: token.clone(),
                hosts: hosts.clone(),
                limits,
                geometry: geometry::packed(&model.cell, source.mode(), draws)?.into(),
                inbox: inbox.clone(),
                history: history.clone(),
                frames,
                browsers: Arc::new(Semaphore::new(limits.browsers)),
                mode: source.mode(),
            })
        };
        let http = HttpServer::start("view", &endpoint, limits.of_connections(), |_, hosts| {
            Ok(routes(Arc::new(shared(hosts)?), assets::assets()?, drawing))
        })?;
        let (to_engine, kept) = (inbox.clone(), history);
        let engine = std::thread::Builder::new().name("view engine".into()).spawn(move || {
            engine::run(&model, &mut source, &to_engine, &kept, &frame_sender, limits.frame_period);
        })?;
        Ok(Self { token, inbox, engine: Some(engine), http, scheme: endpoint.scheme() })
    }

    /// Address at which it serves.
    pub fn address(&self) -> SocketAddr {
        self.http.address()
    }

    /// The address to open in a browser, with the token: everyone who has it sees the cell.
    ///
    /// If the server serves at all addresses, `HOST` stands for a name of its certificate.
    pub fn url(&self) -> String {
        let address = self.address();
        let host = if address.ip().is_unspecified() { format!("HOST:{}", address.port()) } else { address.to_string() };
        format!("{}://{host}/#token={}", self.scheme, self.token.text())
    }

    /// Returns when the program is asked to end: by Ctrl-C, or by SIGTERM on systems that have it.
    ///
    /// # Errors
    /// [`ViewError::System`] if signals cannot be received.
    pub fn wait_for_interrupt(&self) -> Result<(), ViewError> {
        Ok(self.http.wait_for_interrupt()?)
    }

    /// Closes all connections and ends the threads.
    pub fn stop(mut self) {
        self.end();
    }

    fn end(&mut self) {
        self.http.close();
        self.inbox.stop();
        if let Some(engine) = self.engine.take() {
            let _ = engine.join();
        }
        self.http.end();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end();
    }
}
