//! PNG images, read and written with the crate `png`.

use std::io::{self, Cursor, Write};
use std::path::Path;

use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Filter, Limits, Transformations};

use crate::Diagnostic;
use crate::image::{ImageHeader, PixelFormat, check_size, cleared_on_error, undecodable};

/// Memory that the decoder may use in addition to the pixels, bytes.
const MAX_DECODER_BYTES: usize = 1 << 30;

/// Whether these bytes are the beginning of a PNG file.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG")
}

/// Reads a PNG file into `pixels`, whose memory is reused. `file` is named in messages.
///
/// Palettes and samples of less than 8 bits are expanded to 8 bits, a transparent colour to an opacity channel.
/// Interlaced files are supported.
///
/// # Errors
/// [`Diagnostic`] if the file is damaged or cut off, or declares a side above 16,384 pixels or more pixels than its
/// bytes can encode. `pixels` is then empty.
///
/// ```
/// use elbowroom_formats::image::{ImageHeader, PixelFormat};
/// use elbowroom_formats::png;
/// let header = ImageHeader { width: 2, height: 1, format: PixelFormat::Rgb8 };
/// let mut file = Vec::new();
/// png::write(&mut file, &header, &[1, 2, 3, 4, 5, 6])?;
/// let mut pixels = Vec::new();
/// assert_eq!(png::read(&file, "two.png".as_ref(), &mut pixels)?, header);
/// assert_eq!(pixels, [1, 2, 3, 4, 5, 6]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(bytes: &[u8], file: &Path, pixels: &mut Vec<u8>) -> Result<ImageHeader, Diagnostic> {
    cleared_on_error(pixels, |pixels| decode(bytes, file, pixels))
}

fn decode(bytes: &[u8], file: &Path, pixels: &mut Vec<u8>) -> Result<ImageHeader, Diagnostic> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MAX_DECODER_BYTES });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    // The size is checked before the decoder allocates a row.
    let (width, height) = decoder.read_header_info().map_err(|e| undecodable(file, e))?.size();
    let (width, height) = (width as usize, height as usize);
    check_size(&ImageHeader { width, height, format: PixelFormat::Grey8 }, bytes.len(), file)?;
    let mut reader = decoder.read_info().map_err(|e| undecodable(file, e))?;
    let (color, depth) = reader.output_color_type();
    let format = pixel_format(color, depth)
        .ok_or_else(|| undecodable(file, format!("{color:?} samples of {} bits", depth as u8)))?;
    let header = ImageHeader { width, height, format };
    check_size(&header, bytes.len(), file)?;
    pixels.resize(header.byte_count(), 0);
    reader.next_frame(pixels).map_err(|e| undecodable(file, e))?;
    Ok(header)
}

fn pixel_format(color: ColorType, depth: BitDepth) -> Option<PixelFormat> {
    match (color, depth) {
        (ColorType::Grayscale, BitDepth::Eight) => Some(PixelFormat::Grey8),
        (ColorType::GrayscaleAlpha, BitDepth::Eight) => Some(PixelFormat::GreyAlpha8),
        (ColorType::Rgb, BitDepth::Eight) => Some(PixelFormat::Rgb8),
        (ColorType::Rgba, BitDepth::Eight) => Some(PixelFormat::Rgba8),
        (ColorType::Grayscale, BitDepth::Sixteen) => Some(PixelFormat::Grey16),
        (ColorType::GrayscaleAlpha, BitDepth::Sixteen) => Some(PixelFormat::GreyAlpha16),
        (ColorType::Rgb, BitDepth::Sixteen) => Some(PixelFormat::Rgb16),
        (ColorType::Rgba, BitDepth::Sixteen) => Some(PixelFormat::Rgba16),
        _ => None,
    }
}

/// Writes an image as PNG, compressed for speed instead of size, and flushes `out`.
///
/// # Errors
/// The errors of `out`; [`io::ErrorKind::InvalidInput`] for an image without pixels, or if the number of bytes differs
/// from [`ImageHeader::byte_count`].
pub fn write(mut out: impl Write, header: &ImageHeader, pixels: &[u8]) -> io::Result<()> {
    let side = |n: usize| u32::try_from(n).map_err(|e| io::Error::new(io::ErrorKind::InvalidInput, e));
    let mut encoder = Encoder::new(&mut out, side(header.width)?, side(header.height)?);
    encoder.set_color(match header.format.channels() {
        1 => ColorType::Grayscale,
        2 => ColorType::GrayscaleAlpha,
        3 => ColorType::Rgb,
        _ => ColorType::Rgba,
    });
    encoder.set_depth(if header.format.bytes_per_sample() == 1 { BitDepth::Eight } else { BitDepth::Sixteen });
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Adaptive);
    let mut writer = encoder.write_header().map_err(invalid_input)?;
    writer.write_image_data(pixels).map_err(invalid_input)?;
    writer.finish().map_err(invalid_input)?;
    out.flush()
}

/// Keeps errors of the output unchanged; all other errors are about the image.
fn invalid_input(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(e) => e,
        other => io::Error::new(io::ErrorKind::InvalidInput, other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_testkit::random::xorshift;
    use proptest::prelude::*;

    const FORMATS: [PixelFormat; 8] = [
        PixelFormat::Grey8,
        PixelFormat::GreyAlpha8,
        PixelFormat::Rgb8,
        PixelFormat::Rgba8,
        PixelFormat::Grey16,
        PixelFormat::GreyAlpha16,
        PixelFormat::Rgb16,
        PixelFormat::Rgba16,
    ];

    fn encoded(header: &ImageHeader, pixels: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        write(&mut file, header, pixels).unwrap();
        file
    }

    fn message(bytes: &[u8]) -> String {
        let mut pixels = vec![1];
        let error = read(bytes, "a.png".as_ref(), &mut pixels).unwrap_err();
        assert!(pixels.is_empty());
        error.to_string()
    }

    /// A file with an encoder setup that [`write`] does not use.
    fn special(color: ColorType, depth: BitDepth, width: u32, height: u32, rows: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.set_palette(vec![10, 20, 30, 40, 50, 60]);
        if color == ColorType::Indexed && height == 1 {
            encoder.set_trns(vec![255, 7]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(rows).unwrap();
        writer.finish().unwrap();
        file
    }

    #[test]
    fn palettes_and_few_bits_are_expanded() {
        let mut pixels = Vec::new();
        let file = special(ColorType::Indexed, BitDepth::One, 3, 2, &[0b0100_0000, 0b1010_0000]);
        assert_eq!(read(&file, "a.png".as_ref(), &mut pixels).unwrap().format, PixelFormat::Rgb8);
        let (a, b) = ([10, 20, 30], [40, 50, 60]);
        assert_eq!(pixels, [a, b, a, b, a, b].concat());
        let file = special(ColorType::Indexed, BitDepth::Eight, 2, 1, &[1, 0]);
        let header = read(&file, "a.png".as_ref(), &mut pixels).unwrap();
        assert_eq!((header.format, &pixels[..]), (PixelFormat::Rgba8, &[40, 50, 60, 7, 10, 20, 30, 255][..]));
        assert_eq!(header.reduce_to_8_bit(&mut pixels).format, PixelFormat::Rgb8);
        assert_eq!(pixels, [40, 50, 60, 10, 20, 30]);
        let file = special(ColorType::Grayscale, BitDepth::Two, 4, 1, &[0b0001_1011]);
        assert_eq!(read(&file, "a.png".as_ref(), &mut pixels).unwrap().format, PixelFormat::Grey8);
        assert_eq!(pixels, [0, 85, 170, 255]);
    }

    /// Adam7 with 2 × 2 pixels: the pixel at (0, 0), then the one at (1, 0), then the second row.
    #[test]
    fn interlaced_files_are_read() {
        let header = ImageHeader { width: 2, height: 2, format: PixelFormat::Grey8 };
        let stored = special(ColorType::Grayscale, BitDepth::Eight, 2, 2, &[1, 2, 3, 4]);
        let mut file = stored[..8].to_vec();
        let mut ihdr = stored[12..29].to_vec();
        ihdr[16] = 1;
        chunk(&mut file, &ihdr);
        // A stored deflate block of three passes, each row with its filter byte.
        let rows = [0, 10, 0, 20, 0, 30, 40];
        let mut idat = b"IDAT\x78\x01\x01".to_vec();
        idat.extend([rows.len() as u8, 0, !(rows.len() as u8), 255]);
        idat.extend(rows);
        let (a, b) = rows.iter().fold((1_u32, 0_u32), |(a, b), &x| (a + u32::from(x), b + a + u32::from(x)));
        idat.extend((b << 16 | a).to_be_bytes());
        chunk(&mut file, &idat);
        chunk(&mut file, b"IEND");
        let mut pixels = Vec::new();
        assert_eq!(read(&file, "a.png".as_ref(), &mut pixels).unwrap(), header);
        assert_eq!(pixels, [10, 20, 30, 40]);
    }

    fn chunk(file: &mut Vec<u8>, name_and_data: &[u8]) {
        file.extend((name_and_data.len() as u32 - 4).to_be_bytes());
        file.extend(name_and_data);
        let crc = name_and_data.iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
        });
        file.extend((!crc).to_be_bytes());
    }

    #[test]
    fn files_that_announce_more_than_they_hold_are_refused() {
        let header = ImageHeader { width: 3, height: 2, format: PixelFormat::Grey8 };
        let file = encoded(&header, &[1, 2, 3, 4, 5, 6]);
        for length in 0..file.len() - 12 {
            assert!(message(&file[..length]).starts_with("a.png: cannot be decoded: "), "{length}");
        }
        let resized = |width: u32, height: u32| {
            let mut ihdr = file[12..29].to_vec();
            ihdr[4..8].copy_from_slice(&width.to_be_bytes());
            ihdr[8..12].copy_from_slice(&height.to_be_bytes());
            let mut resized = file[..8].to_vec();
            chunk(&mut resized, &ihdr);
            resized.extend(&file[33..]);
            resized
        };
        assert!(message(&resized(3, 70_000)).contains("more than 16384 a side"));
        assert!(message(&resized(16_000, 16_000)).contains("but has only"));
        assert!(message(&resized(4, 2)).contains("cannot be decoded"));
        assert!(message(&resized(0, 2)).contains("cannot be decoded"));
    }

    #[test]
    fn pixels_that_do_not_fit_their_header_are_not_written() {
        let header = ImageHeader { width: 3, height: 2, format: PixelFormat::Rgb8 };
        let kind = |header: &ImageHeader, n: usize| write(io::sink(), header, &vec![0; n]).unwrap_err().kind();
        assert_eq!(kind(&header, 17), io::ErrorKind::InvalidInput);
        assert_eq!(kind(&ImageHeader { width: 0, ..header }, 0), io::ErrorKind::InvalidInput);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn written_files_are_read_back(width in 1_usize..20, height in 1_usize..20, format in 0_usize..8, seed: u64) {
            let header = ImageHeader { width, height, format: FORMATS[format] };
            let mut state = seed | 1;
            let mut byte = || (xorshift(&mut state) >> 32) as u8;
            let pixels: Vec<u8> = (0..header.byte_count()).map(|_| byte()).collect();
            let mut back = Vec::new();
            prop_assert_eq!(read(&encoded(&header, &pixels), "a.png".as_ref(), &mut back).unwrap(), header);
            prop_assert_eq!(back, pixels);
        }

        #[test]
        fn damaged_files_never_panic(at: prop::sample::Index, to: u8) {
            let header = ImageHeader { width: 9, height: 7, format: PixelFormat::Rgb8 };
            let pixels: Vec<u8> = (0..header.byte_count()).map(|i| (i * 7 % 251) as u8).collect();
            let mut file = encoded(&header, &pixels);
            let at = at.index(file.len());
            file[at] = to;
            let mut back = Vec::new();
            if read(&file, "a.png".as_ref(), &mut back).is_err() {
                prop_assert!(back.is_empty());
            }
        }
    }
}
