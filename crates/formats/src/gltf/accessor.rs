//! Numbers of an accessor, every step checked against the bytes that are there.

use std::borrow::Cow;
use std::path::Path;

use elbowroom_spatial::Vec3;
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::View;

use super::point;
use crate::FormatError;

/// An accessor without data is all zeros but for its sparse values; more zeros for each of these than this is no mesh,
/// and memory that the file does not justify.
const MOST_ZEROS_PER_VALUE: usize = 100;

pub(super) struct Reader<'a> {
    pub(super) buffers: &'a [Cow<'a, [u8]>],
    pub(super) file: &'a Path,
}

impl Reader<'_> {
    pub(super) fn error(&self, place: &str, what: &str) -> FormatError {
        FormatError::new(self.file, None, format!("{place} {what}"))
    }

    /// Positions; integers as `KHR_mesh_quantization` has them are read too.
    pub(super) fn points(&self, accessor: &gltf::Accessor<'_>, place: &str) -> Result<Vec<Vec3>, FormatError> {
        if accessor.dimensions() != Dimensions::Vec3 {
            return Err(self.error(place, "has positions that are no vectors of three").hint("\"type\": \"VEC3\""));
        }
        let kind = accessor.data_type();
        let factor = if accessor.normalized() { normalization(kind) } else { 1.0 };
        let rows = self.rows(accessor, place, 3)?;
        let points: Vec<Vec3> =
            rows.chunks_exact(3).map(|r| point([r[0] * factor, r[1] * factor, r[2] * factor])).collect();
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(self
                .error(place, &format!("has a vertex that is no place: {i} (from 0)"))
                .hint("finite numbers; export again"));
        }
        Ok(points)
    }

    pub(super) fn indices(
        &self,
        accessor: &gltf::Accessor<'_>,
        vertices: usize,
        place: &str,
    ) -> Result<Vec<u32>, FormatError> {
        let is_index = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
        if accessor.dimensions() != Dimensions::Scalar || !is_index {
            return Err(self
                .error(place, "has indices that are no unsigned integers")
                .hint("\"type\": \"SCALAR\", \"componentType\": 5125"));
        }
        let numbers = self.rows(accessor, place, 1)?;
        if let Some(bad) = numbers.iter().find(|&&i| i >= vertices as f64) {
            let what = format!("has a corner {bad}, but {vertices} vertices");
            return Err(self.error(place, &what).hint("numbers of vertices, counted from 0"));
        }
        Ok(numbers.into_iter().map(|i| i as u32).collect())
    }

    /// Vectors as they are, or of integers normalized, of as many numbers each as `width`.
    pub(super) fn vectors(
        &self,
        accessor: &gltf::Accessor<'_>,
        width: usize,
        place: &str,
    ) -> Result<Vec<f64>, FormatError> {
        if accessor.dimensions().multiplicity() != width {
            let what = format!("has values of {} numbers instead of {width}", accessor.dimensions().multiplicity());
            return Err(self.error(place, &what).hint("the animation exported again, or left out"));
        }
        let factor = if accessor.normalized() { normalization(accessor.data_type()) } else { 1.0 };
        let rows: Vec<f64> = self.rows(accessor, place, width)?.into_iter().map(|n| n * factor).collect();
        if rows.iter().any(|n| !n.is_finite()) {
            return Err(self.error(place, "has a number that is none").hint("finite numbers; export again"));
        }
        Ok(rows)
    }

    /// `count × width` numbers, sparse replacements applied.
    fn rows(&self, accessor: &gltf::Accessor<'_>, place: &str, width: usize) -> Result<Vec<f64>, FormatError> {
        let (count, kind) = (accessor.count(), accessor.data_type());
        // Read first: what is really there bounds the zeros that are made below.
        let sparse = accessor.sparse().map(|s| self.sparse_rows(&s, kind, place, width)).transpose()?;
        let replaced = sparse.as_ref().map_or(0, |(at, _)| at.len());
        let mut numbers = match accessor.view() {
            Some(view) => self.read(&view, accessor.offset(), count, width, kind, place)?,
            None if replaced > 0 && count / MOST_ZEROS_PER_VALUE <= replaced => vec![0.0; count * width],
            None => {
                return Err(self
                    .error(place, "has an accessor without data")
                    .hint("\"bufferView\": …; or export without compression"));
            }
        };
        let (at, new) = sparse.unwrap_or_default();
        for (i, row) in at.into_iter().zip(new.chunks_exact(width)) {
            let slot = numbers.get_mut((i as usize).saturating_mul(width)..).and_then(|rest| rest.get_mut(..width));
            slot.ok_or_else(|| {
                self.error(place, "replaces a sparse value that does not exist").hint("export the file again")
            })?
            .copy_from_slice(row);
        }
        Ok(numbers)
    }

    /// Which rows are replaced, and by what.
    fn sparse_rows(
        &self,
        sparse: &gltf::accessor::sparse::Sparse<'_>,
        kind: DataType,
        place: &str,
        width: usize,
    ) -> Result<(Vec<f64>, Vec<f64>), FormatError> {
        let (indices, values) = (sparse.indices(), sparse.values());
        let index_kind = match indices.index_type() {
            IndexType::U8 => DataType::U8,
            IndexType::U16 => DataType::U16,
            IndexType::U32 => DataType::U32,
        };
        let at = self.read(&indices.view(), indices.offset(), sparse.count(), 1, index_kind, place)?;
        let new = self.read(&values.view(), values.offset(), sparse.count(), width, kind, place)?;
        Ok((at, new))
    }

    fn read(
        &self,
        view: &View<'_>,
        offset: usize,
        count: usize,
        width: usize,
        kind: DataType,
        place: &str,
    ) -> Result<Vec<f64>, FormatError> {
        let size = kind.size();
        let stride = view.stride().unwrap_or(size * width);
        let short =
            || self.error(place, "wants more bytes than its buffer view has").hint("copy or export the file again");
        let buffer = self.buffers.get(view.buffer().index()).ok_or_else(short)?;
        let end = view.offset().checked_add(view.length()).ok_or_else(short)?;
        let bytes = buffer.get(view.offset()..end).and_then(|b| b.get(offset..)).ok_or_else(short)?;
        let needed =
            count.saturating_sub(1).saturating_mul(stride).saturating_add(if count == 0 { 0 } else { size * width });
        // A stride below one row would let a small file unfold into a large one.
        if needed > bytes.len() || stride < size * width {
            return Err(short());
        }
        let mut numbers = Vec::with_capacity(count * width);
        for i in 0..count {
            let row = &bytes[i * stride..][..size * width];
            numbers.extend(row.chunks_exact(size).map(|raw| decode(kind, raw)));
        }
        Ok(numbers)
    }
}

fn normalization(kind: DataType) -> f64 {
    match kind {
        DataType::I8 => 1.0 / 127.0,
        DataType::U8 => 1.0 / 255.0,
        DataType::I16 => 1.0 / 32767.0,
        DataType::U16 => 1.0 / 65535.0,
        DataType::U32 | DataType::F32 => 1.0,
    }
}

fn decode(kind: DataType, raw: &[u8]) -> f64 {
    match (kind, raw) {
        (DataType::I8, &[a]) => f64::from(a.cast_signed()),
        (DataType::U8, &[a]) => f64::from(a),
        (DataType::I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (DataType::U16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (DataType::U32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (DataType::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => f64::NAN,
    }
}
