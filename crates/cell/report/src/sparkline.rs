//! Sparkline: a curve in one line of text.

/// Values 0..1 as `width` blocks; each shows the smallest value of its interval. NaN is shown as 0.
pub fn sparkline(values: &[f64], width: usize) -> String {
    const BLOCKS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    if values.is_empty() || width == 0 {
        return String::new();
    }
    let width = width.min(values.len());
    let smallest = |i: usize| {
        let interval = &values[i * values.len() / width..(i + 1) * values.len() / width];
        interval.iter().map(|v| if v.is_finite() { v.clamp(0.0, 1.0) } else { 0.0 }).fold(1.0, f64::min)
    };
    (0..width).map(|i| BLOCKS[(smallest(i) * 7.0).round() as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_stop_is_displayed() {
        let mut values = vec![1.0; 1000];
        values[500] = 0.0;
        let line = sparkline(&values, 10);
        assert_eq!(line, "█████▁████");
        assert_eq!(sparkline(&[f64::NAN, 7.0], 10), "▁█");
    }
}
