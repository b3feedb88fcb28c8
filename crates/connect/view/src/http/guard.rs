//! Guard of a server: answers only requests for known hosts; if only pages are served, also only requests without a body.

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Names under which the server is reached.
#[derive(Debug, Clone)]
pub struct Hosts {
    /// `None` for any name, as browsers compare the name with the certificate.
    names: Option<Vec<String>>,
    scheme: &'static str,
    policy: HeaderValue,
}

impl Hosts {
    pub(crate) fn new(hosts: Vec<String>) -> Self {
        // `'self'` includes the WebSocket in recent browsers; a policy cannot name a host in brackets.
        let named = hosts.iter().filter(|host| !host.starts_with('['));
        let sockets = named.map(|host| format!(" ws://{host}")).collect::<Vec<_>>().concat();
        let policy = format!(
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'{sockets}; \
             base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        );
        let policy = HeaderValue::from_str(&policy).unwrap_or(HeaderValue::from_static("default-src 'none'"));
        Self { names: Some(hosts), scheme: "http://", policy }
    }

    /// Accepts the names of the server's certificate: a foreign name that resolves to this computer has no certificate
    /// here.
    pub(crate) fn certified() -> Self {
        Self { names: None, scheme: "https://", ..Self::new(Vec::new()) }
    }

    /// Returns the only `Host` of a request, if it names this server. Another host is a foreign name that was made to
    /// resolve to this computer (DNS rebinding).
    fn host<'h>(&self, headers: &'h HeaderMap) -> Option<&'h str> {
        let host = only(headers, &header::HOST)?;
        self.names.as_ref().is_none_or(|names| names.iter().any(|known| known == host)).then_some(host)
    }

    /// Whether a page of this server sent the request: browsers let any page call any server, and name the page's origin.
    pub fn is_own_page(&self, headers: &HeaderMap) -> bool {
        let origin = only(headers, &header::ORIGIN).and_then(|origin| origin.strip_prefix(self.scheme));
        origin.is_some() && origin == self.host(headers)
    }
}

/// Returns the value of a header that occurs exactly once.
fn only<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(value)
}

/// Refuses requests for other hosts, and adds the headers that keep browsers from sharing the answer with other pages.
pub(crate) async fn guard(State(hosts): State<Hosts>, request: Request, next: Next) -> Response {
    let mut response = match hosts.host(request.headers()) {
        None => (StatusCode::MISDIRECTED_REQUEST, "this host is not served here\n").into_response(),
        Some(_) => next.run(request).await,
    };
    let is_upgrade = response.status() == StatusCode::SWITCHING_PROTOCOLS;
    let headers = response.headers_mut();
    if !is_upgrade {
        // One request per connection, so that no idle connection stays open.
        headers.insert(header::CONNECTION, HeaderValue::from_static("close"));
    }
    headers.insert(header::CONTENT_SECURITY_POLICY, hosts.policy.clone());
    for (name, value) in [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Refuses requests that the page never sends: other methods, and bodies.
pub(crate) async fn read_only(request: Request, next: Next) -> Response {
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return (StatusCode::METHOD_NOT_ALLOWED, "only GET is served here\n").into_response();
    }
    let headers = request.headers();
    let length = headers.get(header::CONTENT_LENGTH);
    if length.is_some_and(|length| length != "0") || headers.contains_key(header::TRANSFER_ENCODING) {
        return (StatusCode::PAYLOAD_TOO_LARGE, "no request has a body here\n").into_response();
    }
    next.run(request).await
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &'static str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(*name, HeaderValue::from_static(value));
        }
        headers
    }

    #[test]
    fn of_a_server_with_a_certificate_only_encrypted_pages_are_own() {
        let hosts = Hosts::certified();
        let is_own = |host: &'static str, origin: &'static str| {
            hosts.is_own_page(&headers(&[("host", host), ("origin", origin)]))
        };
        assert!(is_own("cell.local:8443", "https://cell.local:8443"));
        assert!(!is_own("cell.local:8443", "http://cell.local:8443"));
        assert!(!is_own("cell.local:8443", "https://evil.example"));
        assert!(!hosts.is_own_page(&headers(&[("origin", "https://cell.local:8443")])));
    }

    #[test]
    fn only_pages_of_this_server_are_own() {
        let hosts = Hosts::new(crate::http::loopback::hosts("127.0.0.1:8080".parse().unwrap()));
        let is_own = |pairs: &[_]| hosts.is_own_page(&headers(pairs));
        assert!(is_own(&[("host", "127.0.0.1:8080"), ("origin", "http://127.0.0.1:8080")]));
        assert!(is_own(&[("host", "localhost:8080"), ("origin", "http://localhost:8080")]));
        assert!(is_own(&[("host", "[::1]:8080"), ("origin", "http://[::1]:8080")]));
        for origin in [
            "http://evil.example",
            "null",
            "",
            "http://127.0.0.1:8081",
            "https://127.0.0.1:8080",
            "http://127.0.0.1:8080.evil.example",
            "http://localhost:8080",
            "http://127.0.0.1:8080/",
        ] {
            assert!(!is_own(&[("host", "127.0.0.1:8080"), ("origin", origin)]), "{origin}");
        }
        assert!(!is_own(&[("host", "127.0.0.1:8080")]));
        assert!(!is_own(&[("host", "evil.example"), ("origin", "http://evil.example")]));
        let two = [("host", "127.0.0.1:8080"), ("host", "evil.example"), ("origin", "http://127.0.0.1:8080")];
        assert!(!is_own(&two));
    }
}
