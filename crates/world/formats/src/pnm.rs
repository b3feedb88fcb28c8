//! PNM, the image files of Netpbm: PBM, PGM and PPM, as text (P1 to P3) and binary (P4 to P6).

use std::path::Path;

use crate::Diagnostic;
use crate::image::{ImageHeader, PixelFormat, check_size, cleared_on_error, undecodable};

/// Whether these bytes are the beginning of a PNM file.
pub fn is_pnm(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'1'..=b'6', ..])
}

/// Reads a PNM file into `pixels`, whose memory is reused. `file` is named in messages.
///
/// Samples with a maximum up to 255 become 8-bit samples, others 16-bit samples. If the maximum is smaller than the
/// type's maximum, samples are scaled to the full range. Bitmaps become grey images of 0 (black, 1 in the file) and 255.
///
/// # Errors
/// [`Diagnostic`] if the file is damaged or cut off, or declares a side above 16,384 pixels or more pixels than its
/// bytes can encode. `pixels` is then empty.
///
/// ```
/// use elbowroom_formats::pnm;
/// let mut pixels = Vec::new();
/// let header = pnm::read(b"P2\n# by hand\n3 1\n255\n1 2 3\n", "a.pgm".as_ref(), &mut pixels)?;
/// assert_eq!((header.width, header.height, &pixels[..]), (3, 1, &[1, 2, 3][..]));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn read(bytes: &[u8], file: &Path, pixels: &mut Vec<u8>) -> Result<ImageHeader, Diagnostic> {
    cleared_on_error(pixels, |pixels| decode(bytes, file, pixels))
}

fn decode(bytes: &[u8], file: &Path, pixels: &mut Vec<u8>) -> Result<ImageHeader, Diagnostic> {
    let refused = |why: &str| undecodable(file, why);
    let kind = match bytes {
        [b'P', kind @ b'1'..=b'6', ..] => *kind,
        _ => return Err(refused("it does not begin with P1 to P6")),
    };
    let mut scanner = Scanner { rest: &bytes[2..] };
    let mut number = |of: &str| scanner.header_number().ok_or_else(|| refused(&format!("the header has no {of}")));
    let (width, height) = (number("width")?, number("height")?);
    let is_bitmap = matches!(kind, b'1' | b'4');
    let maximum = if is_bitmap { 1 } else { number("maximum")? };
    if !(1..=0xffff).contains(&maximum) {
        return Err(refused(&format!("the maximum {maximum} is not from 1 to 65535")));
    }
    let format = match (matches!(kind, b'3' | b'6'), maximum > 0xff) {
        (false, false) => PixelFormat::Grey8,
        (false, true) => PixelFormat::Grey16,
        (true, false) => PixelFormat::Rgb8,
        (true, true) => PixelFormat::Rgb16,
    };
    let header = ImageHeader { width, height, format };
    check_size(&header, bytes.len(), file)?;
    let short = || refused("it ends before its pixels");
    match kind {
        b'1' => scanner.bits_in_text(width * height, pixels).map_err(refused)?,
        b'4' => scanner.bits(width, height, pixels).ok_or_else(short)?,
        b'2' | b'3' => scanner.samples_in_text(&header, pixels).map_err(refused)?,
        _ => pixels.extend_from_slice(scanner.rest.get(..header.byte_count()).ok_or_else(short)?),
    }
    scale_to_full_range(&header, maximum, pixels);
    Ok(header)
}

struct Scanner<'a> {
    rest: &'a [u8],
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

impl Scanner<'_> {
    fn skip_while(&mut self, skipped: impl Fn(u8) -> bool) {
        let length = self.rest.iter().position(|&b| !skipped(b)).unwrap_or(self.rest.len());
        self.rest = &self.rest[length..];
    }

    /// Reads a number after blanks and comments, and the one blank that ends it.
    fn header_number(&mut self) -> Option<usize> {
        self.skip_while(is_blank);
        while self.rest.first() == Some(&b'#') {
            self.skip_while(|b| b != b'\n' && b != b'\r');
            self.skip_while(is_blank);
        }
        let number = self.digits()?;
        match self.rest.split_first() {
            Some((&blank, rest)) if is_blank(blank) => self.rest = rest,
            Some((b'#', _)) | None => {}
            Some(_) => return None,
        }
        Some(number)
    }

    fn digits(&mut self) -> Option<usize> {
        let length = self.rest.iter().position(|b| !b.is_ascii_digit()).unwrap_or(self.rest.len());
        let (digits, rest) = self.rest.split_at(length);
        self.rest = rest;
        std::str::from_utf8(digits).ok()?.parse::<u32>().ok().map(|n| n as usize)
    }

    /// Reads whole numbers separated by blanks.
    fn samples_in_text(&mut self, header: &ImageHeader, pixels: &mut Vec<u8>) -> Result<(), &'static str> {
        let bytes = header.format.bytes_per_sample();
        let largest = if bytes == 1 { 0xff } else { 0xffff };
        // At least a digit per sample, so that memory stays in proportion to the file.
        if header.byte_count() / bytes > self.rest.len() {
            return Err("it ends before its pixels");
        }
        pixels.reserve(header.byte_count());
        while pixels.len() < header.byte_count() {
            self.skip_while(is_blank);
            if self.rest.is_empty() {
                return Err("it ends before its pixels");
            }
            let sample = self.digits().filter(|&n| n <= largest && self.rest.first().is_none_or(|&b| is_blank(b)));
            let sample = sample.ok_or("a pixel is not a whole number, or is too large")?;
            pixels.extend_from_slice(&(sample as u16).to_be_bytes()[2 - bytes..]);
        }
        Ok(())
    }

    /// Reads digits 0 and 1, with or without blanks between them.
    fn bits_in_text(&mut self, count: usize, pixels: &mut Vec<u8>) -> Result<(), &'static str> {
        for &byte in self.rest.iter().filter(|&&b| !is_blank(b)).take(count) {
            match byte {
                b'0' => pixels.push(1),
                b'1' => pixels.push(0),
                _ => return Err("a pixel is neither 0 nor 1"),
            }
        }
        if pixels.len() == count { Ok(()) } else { Err("it ends before its pixels") }
    }

    /// Reads eight pixels per byte, the first in the highest bit. Every row begins with a new byte.
    fn bits(&mut self, width: usize, height: usize, pixels: &mut Vec<u8>) -> Option<()> {
        let stride = width.div_ceil(8);
        let rows = self.rest.get(..stride * height)?;
        for row in rows.chunks_exact(stride) {
            pixels.extend((0..width).map(|x| 1 - (row[x / 8] >> (7 - x % 8) & 1)));
        }
        Some(())
    }
}

fn scale_to_full_range(header: &ImageHeader, maximum: usize, pixels: &mut [u8]) {
    let bytes = header.format.bytes_per_sample();
    let largest = if bytes == 1 { 0xff } else { 0xffff };
    if maximum == largest {
        return;
    }
    let factor = largest as f32 / maximum as f32;
    if bytes == 1 {
        for v in pixels.iter_mut() {
            *v = (f32::from(*v) * factor).round() as u8;
        }
    } else {
        for pair in pixels.as_chunks_mut::<2>().0 {
            *pair = ((f32::from(u16::from_be_bytes(*pair)) * factor).round() as u16).to_be_bytes();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decoded(bytes: &[u8]) -> (ImageHeader, Vec<u8>) {
        let mut pixels = vec![9; 3];
        let header = read(bytes, "a.pnm".as_ref(), &mut pixels).unwrap();
        (header, pixels)
    }

    fn message(bytes: &[u8]) -> String {
        let mut pixels = vec![9; 3];
        let error = read(bytes, "a.pnm".as_ref(), &mut pixels).unwrap_err();
        assert!(pixels.is_empty());
        error.to_string()
    }

    #[test]
    fn all_six_pnm_formats_are_read() {
        let grey = |width, height| ImageHeader { width, height, format: PixelFormat::Grey8 };
        let bits = vec![255, 0, 255, 0, 0, 255];
        assert_eq!(decoded(b"P1 3 2 010\n1 1 0"), (grey(3, 2), bits.clone()));
        assert_eq!(decoded(b"P4 3 2\n\x5f\xdf"), (grey(3, 2), bits));
        assert_eq!(decoded(b"P2\n#a\n#b\n2 1 # c\n255\n7\t255 "), (grey(2, 1), vec![7, 255]));
        assert_eq!(decoded(b"P5 2 1 255 \x07\xff"), (grey(2, 1), vec![7, 255]));
        let colour = ImageHeader { width: 1, height: 1, format: PixelFormat::Rgb8 };
        assert_eq!(decoded(b"P3 1 1 255 1 2 3"), (colour, vec![1, 2, 3]));
        assert_eq!(decoded(b"P6 1 1 255\n\x01\x02\x03"), (colour, vec![1, 2, 3]));
    }

    #[test]
    fn sixteen_bits_and_small_maxima() {
        let deep = ImageHeader { width: 2, height: 1, format: PixelFormat::Grey16 };
        assert_eq!(decoded(b"P5 2 1 65535\n\x01\x02\xff\xff"), (deep, vec![1, 2, 255, 255]));
        assert_eq!(decoded(b"P2 2 1 65535 258 65535"), (deep, vec![1, 2, 255, 255]));
        assert_eq!(decoded(b"P2 2 1 256 128 256"), (deep, vec![0x80, 0, 255, 255]));
        assert_eq!(decoded(b"P2 3 1 4 0 1 4").1, [0, 64, 255]);
        let colour = ImageHeader { format: PixelFormat::Rgb16, width: 1, height: 1 };
        assert_eq!(decoded(b"P3 1 1 65535 1 2 3"), (colour, vec![0, 1, 0, 2, 0, 3]));
    }

    #[test]
    fn errors_name_missing_or_invalid_fields() {
        for (bytes, part) in [
            (&b"P7 1 1"[..], "P1 to P6"),
            (b"P5", "no width"),
            (b"P5 3", "no height"),
            (b"P5 3 1 ", "no maximum"),
            (b"P5 3x 1 255 ", "no width"),
            (b"P5 3 1 0 abc", "from 1 to 65535"),
            (b"P5 3 1 65536 abc", "from 1 to 65535"),
            (b"P5 3 1 255 ab", "ends before its pixels"),
            (b"P5 0 1 255 ", "0 x 1 pixels"),
            (b"P5 99999 99999 255 a", "more than 16384 a side"),
            (b"P5 16000 16000 255 a", "but has only"),
            (b"P2 3 1 255 1 2", "ends before its pixels"),
            (b"P2 2 1 255 1 256", "too large"),
            (b"P2 2 1 255 1 x ", "not a whole number"),
            (b"P1 2 1 12", "neither 0 nor 1"),
            (b"P1 3 1 11", "ends before its pixels"),
            (b"P4 9 2 \x00\x00\x00", "ends before its pixels"),
        ] {
            let message = message(bytes);
            assert!(message.contains(part), "{part}: {message}");
        }
    }

    proptest! {
        #[test]
        fn damaged_files_never_panic(kind in b'1'..=b'6', at: prop::sample::Index, to: u8) {
            let mut bytes = b"P1 3 2 255\n1 0 0 1 1 1 0 0 1 1 0 0 1 1 1 1 1 1 ".to_vec();
            bytes[1] = kind;
            let at = at.index(bytes.len());
            bytes[at] = to;
            let _ = read(&bytes, "a.pnm".as_ref(), &mut Vec::new());
        }
    }
}
