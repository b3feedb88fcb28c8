//! Server on its own threads, until it is stopped.

use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use axum::{Router, middleware};
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;

use super::connection::{self, Served};
use super::connection_limits::ConnectionLimits;
use super::endpoint::Endpoint;
use super::guard::{Hosts, guard};
use super::loopback::hosts;
use super::places::Places;
use super::tls::TlsIdentity;
use crate::ViewError;

/// Serves at an endpoint, for a caller that is not async. It ends when it is dropped.
#[derive(Debug)]
pub struct HttpServer {
    address: SocketAddr,
    stop: watch::Sender<bool>,
    runtime: Option<Runtime>,
}

impl HttpServer {
    /// Starts to serve the router that `routes` makes from the names of the server.
    ///
    /// Requests for other hosts never reach it.
    ///
    /// # Errors
    /// [`ViewError`] if the address is taken, or the routes cannot be made.
    pub fn start(
        name: &str,
        endpoint: &Endpoint,
        limits: ConnectionLimits,
        routes: impl FnOnce(SocketAddr, &Hosts) -> Result<Router, ViewError>,
    ) -> Result<Self, ViewError> {
        let address = endpoint.address();
        let runtime = Builder::new_multi_thread().worker_threads(2).thread_name(name).enable_all().build()?;
        let bind = |source: io::Error| ViewError::Bind { address, source };
        let listener = runtime.block_on(TcpListener::bind(address)).map_err(bind)?;
        let address = listener.local_addr()?;
        let hosts = if endpoint.identity().is_some() { Hosts::certified() } else { Hosts::new(hosts(address)) };
        let router = routes(address, &hosts)?.layer(middleware::from_fn_with_state(hosts, guard));
        let (stop, stopped) = watch::channel(false);
        let service = Served { router, limits, tls: endpoint.identity().map(TlsIdentity::acceptor) };
        runtime.spawn(connection::accept(listener, service, Places::new(limits.connections), stopped));
        Ok(Self { address, stop, runtime: Some(runtime) })
    }

    /// Address at which it serves.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Returns when the program is asked to end: by Ctrl-C, or by SIGTERM on systems that have it.
    pub(crate) fn wait_for_interrupt(&self) -> io::Result<()> {
        self.runtime.as_ref().map_or(Ok(()), |runtime| runtime.block_on(interrupted()))
    }

    /// Stops accepting connections.
    pub(crate) fn close(&self) {
        let _ = self.stop.send(true);
    }

    /// Closes all connections.
    pub(crate) fn end(&mut self) {
        self.close();
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(Duration::from_millis(500));
        }
    }
}

impl Drop for HttpServer {
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
