//! Files to frames: PNG, PGM and PPM, and bare bytes. Hostile input ends here.

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use elbowroom_formats::FormatError;
use image::codecs::{png::PngDecoder, pnm::PnmDecoder};
use image::{ColorType, DynamicImage, ImageDecoder, ImageError, Limits};

use crate::{Channels, Frame, VisionError};

/// Larger pictures are refused: no camera above a cell has them, and memory is bounded by it.
const MAX_SIDE: u32 = 16_384;
/// Larger files are refused.
const MAX_BYTES: u64 = 1 << 28;
/// Deflate, the denser of the packings, makes at most 1032 bytes of one.
const MOST_PER_BYTE: u64 = 1100;

/// What bare bytes mean: files that end in `.raw`, `.gray` or `.grey` do not say it themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawLayout {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Grey or RGB.
    pub channels: Channels,
}

/// Reads a picture into `frame`, whose memory is reused; its name becomes the path. The kind follows from the content
/// (PNG, PNM) or from the name (`.raw`, `.gray`, `.grey`, which need a layout). Transparency is dropped, 16 bits become 8.
///
/// # Errors
/// Files that are missing, truncated, too large or of another kind: the file, what is wrong, what to write instead.
pub fn read(path: &Path, raw: Option<RawLayout>, frame: &mut Frame) -> Result<(), VisionError> {
    frame.empty();
    let bytes = read_bytes(path)?;
    decode(&bytes, path, raw, frame)
}

/// As [`read`], from bytes; `file` is what messages call them.
///
/// # Errors
/// As [`read`]; the frame is then empty: half a picture does not pass for one.
pub fn decode(bytes: &[u8], file: &Path, raw: Option<RawLayout>, frame: &mut Frame) -> Result<(), VisionError> {
    frame.name.clear();
    frame.name.push_str(&file.to_string_lossy());
    let result = decode_any(bytes, file, raw, frame);
    if result.is_err() {
        frame.empty();
    }
    result
}

fn decode_any(bytes: &[u8], file: &Path, raw: Option<RawLayout>, frame: &mut Frame) -> Result<(), VisionError> {
    if bytes.is_empty() {
        return Err(FormatError::new(file, None, "is empty").hint("a PNG, PGM or PPM picture, or raw bytes").into());
    }
    if bytes.starts_with(b"\x89PNG") {
        let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits()).map_err(|e| refused(file, &e))?;
        return unpack(decoder, bytes.len(), file, frame);
    }
    if is_raw(file) {
        let layout = raw.ok_or_else(|| {
            FormatError::new(file, None, "is raw bytes, which do not say how wide the picture is")
                .hint("width, height and channels of raw frames; or pictures as PNG, PGM or PPM")
        })?;
        return frame.fill(layout.width, layout.height, layout.channels, |pixels| {
            pixels.clear();
            pixels.extend_from_slice(bytes);
        });
    }
    if matches!(bytes, [b'P', b'1'..=b'6', ..]) {
        let decoder = PnmDecoder::new(Cursor::new(bytes)).map_err(|e| refused(file, &e))?;
        return unpack(decoder, bytes.len(), file, frame);
    }
    Err(FormatError::new(file, None, "is no picture that can be read").hint("PNG, PGM, PPM or raw bytes").into())
}

fn is_raw(file: &Path) -> bool {
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    ["raw", "gray", "grey"].iter().any(|&e| extension == e)
}

fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES * 4);
    limits
}

/// Bytes of a regular file, or why not.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, FormatError> {
    let cannot = |e: std::io::Error| FormatError::new(path, None, format!("cannot be read: {e}"));
    let meta = std::fs::metadata(path).map_err(cannot)?;
    if !meta.is_file() {
        return Err(FormatError::new(path, None, "is not a file").hint("the path of a file, not of a directory"));
    }
    if meta.len() > MAX_BYTES {
        let what = format!("has {} bytes, more than the {MAX_BYTES} allowed", meta.len());
        return Err(FormatError::new(path, None, what).hint("a smaller picture or a thinner cloud"));
    }
    let mut bytes = Vec::with_capacity(meta.len() as usize);
    File::open(path).and_then(|f| f.take(MAX_BYTES).read_to_end(&mut bytes)).map_err(cannot)?;
    Ok(bytes)
}

fn refused(file: &Path, error: &ImageError) -> VisionError {
    FormatError::new(file, None, format!("cannot be decoded: {error}"))
        .hint("the whole picture: the file is damaged or was cut off while it was written")
        .into()
}

/// Refuses pictures that are too large, or larger than the file's bytes can say.
fn check_size(decoder: &impl ImageDecoder, file_bytes: usize, file: &Path) -> Result<(), VisionError> {
    let (width, height) = decoder.dimensions();
    if width > MAX_SIDE || height > MAX_SIDE {
        let what = format!("announces {width} x {height} pixels, more than {MAX_SIDE} a side");
        return Err(FormatError::new(file, None, what).hint("a smaller picture").into());
    }
    if decoder.total_bytes() > file_bytes as u64 * MOST_PER_BYTE {
        let what = format!("announces {width} x {height} pixels, but has only {file_bytes} bytes");
        return Err(FormatError::new(file, None, what)
            .hint("the whole picture: the file is damaged or cut off")
            .into());
    }
    Ok(())
}

fn unpack(decoder: impl ImageDecoder, file_bytes: usize, file: &Path, frame: &mut Frame) -> Result<(), VisionError> {
    check_size(&decoder, file_bytes, file)?;
    let (width, height) = decoder.dimensions();
    let channels = match decoder.color_type() {
        ColorType::L8 => Channels::Grey,
        ColorType::Rgb8 => Channels::Rgb,
        _ => return convert(decoder, file, frame),
    };
    let length = decoder.total_bytes() as usize;
    let mut result = Ok(());
    let filled = frame.fill(width as usize, height as usize, channels, |pixels| {
        pixels.resize(length, 0);
        result = decoder.read_image(pixels);
    });
    result.map_err(|e| refused(file, &e))?;
    filled
}

/// The kinds that cameras rarely send: palettes, transparency, 16 bits.
fn convert(decoder: impl ImageDecoder, file: &Path, frame: &mut Frame) -> Result<(), VisionError> {
    let image = DynamicImage::from_decoder(decoder).map_err(|e| refused(file, &e))?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    if image.color().has_color() {
        return frame.fill(width, height, Channels::Rgb, |pixels| *pixels = image.into_rgb8().into_raw());
    }
    frame.fill(width, height, Channels::Grey, |pixels| *pixels = image.into_luma8().into_raw())
}

/// A 16-bit grey PNG or PGM as (width, height, values): how depth cameras save pictures.
///
/// # Errors
/// As [`read`]; and pictures of 8 bits, which hold no depths worth the name.
pub fn read_grey16(path: &Path) -> Result<(usize, usize, Vec<u16>), VisionError> {
    let bytes = read_bytes(path)?;
    let image = if bytes.starts_with(b"\x89PNG") {
        whole(PngDecoder::with_limits(Cursor::new(&bytes), limits()), bytes.len(), path)?
    } else {
        whole(PnmDecoder::new(Cursor::new(&bytes)), bytes.len(), path)?
    };
    match image {
        DynamicImage::ImageLuma16(depths) => Ok((depths.width() as usize, depths.height() as usize, depths.into_raw())),
        other => {
            let what = format!("holds {:?} values, not depths", other.color());
            Err(FormatError::new(path, None, what).hint("one grey channel of 16 bits, as depth cameras save it").into())
        }
    }
}

fn whole<D: ImageDecoder>(
    decoder: Result<D, ImageError>,
    bytes: usize,
    file: &Path,
) -> Result<DynamicImage, VisionError> {
    let decoder = decoder.map_err(|e| refused(file, &e))?;
    check_size(&decoder, bytes, file)?;
    DynamicImage::from_decoder(decoder).map_err(|e| refused(file, &e))
}
