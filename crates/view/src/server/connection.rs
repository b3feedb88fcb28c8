//! Connections: accepted, served, and closed where they hang.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;

use super::shared::Shared;

/// After an error of the listener, such as too many open files.
const RETRY: Duration = Duration::from_millis(20);

/// Accepts connections until it is stopped.
pub(crate) async fn accept(
    listener: TcpListener,
    router: Router,
    shared: Arc<Shared>,
    mut stopped: watch::Receiver<bool>,
) {
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = stopped.wait_for(|stopped| *stopped) => return,
        };
        match accepted {
            Ok((stream, _)) => _ = tokio::spawn(serve(stream, router.clone(), shared.clone())),
            Err(_) => tokio::time::sleep(RETRY).await,
        }
    }
}

/// One request, or a WebSocket, which goes on by itself.
async fn serve(stream: TcpStream, router: Router, shared: Arc<Shared>) {
    let limits = &shared.limits;
    let mut place = shared.places.enter();
    // Frames are small and must not wait for more.
    let _ = stream.set_nodelay(true);
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.head)
        .max_buf_size(limits.head_bytes)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    tokio::select! {
        _ = tokio::time::timeout(limits.request, connection) => {}
        () = place.vacated() => {}
    }
}
