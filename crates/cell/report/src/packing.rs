//! Compact numbers and texts for the page: quantised, delta coded, deflated, base64.

use std::io::{self, Write as _};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use elbowroom_spatial::Pose;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde_json::{Value, json};

/// Largest quantised value; 0 stands for NaN.
const MAX_LEVEL: f64 = 4_294_967_294.0;

/// Raw deflate as base64: the page inflates it with `DecompressionStream`.
///
/// # Errors
///
/// None in practice: the encoder writes to memory.
pub fn deflated(bytes: &[u8]) -> io::Result<String> {
    let mut encoder = DeflateEncoder::new(Vec::with_capacity(bytes.len() / 3), Compression::new(5));
    encoder.write_all(bytes)?;
    Ok(STANDARD.encode(encoder.finish()?))
}

/// Collects arrays of numbers in one buffer.
///
/// An array is quantised with a step, then coded as differences to the value one row before. All low bytes come first,
/// then all second bytes, and so on. Smooth curves and neighbouring vertices become bytes that deflate well.
#[derive(Debug, Default)]
pub struct ArrayPacker {
    bytes: Vec<u8>,
}

impl ArrayPacker {
    /// The buffer.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Adds rows of `width` numbers, exact to half of `step`. Returns the place and the coding of the array, for the
    /// page.
    ///
    /// The step is larger if the range needs more than 32 bits.
    pub fn add(&mut self, values: &[f64], width: usize, step: f64) -> Value {
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        let low = if low.is_finite() { low } else { 0.0 };
        let step = step.max((high - low) / (MAX_LEVEL - 1.0));
        let level = |v: f64| if v.is_finite() { 1 + ((v - low) / step).round() as u32 } else { 0 };
        let levels: Vec<u32> = values.iter().map(|v| level(*v)).collect();
        let before = |i: usize| i.checked_sub(width).map_or(0, |b| levels[b]);
        let coded: Vec<u32> = (0..levels.len()).map(|i| zigzag(levels[i].wrapping_sub(before(i)))).collect();
        let at = self.bytes.len();
        for plane in 0..4 {
            self.bytes.extend(coded.iter().map(|c| c.to_le_bytes()[plane]));
        }
        json!({ "at": at, "n": values.len(), "width": width, "step": step, "zero": low - step })
    }
}

/// Quaternion x y z w, then the translation.
pub fn pose_values(pose: &Pose) -> [f64; 7] {
    let [x, y, z, w] = pose.rotation.to_quaternion_xyzw();
    let t = pose.translation;
    [x, y, z, w, t.x, t.y, t.z]
}

/// Small differences of either sign as small numbers.
fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ (0_u32.wrapping_sub(difference >> 31))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads an array like the page.
    fn read(bytes: &[u8], entry: &Value) -> Vec<f64> {
        let number = |key: &str| entry[key].as_f64().unwrap();
        let (at, n, width) = (number("at") as usize, number("n") as usize, number("width") as usize);
        let mut levels: Vec<u32> = Vec::new();
        for i in 0..n {
            let coded = u32::from_le_bytes([0, 1, 2, 3].map(|plane| bytes[at + plane * n + i]));
            let difference = (coded >> 1) ^ 0_u32.wrapping_sub(coded & 1);
            levels.push(difference.wrapping_add(i.checked_sub(width).map_or(0, |b| levels[b])));
        }
        let value = |l: u32| if l == 0 { f64::NAN } else { number("zero") + number("step") * f64::from(l) };
        levels.into_iter().map(value).collect()
    }

    #[test]
    fn arrays_read_back_within_half_a_step() {
        let mut packer = ArrayPacker::default();
        let curve: Vec<f64> = (0..300).map(|i| (f64::from(i) * 0.1).sin() * 3.0).collect();
        let far = [-1e9, 0.0, 1e9];
        let gaps = [f64::NAN, 1.5, f64::INFINITY, -2.5];
        let entries = [packer.add(&curve, 3, 1e-8), packer.add(&far, 1, 1e-8), packer.add(&gaps, 2, 0.5)];
        let back = |i: usize| read(packer.bytes(), &entries[i]);
        assert!(curve.iter().zip(back(0)).all(|(a, b)| (a - b).abs() <= 0.51e-8));
        assert!(far.iter().zip(back(1)).all(|(a, b)| (a - b).abs() < 0.5));
        assert!(back(2)[0].is_nan() && back(2)[1] == 1.5 && back(2)[2].is_nan() && back(2)[3] == -2.5);
        assert!(read(packer.bytes(), &packer_entry_of_nothing()).is_empty());
    }

    fn packer_entry_of_nothing() -> Value {
        ArrayPacker::default().add(&[], 1, 1.0)
    }
}
