//! Grouping of the exchange regions that share a slot.

use elbowroom_proximity::within;

use crate::Region;

/// Groups exchange regions whose warning zones overlap; all dynamic regions are in one group. A group is one slot,
/// granted as a whole, so that two robots never each hold what the other needs next. Returns the group number of
/// each region.
pub fn group_overlapping(regions: &[&Region]) -> Vec<usize> {
    let mut group: Vec<usize> = (0..regions.len()).collect();
    for i in 0..regions.len() {
        for j in 0..i {
            if zones_overlap(regions[i], regions[j]) {
                let (keep, drop) = (group[j].min(group[i]), group[j].max(group[i]));
                group.iter_mut().filter(|g| **g == drop).for_each(|g| *g = keep);
            }
        }
    }
    let mut numbers: Vec<usize> = group.clone();
    numbers.sort_unstable();
    numbers.dedup();
    group.iter().map(|g| numbers.partition_point(|n| n < g)).collect()
}

fn zones_overlap(a: &Region, b: &Region) -> bool {
    if a.follow.is_some() || b.follow.is_some() {
        return true;
    }
    let in_world = |r: &Region| r.anchor * r.shape_in_anchor;
    within(&a.shape, &in_world(a), &b.shape, &in_world(b), a.warning_m + b.warning_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Vec3;

    #[test]
    fn overlapping_warning_zones_share_a_group() {
        let ball = |x: f64| Region::sphere(format!("{x}"), Vec3::X * x, 0.1).warning(0.2);
        let [a, b, c] = [ball(0.0), ball(0.5), ball(2.0)];
        assert_eq!(group_overlapping(&[&a, &c, &b]), [0, 1, 0]);
    }
}
