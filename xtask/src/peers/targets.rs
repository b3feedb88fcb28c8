//! Target ratios of the project: best peer's time over elbowroom's.

/// Returns the target ratio, if there is one.
pub fn asked(lib: &str, set: &str, query: &str) -> Option<f64> {
    let warm = lib.contains("warm");
    let robots = set.starts_with("robots_");
    let met_or_near = set.ends_with("_touch") || set.ends_with("_near") || set == "robots_hard";
    match query {
        "collide" if met_or_near => Some(if robots { 10.0 } else { 12.0 }),
        "tolerance" if met_or_near => Some(if robots { 20.0 } else { 60.0 }),
        "distance" if robots => Some(25.0),
        "distance" if set.ends_with("_path") => warm.then_some(40.0),
        "distance" => Some(20.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::asked;

    #[test]
    fn every_kind_of_row_has_its_own() {
        assert_eq!(asked("elbowroom", "m4k_touch", "collide"), Some(12.0));
        assert_eq!(asked("elbowroom", "m4k_far", "collide"), None);
        assert_eq!(asked("elbowroom", "robots_hard", "tolerance"), Some(20.0));
        assert_eq!(asked("elbowroom", "robots_1.4", "collide"), None);
        assert_eq!(asked("elbowroom", "robots_1.4", "distance"), Some(25.0));
        assert_eq!(asked("elbowroom+warm", "m23k_far_path", "distance"), Some(40.0));
        assert_eq!(asked("elbowroom", "m23k_far_path", "distance"), None);
        assert_eq!(asked("elbowroom", "m23k_near", "tolerance"), Some(60.0));
    }
}
