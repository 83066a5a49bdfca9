//! Places in files as short text: each file once, with its lines.

use std::ops::RangeInclusive;
use std::path::Path;

use crate::error::Origin;

/// One line of text for each file, of at most `width` columns where the file's name leaves room:
/// `scene.toml:6-15,44`. `whole` stands behind the name of a file that asks without a line.
pub(super) fn layout(origins: &[Origin], whole: &str, width: usize) -> Vec<String> {
    let mut files: Vec<(&Path, Vec<usize>)> = Vec::new();
    for origin in origins {
        let file = origin.file.as_ref();
        match files.iter_mut().find(|(known, _)| *known == file) {
            Some((_, lines)) => lines.push(origin.line),
            None => files.push((file, vec![origin.line])),
        }
    }
    files.into_iter().map(|(file, lines)| of_file(file, lines, whole, width)).collect()
}

fn of_file(file: &Path, mut lines: Vec<usize>, whole: &str, width: usize) -> String {
    lines.sort_unstable();
    lines.dedup();
    let ranges = ranges(&lines);
    let whole = if lines.first() == Some(&0) { whole } else { "" };
    let separator = if whole.is_empty() { ":" } else { ", lines " };
    let with_ranges = |count: usize| {
        let (shown, left) = ranges.split_at(count);
        let left: usize = left.iter().map(|range| range.end() - range.start() + 1).sum();
        let shown: Vec<_> = shown.iter().map(in_words).collect();
        let more = if left > 0 { format!(" and {left} more") } else { String::new() };
        let separator = if shown.is_empty() { "" } else { separator };
        format!("{}{whole}{separator}{}{more}", file.display(), shown.join(","))
    };
    // All of them, or as many as fit, which is less than one a column; the first in any case.
    let fewer = (1..ranges.len().min(width)).rev();
    let fitting = [ranges.len()].into_iter().chain(fewer).map(with_ranges).find(|text| text.chars().count() <= width);
    fitting.unwrap_or_else(|| with_ranges(ranges.len().min(1)))
}

fn in_words(range: &RangeInclusive<usize>) -> String {
    let (first, last) = (range.start(), range.end());
    if first == last { first.to_string() } else { format!("{first}-{last}") }
}

/// The runs of neighbours in ascending `lines`, without line 0, which is no line.
fn ranges(lines: &[usize]) -> Vec<RangeInclusive<usize>> {
    let runs = lines.chunk_by(|a, b| *a > 0 && a + 1 == *b);
    runs.filter_map(|run| Some(*run.first()?..=*run.last()?)).filter(|range| *range.start() > 0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(file: &str, lines: &[usize]) -> Vec<Origin> {
        lines.iter().map(|&line| Origin::file(Path::new(file)).at(line)).collect()
    }

    #[test]
    fn lines_are_grouped_by_file_and_neighbours_joined() {
        let origins = [at("a.toml", &[44, 6, 7, 8]), at("b.mtl", &[3]), at("a.toml", &[7, 10])].concat();
        assert_eq!(layout(&origins, "", 80), ["a.toml:6-8,10,44", "b.mtl:3"]);
        assert!(layout(&[], "", 80).is_empty());
    }

    #[test]
    fn a_file_as_a_whole_gets_its_note() {
        assert_eq!(layout(&at("a.toml", &[0]), " (all)", 80), ["a.toml (all)"]);
        assert_eq!(layout(&at("a.toml", &[1, 0, 2]), " (all)", 80), ["a.toml (all), lines 1-2"]);
    }

    #[test]
    fn long_lists_end_within_the_width_and_count_the_rest() {
        let lines: Vec<usize> = (1..200).map(|n| 3 * n).collect();
        for width in 24..100 {
            let [text] = layout(&at("a.toml", &lines), "", width).try_into().expect("one file");
            assert!(text.len() <= width, "{text}");
            assert!(text.len() + 8 > width, "room for more: {text}");
            let (shown, more) = text.split_once(" and ").expect("a rest");
            let left: usize = more.strip_suffix(" more").expect("more").parse().expect("a number");
            assert_eq!(shown.matches(',').count() + 1 + left, lines.len());
        }
        assert_eq!(layout(&at("a.toml", &[1, 3, 9]), "", 12), ["a.toml:1,3,9"]);
        assert_eq!(layout(&at("a-long-name.toml", &[1, 2, 9]), "", 5), ["a-long-name.toml:1-2 and 1 more"]);
    }
}
