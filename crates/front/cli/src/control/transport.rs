//! Transport of requests: unencrypted on this computer, encrypted to another computer.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::path::Path;

use crate::output::Failure;
#[cfg(feature = "live")]
use elbowroom::view::http::TlsClient;
#[cfg(not(feature = "live"))]
use missing::TlsClient;

/// A connection to a service.
pub(super) trait Connection: Read + Write {}

impl<T: Read + Write> Connection for T {}

/// Transport of requests: TLS, or unencrypted.
pub(super) struct Transport {
    tls: Option<TlsClient>,
}

impl Transport {
    /// Makes the transport: encrypted if the certificate of the service is given.
    pub(super) fn of(certificate: Option<&Path>) -> Result<Self, Failure> {
        let tls = certificate.map(TlsClient::trusting).transpose();
        Ok(Self { tls: tls.map_err(|e| Failure::Wrong(format!("--certificate: {e}")))? })
    }

    pub(super) fn is_encrypted(&self) -> bool {
        self.tls.is_some()
    }

    /// Wraps a connection to the service of this host name.
    pub(super) fn over(&self, host: &str, stream: TcpStream) -> io::Result<Box<dyn Connection>> {
        match &self.tls {
            Some(tls) => Ok(Box::new(tls.connect(host, stream)?)),
            None => Ok(Box::new(stream)),
        }
    }
}

/// Stands in for TLS in the default build; says how to get TLS.
#[cfg(not(feature = "live"))]
mod missing {
    use std::io;
    use std::net::TcpStream;
    use std::path::Path;

    pub(super) enum TlsClient {}

    impl TlsClient {
        pub(super) fn trusting(_: &Path) -> Result<Self, &'static str> {
            Err("is not in this build, which has no TLS\n  help: cargo build --release --features live")
        }

        pub(super) fn connect(&self, _: &str, _: TcpStream) -> io::Result<TcpStream> {
            match *self {}
        }
    }
}
