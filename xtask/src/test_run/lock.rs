//! Locks that a panic of another worker does not close.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks `value`.
pub fn locked<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
