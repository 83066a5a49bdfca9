//! Figures as people read them.

/// `1 light`, `3 lights`.
pub(super) fn counted(count: u64, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

/// A number with three digits and `k`, `M` or `G`.
pub(crate) fn abridged(number: f64) -> String {
    // Each limit is where rounding to three digits would give 1000 of the smaller unit.
    match number {
        ..999.5 => format!("{number:.0}"),
        ..999.5e3 => format!("{} k", three_digits(number * 1e-3)),
        ..999.5e6 => format!("{} M", three_digits(number * 1e-6)),
        _ => format!("{} G", three_digits(number * 1e-9)),
    }
}

/// Bytes, in powers of 1024.
pub(super) fn bytes(count: usize) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    if count < 1024 {
        return format!("{count} B");
    }
    let (mut size, mut unit) = (count as f64 / 1024.0, 0);
    while size >= 999.5 && unit + 1 < UNITS.len() {
        (size, unit) = (size / 1024.0, unit + 1);
    }
    format!("{} {}", three_digits(size), UNITS[unit])
}

/// A stretch of time in seconds, from milliseconds to hours.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match seconds {
        ..0.9995 => format!("{} ms", three_digits(seconds * 1e3)),
        ..59.95 => format!("{} s", three_digits(seconds)),
        ..3599.5 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

fn three_digits(number: f64) -> String {
    match number {
        ..9.995 => format!("{number:.2}"),
        ..99.95 => format!("{number:.1}"),
        _ => format!("{number:.0}"),
    }
}

/// Words in lines of at most `width` columns, with commas between them.
pub(super) fn wrapped(words: &[&str], width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for (index, word) in words.iter().enumerate() {
        let comma = if index + 1 < words.len() { "," } else { "" };
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() + comma.len() <= width => *line += &format!(" {word}{comma}"),
            _ => lines.push(format!("{word}{comma}")),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular() {
        assert_eq!([0, 1, 2].map(|count| counted(count, "light")), ["0 lights", "1 light", "2 lights"]);
    }

    #[test]
    fn numbers_keep_three_digits_and_never_show_a_thousand() {
        for (number, text) in [
            (0.0, "0"),
            (7.4, "7"),
            (999.4, "999"),
            (999.6, "1.00 k"),
            (28_349.0, "28.3 k"),
            (999_499.0, "999 k"),
            (999_600.0, "1.00 M"),
            (1_204_000.0, "1.20 M"),
            (9.996e6, "10.0 M"),
            (3.21e9, "3.21 G"),
            (f64::INFINITY, "inf G"),
        ] {
            assert_eq!(abridged(number), text);
        }
    }

    #[test]
    fn bytes_come_in_the_largest_unit_that_fits() {
        for (count, text) in [
            (0, "0 B"),
            (1023, "1023 B"),
            (1024, "1.00 KiB"),
            (1 << 20, "1.00 MiB"),
            (21 << 20, "21.0 MiB"),
            (343_586_898_000, "320 GiB"),
            (5000 << 40, "5000 TiB"),
        ] {
            assert_eq!(bytes(count), text);
        }
    }

    #[test]
    fn time_is_told_in_the_units_of_a_clock() {
        for (seconds, text) in [
            (0.0, "0.00 ms"),
            (0.0037, "3.70 ms"),
            (0.9996, "1.00 s"),
            (3.514, "3.51 s"),
            (59.96, "1 min 00 s"),
            (245.0, "4 min 05 s"),
            (3599.6, "1 h 00 min"),
            (7_440.0, "2 h 04 min"),
        ] {
            assert_eq!(duration(seconds), text);
        }
    }

    #[test]
    fn words_are_wrapped_before_the_width() {
        assert_eq!(wrapped(&["ab", "cd", "e"], 6), ["ab,", "cd, e"]);
        assert_eq!(wrapped(&["ab", "cd", "e"], 7), ["ab, cd,", "e"]);
        assert_eq!(wrapped(&["longer"], 3), ["longer"]);
        assert!(wrapped(&[], 3).is_empty());
    }
}
