//! Streams of consecutive PNG pictures, as `ffmpeg -f image2pipe -c:v png -` writes them.

use std::io::{self, ErrorKind, Read};

const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// Largest size of a picture, bytes.
const MAX_BYTES: usize = 256 << 20;
/// Size of the length, type and checksum of a chunk, bytes.
const CHUNK_FRAME: usize = 12;

/// Splits a stream into PNG pictures.
///
/// ```
/// use elbowroom_formats::image::{ImageHeader, PixelFormat};
/// use elbowroom_formats::{PngStream, png};
/// let mut bytes = Vec::new();
/// for grey in [0, 200] {
///     png::write(&mut bytes, &ImageHeader { width: 1, height: 1, format: PixelFormat::Grey8 }, &[grey])?;
/// }
/// let mut stream = PngStream::new(&bytes[..]);
/// let (first, second) = (stream.next_picture()?.unwrap(), stream.next_picture()?.unwrap());
/// assert_eq!([first, second].concat(), bytes);
/// assert!(stream.next_picture()?.is_none());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct PngStream<R> {
    input: R,
}

impl<R: Read> PngStream<R> {
    /// Creates a reader for a stream that begins with a picture.
    pub fn new(input: R) -> Self {
        Self { input }
    }

    /// Returns the bytes of the next picture; `None` at the end of the stream. The content of the picture is not checked.
    ///
    /// # Errors
    /// [`io::Error`] if the stream cannot be read, ends within a picture, or its next bytes are not a PNG picture.
    pub fn next_picture(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut picture = vec![0; SIGNATURE.len()];
        if !self.read_or_end(&mut picture)? {
            return Ok(None);
        }
        if picture != SIGNATURE {
            return Err(io::Error::new(ErrorKind::InvalidData, "the next bytes are no PNG picture"));
        }
        loop {
            let start = picture.len();
            self.append(&mut picture, 8)?;
            let length = picture[start..start + 4].iter().fold(0_usize, |n, byte| n << 8 | usize::from(*byte));
            if length > MAX_BYTES - CHUNK_FRAME || picture.len() + length > MAX_BYTES {
                return Err(io::Error::new(ErrorKind::InvalidData, "a PNG picture has more than 256 MB"));
            }
            let is_last = picture[start + 4..start + 8] == *b"IEND";
            self.append(&mut picture, length + 4)?;
            if is_last {
                return Ok(Some(picture));
            }
        }
    }

    fn append(&mut self, picture: &mut Vec<u8>, count: usize) -> io::Result<()> {
        let from = picture.len();
        // Memory grows with the received bytes, not with the length that a header declares.
        let read = self.input.by_ref().take(count as u64).read_to_end(picture)?;
        if picture.len() - from == count && read == count {
            return Ok(());
        }
        Err(io::Error::new(ErrorKind::UnexpectedEof, "the stream ends within a picture"))
    }

    /// Fills the buffer. Returns false at the end of the stream.
    fn read_or_end(&mut self, buffer: &mut [u8]) -> io::Result<bool> {
        let mut filled = 0;
        while filled < buffer.len() {
            match self.input.read(&mut buffer[filled..]) {
                Ok(0) if filled == 0 => return Ok(false),
                Ok(0) => return Err(io::Error::new(ErrorKind::UnexpectedEof, "the stream ends within a picture")),
                Ok(count) => filled += count,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_picture_is_an_error_and_never_the_end() {
        let chunk =
            |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_be_bytes()[..], kind, data, &[0; 4]].concat();
        let whole = [&SIGNATURE[..], &chunk(b"IDAT", &[7; 100]), &chunk(b"IEND", &[])].concat();
        let read = |bytes: &[u8]| PngStream::new(bytes).next_picture();
        assert_eq!(read(&whole).unwrap().as_deref(), Some(&whole[..]));
        assert!(read(&[]).unwrap().is_none());
        for end in 1..whole.len() {
            assert_eq!(read(&whole[..end]).unwrap_err().kind(), ErrorKind::UnexpectedEof, "{end}");
        }
        assert_eq!(read(b"JFIF....").unwrap_err().kind(), ErrorKind::InvalidData);
        let endless = [&SIGNATURE[..], &[0xff; 8]].concat();
        assert_eq!(read(&endless).unwrap_err().kind(), ErrorKind::InvalidData);
    }
}
