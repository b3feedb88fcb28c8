//! How requests travel: in the clear on this computer, encrypted to another one.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::path::Path;

use crate::output::Failure;

/// A connection to a service.
pub(super) trait Connection: Read + Write {}

impl<T: Read + Write> Connection for T {}

/// How requests travel.
pub(super) struct Transport {
    #[cfg(feature = "live")]
    tls: Option<elbowroom::view::http::TlsClient>,
}

impl Transport {
    /// Encrypted where there is the certificate of the service.
    #[cfg(feature = "live")]
    pub(super) fn of(certificate: Option<&Path>) -> Result<Self, Failure> {
        let tls = certificate.map(elbowroom::view::http::TlsClient::trusting).transpose();
        Ok(Self { tls: tls.map_err(|e| Failure::Wrong(format!("--certificate: {e}")))? })
    }

    #[cfg(not(feature = "live"))]
    pub(super) fn of(certificate: Option<&Path>) -> Result<Self, Failure> {
        match certificate {
            None => Ok(Self {}),
            Some(_) => Err(Failure::Wrong(
                "`--certificate` is not in this build, which has no TLS.\n  help: cargo build --release --features live".into(),
            )),
        }
    }

    /// To the service of this name, over a connection.
    #[cfg(feature = "live")]
    pub(super) fn over(&self, host: &str, stream: TcpStream) -> io::Result<Box<dyn Connection>> {
        match &self.tls {
            Some(tls) => Ok(Box::new(tls.connect(host, stream)?)),
            None => Ok(Box::new(stream)),
        }
    }

    #[cfg(not(feature = "live"))]
    pub(super) fn over(&self, _: &str, stream: TcpStream) -> io::Result<Box<dyn Connection>> {
        Ok(Box::new(stream))
    }
}
