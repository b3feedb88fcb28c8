//! Opening and closing with a 3 × 3 square on planes of zeros and ones; what lies outside the picture counts as nothing
//! for closing and as anything for opening.

/// Scratch of the size of the picture.
#[derive(Debug, Clone, Default)]
pub(crate) struct Morphology {
    along: Vec<u8>,
    raw: Vec<u8>,
}

impl Morphology {
    /// Takes away what is narrower than `2 · radius + 1` pixels: noise.
    pub(crate) fn open(&mut self, plane: &mut [u8], width: usize, radius: usize) {
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a & b);
        }
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a | b);
        }
    }

    /// As [`Self::open`], but what remains gets back what it lost at its corners, up to `radius` pixels away.
    pub(crate) fn open_and_restore(&mut self, plane: &mut [u8], width: usize, radius: usize) {
        self.raw.clear();
        self.raw.extend_from_slice(plane);
        self.open(plane, width, radius);
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a | b);
        }
        for (pixel, raw) in plane.iter_mut().zip(&self.raw) {
            *pixel &= raw;
        }
    }

    /// Fills gaps that are narrower than `2 · radius + 1` pixels.
    pub(crate) fn close(&mut self, plane: &mut [u8], width: usize, radius: usize) {
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a | b);
        }
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a & b);
        }
    }

    /// Each pixel becomes the combination of its 3 × 3 neighbourhood within the picture.
    #[inline]
    fn pass(&mut self, plane: &mut [u8], width: usize, join: impl Fn(u8, u8) -> u8 + Copy) {
        self.along.resize(plane.len(), 0);
        for (row, out) in plane.chunks_exact(width).zip(self.along.chunks_exact_mut(width)) {
            along_row(row, out, join);
        }
        let along = &self.along;
        let height = plane.len() / width;
        for (y, out) in plane.chunks_exact_mut(width).enumerate() {
            let above = &along[y.saturating_sub(1) * width..][..width];
            let here = &along[y * width..][..width];
            let below = &along[(y + 1).min(height - 1) * width..][..width];
            for i in 0..width {
                out[i] = join(join(above[i], here[i]), below[i]);
            }
        }
    }
}

#[inline]
fn along_row(row: &[u8], out: &mut [u8], join: impl Fn(u8, u8) -> u8) {
    let n = row.len();
    if n < 2 {
        out.copy_from_slice(row);
        return;
    }
    out[0] = join(row[0], row[1]);
    out[n - 1] = join(row[n - 2], row[n - 1]);
    let (left, here, right) = (&row[..n - 2], &row[1..n - 1], &row[2..]);
    let out = &mut out[1..n - 1];
    for i in 0..out.len() {
        out[i] = join(join(left[i], here[i]), right[i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn naive(plane: &[u8], width: usize, all: bool) -> Vec<u8> {
        let height = plane.len() / width;
        let pixel = |i: usize| {
            let (x, y) = (i % width, i / width);
            let near = |a: usize, n: usize| a.saturating_sub(1)..(a + 2).min(n);
            let mut square = near(y, height).flat_map(|v| near(x, width).map(move |u| plane[v * width + u]));
            u8::from(if all { square.all(|p| p == 1) } else { square.any(|p| p == 1) })
        };
        (0..plane.len()).map(pixel).collect()
    }

    proptest! {
        #[test]
        fn opening_and_closing_are_as_defined(width in 1_usize..40, height in 1_usize..12, seed in any::<u64>()) {
            let mut state = seed | 1;
            let mut bit = || { state ^= state << 13; state ^= state >> 7; state ^= state << 17; u8::from(state % 3 > 0) };
            let plane: Vec<u8> = (0..width * height).map(|_| bit()).collect();
            let (mut opened, mut closed) = (plane.clone(), plane.clone());
            let mut scratch = Morphology::default();
            scratch.open(&mut opened, width, 1);
            scratch.close(&mut closed, width, 1);
            prop_assert_eq!(opened, naive(&naive(&plane, width, true), width, false));
            prop_assert_eq!(closed, naive(&naive(&plane, width, false), width, true));
        }
    }
}
