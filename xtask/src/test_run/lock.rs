//! Locks that stay usable after a panic of another worker.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks `value`.
pub fn locked<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
