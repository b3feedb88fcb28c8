//! Relay: a connection through this process, which can be cut without being closed; messages sent meanwhile arrive late.

use std::io::{Read, Result, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::time::Duration;

/// Longest delay until a connection continues that is no longer cut.
const POLL: Duration = Duration::from_millis(2);

/// Listens at its own port, and connects each client there to another address.
pub struct Relay {
    address: String,
    is_cut: Arc<AtomicBool>,
}

impl Relay {
    pub fn to(address: &str) -> Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let (own, is_cut) = (listener.local_addr()?.to_string(), Arc::<AtomicBool>::default());
        let (address, cut) = (address.to_owned(), is_cut.clone());
        std::thread::spawn(move || {
            for near in listener.incoming().flatten() {
                let Ok(far) = TcpStream::connect(&address) else { continue };
                // A connection that cannot be relayed has failed: its process connects again.
                let _ = connect(&near, &far, &cut);
            }
        });
        Ok(Self { address: own, is_cut })
    }

    pub fn address(&self) -> &str {
        &self.address
    }

    pub fn cut(&self, is_cut: bool) {
        self.is_cut.store(is_cut, SeqCst);
    }
}

fn connect(near: &TcpStream, far: &TcpStream, is_cut: &Arc<AtomicBool>) -> Result<()> {
    for (from, to) in [(near, far), (far, near)] {
        from.set_nodelay(true)?;
        let (from, to, is_cut) = (from.try_clone()?, to.try_clone()?, is_cut.clone());
        std::thread::spawn(move || forward(from, to, &is_cut));
    }
    Ok(())
}

fn forward(mut from: TcpStream, mut to: TcpStream, is_cut: &AtomicBool) {
    let mut bytes = vec![0; 65_536];
    loop {
        let count = match from.read(&mut bytes) {
            Ok(0) | Err(_) => break,
            Ok(count) => count,
        };
        while is_cut.load(SeqCst) {
            std::thread::sleep(POLL);
        }
        if to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    // Either side may be closed already.
    let _ = from.shutdown(Shutdown::Both);
    let _ = to.shutdown(Shutdown::Both);
}
