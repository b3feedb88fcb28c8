//! Utilities that tests, benches and developers' tools of several crates share.
//!
//! It has generators of pseudo-random numbers, folders of data, the extent of tests, a counter of allocations, a hash, free addresses, a Python,
//! compilers of C and C++, certificates and arguments of benches. Shipped crates never link this crate.
//!
//! ```
//! use elbowroom_testkit::random::Random;
//! let mut random = Random(7);
//! let lengths_m: Vec<f64> = (0..1000).map(|_| random.between(0.1, 0.5)).collect();
//! assert!(lengths_m.iter().all(|length_m| (0.1..0.5).contains(length_m)));
//! assert!((0..1000).all(|_| random.below(6) < 6));
//! // A test that fails can be repeated by its seed.
//! let again: Vec<f64> = { let mut random = Random(7); (0..1000).map(|_| random.between(0.1, 0.5)).collect() };
//! assert_eq!(again, lengths_m);
//! ```
//!
//! **Invariant.** From equal seeds, a generator always returns equal sequences: on every machine, in every release.

pub mod allocation;
pub mod bench;
pub mod certificate;
pub mod compiler;
pub mod extent;
pub mod folder;
pub mod hash;
pub mod network;
pub mod python;
pub mod random;
