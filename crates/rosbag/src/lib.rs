//! MCAP recordings of a cell: written, read, replayed.
