//! The server as its caller sees it.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread::JoinHandle;

use elbowroom_cell::Cell;
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{Semaphore, watch};

use super::guard::Hosts;
use super::places::Places;
use super::routes::routes;
use super::shared::Shared;
use super::token::Token;
use super::{assets, connection};
use crate::engine::{self, JogCell, Model, SentFrame};
use crate::feed::StatusFeed;
use crate::geometry;
use crate::history::History;
use crate::inbox::Inbox;
use crate::settings::hosts;
use crate::source::{RunningCell, ViewSource};
use crate::{ServerSettings, ViewError};

/// A cell in a browser, until it is stopped or dropped. It has threads of its own; its caller is not async.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    token: Token,
    inbox: Arc<Inbox>,
    stop: watch::Sender<bool>,
    engine: Option<JoinHandle<()>>,
    runtime: Option<Runtime>,
}

impl Server {
    /// Shows a running cell: what is published through the feed.
    ///
    /// # Errors
    /// [`ViewError`] where the address cannot be served at or the cell has no model.
    pub fn watch(cell: &Cell, feed: &StatusFeed, settings: ServerSettings) -> Result<Self, ViewError> {
        Self::start(Model::of(cell)?, RunningCell, feed.inbox.clone(), settings)
    }

    /// Shows a cell at rest; its robots are moved in the page.
    ///
    /// # Errors
    /// As [`Self::watch`].
    pub fn jog(cell: &Cell, settings: ServerSettings) -> Result<Self, ViewError> {
        let model = Model::of(cell)?;
        let source = JogCell::new(model.cell.clone(), model.setups.clone())?;
        Self::start(model, source, Arc::default(), settings)
    }

    fn start(
        model: Model,
        mut source: impl ViewSource + Send + 'static,
        inbox: Arc<Inbox>,
        settings: ServerSettings,
    ) -> Result<Self, ViewError> {
        let ServerSettings { address, limits } = settings;
        if !address.ip().is_loopback() {
            return Err(ViewError::NotLoopback(address));
        }
        let runtime = Builder::new_multi_thread().worker_threads(2).thread_name("view").enable_all().build()?;
        let bind = |source: io::Error| ViewError::Bind { address, source };
        let listener = runtime.block_on(TcpListener::bind(address)).map_err(bind)?;
        let address = listener.local_addr()?;
        let token = Token::random()?;
        let (frame_sender, frames) = watch::channel(SentFrame::default());
        let (stop, stopped) = watch::channel(false);
        let history = Arc::new(History::default());
        let shared = Arc::new(Shared {
            token: token.clone(),
            hosts: Hosts::new(hosts(address)),
            limits,
            geometry: geometry::packed(&model.cell, source.mode())?.into(),
            inbox: inbox.clone(),
            history: history.clone(),
            frames,
            places: Places::new(limits.connections),
            browsers: Arc::new(Semaphore::new(limits.browsers)),
            mode: source.mode(),
        });
        let router = routes(shared.clone(), assets::assets()?);
        runtime.spawn(connection::accept(listener, router, shared, stopped));
        let (to_engine, kept) = (inbox.clone(), history);
        let engine = std::thread::Builder::new().name("view engine".into()).spawn(move || {
            engine::run(&model, &mut source, &to_engine, &kept, &frame_sender, limits.frame_period);
        })?;
        Ok(Self { address, token, inbox, stop, engine: Some(engine), runtime: Some(runtime) })
    }

    /// Where it serves.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What to open in a browser, with the token: whoever has it sees the cell.
    pub fn url(&self) -> String {
        format!("http://{}/#token={}", self.address, self.token.text())
    }

    /// Returns when the program is asked to end: by Ctrl-C, or by SIGTERM where there is one.
    ///
    /// # Errors
    /// [`ViewError::System`] where signals cannot be received.
    pub fn wait_for_interrupt(&self) -> Result<(), ViewError> {
        match &self.runtime {
            Some(runtime) => Ok(runtime.block_on(interrupted())?),
            None => Ok(()),
        }
    }

    /// Closes all connections and ends the threads.
    pub fn stop(mut self) {
        self.end();
    }

    fn end(&mut self) {
        let _ = self.stop.send(true);
        self.inbox.stop();
        if let Some(engine) = self.engine.take() {
            let _ = engine.join();
        }
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(std::time::Duration::from_millis(500));
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end();
    }
}

#[cfg(unix)]
async fn interrupted() -> io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminated = signal(SignalKind::terminate())?;
    tokio::select! {
        interrupted = tokio::signal::ctrl_c() => interrupted,
        _ = terminated.recv() => Ok(()),
    }
}

#[cfg(not(unix))]
async fn interrupted() -> io::Result<()> {
    tokio::signal::ctrl_c().await
}
