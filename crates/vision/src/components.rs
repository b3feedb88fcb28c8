//! Foreground pixels to blobs: runs along rows, joined to those of the row above by union-find (8 neighbours).

use std::ops::Range;

use crate::sets::Sets;
use crate::{Point2, polygon};

/// A connected patch of the picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Blob {
    /// Its pixels.
    pub area_px: usize,
    /// Columns from its leftmost pixel to one past its rightmost.
    pub columns: Range<usize>,
    /// Rows from its uppermost pixel to one past its lowest.
    pub rows: Range<usize>,
    /// The mean place of its pixels.
    pub centre_px: Point2,
    /// The convex hull of its pixels, edges of pixels included.
    pub outline_px: Vec<Point2>,
}

/// Pixels `columns` of row `row`.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: u32,
    begin: u32,
    end: u32,
}

/// Finds blobs; keeps its memory from picture to picture.
///
/// ```
/// use elbowroom_vision::Labeller;
/// let plane = [1, 1, 0, 0, 0,
///              0, 0, 1, 0, 1];
/// let mut labeller = Labeller::default();
/// let blobs = labeller.blobs(&plane, 5, 1);
/// assert_eq!(blobs.iter().map(|blob| blob.area_px).collect::<Vec<_>>(), [3, 1]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Labeller {
    runs: Vec<Run>,
    sets: Sets,
    blob_of: Vec<u32>,
    sums: Vec<Sums>,
    blobs: Vec<Blob>,
    found: usize,
    corners: Vec<Point2>,
    by_blob: Vec<u32>,
}

#[derive(Debug, Clone, Default)]
struct Sums {
    area: u64,
    x_twice: u64,
    y_twice: u64,
    columns: Range<u32>,
    rows: Range<u32>,
    /// Runs, and where they start in `by_blob`.
    runs: u32,
    first: u32,
}

const NONE: u32 = u32::MAX;

impl Labeller {
    /// The blobs of a plane (a pixel counts where it is not 0) that is `width` wide, of at least `least_px` pixels, in
    /// the order of their first pixels, row by row.
    pub fn blobs(&mut self, plane: &[u8], width: usize, least_px: usize) -> &[Blob] {
        self.runs.clear();
        self.sets.parent.clear();
        let mut above = 0..0;
        for (y, row) in plane.chunks_exact(width.max(1)).enumerate() {
            let first = self.runs.len();
            runs_of_row(row, y as u32, &mut self.runs);
            self.sets.parent.extend(first as u32..self.runs.len() as u32);
            self.join(above, first);
            above = first..self.runs.len();
        }
        self.gather();
        self.sort_runs();
        self.finish(least_px);
        &self.blobs[..self.found]
    }

    /// Joins the runs from `first` on to those of the row above that they touch, diagonally too.
    fn join(&mut self, above: Range<usize>, first: usize) {
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
                self.sets.unite(b as u32, here as u32);
                b += 1;
            }
        }
    }

    fn gather(&mut self) {
        self.sums.clear();
        self.blob_of.clear();
        for i in 0..self.runs.len() {
            let root = self.sets.root(i as u32) as usize;
            let blob = if root == i { self.sums.len() as u32 } else { self.blob_of[root] };
            self.blob_of.push(blob);
            let run = self.runs[i];
            if root == i {
                let (columns, rows) = (run.begin..run.end, run.row..run.row);
                self.sums.push(Sums { columns, rows, ..Sums::default() });
            }
            self.sums[blob as usize].add(run);
        }
    }

    /// Lists the runs blob by blob (counting sort).
    fn sort_runs(&mut self) {
        let mut first = 0;
        for sums in &mut self.sums {
            sums.first = first;
            first += sums.runs;
            sums.runs = 0;
        }
        self.by_blob.clear();
        self.by_blob.resize(self.runs.len(), NONE);
        for (i, &blob) in self.blob_of.iter().enumerate() {
            let sums = &mut self.sums[blob as usize];
            self.by_blob[(sums.first + sums.runs) as usize] = i as u32;
            sums.runs += 1;
        }
    }

    fn finish(&mut self, least_px: usize) {
        self.found = 0;
        for sums in &self.sums {
            if (sums.area as usize) < least_px {
                continue;
            }
            if self.found == self.blobs.len() {
                self.blobs.push(Blob::default());
            }
            let blob = &mut self.blobs[self.found];
            self.found += 1;
            blob.area_px = sums.area as usize;
            blob.columns = sums.columns.start as usize..sums.columns.end as usize;
            blob.rows = sums.rows.start as usize..sums.rows.end as usize;
            let twice = 2.0 * sums.area as f64;
            blob.centre_px = Point2::new(sums.x_twice as f64 / twice, sums.y_twice as f64 / twice);
            let runs = &self.by_blob[sums.first as usize..(sums.first + sums.runs) as usize];
            outline(runs.iter().map(|&i| self.runs[i as usize]), &mut self.corners, &mut blob.outline_px);
        }
    }
}

impl Sums {
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

/// The convex hull of runs that come row by row: of each row only the ends can be corners.
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

/// Appends the runs of a row; eight empty pixels cost one comparison.
fn runs_of_row(row: &[u8], y: u32, runs: &mut Vec<Run>) {
    let mut begin = None;
    let (chunks, rest) = row.as_chunks::<8>();
    for (c, chunk) in chunks.iter().enumerate() {
        let word = u64::from_ne_bytes(*chunk);
        let is_even = if begin.is_some() { word == 0x0101_0101_0101_0101 } else { word == 0 };
        if !is_even {
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
