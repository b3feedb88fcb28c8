//! Tracks of the keyframer: values at frames.

use std::f64::consts::PI;

use elbowroom_spatial::{Rotation, Vec3};

use super::chunk::Cursor;
use crate::Diagnostic;

/// Frame rate of 3D Studio, frames per second. Files do not state it.
pub(super) const FRAMES_PER_SECOND: f64 = 30.0;

/// Largest rotation (rad) between two keys without keys in between: beyond half a turn the direction is ambiguous.
const MAX_KEY_ANGLE: f64 = 0.9 * PI;
/// Largest number of inserted keys. A rotation that would need more keys gets none.
const MAX_INSERTED_KEYS: f64 = 8.0;

/// Values at frames, in order of the frames.
pub(super) type Track<T> = Vec<(f64, T)>;

/// Reads keys: frame, flags, as many spline parameters as flags are set, and the value.
fn keys<'a, 'f, T>(
    cursor: &mut Cursor<'a, 'f>,
    bytes_each: usize,
    mut value: impl FnMut(&mut Cursor<'a, 'f>) -> Result<T, Diagnostic>,
) -> Result<Track<T>, Diagnostic> {
    // Flags and two reserved numbers.
    cursor.skip(10)?;
    let count = cursor.u32()? as usize;
    let count = cursor.count(count, 6 + bytes_each, "keys")?;
    let mut track = Vec::with_capacity(count);
    for _ in 0..count {
        let (frame, flags) = (cursor.u32()?, cursor.u16()?);
        // Tension, continuity, bias, ease to, ease from.
        cursor.skip(4 * (flags & 0x1f).count_ones() as usize)?;
        track.push((f64::from(frame), value(cursor)?));
    }
    Ok(track)
}

pub(super) fn vectors(cursor: &mut Cursor<'_, '_>) -> Result<Track<Vec3>, Diagnostic> {
    let mut track = keys(cursor, 12, Cursor::vector)?;
    track.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(track)
}

pub(super) fn numbers(cursor: &mut Cursor<'_, '_>) -> Result<Track<f64>, Diagnostic> {
    keys(cursor, 4, |c| c.f32().map(f64::from))
}

/// Reads rotations in the parent's frame.
///
/// A key is an angle (left-handed) and an axis, relative to the previous key. Large rotations get keys in between, so
/// that neighbouring keys are less than half a turn apart.
pub(super) fn rotations(cursor: &mut Cursor<'_, '_>) -> Result<Track<Rotation>, Diagnostic> {
    let keys = keys(cursor, 16, |c| Ok((f64::from(c.f32()?), c.vector()?)))?;
    let mut track: Track<Rotation> = Vec::with_capacity(keys.len());
    for (frame, (angle, axis)) in keys {
        let axis = axis.try_normalize().unwrap_or(Vec3::Z);
        let (before, from) = track.last().copied().map_or((frame, Rotation::IDENTITY), |(f, r)| (f, r));
        let parts = (angle.abs() / MAX_KEY_ANGLE).ceil().max(1.0);
        let parts = if track.is_empty() || parts > MAX_INSERTED_KEYS { 1.0 } else { parts };
        for part in 1..=parts as usize {
            let share = part as f64 / parts;
            let turned = Rotation::from_axis_angle(axis, -angle * share) * from;
            track.push((before + (frame - before) * share, turned.renormalized()));
        }
    }
    Ok(track)
}
