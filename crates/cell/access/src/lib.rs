//! Who may change what: keys that sign edits, tokens of people and programs, roles, and logs that cannot be changed
//! unnoticed.
//!
//! [`TrustedKeys`] lists the public keys whose edits of a cell file are accepted, [`PrivateKey`] signs a [`LogEntry`]. A
//! running cell is changed on behalf of the holders of [`AccessTokens`]; [`ControlLog`] records who changed what.
//! [`NetworkKey`] is the secret that the processes of a cell share. `elbowroom_cell::seal` seals cell files with these;
//! `docs/roles.md` states what this protects against, and what it does not.
//!
//! ```
//! use elbowroom_access::{AccessTokens, PrivateKey, PublicKey};
//! use elbowroom_monitor::AccessClass;
//! let key = PrivateKey::generate(AccessClass::Integrator, "cell 4")?;
//! assert_eq!(PublicKey::from_hex(&key.public().to_hex()), Some(key.public()));
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("tokens.toml");
//! let secret = AccessTokens::add(&file, AccessClass::Operator, "panel")?;
//! let tokens = AccessTokens::read(&file)?;
//! assert_eq!(tokens.find(&secret).unwrap().name, "panel");
//! assert!(tokens.find("guessed").is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** On Unix a secret is written only to a file that nobody but its owner may read, and read only from such a
//! file; of a token only the hash is kept. A control log is refused unless it begins with the entries that its service
//! has signed; one more line may follow, which was being written.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod access_tokens;
mod change;
mod control_entry;
mod control_history;
mod control_log;
mod entry;
pub mod hex;
mod keys;
mod log_head;
mod network_key;
mod result;
mod secret_file;
pub mod text_file;
mod time;
pub mod trust;

pub use access_tokens::{AccessToken, AccessTokens};
pub use change::Change;
pub use control_entry::ControlEntry;
pub use control_history::{ControlHistory, control_history};
pub use control_log::{ControlLog, Controlled, control_log_of};
pub use entry::LogEntry;
pub use keys::{PrivateKey, PublicKey};
pub use network_key::NetworkKey;
pub use secret_file::check_private_permissions;
pub use time::utc_now;
pub use trust::{TrustedKey, TrustedKeys};
