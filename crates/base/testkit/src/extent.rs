//! How much a test does: the usual amount, or that of a long run.

/// True in a long run, as `cargo xtask soak` makes them: `ELBOWROOM_LONG=1`.
pub fn is_long_run() -> bool {
    std::env::var_os("ELBOWROOM_LONG").is_some_and(|value| value == "1")
}

/// An amount of work: `usual` in the checks of every change, `long` in a long run.
pub fn amount<T>(usual: T, long: T) -> T {
    if is_long_run() { long } else { usual }
}
