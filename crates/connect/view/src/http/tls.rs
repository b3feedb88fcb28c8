//! Encrypted connections: the identity of a server, and the certificates that a client trusts.

use std::fmt;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;

use elbowroom_cell::access::check_private_permissions;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use tokio_rustls::rustls::version::TLS13;
use tokio_rustls::rustls::{ClientConfig, ClientConnection, Error, RootCertStore, ServerConfig, StreamOwned};

use crate::ViewError;

/// The certificate and the private key of a server: with them it may serve other computers, by TLS 1.3.
#[derive(Clone)]
pub struct TlsIdentity(Arc<ServerConfig>);

impl fmt::Debug for TlsIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The output never shows the key.
        f.write_str("TlsIdentity")
    }
}

impl TlsIdentity {
    /// Reads certificate and key from PEM files; the certificates of its issuers may follow the certificate.
    ///
    /// # Errors
    /// [`ViewError::Certificate`] if a file cannot be read or has none, or if the two do not belong together.
    /// [`ViewError::Cell`] if others may read the key.
    pub fn read(certificate: &Path, key: &Path) -> Result<Self, ViewError> {
        let (chain, private) = (certificates(certificate)?, private_key(key)?);
        let config = ServerConfig::builder_with_provider(Arc::new(default_provider()))
            .with_protocol_versions(&[&TLS13])
            .and_then(|config| config.with_no_client_auth().with_single_cert(chain, private));
        let config = config.map_err(|e| match e {
            Error::InvalidCertificate(_) => {
                wrong(certificate, &e, "a certificate of version 3, as docs/security.md makes it")
            }
            _ => wrong(key, &e, "the private key of the certificate"),
        });
        Ok(Self(Arc::new(config?)))
    }

    pub(crate) fn acceptor(&self) -> TlsAcceptor {
        TlsAcceptor::from(self.0.clone())
    }
}

/// A client that trusts the servers of given certificates and no others.
#[derive(Debug, Clone)]
pub struct TlsClient(Arc<ClientConfig>);

impl TlsClient {
    /// Trusts the certificates of a PEM file, and certificates that they have issued.
    ///
    /// # Errors
    /// [`ViewError::Certificate`] if the file cannot be read, or has no certificate that can be trusted.
    pub fn trusting(certificate: &Path) -> Result<Self, ViewError> {
        let mut roots = RootCertStore::empty();
        for one in certificates(certificate)? {
            roots.add(one).map_err(|e| wrong(certificate, &e, "the certificate of the service in PEM"))?;
        }
        let config = ClientConfig::builder_with_provider(Arc::new(default_provider()))
            .with_protocol_versions(&[&TLS13])
            .map_err(|e| wrong(certificate, &e, "the certificate of the service in PEM"))?;
        Ok(Self(Arc::new(config.with_root_certificates(roots).with_no_client_auth())))
    }

    /// Starts TLS with the server of a name or an IP address, over a connection.
    ///
    /// # Errors
    /// The name is invalid. A server that cannot prove its identity is noticed at the first write or read.
    pub fn connect(&self, name: &str, stream: TcpStream) -> io::Result<impl Read + Write + use<>> {
        let name = ServerName::try_from(name.trim_matches(['[', ']']).to_owned()).map_err(io::Error::other)?;
        let connection = ClientConnection::new(self.0.clone(), name).map_err(io::Error::other)?;
        Ok(StreamOwned::new(connection, stream))
    }
}

/// Reads a key that only its owner may read.
fn private_key(file: &Path) -> Result<PrivateKeyDer<'static>, ViewError> {
    let text = std::fs::read_to_string(file).map_err(|e| wrong(file, &e, "its private key in PEM"))?;
    check_private_permissions(file)?;
    if text.contains("ENCRYPTED") {
        return Err(wrong(file, &"is encrypted with a password", "a key without one: openssl … -nodes"));
    }
    PrivateKeyDer::from_pem_slice(text.as_bytes()).map_err(|e| wrong(file, &e, "its private key in PEM"))
}

fn certificates(file: &Path) -> Result<Vec<CertificateDer<'static>>, ViewError> {
    let instead = "a certificate in PEM: -----BEGIN CERTIFICATE-----";
    let read = CertificateDer::pem_file_iter(file).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let all = read.map_err(|e| wrong(file, &e, instead))?;
    if all.is_empty() { Err(wrong(file, &"no certificate is in it", instead)) } else { Ok(all) }
}

fn wrong(file: &Path, why: &dyn fmt::Display, instead: &'static str) -> ViewError {
    ViewError::Certificate { file: file.to_owned(), why: why.to_string(), instead }
}
