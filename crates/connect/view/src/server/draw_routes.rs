//! Routes of a page that draws targets of virtual fixtures: they check token and origin and pass the request on.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, Method, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use elbowroom_diagnostic::Diagnostic;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::responses::{compressed, has_token, no_token};
use super::shared::Shared;
use crate::drawing::{DrawingRefusal, TargetDrawing};
use crate::geometry::packed_data;
use crate::http::Place;

/// Longest body, bytes: a target with the largest number of points.
const MAX_BODY: usize = 128 * 1024;

const JSON: [(HeaderName, &str); 1] = [(header::CONTENT_TYPE, "application/json")];

/// Refusal of a request.
type Refused = (StatusCode, [(HeaderName, &'static str); 1], String);

/// Builds the routes.
pub(super) fn draw_routes(shared: &Arc<Shared>, drawing: Arc<TargetDrawing>) -> Router {
    Router::new()
        .route("/draw", get(description))
        .route("/draw/pick", post(pick))
        .route("/draw/line", post(line))
        .route("/draw/preview", post(preview))
        .route("/draw/write", post(write))
        .layer(middleware::from_fn_with_state(shared.clone(), own_page))
        .with_state(drawing)
}

/// Lets only this server's own page with the token draw, and reads a body only after that. Browsers name the origin of each
/// POST, and of a GET by another site.
async fn own_page(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let headers = request.headers();
    if !has_token(&shared, headers) {
        return no_token();
    }
    let has_origin = headers.contains_key(header::ORIGIN) || request.method() != Method::GET;
    if has_origin && !shared.hosts.is_own_page(headers) {
        return refused(StatusCode::FORBIDDEN, "only the page of this server may draw", None).into_response();
    }
    if let Some(place) = request.extensions().get::<Place>() {
        place.keep();
    }
    match with_body(request, shared.limits.head).await {
        Ok(request) => next.run(request).await,
        Err(refused) => refused.into_response(),
    }
}

/// Reads the body of a request; it must be short, and arrive in time.
async fn with_body(request: Request, at_most: Duration) -> Result<Request, Refused> {
    let (parts, body) = request.into_parts();
    let read = tokio::time::timeout(at_most, to_bytes(body, MAX_BODY)).await;
    let late = |_| refused(StatusCode::REQUEST_TIMEOUT, "the body did not arrive in time", None);
    let long = |_| refused(StatusCode::PAYLOAD_TOO_LARGE, &format!("the body is longer than {MAX_BODY} bytes"), None);
    let bytes = read.map_err(late)?.map_err(long)?;
    Ok(Request::from_parts(parts, Body::from(bytes)))
}

async fn description(State(drawing): State<Arc<TargetDrawing>>) -> Response {
    answer(tokio::task::spawn_blocking(move || Ok(drawing.description())).await)
}

async fn pick(State(drawing): State<Arc<TargetDrawing>>, headers: HeaderMap, body: Bytes) -> Response {
    respond(drawing, headers, body, |drawing, request| {
        let hit = drawing.pick(request)?;
        let hit = hit.map(|h| (h.point.to_array(), h.outward.to_array(), h.triangle));
        let (point_m, outward, triangle) = hit.map_or((None, None, None), |(p, n, t)| (Some(p), Some(n), t));
        Ok(json!({ "point_m": point_m, "outward": outward, "triangle": triangle }))
    })
    .await
}

async fn line(State(drawing): State<Arc<TargetDrawing>>, headers: HeaderMap, body: Bytes) -> Response {
    respond(drawing, headers, body, |drawing, request| Ok(json!({ "points_m": drawing.line(request)? }))).await
}

async fn write(State(drawing): State<Arc<TargetDrawing>>, headers: HeaderMap, body: Bytes) -> Response {
    respond(drawing, headers, body, TargetDrawing::write).await
}

/// Answers with a mesh: the length of a document, the document, and its arrays.
async fn preview(State(drawing): State<Arc<TargetDrawing>>, headers: HeaderMap, body: Bytes) -> Response {
    let request = match request(&headers, &body) {
        Ok(request) => request,
        Err(refused) => return refused.into_response(),
    };
    let made = tokio::task::spawn_blocking(move || drawing.preview(&request).map(|data| packed_data(&data))).await;
    match made {
        Ok(Ok(Ok(packed))) => compressed("application/octet-stream", packed.into()),
        Ok(Err(e)) => refusal(&e).into_response(),
        Ok(Ok(Err(_))) | Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// Carries out a request whose answer is a document.
async fn respond<R: DeserializeOwned + Send + 'static>(
    drawing: Arc<TargetDrawing>,
    headers: HeaderMap,
    body: Bytes,
    carry_out: fn(&TargetDrawing, &R) -> Result<Value, DrawingRefusal>,
) -> Response {
    let done = tokio::task::spawn_blocking(move || {
        let request: R = request(&headers, &body)?;
        carry_out(&drawing, &request).map_err(|e| refusal(&e))
    });
    answer(done.await)
}

fn answer(done: Result<Result<Value, Refused>, tokio::task::JoinError>) -> Response {
    match done {
        Ok(Ok(document)) => (JSON, document.to_string()).into_response(),
        Ok(Err(refused)) => refused.into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

fn request<R: DeserializeOwned>(headers: &HeaderMap, body: &Bytes) -> Result<R, Refused> {
    let kind = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    if kind.split(';').next().map(str::trim) != Some("application/json") {
        return Err(refused(StatusCode::UNSUPPORTED_MEDIA_TYPE, "the body is not JSON", None));
    }
    let wrong = |e| refused(StatusCode::UNPROCESSABLE_ENTITY, &format!("the body is not such a request: {e}"), None);
    serde_json::from_slice(body).map_err(wrong)
}

fn refusal(e: &DrawingRefusal) -> Refused {
    match e {
        DrawingRefusal::Wrong(Diagnostic { message, hint, .. }) => {
            refused(StatusCode::UNPROCESSABLE_ENTITY, message, hint.as_deref())
        }
        DrawingRefusal::Busy => {
            refused(StatusCode::CONFLICT, "another shield is being made", Some("try again when it is finished"))
        }
    }
}

fn refused(status: StatusCode, error: &str, help: Option<&str>) -> Refused {
    (status, JSON, json!({ "error": error, "help": help }).to_string())
}
