//! Free addresses and waiting, for tests of services on the loopback network.

use std::net::TcpListener;
use std::time::{Duration, Instant};

/// A loopback address at which no program listens, such as `127.0.0.1:40123`.
///
/// # Panics
/// Panics if no port is free.
pub fn free_address() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    listener.local_addr().expect("its address").to_string()
}

/// Waits until a condition holds, at most 20 s; checks every 2 ms.
///
/// # Panics
/// Panics with the message `what` if the condition does not hold by then.
#[track_caller]
pub fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let began = Instant::now();
    while !holds() {
        assert!(began.elapsed() < Duration::from_secs(20), "{what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_free_and_waiting_ends() {
        let address = free_address();
        let mut tries = 0;
        eventually("the address is taken", || {
            tries += 1;
            tries > 2 && TcpListener::bind(&address).is_ok()
        });
        assert!(tries > 2);
    }
}
