//! Connections: accepted, served, and closed where they hang.

use std::time::Duration;

use axum::Router;
use hyper::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;

use super::connection_limits::ConnectionLimits;
use super::places::{Place, Places};

/// After an error of the listener, such as too many open files.
const RETRY: Duration = Duration::from_millis(20);

/// Accepts connections until it is stopped.
pub(crate) async fn accept(
    listener: TcpListener,
    router: Router,
    limits: ConnectionLimits,
    places: Places,
    mut stopped: watch::Receiver<bool>,
) {
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = stopped.wait_for(|stopped| *stopped) => return,
        };
        match accepted {
            Ok((stream, _)) => {
                // Here, as tasks run in any order: a connection is as old as its acceptance.
                let place = places.enter();
                _ = tokio::spawn(serve(stream, place, router.clone(), limits));
            }
            Err(_) => tokio::time::sleep(RETRY).await,
        }
    }
}

/// One request, or a WebSocket, which goes on by itself.
async fn serve(stream: TcpStream, place: Place, router: Router, limits: ConnectionLimits) {
    let (router, held) = (TowerToHyperService::new(router), place.clone());
    // A WebSocket keeps the place of its connection.
    let service = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(held.clone());
        router.call(request)
    });
    // Frames are small and must not wait for more.
    let _ = stream.set_nodelay(true);
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.head)
        .max_buf_size(limits.head_bytes)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades();
    tokio::select! {
        _ = tokio::time::timeout(limits.request, connection) => {}
        () = place.vacated() => {}
    }
}
