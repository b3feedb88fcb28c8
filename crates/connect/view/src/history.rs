//! Frames of the last minutes, for a page that is opened later.

use std::collections::VecDeque;
use std::io::{self, Write as _};
use std::sync::{Mutex, PoisonError};

use axum::extract::ws::Utf8Bytes;
use flate2::Compression;
use flate2::write::GzEncoder;

/// Length of the history, s.
const KEPT_S: f64 = 300.0;
/// Time between two kept frames, s.
const SPACING_S: f64 = 0.2;
/// Largest size of all kept frames together, bytes.
const MAX_BYTES: usize = 32 << 20;

/// Frames of the last minutes, a few per second.
#[derive(Debug, Default)]
pub(crate) struct History {
    kept: Mutex<Kept>,
}

#[derive(Debug, Default)]
struct Kept {
    frames: VecDeque<(f64, Utf8Bytes)>,
    bytes: usize,
}

impl History {
    /// Adds a frame, unless it follows the last kept one too soon.
    pub(crate) fn add(&self, t_s: f64, frame: &Utf8Bytes) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let newest = kept.frames.back().map_or(f64::NEG_INFINITY, |(t, _)| *t);
        // A restarted service counts its time from 0.
        if t_s < newest {
            *kept = Kept::default();
        } else if t_s - newest < SPACING_S {
            return;
        }
        kept.bytes += frame.len();
        kept.frames.push_back((t_s, frame.clone()));
        while let Some((t, oldest)) = kept.frames.front() {
            if kept.bytes <= MAX_BYTES && t_s - t <= KEPT_S {
                break;
            }
            kept.bytes -= oldest.len();
            kept.frames.pop_front();
        }
    }

    /// Packs the frames as a JSON list, compressed as gzip.
    pub(crate) fn packed(&self) -> io::Result<Vec<u8>> {
        // Cloned frames share their text.
        let frames = self.kept.lock().unwrap_or_else(PoisonError::into_inner).frames.clone();
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(b"[")?;
        for (i, (_, frame)) in frames.iter().enumerate() {
            encoder.write_all(if i == 0 { b"" } else { b"," })?;
            encoder.write_all(frame.as_bytes())?;
        }
        encoder.write_all(b"]")?;
        encoder.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(history: &History) -> Vec<f64> {
        history.kept.lock().unwrap().frames.iter().map(|(t, _)| *t).collect()
    }

    #[test]
    fn time_and_bytes_are_bounded() {
        let (history, frame) = (History::default(), Utf8Bytes::from("{}"));
        for k in 0..40_000 {
            history.add(0.01 * f64::from(k), &frame);
        }
        let kept = times(&history);
        assert!(kept.len() <= 1501 && kept[0] >= 99.0 && *kept.last().unwrap() > 399.7, "{} {}", kept.len(), kept[0]);
        assert!(kept.windows(2).all(|w| w[1] - w[0] >= SPACING_S));
        history.add(1.0, &frame);
        assert_eq!(times(&history), [1.0]);
        let large = Utf8Bytes::from("x".repeat(MAX_BYTES / 3));
        (2..9).for_each(|t| history.add(f64::from(t), &large));
        assert_eq!(times(&history), [6.0, 7.0, 8.0]);
    }
}
