//! Tables, in Markdown.

use crate::measure::Measured;
use crate::ours;
use crate::peer::Row;
use crate::rays::NAMES;

/// The figures of a mesh: one line per row. Leaks where the mesh is closed.
pub(crate) fn figures(rows: &[Row<'_>], measured: &[Vec<Measured>], leaks: Option<&[f64]>) {
    let mut lines = vec![header(&["peer", "isa", "build s", "on 2", "bytes/tri"])];
    lines[0].extend(NAMES.map(str::to_owned));
    lines[0].extend(NAMES.map(|name| format!("ours/{name}")));
    lines[0].push("leaks/M".to_owned());
    for (at, row) in rows.iter().enumerate() {
        let mut line = vec![row.name.to_owned(), row.isa.to_string()];
        line.extend(row.build_seconds.map(|time| time.map_or_else(missing, significant)));
        line.push(format!("{:.0}", row.bytes_per_triangle));
        line.extend(measured[at].iter().map(|of_set| format!("{:.2}", of_set.rate() / 1e6)));
        let ours = rows.iter().position(|other| other.name == ours::NAME && other.isa == row.isa);
        line.extend((0..NAMES.len()).map(|set| {
            ours.map_or_else(missing, |ours| format!("{:.2}", measured[ours][set].ratio(&measured[at][set])))
        }));
        line.push(leaks.map_or_else(missing, |leaks| format!("{:.0}", leaks[at])));
        lines.push(line);
    }
    print(&lines);
}

/// What is answered differently than by our first row.
pub(crate) fn differences(rows: &[Row<'_>], measured: &[Vec<Measured>]) {
    let mut lines = vec![header(&["peer", "isa"])];
    lines[0].extend(NAMES.map(|name| format!("hit: {name}")));
    lines[0].extend(NAMES[..3].iter().map(|name| format!("t: {name}")));
    for (row, of_row) in rows.iter().zip(measured) {
        let mut line = vec![row.name.to_owned(), row.isa.to_string()];
        line.extend(of_row.iter().map(|of_set| of_set.difference.hits.to_string()));
        line.extend(of_row[..3].iter().map(|of_set| of_set.difference.distances.to_string()));
        lines.push(line);
    }
    print(&lines);
}

/// Leaks of one mesh.
pub(crate) fn leaks(rows: &[Row<'_>], leaks: &[f64]) {
    let mut lines = vec![header(&["peer", "isa", "leaks/M"])];
    let line = |(row, leaks): (&Row<'_>, &f64)| vec![row.name.to_owned(), row.isa.to_string(), format!("{leaks:.0}")];
    lines.extend(rows.iter().zip(leaks).map(line));
    print(&lines);
}

/// The growth table's lines for one size.
pub(crate) fn growth_lines(triangles: usize, rows: &[Row<'_>], measured: &[Vec<Measured>]) -> Vec<Vec<String>> {
    let line = |(row, of_row): (&Row<'_>, &Vec<Measured>)| {
        let mut line = vec![triangles.to_string(), row.name.to_owned(), row.isa.to_string()];
        line.push(row.build_seconds[0].map_or_else(missing, significant));
        line.push(format!("{:.0}", row.bytes_per_triangle));
        line.extend(of_row.iter().map(|of_set| format!("{:.2}", of_set.rate() / 1e6)));
        line
    };
    rows.iter().zip(measured).map(line).collect()
}

/// The lines of all sizes, ordered by peer.
pub(crate) fn growth(mut lines: Vec<Vec<String>>) {
    let mut names: Vec<String> = Vec::new();
    for line in &lines {
        if !names.contains(&line[1]) {
            names.push(line[1].clone());
        }
    }
    lines.sort_by_key(|line| names.iter().position(|name| *name == line[1]));
    let mut header = header(&["triangles", "peer", "isa", "build s", "bytes/tri"]);
    header.extend(NAMES.map(str::to_owned));
    lines.insert(0, header);
    print(&lines);
}

fn header(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn missing() -> String {
    "-".to_owned()
}

/// Seconds with about three digits that count.
fn significant(seconds: f64) -> String {
    match seconds {
        10.0.. => format!("{seconds:.1}"),
        1.0.. => format!("{seconds:.2}"),
        0.1.. => format!("{seconds:.3}"),
        0.001.. => format!("{seconds:.4}"),
        _ => format!("{seconds:.1e}"),
    }
}

/// The first line is the header.
fn print(lines: &[Vec<String>]) {
    let width = |column: usize| lines.iter().map(|line| line[column].len()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..lines[0].len()).map(width).collect();
    for (at, line) in lines.iter().enumerate() {
        let cells: Vec<String> = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        println!("| {} |", cells.join(" | "));
        if at == 0 {
            println!("|{}|", widths.iter().map(|width| "-".repeat(width + 2)).collect::<Vec<_>>().join("|"));
        }
    }
}
