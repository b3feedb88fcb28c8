//! Colours of plots and of the 3-D scene.

/// Colour of the region with this index: in tables, plots and the 3-D scene.
///
/// The colours are distinct on white and on black. The first ones also differ from the colours of runs and robots.
pub fn of_region(index: usize) -> &'static str {
    const COLORS: [&str; 10] =
        ["#9a4fd6", "#1f9d55", "#d9488b", "#b58900", "#0f9fb5", "#a5673f", "#6a67e0", "#7c8a12", "#e5484d", "#2f7ed8"];
    COLORS[index % COLORS.len()]
}

/// Colour of the curve of the robot with this index: red with control, blue without, as in the paper's figure 12; each further robot has its own pair.
pub fn of_run(index: usize, monitored: bool) -> &'static str {
    const PAIRS: [(&str, &str); 4] =
        [("#d6203a", "#1f6fd6"), ("#ef8a17", "#12a5a5"), ("#9b51c9", "#5b6b7b"), ("#8c6d31", "#74c476")];
    let (on, off) = PAIRS[index % PAIRS.len()];
    if monitored { on } else { off }
}

/// Colour by index.
pub fn of_index(i: usize) -> &'static str {
    const COLORS: [&str; 10] =
        ["#4c78a8", "#f58518", "#54a24b", "#e45756", "#72b7b2", "#b279a2", "#eeca3b", "#ff9da6", "#9d755d", "#8a8f98"];
    COLORS[i % COLORS.len()]
}

/// Colour of a robot's links.
pub fn of_robot(i: usize) -> &'static str {
    const LINKS: [&str; 4] = ["#e2833b", "#b9c0c9", "#e0c34a", "#8f9fd6"];
    LINKS[i % LINKS.len()]
}

/// Colour of tools.
pub const TOOL: &str = "#59636f";
/// Colour of objects.
pub const OBJECT: &str = "#9aa3ad";
/// Colour of shields of virtual fixtures.
pub const SHIELD: &str = "#12a5a5";
/// Colour of the lines of grids.
pub const GRID: &str = "#7286a0";
/// Colour of moving objects.
pub const MOVING: &str = "#8a6fb3";
