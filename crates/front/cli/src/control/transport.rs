//! How requests travel: in the clear on this computer, encrypted to another one.

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

/// How requests travel.
pub(super) struct Transport {
    tls: Option<TlsClient>,
}

impl Transport {
    /// Encrypted where there is the certificate of the service.
    pub(super) fn of(certificate: Option<&Path>) -> Result<Self, Failure> {
        let tls = certificate.map(TlsClient::trusting).transpose();
        Ok(Self { tls: tls.map_err(|e| Failure::Wrong(format!("--certificate: {e}")))? })
    }

    pub(super) fn is_encrypted(&self) -> bool {
        self.tls.is_some()
    }

    /// To the service of this name, over a connection.
    pub(super) fn over(&self, host: &str, stream: TcpStream) -> io::Result<Box<dyn Connection>> {
        match &self.tls {
            Some(tls) => Ok(Box::new(tls.connect(host, stream)?)),
            None => Ok(Box::new(stream)),
        }
    }
}

/// The default build has no TLS, and says how to get it.
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
