//! Addresses as text, and the names of addresses that only this computer reaches.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

/// Parses an address. Names are not looked up, as a name may resolve to anything.
pub(super) fn address(text: &str) -> Option<SocketAddr> {
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

/// Names under which a loopback address is reached.
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
