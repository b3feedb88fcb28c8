//! Warnings of addresses at which other computers reach a cell's network without a key.

use std::net::IpAddr;

use super::args::NetworkArgs;

/// Returns a warning for each such address.
pub(super) fn open_addresses(args: &NetworkArgs) -> Vec<String> {
    let NetworkArgs { listen, connect, network_key, udp } = args;
    let has_no_key = network_key.is_none();
    let key = "--network-key FILE, which `elbowroom control network-key` makes";
    let options = [
        ("--listen", listen.as_deref().filter(|_| has_no_key), key),
        ("--connect", connect.as_deref().filter(|_| has_no_key), key),
        ("--udp", udp.as_deref(), "a wire of its own: datagrams have no key"),
    ];
    let warning = |(option, address, help): (&str, Option<&str>, &str)| {
        let address = address.filter(|address| !is_of_this_computer(address))?;
        let what = "whoever reaches this network can send joint values and switch temporary regions";
        Some(format!("warning: {option} {address}: {what}\n  help: {help} (docs/security.md)"))
    };
    options.into_iter().filter_map(warning).collect()
}

/// Whether only this computer reaches an address, `HOST:PORT`.
fn is_of_this_computer(address: &str) -> bool {
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    let ip = host.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>();
    ip.map_or(host == "localhost", |ip| ip.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_that_others_reach_without_a_key_are_warned_of() {
        let args = |listen: &str, udp: Option<&str>, key: Option<&str>| NetworkArgs {
            listen: Some(listen.to_owned()),
            connect: None,
            network_key: key.map(Into::into),
            udp: udp.map(str::to_owned),
        };
        for own in ["127.0.0.1:7447", "localhost:7447", "[::1]:7447"] {
            assert!(open_addresses(&args(own, Some(own), None)).is_empty(), "{own}");
        }
        for open in ["0.0.0.0:7447", "192.168.0.5:7447", "cell-controller:7447", "[::]:7447"] {
            let warnings = open_addresses(&args(open, None, None));
            assert!(warnings[0].contains(&format!("--listen {open}")) && warnings[0].contains("--network-key"));
            assert!(open_addresses(&args(open, None, Some("cell.key"))).is_empty());
            // No key covers datagrams.
            let warnings = open_addresses(&args(open, Some(open), Some("cell.key")));
            assert!(warnings.len() == 1 && warnings[0].contains("--udp"), "{warnings:?}");
        }
    }
}
