//! Labels beside the ends of lines, pushed apart.

/// Places near the wanted ones, in the same order, at least `gap` apart and within `ends`; closer where they do not fit. The
/// sum of squared ways is the least there is (pool adjacent violators: Barlow et al. 1972).
pub(super) fn push_apart(wanted: &[f64], gap: f64, ends: [f64; 2]) -> Vec<f64> {
    if wanted.is_empty() {
        return Vec::new();
    }
    let steps = wanted.len() as f64 - 1.0;
    let gap = gap.min((ends[1] - ends[0]) / steps.max(1.0));
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // Less what the labels above take up, places must only not fall.
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (rank, &at) in order.iter().enumerate() {
        let mut pool = (wanted[at] - rank as f64 * gap, 1);
        while let Some(&(value, count)) = pools.last()
            && value > pool.0
        {
            pools.pop();
            let all = count + pool.1;
            pool = ((value * count as f64 + pool.0 * pool.1 as f64) / all as f64, all);
        }
        pools.push(pool);
    }
    let free = pools.into_iter().flat_map(|(value, count)| std::iter::repeat_n(value, count));
    let mut places = vec![0.0; wanted.len()];
    for ((rank, &at), value) in order.iter().enumerate().zip(free) {
        places[at] = value.max(ends[0]).min(ends[1] - steps * gap) + rank as f64 * gap;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_do_not_overlap_and_keep_their_order() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for count in 0..20 {
            for _ in 0..50 {
                let wanted: Vec<f64> = (0..count).map(|_| 50.0 + 300.0 * next() * next() * next()).collect();
                let places = push_apart(&wanted, 15.0, [10.0, 310.0]);
                assert_eq!(places.len(), count);
                assert!(places.iter().all(|place| (10.0 - 1e-9..=310.0 + 1e-9).contains(place)), "{places:?}");
                for a in 0..count {
                    for b in 0..a {
                        assert!((places[a] - places[b]).abs() > 15.0 - 1e-9, "{places:?}");
                        assert!((wanted[a] < wanted[b]) == (places[a] < places[b]), "{wanted:?} {places:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn labels_with_room_stay_and_crowded_ones_share_the_way() {
        assert_eq!(push_apart(&[40.0, 10.0, 80.0], 15.0, [0.0, 100.0]), [40.0, 10.0, 80.0]);
        assert_eq!(push_apart(&[50.0, 50.0], 10.0, [0.0, 100.0]), [45.0, 55.0]);
        assert_eq!(push_apart(&[5.0, 5.0, 5.0], 50.0, [0.0, 10.0]), [0.0, 5.0, 10.0]);
    }
}
