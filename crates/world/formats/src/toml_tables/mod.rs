//! Tables of TOML files with the line of every key and value, and typed access to them with instructive errors.
//!
//! ```
//! use elbowroom_formats::toml_tables::{Table, parse};
//! let entries = parse("tool.toml".as_ref(), "[tool.gripper]\nmass = -3\n")?;
//! let file = Table { file: "tool.toml".as_ref(), name: String::new(), line: 1, entries: &entries };
//! let (name, tool) = file.named("tool")?.remove(0);
//! let error = tool.need("mass", "mass = 2")?.positive().unwrap_err();
//! assert_eq!((name, error.line), ("gripper", Some(2)));
//! # Ok::<(), elbowroom_formats::Diagnostic>(())
//! ```

mod node;
mod read;

pub use node::{Data, Entry, Node, parse};
pub use read::{Table, Value};
