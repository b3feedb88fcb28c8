//! Certificates for test servers.

use std::path::{Path, PathBuf};

/// Writes a self-signed certificate for these host names (or IP addresses) and its private key, both in PEM, to
/// `NAME.pem` and `NAME.key.pem` in a folder.
///
/// # Panics
/// Panics if a host name is invalid, or the folder cannot be written to.
pub fn write_certificate(folder: &Path, name: &str, hosts: &[&str]) -> (PathBuf, PathBuf) {
    let hosts = hosts.iter().map(|host| (*host).to_owned()).collect::<Vec<_>>();
    let made = rcgen::generate_simple_self_signed(hosts).expect("names of hosts");
    let (certificate, key) = (folder.join(format!("{name}.pem")), folder.join(format!("{name}.key.pem")));
    std::fs::write(&certificate, made.cert.pem()).expect("the folder can be written to");
    std::fs::write(&key, made.signing_key.serialize_pem()).expect("the folder can be written to");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        std::fs::set_permissions(&key, std::fs::Permissions::from_mode(0o600)).expect("the file is there");
    }
    (certificate, key)
}
