//! Logarithmic axes: what they span, where a value stands, which values have a tick.

use crate::diff::significant;

/// Values that a plot can show: far enough from where doubles end for some room around them.
const SHOWN: std::ops::RangeInclusive<f64> = 1e-200..=1e200;
/// The least that an axis spans, as a factor, so that chance does not look like a trend.
const LEAST_SPAN: f64 = 4.0;
/// Room at either end, as a factor.
const ROOM: f64 = 1.25;

/// A logarithmic axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// The values at its ends.
    pub(super) range: [f64; 2],
    /// Where these ends are on the paper.
    pub(super) ends: [f64; 2],
}

impl Axis {
    /// Where a value stands; those beyond the ends stand at the ends.
    pub(super) fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range.map(libm::log);
        // What is no logarithm is not above the low end.
        let value = if value > self.range[0] { libm::log(value.min(self.range[1])) } else { low };
        self.ends[0] + (value - low) / (high - low) * (self.ends[1] - self.ends[0])
    }
}

/// Whether a value can stand on a logarithmic axis.
pub(super) fn is_shown(value: f64) -> bool {
    SHOWN.contains(&value)
}

/// A range around all values that can be shown, with some room.
pub(super) fn range_of(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let mut range: Option<[f64; 2]> = None;
    for value in values.into_iter().filter(|value| is_shown(*value)) {
        let [low, high] = range.unwrap_or([value, value]);
        range = Some([low.min(value), high.max(value)]);
    }
    let [low, high] = range.unwrap_or([0.5, 2.0]);
    let missing = (LEAST_SPAN / (high / low)).max(1.0).sqrt() * ROOM;
    [low / missing, high * missing]
}

/// Values within a range that deserve a tick: at least one, and at most `most` of them, which is 5 or more. 1, 2 and 5 of
/// each decade, or fewer where that is too many; round numbers where a range holds less than two of these.
pub(super) fn ticks([low, high]: [f64; 2], most: usize) -> Vec<f64> {
    let decades = libm::floor(libm::log10(low)) as i32..=libm::ceil(libm::log10(high)) as i32;
    let of = |mantissas: &[f64], every: usize| -> Vec<f64> {
        let decades = decades.clone().filter(|decade| decade.rem_euclid(every as i32) == 0);
        let all = decades.flat_map(|decade| mantissas.iter().map(move |m| m * libm::pow(10.0, f64::from(decade))));
        all.filter(|tick| (low..=high).contains(tick)).collect()
    };
    let fewer = (1..=401).map(|every| of(&[1.0], every));
    let all = [of(&[1.0, 2.0, 5.0], 1), of(&[1.0, 5.0], 1)].into_iter().chain(fewer);
    let fitting = all.into_iter().find(|ticks| ticks.len() <= most).unwrap_or_default();
    if fitting.len() > 1 { fitting } else { even_ticks([low, high], most) }
}

/// Multiples of a round number.
fn even_ticks([low, high]: [f64; 2], most: usize) -> Vec<f64> {
    let finest = libm::floor(libm::log10((high - low) / most as f64)) as i32;
    for exponent in finest..finest + 3 {
        for mantissa in [1.0, 2.0, 5.0] {
            let step = mantissa * libm::pow(10.0, f64::from(exponent));
            let [first, last] = [libm::ceil(low / step), libm::floor(high / step)];
            // Steps that a double cannot tell apart are none.
            if !(step > 0.0 && last < 1e12) {
                continue;
            }
            let ticks: Vec<f64> = (first as i64..=last as i64).take(most + 1).map(|k| k as f64 * step).collect();
            if (1..=most).contains(&ticks.len()) {
                return ticks;
            }
        }
    }
    vec![(low * high).sqrt()]
}

/// A figure at a tick: three digits at most, without zeros at its end.
pub(super) fn plain(value: f64) -> String {
    let text = significant(value, 3);
    let (mantissa, exponent) = match text.split_once('e') {
        Some((mantissa, exponent)) => (mantissa.to_owned(), format!("e{exponent}")),
        None => (text, String::new()),
    };
    let mantissa =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { &mantissa };
    format!("{mantissa}{exponent}")
}

/// Seconds at a tick.
pub(super) fn plain_seconds(value: f64) -> String {
    match value {
        ..0.9e-6 => format!("{} s", plain(value)),
        ..0.9e-3 => format!("{} \u{b5}s", plain(value * 1e6)),
        ..0.9 => format!("{} ms", plain(value * 1e3)),
        _ => format!("{} s", plain(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_range_has_some_ticks_and_not_too_many() {
        for most in [5, 8, 12] {
            for exponent in -30..30 {
                for span in [1e-16, 1e-9, 0.003, 0.1, 0.5, 0.7, 1.0, 1.7, 3.0, 7.0, 40.0, 150.0] {
                    for offset in 0..7 {
                        let low = libm::pow(10.0, f64::from(exponent) * 5.0 + 0.13 * f64::from(offset));
                        let high = low * libm::pow(10.0, span);
                        let ticks = ticks([low, high], most);
                        assert!((1..=most).contains(&ticks.len()), "{low:e}..{high:e}: {ticks:?}");
                        assert!(ticks.is_sorted_by(|a, b| a < b), "{low:e}..{high:e}: {ticks:?}");
                        let within = |tick: &f64| *tick >= low * (1.0 - 1e-12) && *tick <= high * (1.0 + 1e-12);
                        assert!(ticks.iter().all(within), "{low:e}..{high:e}: {ticks:?}");
                        assert!(span < 0.1 || ticks.len() > 1, "{low:e}..{high:e}: {ticks:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn ticks_are_round() {
        let text = |range, most| ticks(range, most).into_iter().map(plain).collect::<Vec<_>>();
        assert_eq!(text([0.9, 60.0], 8), ["1", "2", "5", "10", "20", "50"]);
        assert_eq!(text([0.9, 60.0], 5), ["1", "5", "10", "50"]);
        assert_eq!(text([1e-6, 30.0], 8), ["1e-6", "1e-5", "0.0001", "0.001", "0.01", "0.1", "1", "10"]);
        assert_eq!(text([2.1, 4.6], 6), ["2.5", "3", "3.5", "4", "4.5"]);
        assert_eq!([2e-4, 0.02, 1.0, 50.0].map(plain_seconds), ["200 \u{b5}s", "20 ms", "1 s", "50 s"]);
    }

    #[test]
    fn ranges_hold_what_can_be_shown() {
        let [low, high] = range_of([3.0, f64::NAN, 0.0, -1.0, f64::INFINITY, 30.0]);
        assert!((low - 2.4).abs() < 1e-12 && (high - 37.5).abs() < 1e-12);
        for values in [vec![], vec![7.0]] {
            let [low, high] = range_of(values);
            assert!(low > 0.0 && high / low > LEAST_SPAN);
        }
        let axis = Axis { range: [1.0, 100.0], ends: [10.0, 30.0] };
        let places = [0.0, 1.0, 10.0, 1000.0, f64::NAN].map(|value| axis.place(value));
        assert!(places.iter().zip([10.0, 10.0, 20.0, 30.0, 10.0]).all(|(place, wanted)| (place - wanted).abs() < 1e-9));
    }
}
