//! Endpoint of a server: its address and its certificate.

use std::net::SocketAddr;

use super::loopback::address;
use super::tls::TlsIdentity;
use crate::ViewError;

/// An address that only this computer reaches, or any address with a certificate: connections of other computers are
/// always encrypted.
#[derive(Debug, Clone)]
pub struct Endpoint {
    address: SocketAddr,
    identity: Option<TlsIdentity>,
}

impl Endpoint {
    /// Parses an address: `127.0.0.1:8080`, `localhost:8080`, `[::1]:8080`, or a port alone.
    ///
    /// ```
    /// use elbowroom_view::ViewError;
    /// use elbowroom_view::http::Endpoint;
    /// assert_eq!(Endpoint::new("localhost:8080", None)?.address(), "127.0.0.1:8080".parse().unwrap());
    /// assert_eq!(Endpoint::new("8080", None)?.address(), Endpoint::new("127.0.0.1:8080", None)?.address());
    /// let error = Endpoint::new("0.0.0.0:8080", None).unwrap_err();
    /// assert!(matches!(error, ViewError::NotEncrypted(_)) && error.to_string().contains("--certificate"));
    /// assert!(matches!(Endpoint::new("cell.local", None), Err(ViewError::NoAddress(_))));
    /// # Ok::<(), ViewError>(())
    /// ```
    ///
    /// # Errors
    /// [`ViewError::NoAddress`], or [`ViewError::NotEncrypted`] for an address that other computers reach, without a certificate.
    pub fn new(text: &str, identity: Option<TlsIdentity>) -> Result<Self, ViewError> {
        let address = address(text).ok_or_else(|| ViewError::NoAddress(text.to_owned()))?;
        if identity.is_none() && !address.ip().is_loopback() {
            return Err(ViewError::NotEncrypted(address));
        }
        Ok(Self { address, identity })
    }

    /// The address; port 0 takes any free port.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    pub(crate) fn identity(&self) -> Option<&TlsIdentity> {
        self.identity.as_ref()
    }

    /// The scheme, `http` or `https`.
    pub(crate) fn scheme(&self) -> &'static str {
        if self.identity.is_some() { "https" } else { "http" }
    }
}
