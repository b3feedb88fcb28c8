//! The edges of a surface, grouped by a counting sort instead of hashing.

/// Uses of every edge, in buckets by the edge's smaller vertex. Faces with fewer than three different corners have
/// no uses.
pub(crate) struct Edges {
    /// Start of the bucket of each vertex in `uses`.
    starts: Vec<usize>,
    /// Larger vertex in the upper half, label in the lower half, sorted within each bucket.
    uses: Vec<u64>,
}

impl Edges {
    /// Collects the edges. `label` of triangle and corner is stored with the use of the edge from that corner to the
    /// next.
    pub fn new(vertices: usize, faces: &[[u32; 3]], label: impl Fn(usize, usize) -> u32) -> Self {
        let mut starts = vec![0; vertices + 1];
        for_each_edge(faces, |_, _, low, _| starts[low as usize] += 1);
        let mut total = 0;
        for s in &mut starts {
            total += std::mem::replace(s, total);
        }
        let mut uses = vec![0_u64; total];
        for_each_edge(faces, |triangle, corner, low, high| {
            let at = &mut starts[low as usize];
            uses[*at] = u64::from(high) << 32 | u64::from(label(triangle, corner));
            *at += 1;
        });
        // Each start has moved to the end of its bucket, which is the start of the next.
        starts.rotate_right(1);
        starts[0] = 0;
        let mut edges = Self { starts, uses };
        edges.sort();
        edges
    }

    fn sort(&mut self) {
        for bucket in self.starts.windows(2) {
            self.uses[bucket[0]..bucket[1]].sort_unstable();
        }
    }

    /// Visits every edge once: smaller vertex, larger vertex, uses with the larger vertex in the upper half.
    pub fn for_each(&self, mut edge: impl FnMut(u32, u32, &[u64])) {
        for (low, bucket) in self.starts.windows(2).enumerate() {
            for uses in self.uses[bucket[0]..bucket[1]].chunk_by(|a, b| a >> 32 == b >> 32) {
                edge(low as u32, (uses[0] >> 32) as u32, uses);
            }
        }
    }
}

/// Triangle, corner, smaller and larger vertex of every edge of the faces with three different corners.
fn for_each_edge(faces: &[[u32; 3]], mut edge: impl FnMut(usize, usize, u32, u32)) {
    for (triangle, f) in faces.iter().enumerate().filter(|(_, f)| is_proper(f)) {
        for corner in 0..3 {
            let (a, b) = (f[corner], f[(corner + 1) % 3]);
            edge(triangle, corner, a.min(b), a.max(b));
        }
    }
}

/// True if the three corners are different.
pub(crate) fn is_proper(f: &[u32; 3]) -> bool {
    f[0] != f[1] && f[1] != f[2] && f[2] != f[0]
}
