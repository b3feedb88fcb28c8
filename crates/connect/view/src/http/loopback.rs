//! Addresses that only this computer reaches.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use crate::ViewError;

/// The address in a text: `127.0.0.1:8080`, `localhost:8080`, `[::1]:8080`, or a port alone.
///
/// ```
/// use elbowroom_view::ViewError;
/// use elbowroom_view::http::loopback_address;
/// assert_eq!(loopback_address("localhost:8080")?, "127.0.0.1:8080".parse().unwrap());
/// assert_eq!(loopback_address("8080")?, loopback_address("127.0.0.1:8080")?);
/// let error = loopback_address("0.0.0.0:8080").unwrap_err();
/// assert!(matches!(error, ViewError::NotLoopback(_)) && error.to_string().contains("ssh -L 8080"));
/// assert!(matches!(loopback_address("cell.local"), Err(ViewError::NoAddress(_))));
/// # Ok::<(), ViewError>(())
/// ```
///
/// # Errors
/// [`ViewError::NoAddress`], or [`ViewError::NotLoopback`] for an address that other computers reach.
pub fn loopback_address(text: &str) -> Result<SocketAddr, ViewError> {
    let address = address(text).ok_or_else(|| ViewError::NoAddress(text.to_owned()))?;
    if address.ip().is_loopback() { Ok(address) } else { Err(ViewError::NotLoopback(address)) }
}

/// No names are looked up: a name may resolve to anything.
fn address(text: &str) -> Option<SocketAddr> {
    let localhost = IpAddr::V4(Ipv4Addr::LOCALHOST);
    if let Ok(port) = text.parse::<u16>() {
        return Some((localhost, port).into());
    }
    if let Some(port) = text.strip_prefix("localhost:") {
        return Some((localhost, port.parse().ok()?).into());
    }
    if text == "localhost" {
        return Some((localhost, 0).into());
    }
    text.parse().ok().or_else(|| {
        let ip: IpAddr = text.trim_matches(['[', ']']).parse().ok()?;
        Some((ip, 0).into())
    })
}

/// The names under which a loopback address is reached.
pub(crate) fn hosts(address: SocketAddr) -> Vec<String> {
    let port = address.port();
    let mut hosts = vec![format!("localhost:{port}"), address.to_string()];
    for ip in [IpAddr::V4(Ipv4Addr::LOCALHOST), IpAddr::V6(Ipv6Addr::LOCALHOST)] {
        hosts.push(SocketAddr::from((ip, port)).to_string());
    }
    hosts.dedup();
    if port == 80 {
        hosts.extend(["localhost", "127.0.0.1", "[::1]"].map(str::to_owned));
    }
    hosts
}
