//! Connected components of a mesh.

/// Root vertex of the connected component of each vertex (union-find with path halving).
pub(crate) fn components(count: usize, faces: &[[u32; 3]]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..count as u32).collect();
    for f in faces {
        let mut a = root(&mut parent, f[0]);
        for &v in &f[1..] {
            let b = root(&mut parent, v);
            // The smaller index becomes the root: neighbours in a file are mostly neighbours in space.
            let (low, high) = (a.min(b), a.max(b));
            parent[high as usize] = low;
            a = low;
        }
    }
    for v in 0..count {
        // A parent has a smaller index, so its root is final already.
        parent[v] = parent[parent[v] as usize];
    }
    parent
}

fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}
