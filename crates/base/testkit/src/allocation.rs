//! Counter of a program's allocations, for tests and benches.
//!
//! Such a test runs without the test harness (`harness = false`): the harness has threads that allocate, and the
//! counter is for the whole process. The program installs the allocator:
//!
//! ```
//! use elbowroom_testkit::allocation::{COUNTING_ALLOCATOR, AllocationCounter, CountingAllocator};
//!
//! #[global_allocator]
//! static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;
//!
//! fn main() {
//!     let counter = AllocationCounter::start();
//!     let sum = 2 + 2;
//!     assert_eq!((sum, counter.allocations(), counter.changes()), (4, 0, 0));
//!     let list = std::hint::black_box(vec![sum]);
//!     assert_eq!(counter.held_bytes(), 4);
//!     drop(list);
//!     assert_eq!((counter.allocations(), counter.changes(), counter.held_bytes()), (1, 2, 0));
//! }
//! ```

use std::alloc::System;
use std::hint::black_box;

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

/// The type of [`COUNTING_ALLOCATOR`].
pub type CountingAllocator = &'static StatsAlloc<System>;

/// The system allocator with counters.
pub const COUNTING_ALLOCATOR: CountingAllocator = &INSTRUMENTED_SYSTEM;

/// Counts the allocations of all threads since its start.
pub struct AllocationCounter(Region<'static, System>);

impl AllocationCounter {
    /// Starts counting.
    ///
    /// # Panics
    /// Panics if the program has another allocator, because then nothing would be counted.
    pub fn start() -> Self {
        let check = Region::new(COUNTING_ALLOCATOR);
        drop(black_box(Box::new(1_u8)));
        assert!(check.change().allocations > 0, "`COUNTING_ALLOCATOR` is not the program's `#[global_allocator]`");
        Self(Region::new(COUNTING_ALLOCATOR))
    }

    /// Number of new blocks, and of blocks that were resized.
    pub fn allocations(&self) -> usize {
        let change = self.0.change();
        change.allocations + change.reallocations
    }

    /// Bytes of the blocks that were allocated since the start and are still in use; negative if more was freed.
    pub fn held_bytes(&self) -> i64 {
        let change = self.0.change();
        change.bytes_allocated.cast_signed() as i64 - change.bytes_deallocated.cast_signed() as i64
    }

    /// Number of [`Self::allocations`], and of blocks that were freed.
    pub fn changes(&self) -> usize {
        self.allocations() + self.0.change().deallocations
    }
}
