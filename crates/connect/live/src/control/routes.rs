//! Routes of the control interface over HTTP: they check the token and pass the request on.

use std::sync::Arc;

use axum::Router;
use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use elbowroom_cell::access::{AccessToken, AccessTokens};
use elbowroom_view::http::{Hosts, Place};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::refusal::Refusal;
use super::request_handler::{Done, RequestHandler};

/// Longest body, bytes.
const MAX_BODY: usize = 64 * 1024;

/// State that all requests share.
struct Shared {
    handler: RequestHandler,
    tokens: AccessTokens,
    hosts: Hosts,
}

/// Builds the router. Other paths and methods are refused.
pub(crate) fn routes(handler: RequestHandler, tokens: AccessTokens, hosts: Hosts) -> Router {
    let only =
        |method: &'static str| move || async move { answer(&Refusal::new(405, format!("this path takes {method}"))) };
    let shared = Arc::new(Shared { handler, tokens, hosts });
    Router::new()
        .route("/regions", get(regions).fallback(only("GET")))
        .route("/distance", post(distance).fallback(only("POST")))
        .route("/switch", post(switch).fallback(only("POST")))
        .route("/move", post(move_region).fallback(only("POST")))
        .route("/add", post(add).fallback(only("POST")))
        .route("/remove", post(remove).fallback(only("POST")))
        .route("/clear", post(clear).fallback(only("POST")))
        .fallback(|| async {
            answer(
                &Refusal::new(404, "not here")
                    .help("GET /regions, POST /distance, /switch, /move, /add, /remove or /clear (docs/control.md)"),
            )
        })
        .layer(DefaultBodyLimit::max(MAX_BODY))
        .layer(middleware::from_fn(short))
        .layer(middleware::from_fn_with_state(shared.clone(), keep_place))
        .with_state(shared)
}

/// Keeps the place of a connection whose request has a valid token, so that strangers cannot displace it.
async fn keep_place(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    if let Some(place) = request.extensions().get::<Place>()
        && holder(&shared, request.headers()).is_ok()
    {
        place.keep();
    }
    next.run(request).await
}

/// Refuses a body whose announced length is too long, before it arrives.
async fn short(request: Request, next: Next) -> Response {
    let length = request.headers().get(header::CONTENT_LENGTH).and_then(|value| value.to_str().ok());
    let is_long = length.is_some_and(|length| !length.parse::<usize>().is_ok_and(|length| length <= MAX_BODY));
    if is_long { answer(&too_long()) } else { next.run(request).await }
}

fn too_long() -> Refusal {
    Refusal::new(413, format!("the body is longer than {MAX_BODY} bytes"))
}

async fn regions(State(shared): State<Arc<Shared>>, headers: HeaderMap) -> Response {
    if let Err(refusal) = holder(&shared, &headers) {
        return answer(&refusal);
    }
    let overview = tokio::task::spawn_blocking(move || shared.handler.overview()).await;
    overview.map_or_else(|_| answer(&broken()), |overview| json(StatusCode::OK, &overview))
}

async fn distance(
    State(shared): State<Arc<Shared>>,
    headers: HeaderMap,
    body: Result<Bytes, BytesRejection>,
) -> Response {
    let asked = tokio::task::spawn_blocking(move || {
        holder(&shared, &headers)?;
        shared.handler.distance(&request(&headers, body)?)
    });
    answer_of(asked.await)
}

async fn switch(state: State<Arc<Shared>>, headers: HeaderMap, body: Result<Bytes, BytesRejection>) -> Response {
    change(state, headers, body, RequestHandler::switch).await
}

async fn move_region(state: State<Arc<Shared>>, headers: HeaderMap, body: Result<Bytes, BytesRejection>) -> Response {
    change(state, headers, body, RequestHandler::move_region).await
}

async fn add(state: State<Arc<Shared>>, headers: HeaderMap, body: Result<Bytes, BytesRejection>) -> Response {
    change(state, headers, body, RequestHandler::add).await
}

async fn remove(state: State<Arc<Shared>>, headers: HeaderMap, body: Result<Bytes, BytesRejection>) -> Response {
    change(state, headers, body, RequestHandler::remove).await
}

async fn clear(state: State<Arc<Shared>>, headers: HeaderMap, body: Result<Bytes, BytesRejection>) -> Response {
    change(state, headers, body, RequestHandler::clear).await
}

/// Makes a change that a token's holder requests.
async fn change<R: DeserializeOwned + Send + 'static>(
    State(shared): State<Arc<Shared>>,
    headers: HeaderMap,
    body: Result<Bytes, BytesRejection>,
    make: fn(&RequestHandler, &AccessToken, &str, &R) -> Result<Done, Refusal>,
) -> Response {
    let made = tokio::task::spawn_blocking(move || {
        let who = holder(&shared, &headers)?;
        let at = revision(&headers)?;
        let request = request(&headers, body)?;
        make(&shared.handler, who, &at, &request)
    });
    answer_of(made.await)
}

fn answer_of<A: Serialize>(result: Result<Result<A, Refusal>, tokio::task::JoinError>) -> Response {
    match result {
        Ok(Ok(done)) => json(StatusCode::OK, &done),
        Ok(Err(refusal)) => answer(&refusal),
        // The handler panicked: the service continues, and the client learns that the result is unknown.
        Err(_) => answer(&broken()),
    }
}

fn broken() -> Refusal {
    Refusal::new(500, "the request failed inside the service").help("GET /regions says what is so now")
}

/// Returns the token's holder. Requests of another site's page in a browser are refused too, although such a page
/// cannot know the secret.
fn holder<'s>(shared: &'s Shared, headers: &HeaderMap) -> Result<&'s AccessToken, Refusal> {
    if headers.contains_key(header::ORIGIN) && !shared.hosts.is_own_page(headers) {
        return Err(Refusal::new(403, "a page of another server may not control this cell"));
    }
    let mut given = headers.get_all(header::AUTHORIZATION).iter();
    let only = given.next().filter(|_| given.next().is_none()).and_then(|value| value.to_str().ok());
    let secret = only.and_then(|value| value.strip_prefix("Bearer "));
    let found = secret.and_then(|secret| shared.tokens.find(secret));
    found.ok_or_else(|| {
        let help = "the header Authorization: Bearer SECRET (elbowroom control token makes one)";
        Refusal::new(401, "the token is missing or another one").help(help)
    })
}

/// Reads the revision that the request was made for.
fn revision(headers: &HeaderMap) -> Result<String, Refusal> {
    let given = headers.get(header::IF_MATCH).and_then(|value| value.to_str().ok());
    let text = given.map(|text| text.trim_matches('"')).filter(|text| !text.is_empty());
    text.map(str::to_owned).ok_or_else(|| {
        let help = "the header If-Match: \"REVISION\", with the `revision` of GET /regions: a request that is sent twice has no effect";
        Refusal::new(428, "the request does not say for which revision of the cell it is").help(help)
    })
}

fn request<R: DeserializeOwned>(headers: &HeaderMap, body: Result<Bytes, BytesRejection>) -> Result<R, Refusal> {
    let kind = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    if kind.split(';').next().map(str::trim) != Some("application/json") {
        return Err(Refusal::new(415, "the body is no JSON").help("the header Content-Type: application/json"));
    }
    let body = body.map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_long(),
        _ => Refusal::new(400, "the body did not arrive"),
    })?;
    serde_json::from_slice(&body).map_err(|e| Refusal::new(422, format!("the body is not such a request: {e}")))
}

fn answer(refusal: &Refusal) -> Response {
    json(StatusCode::from_u16(refusal.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR), refusal)
}

fn json(status: StatusCode, document: &impl Serialize) -> Response {
    match serde_json::to_vec(document) {
        Ok(bytes) => (status, [(header::CONTENT_TYPE, "application/json")], bytes).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}
