//! Connected-component labelling: runs along rows, united by union-find with the runs of the row above (8 neighbours).

use std::ops::Range;

use crate::disjoint_sets::DisjointSets;
use crate::{Point2, polygon};

/// A connected component of the foreground.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Blob {
    /// Number of pixels.
    pub area_px: usize,
    /// Columns from its leftmost pixel to one past its rightmost.
    pub columns: Range<usize>,
    /// Rows from its uppermost pixel to one past its lowest.
    pub rows: Range<usize>,
    /// Mean position of the pixels.
    pub centre_px: Point2,
    /// The convex hull of the pixels, including their edges.
    pub outline_px: Vec<Point2>,
}

/// Pixels `columns` of row `row`.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: u32,
    begin: u32,
    end: u32,
}

/// Finds connected components; memory is reused.
///
/// ```
/// use elbowroom_vision::ConnectedComponents;
/// let plane = [1, 1, 0, 0, 0,
///              0, 0, 1, 0, 1];
/// let mut components = ConnectedComponents::default();
/// let blobs = components.label(&plane, 5, 1);
/// assert_eq!(blobs.iter().map(|blob| blob.area_px).collect::<Vec<_>>(), [3, 1]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct ConnectedComponents {
    runs: Vec<Run>,
    sets: DisjointSets,
    blob_of: Vec<u32>,
    stats: Vec<ComponentStats>,
    blobs: Vec<Blob>,
    count: usize,
    corners: Vec<Point2>,
    runs_by_blob: Vec<u32>,
}

#[derive(Debug, Clone, Default)]
struct ComponentStats {
    area: u64,
    x_twice: u64,
    y_twice: u64,
    columns: Range<u32>,
    rows: Range<u32>,
    /// Number of runs, and their start in `runs_by_blob`.
    runs: u32,
    first: u32,
}

const NONE: u32 = u32::MAX;

impl ConnectedComponents {
    /// Finds the blobs of at least `min_area_px` pixels in a plane that is `width` wide (pixels other than 0 are
    /// foreground), in the order of their first pixels, row by row.
    pub fn label(&mut self, plane: &[u8], width: usize, min_area_px: usize) -> &[Blob] {
        self.runs.clear();
        self.sets.parent.clear();
        let mut above = 0..0;
        for (y, row) in plane.chunks_exact(width.max(1)).enumerate() {
            let first = self.runs.len();
            runs_of_row(row, y as u32, &mut self.runs);
            self.sets.parent.extend(first as u32..self.runs.len() as u32);
            self.unite_with_row_above(above, first);
            above = first..self.runs.len();
        }
        self.collect_stats();
        self.sort_runs();
        self.finish(min_area_px);
        &self.blobs[..self.count]
    }

    /// Unites the runs from `first` on with the runs of the row above that they touch, also diagonally.
    fn unite_with_row_above(&mut self, above: Range<usize>, first: usize) {
        let mut a = above.start;
        for here in first..self.runs.len() {
            let run = self.runs[here];
            if above.is_empty() || self.runs[above.start].row + 1 != run.row {
                return;
            }
            while a < above.end && self.runs[a].end < run.begin {
                a += 1;
            }
            let mut b = a;
            while b < above.end && self.runs[b].begin <= run.end {
                self.sets.union(b as u32, here as u32);
                b += 1;
            }
        }
    }

    fn collect_stats(&mut self) {
        self.stats.clear();
        self.blob_of.clear();
        for i in 0..self.runs.len() {
            let root = self.sets.find(i as u32) as usize;
            let blob = if root == i { self.stats.len() as u32 } else { self.blob_of[root] };
            self.blob_of.push(blob);
            let run = self.runs[i];
            if root == i {
                let (columns, rows) = (run.begin..run.end, run.row..run.row);
                self.stats.push(ComponentStats { columns, rows, ..ComponentStats::default() });
            }
            self.stats[blob as usize].add(run);
        }
    }

    /// Groups the runs by blob (counting sort).
    fn sort_runs(&mut self) {
        let mut first = 0;
        for stats in &mut self.stats {
            stats.first = first;
            first += stats.runs;
            stats.runs = 0;
        }
        self.runs_by_blob.clear();
        self.runs_by_blob.resize(self.runs.len(), NONE);
        for (i, &blob) in self.blob_of.iter().enumerate() {
            let stats = &mut self.stats[blob as usize];
            self.runs_by_blob[(stats.first + stats.runs) as usize] = i as u32;
            stats.runs += 1;
        }
    }

    fn finish(&mut self, min_area_px: usize) {
        self.count = 0;
        for stats in &self.stats {
            if (stats.area as usize) < min_area_px {
                continue;
            }
            if self.count == self.blobs.len() {
                self.blobs.push(Blob::default());
            }
            let blob = &mut self.blobs[self.count];
            self.count += 1;
            blob.area_px = stats.area as usize;
            blob.columns = stats.columns.start as usize..stats.columns.end as usize;
            blob.rows = stats.rows.start as usize..stats.rows.end as usize;
            let twice = 2.0 * stats.area as f64;
            blob.centre_px = Point2::new(stats.x_twice as f64 / twice, stats.y_twice as f64 / twice);
            let runs = &self.runs_by_blob[stats.first as usize..(stats.first + stats.runs) as usize];
            outline(runs.iter().map(|&i| self.runs[i as usize]), &mut self.corners, &mut blob.outline_px);
        }
    }
}

impl ComponentStats {
    fn add(&mut self, run: Run) {
        let n = u64::from(run.end - run.begin);
        self.area += n;
        self.x_twice += n * u64::from(run.begin + run.end);
        self.y_twice += n * u64::from(2 * run.row + 1);
        self.columns = self.columns.start.min(run.begin)..self.columns.end.max(run.end);
        self.rows.end = run.row + 1;
        self.runs += 1;
    }
}

/// The convex hull of runs in the order of their rows: only the ends of each row can be corners.
fn outline(runs: impl Iterator<Item = Run>, corners: &mut Vec<Point2>, hull: &mut Vec<Point2>) {
    corners.clear();
    let mut row: Option<Run> = None;
    for run in runs {
        match &mut row {
            Some(whole) if whole.row == run.row => whole.end = run.end,
            _ => {
                if let Some(whole) = row.replace(run) {
                    push_corners(whole, corners);
                }
            }
        }
    }
    if let Some(whole) = row {
        push_corners(whole, corners);
    }
    polygon::convex_hull(corners, hull);
}

fn push_corners(run: Run, corners: &mut Vec<Point2>) {
    let (y, begin, end) = (f64::from(run.row), f64::from(run.begin), f64::from(run.end));
    corners.extend([(begin, y), (end, y), (begin, y + 1.0), (end, y + 1.0)].map(|(x, y)| Point2::new(x, y)));
}

/// Appends the runs of a row; eight equal pixels cost one comparison.
fn runs_of_row(row: &[u8], y: u32, runs: &mut Vec<Run>) {
    let mut begin = None;
    let (chunks, rest) = row.as_chunks::<8>();
    for (c, chunk) in chunks.iter().enumerate() {
        let word = u64::from_ne_bytes(*chunk);
        let is_uniform = if begin.is_some() { word == 0x0101_0101_0101_0101 } else { word == 0 };
        if !is_uniform {
            runs_of_pixels(chunk, 8 * c, y, &mut begin, runs);
        }
    }
    runs_of_pixels(rest, row.len() - rest.len(), y, &mut begin, runs);
    if let Some(begin) = begin {
        runs.push(Run { row: y, begin, end: row.len() as u32 });
    }
}

fn runs_of_pixels(pixels: &[u8], from: usize, y: u32, begin: &mut Option<u32>, runs: &mut Vec<Run>) {
    for (i, &pixel) in pixels.iter().enumerate() {
        let x = (from + i) as u32;
        match (*begin, pixel != 0) {
            (None, true) => *begin = Some(x),
            (Some(start), false) => {
                runs.push(Run { row: y, begin: start, end: x });
                *begin = None;
            }
            _ => {}
        }
    }
}
