//! Morphological opening and closing with a 3 × 3 square on planes of zeros and ones; pixels outside the image have no
//! influence.

/// Workspace of the size of the image.
#[derive(Debug, Clone, Default)]
pub(crate) struct Morphology {
    horizontal: Vec<u8>,
    original: Vec<u8>,
}

impl Morphology {
    /// Removes areas narrower than `2 · radius + 1` pixels, which are noise.
    pub(crate) fn open(&mut self, plane: &mut [u8], width: usize, radius: usize) {
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a & b);
        }
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a | b);
        }
    }

    /// Like [`Self::open`], but restores the corners of the remaining areas, up to `radius` pixels away.
    pub(crate) fn open_and_restore(&mut self, plane: &mut [u8], width: usize, radius: usize) {
        self.original.clear();
        self.original.extend_from_slice(plane);
        self.open(plane, width, radius);
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a | b);
        }
        for (pixel, original) in plane.iter_mut().zip(&self.original) {
            *pixel &= original;
        }
    }

    /// Fills gaps narrower than `2 · radius + 1` pixels.
    pub(crate) fn close(&mut self, plane: &mut [u8], width: usize, radius: usize) {
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a | b);
        }
        for _ in 0..radius {
            self.pass(plane, width, |a, b| a & b);
        }
    }

    /// Combines the 3 × 3 neighbourhood of each pixel within the image.
    #[inline]
    fn pass(&mut self, plane: &mut [u8], width: usize, join: impl Fn(u8, u8) -> u8 + Copy) {
        self.horizontal.resize(plane.len(), 0);
        for (row, out) in plane.chunks_exact(width).zip(self.horizontal.chunks_exact_mut(width)) {
            pass_along_row(row, out, join);
        }
        let horizontal = &self.horizontal;
        let height = plane.len() / width;
        for (y, out) in plane.chunks_exact_mut(width).enumerate() {
            let above = &horizontal[y.saturating_sub(1) * width..][..width];
            let here = &horizontal[y * width..][..width];
            let below = &horizontal[(y + 1).min(height - 1) * width..][..width];
            for i in 0..width {
                out[i] = join(join(above[i], here[i]), below[i]);
            }
        }
    }
}

#[inline]
fn pass_along_row(row: &[u8], out: &mut [u8], join: impl Fn(u8, u8) -> u8) {
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
    use elbowroom_testkit::random::xorshift;
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
            let mut bit = || u8::from(!xorshift(&mut state).is_multiple_of(3));
            let plane: Vec<u8> = (0..width * height).map(|_| bit()).collect();
            let (mut opened, mut closed) = (plane.clone(), plane.clone());
            let mut morphology = Morphology::default();
            morphology.open(&mut opened, width, 1);
            morphology.close(&mut closed, width, 1);
            prop_assert_eq!(opened, naive(&naive(&plane, width, true), width, false));
            prop_assert_eq!(closed, naive(&naive(&plane, width, false), width, true));
        }
    }
}
