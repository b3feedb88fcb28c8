//! Reads the numbers of an accessor, and checks every step against the available bytes.

use std::borrow::Cow;
use std::path::Path;

use elbowroom_spatial::Vec3;

use super::document::{Accessor, Document, Sparse};
use crate::Diagnostic;

/// Largest number of zeros per sparse value.
///
/// An accessor without data is all zeros except for its sparse values; more zeros would take memory out of proportion to
/// the file.
const MAX_ZEROS_PER_VALUE: usize = 100;

/// Type of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ComponentType {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl ComponentType {
    fn of(code: u32) -> Option<Self> {
        match code {
            5120 => Some(Self::I8),
            5121 => Some(Self::U8),
            5122 => Some(Self::I16),
            5123 => Some(Self::U16),
            5125 => Some(Self::U32),
            5126 => Some(Self::F32),
            _ => None,
        }
    }

    fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// Size, bytes.
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Scale factor of normalized integers.
    fn normalization(self) -> f64 {
        match self {
            Self::I8 => 1.0 / 127.0,
            Self::U8 => 1.0 / 255.0,
            Self::I16 => 1.0 / 32767.0,
            Self::U16 => 1.0 / 65535.0,
            Self::U32 | Self::F32 => 1.0,
        }
    }

    fn decode(self, raw: &[u8]) -> f64 {
        match (self, raw) {
            (Self::I8, &[a]) => f64::from(a.cast_signed()),
            (Self::U8, &[a]) => f64::from(a),
            (Self::I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
            (Self::U16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
            (Self::U32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (Self::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => f64::NAN,
        }
    }
}

/// Number of numbers per element.
fn width(element_type: &str) -> Option<usize> {
    match element_type {
        "SCALAR" => Some(1),
        "VEC2" => Some(2),
        "VEC3" => Some(3),
        "VEC4" | "MAT2" => Some(4),
        "MAT3" => Some(9),
        "MAT4" => Some(16),
        _ => None,
    }
}

/// Elements of a buffer view: a fixed number of numbers of one type per element.
struct Elements {
    buffer_view: usize,
    offset: usize,
    count: usize,
    width: usize,
    component: ComponentType,
}

/// Reads accessors of a document.
pub(super) struct AccessorReader<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a [Cow<'a, [u8]>],
    pub(super) file: &'a Path,
}

impl<'a> AccessorReader<'a> {
    pub(super) fn error(&self, place: &str, what: &str) -> Diagnostic {
        Diagnostic::new(self.file, None, format!("{place} {what}"))
    }

    /// The accessor with an index. Messages name its purpose `what`.
    pub(super) fn accessor(&self, index: usize, place: &str, what: &str) -> Result<&'a Accessor, Diagnostic> {
        self.document.accessors.get(index).ok_or_else(|| {
            self.error(place, &format!("has its {what} in accessor {index}, which does not exist"))
                .hint("the number of an accessor, counted from 0")
        })
    }

    /// Reads positions. Integers as in `KHR_mesh_quantization` are also supported.
    pub(super) fn points(&self, accessor: &Accessor, place: &str) -> Result<Vec<Vec3>, Diagnostic> {
        if accessor.element_type != "VEC3" {
            return Err(self.error(place, "has positions that are no vectors of three").hint("\"type\": \"VEC3\""));
        }
        let factor = self.factor(accessor, place)?;
        let rows = self.rows(accessor, place, 3)?;
        let point = |r: &[f64]| Vec3::new(r[0] * factor, r[1] * factor, r[2] * factor);
        let points: Vec<Vec3> = rows.chunks_exact(3).map(point).collect();
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(self
                .error(place, &format!("has a vertex that is not finite: {i} (from 0)"))
                .hint("finite numbers; export again"));
        }
        Ok(points)
    }

    pub(super) fn indices(&self, accessor: &Accessor, vertices: usize, place: &str) -> Result<Vec<u32>, Diagnostic> {
        let is_index = ComponentType::of(accessor.component_type).is_some_and(ComponentType::is_index);
        if accessor.element_type != "SCALAR" || !is_index {
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

    /// Reads floats or normalized integers, `width` per element.
    pub(super) fn vectors(&self, accessor: &Accessor, width: usize, place: &str) -> Result<Vec<f64>, Diagnostic> {
        let found = self::width(&accessor.element_type);
        if found != Some(width) {
            let found = found.map_or_else(|| accessor.element_type.clone(), |n| n.to_string());
            let what = format!("has values of {found} numbers instead of {width}");
            return Err(self.error(place, &what).hint("the animation exported again, or left out"));
        }
        let factor = self.factor(accessor, place)?;
        let rows: Vec<f64> = self.rows(accessor, place, width)?.into_iter().map(|n| n * factor).collect();
        if rows.iter().any(|n| !n.is_finite()) {
            return Err(self.error(place, "has a number that is not finite").hint("finite numbers; export again"));
        }
        Ok(rows)
    }

    fn factor(&self, accessor: &Accessor, place: &str) -> Result<f64, Diagnostic> {
        let component = self.component(accessor.component_type, place)?;
        Ok(if accessor.normalized { component.normalization() } else { 1.0 })
    }

    fn component(&self, code: u32, place: &str) -> Result<ComponentType, Diagnostic> {
        ComponentType::of(code).ok_or_else(|| {
            self.error(place, &format!("has numbers of the unknown type {code}"))
                .hint("\"componentType\": 5120, 5121, 5122, 5123, 5125 or 5126")
        })
    }

    /// Reads `count × width` numbers and applies sparse replacements.
    fn rows(&self, accessor: &Accessor, place: &str, width: usize) -> Result<Vec<f64>, Diagnostic> {
        let (count, component) = (accessor.count, self.component(accessor.component_type, place)?);
        // Read first, because the number of sparse values limits the number of zeros.
        let sparse = accessor.sparse.as_ref().map(|s| self.sparse_rows(s, component, place, width)).transpose()?;
        let replaced = sparse.as_ref().map_or(0, |(rows, _)| rows.len());
        let mut numbers = match accessor.buffer_view {
            Some(buffer_view) => {
                let offset = accessor.byte_offset;
                self.read(&Elements { buffer_view, offset, count, width, component }, place)?
            }
            None if replaced > 0 && count / MAX_ZEROS_PER_VALUE <= replaced => vec![0.0; count * width],
            None => {
                return Err(self
                    .error(place, "has an accessor without data")
                    .hint("\"bufferView\": …; or export without compression"));
            }
        };
        let (rows, values) = sparse.unwrap_or_default();
        for (i, value) in rows.into_iter().zip(values.chunks_exact(width)) {
            let slot = numbers.get_mut((i as usize).saturating_mul(width)..).and_then(|rest| rest.get_mut(..width));
            slot.ok_or_else(|| {
                self.error(place, "replaces a sparse value that does not exist").hint("export the file again")
            })?
            .copy_from_slice(value);
        }
        Ok(numbers)
    }

    /// The replaced rows and their values.
    fn sparse_rows(
        &self,
        sparse: &Sparse,
        component: ComponentType,
        place: &str,
        width: usize,
    ) -> Result<(Vec<f64>, Vec<f64>), Diagnostic> {
        let (indices, values, count) = (&sparse.indices, &sparse.values, sparse.count);
        let index_type = ComponentType::of(indices.component_type).filter(|c| c.is_index()).ok_or_else(|| {
            self.error(place, "has sparse indices that are no unsigned integers").hint("\"componentType\": 5125")
        })?;
        let (buffer_view, offset) = (indices.buffer_view, indices.byte_offset);
        let rows = self.read(&Elements { buffer_view, offset, count, width: 1, component: index_type }, place)?;
        let (buffer_view, offset) = (values.buffer_view, values.byte_offset);
        Ok((rows, self.read(&Elements { buffer_view, offset, count, width, component }, place)?))
    }

    fn read(&self, elements: &Elements, place: &str) -> Result<Vec<f64>, Diagnostic> {
        let Elements { count, width, component, .. } = *elements;
        let short =
            || self.error(place, "needs more bytes than its buffer view has").hint("copy or export the file again");
        let view = self.document.buffer_views.get(elements.buffer_view).ok_or_else(|| {
            self.error(place, &format!("has its numbers in buffer view {}, which does not exist", elements.buffer_view))
                .hint("the number of a buffer view, counted from 0")
        })?;
        let row_bytes = component.size() * width;
        // A stride of 0 means packed elements.
        let stride = view.byte_stride.filter(|&stride| stride > 0).unwrap_or(row_bytes);
        let buffer = self.buffers.get(view.buffer).ok_or_else(short)?;
        let end = view.byte_offset.checked_add(view.byte_length).ok_or_else(short)?;
        let bytes = buffer.get(view.byte_offset..end).and_then(|b| b.get(elements.offset..)).ok_or_else(short)?;
        let needed =
            count.saturating_sub(1).saturating_mul(stride).saturating_add(if count == 0 { 0 } else { row_bytes });
        // With a stride below one row, a small file could expand to a large one.
        if needed > bytes.len() || stride < row_bytes {
            return Err(short());
        }
        let mut numbers = Vec::with_capacity(count * width);
        for i in 0..count {
            let row = &bytes[i * stride..][..row_bytes];
            numbers.extend(row.chunks_exact(component.size()).map(|raw| component.decode(raw)));
        }
        Ok(numbers)
    }
}
