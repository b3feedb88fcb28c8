//! Error of sine and cosine in lanes.

use fearless_simd::dispatch;

use super::{LANES, Row, detected_simd_level, sin_cos};

/// Largest error over evenly spaced angles up to a size.
fn largest_error(size: f64, blocks: usize) -> f64 {
    let mut worst: f64 = 0.0;
    for block in 0..blocks {
        let angle = |lane: usize| size * (2.0 * ((block * LANES + lane) as f64 + 0.37) / (blocks * LANES) as f64 - 1.0);
        let angles = Row(std::array::from_fn(|lane| angle(lane) as f32));
        let (mut sin, mut cos) = (Row::ZERO, Row::ZERO);
        dispatch!(detected_simd_level(), simd => {
            let found = sin_cos(simd, angles.load(simd));
            sin.store(found.0);
            cos.store(found.1);
        });
        for lane in 0..LANES {
            let exact = f64::from(angles.0[lane]).sin_cos();
            worst = worst.max((f64::from(sin.0[lane]) - exact.0).abs()).max((f64::from(cos.0[lane]) - exact.1).abs());
        }
    }
    worst
}

#[test]
fn sine_and_cosine_are_as_exact_as_their_documentation_says() {
    // README.md of this crate assumes 8 rad.
    for (size, blocks) in [(0.01, 2000), (0.8, 60_000), (8.0, 200_000), (1000.0, 200_000)] {
        let worst = largest_error(size, blocks);
        println!("up to {size} rad: {worst:.2e}");
        assert!(worst < 1.5e-7, "up to {size} rad: {worst}");
    }
}
