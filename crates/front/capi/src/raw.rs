//! Everything that follows a pointer from C, and the one borrow that the compiler cannot check.
#![allow(unsafe_code, reason = "C passes pointers; docs/decisions/0041-a-c-interface-of-queries.md")]

use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::slice;
use std::sync::Arc;

use elbowroom::query::{QueryChecker, QueryKind, QueryPairs, QueryRow};
use elbowroom::scene::{CheckerOptions, SceneState};

use crate::failure::Failure;
use crate::model::Model;

/// The text at a pointer; `None` for NULL.
///
/// # Safety
/// The pointer is NULL, or a text with a NUL at its end that nobody changes during `'a`.
pub(crate) unsafe fn optional_text<'a>(text: *const c_char, name: &str) -> Result<Option<&'a str>, Failure> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: not NULL, so by the caller's promise a text with its end.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map(Some).map_err(|e| Failure::invalid(format!("`{name}` is not UTF-8 text: {e}")))
}

/// Like [`optional_text`], but NULL is an error.
///
/// # Safety
/// As for [`optional_text`].
pub(crate) unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, Failure> {
    // SAFETY: the caller's promise.
    unsafe { optional_text(text, name) }?.ok_or_else(|| Failure::null(name))
}

/// The values at a pointer; NULL only without values.
///
/// # Safety
/// The pointer is NULL, or the first of `count` initialized values that nobody changes during `'a`.
pub(crate) unsafe fn values<'a, T>(first: *const T, count: usize, name: &str) -> Result<&'a [T], Failure> {
    if check_array(first, count, name)? {
        return Ok(&[]);
    }
    // SAFETY: not NULL, aligned, of a size that exists; the rest is the caller's promise.
    Ok(unsafe { slice::from_raw_parts(first, count) })
}

/// Like [`values`], to write.
///
/// # Safety
/// The pointer is NULL, or the first of `count` places that nobody else uses during `'a`.
pub(crate) unsafe fn places<'a, T>(
    first: *mut T,
    count: usize,
    name: &str,
) -> Result<&'a mut [MaybeUninit<T>], Failure> {
    if check_array(first, count, name)? {
        return Ok(&mut []);
    }
    // SAFETY: not NULL, aligned, of a size that exists; the rest is the caller's promise.
    Ok(unsafe { slice::from_raw_parts_mut(first.cast(), count) })
}

/// Refuses what cannot be an array; true for an array without elements.
fn check_array<T>(first: *const T, count: usize, name: &str) -> Result<bool, Failure> {
    if count == 0 {
        return Ok(true);
    }
    if first.is_null() {
        return Err(Failure::null(name));
    }
    if !first.is_aligned() || count.checked_mul(size_of::<T>()).is_none_or(|size| isize::try_from(size).is_err()) {
        return Err(Failure::invalid(format!("`{name}` cannot be an array of {count} values")));
    }
    Ok(false)
}

/// A checker with the model that it reads.
#[derive(Debug)]
pub(crate) struct OwningChecker {
    /// Before `model`, so that it is dropped first. It never leaves this type.
    checker: QueryChecker<'static>,
    model: Arc<Model>,
    options: CheckerOptions,
    pairs: QueryPairs,
}

impl OwningChecker {
    /// Creates a checker of a model.
    pub fn new(model: Arc<Model>, options: CheckerOptions, pairs: QueryPairs) -> Self {
        let scene = &raw const model.scene;
        // SAFETY: the scene stays where it is and is never changed while `model` lives, because an `Arc` gives no `&mut`.
        // `model` lives longer than the checker: both are private fields of one value, dropped in their order, and
        // no method returns a reference with the lifetime of the scene.
        let checker = QueryChecker::new(unsafe { &*scene }, options, &pairs);
        Self { checker, model, options, pairs }
    }

    /// Forgets what earlier answers taught.
    pub fn restart(&mut self) {
        *self = Self::new(self.model.clone(), self.options, self.pairs.clone());
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Whether there is a pair to test.
    pub fn has_pair(&mut self, state: &SceneState) -> bool {
        self.checker.has_pair(state)
    }

    /// The answer for a state.
    pub fn row(&mut self, state: &SceneState, kind: QueryKind) -> QueryRow {
        self.checker.row(state, kind)
    }

    /// An answer for each pair no farther apart than a distance, m, the nearest first.
    pub fn rows_within(&mut self, state: &SceneState, margin_m: f64) -> impl Iterator<Item = QueryRow> {
        self.checker.rows_within(state, margin_m)
    }
}
