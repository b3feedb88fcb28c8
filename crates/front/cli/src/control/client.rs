//! Requests to the control interface of a service.

use std::io::{Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::path::PathBuf;
use std::time::Duration;

use serde_json::Value;

use super::args::ServiceArgs;
use super::transport::Transport;
use crate::output::{Failure, cannot_read};

/// Longest wait for an answer of the service.
const WAIT: Duration = Duration::from_secs(20);
/// Longest answer, bytes.
const MAX_ANSWER: u64 = 16 << 20;

/// A service and the secret of a token.
pub(crate) struct Client {
    address: String,
    secret: String,
    transport: Transport,
}

impl Client {
    pub(crate) fn new(args: &ServiceArgs) -> Result<Self, Failure> {
        let named = || std::env::var_os("ELBOWROOM_SECRET").filter(|v| !v.is_empty()).map(PathBuf::from);
        let file = args.secret.clone().or_else(named).ok_or_else(|| {
            let help = "--secret FILE, or ELBOWROOM_SECRET=FILE in the environment (elbowroom control token makes one)";
            Failure::Wrong(format!("the service asks for a token\n  write: {help}"))
        })?;
        let secret = std::fs::read_to_string(&file).map_err(cannot_read(&file))?.trim().to_owned();
        if secret.is_empty() || !secret.chars().all(|c| c.is_ascii_alphanumeric()) {
            let what = format!("{}: is no secret: 64 hexadecimal digits on one line", file.display());
            return Err(Failure::Wrong(what));
        }
        Ok(Self { address: args.at.clone(), secret, transport: Transport::of(args.certificate.as_deref())? })
    }

    /// Fetches the regions and their revision.
    pub(crate) fn regions(&self) -> Result<Value, Failure> {
        self.ask("GET", "/regions", "", None)
    }

    /// Requests a change of the present state.
    pub(crate) fn change(&self, path: &str, request: &Value) -> Result<Value, Failure> {
        let now = self.regions()?;
        let revision = now["revision"].as_str().unwrap_or_default();
        let headers = format!("If-Match: \"{revision}\"\r\nContent-Type: application/json\r\n");
        self.ask("POST", path, &headers, Some(request))
    }

    /// Asks for the distance of a robot from a region that the cell does not have yet.
    pub(crate) fn distance(&self, request: &Value) -> Result<Value, Failure> {
        self.ask("POST", "/distance", "Content-Type: application/json\r\n", Some(request))
    }

    fn ask(&self, method: &str, path: &str, headers: &str, body: Option<&Value>) -> Result<Value, Failure> {
        let (address, secret) = (&self.address, &self.secret);
        let body = body.map(Value::to_string).unwrap_or_default();
        let request = format!(
            "{method} {path} HTTP/1.1\r\nHost: {address}\r\nAuthorization: Bearer {secret}\r\n{headers}Content-Length: {}\r\n\r\n{body}",
            body.len()
        );
        let answer = self.exchange(&request)?;
        let (head, document) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
        let lengths = head
            .lines()
            .filter_map(|line| line.to_ascii_lowercase().strip_prefix("content-length:")?.trim().parse().ok());
        if lengths.into_iter().any(|length: usize| length != document.len()) {
            return Err(Failure::Wrong(format!("{address}: the answer was cut off\n  write: the same command again")));
        }
        let document: Value = serde_json::from_str(document).unwrap_or_default();
        match head.split(' ').nth(1) {
            Some("200") if head.starts_with("HTTP/") => Ok(document),
            Some(status) if head.starts_with("HTTP/") => Err(refusal(status, &document)),
            _ => Err(Failure::Wrong(format!(
                "{address}: no control interface answers there, or one that is encrypted\n  write: --certificate FILE.pem as the service has it, or --at ADDR"
            ))),
        }
    }

    fn exchange(&self, request: &str) -> Result<String, Failure> {
        let none = |e: std::io::Error| self.silent(&e);
        let addresses = self.address.to_socket_addrs().map_err(none)?;
        let mut last = std::io::Error::other("no such address");
        for address in addresses {
            if !(address.ip().is_loopback() || self.transport.is_encrypted()) {
                let help = "--certificate FILE.pem as the service has it (docs/security.md), or a tunnel to a loopback address";
                let what = format!("{address}: is another computer, and the secret would travel in the clear");
                return Err(Failure::Wrong(format!("{what}\n  write: {help}")));
            }
            match TcpStream::connect_timeout(&address, WAIT) {
                Ok(stream) => return self.converse(stream, request).map_err(|e| self.misunderstood(&e)),
                Err(e) => last = e,
            }
        }
        Err(self.silent(&last))
    }

    fn converse(&self, stream: TcpStream, request: &str) -> std::io::Result<String> {
        stream.set_read_timeout(Some(WAIT))?;
        let host = self.address.rsplit_once(':').map_or(&*self.address, |(host, _)| host);
        let mut stream = self.transport.over(host, stream)?;
        stream.write_all(request.as_bytes())?;
        let mut answer = Vec::new();
        // One request per connection: the service closes it.
        stream.take(MAX_ANSWER).read_to_end(&mut answer)?;
        String::from_utf8(answer).map_err(std::io::Error::other)
    }

    /// Makes the error for a service that does not answer.
    fn silent(&self, error: &std::io::Error) -> Failure {
        let address = &self.address;
        let help = format!("elbowroom live CELL --arbiter --control {address} --tokens FILE, or --at ADDR here");
        Failure::Wrong(format!("{address}: the service does not answer: {error}\n  write: {help}"))
    }

    /// Makes the error for a service that is not trusted or does not speak the protocol.
    fn misunderstood(&self, error: &std::io::Error) -> Failure {
        let (address, why) = (&self.address, error.to_string());
        if !self.transport.is_encrypted() {
            return self.silent(error);
        }
        if why.contains("certificate") {
            let help = "the service's own certificate, which holds today, for this name, and is CA:FALSE, as docs/security.md shows";
            return Failure::Wrong(format!("{address}: the service is not trusted: {why}\n  write: {help}"));
        }
        let help = "no --certificate here if the service has none, or `live --certificate FILE.pem --certificate-key FILE.pem` there";
        Failure::Wrong(format!("{address}: no encrypted service answers: {why}\n  write: {help}"))
    }
}

fn refusal(status: &str, document: &Value) -> Failure {
    let error = document["error"].as_str().map_or_else(|| format!("the service answers {status}"), str::to_owned);
    let help = document["help"].as_str().map(|help| format!("\n  help: {help}")).unwrap_or_default();
    Failure::Wrong(error + &help)
}
