//! Connections: accepted, served, and closed if they hang.

use std::time::Duration;

use axum::Router;
use hyper::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio_rustls::TlsAcceptor;

use super::connection_limits::ConnectionLimits;
use super::places::{Place, Places};

/// Pause after an error of the listener, such as too many open files.
const RETRY: Duration = Duration::from_millis(20);

/// State that all connections share.
#[derive(Clone)]
pub(crate) struct Served {
    pub(crate) router: Router,
    pub(crate) limits: ConnectionLimits,
    /// `None` for connections without encryption.
    pub(crate) tls: Option<TlsAcceptor>,
}

/// Accepts connections until it is stopped.
pub(crate) async fn accept(listener: TcpListener, served: Served, places: Places, mut stopped: watch::Receiver<bool>) {
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = stopped.wait_for(|stopped| *stopped) => return,
        };
        match accepted {
            Ok((stream, _)) => {
                // The place is taken here, as tasks run in any order: the age of a connection counts from its acceptance.
                let (place, served) = (places.enter(), served.clone());
                _ = tokio::spawn(async move {
                    tokio::select! {
                        () = converse(stream, &place, &served) => {}
                        () = place.vacated() => {}
                    }
                });
            }
            Err(_) => tokio::time::sleep(RETRY).await,
        }
    }
}

async fn converse(stream: TcpStream, place: &Place, served: &Served) {
    // Frames are small and must be sent at once.
    let _ = stream.set_nodelay(true);
    let Some(tls) = &served.tls else { return serve(stream, place, served).await };
    // The handshake has the same time limit as the head of a request.
    if let Ok(Ok(stream)) = tokio::time::timeout(served.limits.head, tls.accept(stream)).await {
        serve(stream, place, served).await;
    }
}

/// Serves one request, or opens a WebSocket, which then runs by itself.
async fn serve(stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static, place: &Place, served: &Served) {
    let Served { router, limits, .. } = served;
    let (router, held) = (TowerToHyperService::new(router.clone()), place.clone());
    // A WebSocket keeps the place of its connection.
    let service = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(held.clone());
        router.call(request)
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.head)
        .max_buf_size(limits.head_bytes)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades();
    let _ = tokio::time::timeout(limits.request, connection).await;
}
