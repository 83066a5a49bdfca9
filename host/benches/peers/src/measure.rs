//! Times of interleaved rounds, and whether the answers agree.

use rustix::time::{ClockId, clock_gettime};

use crate::ours;
use crate::peer::{Answer, Peer, Ray, Row};
use crate::rays::Set;

/// Distances of hits that differ by more than this, relative to our own, do not agree.
const TOLERANCE: f32 = 1e-3;

/// What of a set was answered differently than by the first row.
#[derive(Clone, Copy, Default)]
pub(crate) struct Difference {
    /// Rays that hit in one and miss in the other.
    pub(crate) hits: usize,
    /// Hits of both at different distances.
    pub(crate) distances: usize,
    /// Answers of different bits; zero among our own rows.
    pub(crate) bits: usize,
}

/// What a row did with a set.
pub(crate) struct Measured {
    /// How it differs.
    pub(crate) difference: Difference,
    /// Rays per second in each round.
    rates: Vec<f64>,
}

impl Measured {
    /// The median of rays per second.
    pub(crate) fn rate(&self) -> f64 {
        median(&mut self.rates.clone())
    }

    /// The median of `self`'s rates over those of `other` in the same rounds.
    pub(crate) fn ratio(&self, other: &Self) -> f64 {
        median(&mut self.rates.iter().zip(&other.rates).map(|(a, b)| a / b).collect::<Vec<_>>())
    }
}

/// Shows every set to every row, `rounds` times in turns after once for the answers; results by row and set. The order
/// of the rows changes from round to round, so that nobody always comes after the same other.
pub(crate) fn measure(rows: &[Row<'_>], sets: &[Set], rounds: usize) -> Vec<Vec<Measured>> {
    let expected: Vec<Vec<Answer>> = sets.iter().map(|set| answer(&*rows[0].peer, set).1).collect();
    let first = |row: &Row<'_>, set, expected: &Vec<Answer>| {
        let difference = compare(expected, &answer(&*row.peer, set).1);
        Measured { difference, rates: Vec::new() }
    };
    let of_row = |row| sets.iter().zip(&expected).map(|(set, expected)| first(row, set, expected)).collect();
    let mut measured: Vec<Vec<Measured>> = rows.iter().map(of_row).collect();
    for round in 0..rounds {
        for (at, set) in sets.iter().enumerate() {
            for turn in 0..rows.len() {
                let row = (turn + round) % rows.len();
                let (time, _) = answer(&*rows[row].peer, set);
                measured[row][at].rates.push(set.rays.len() as f64 / time);
            }
        }
    }
    measured
}

/// The share of rays that hit.
pub(crate) fn hits(row: &Row<'_>, set: &Set) -> f64 {
    let (_, answers) = answer(&*row.peer, set);
    answers.iter().filter(|answer| answer.is_hit()).count() as f64 / set.rays.len() as f64
}

/// Seconds and answers of a set.
fn answer(peer: &dyn Peer, Set { rays, any }: &Set) -> (f64, Vec<Answer>) {
    let mut answers = vec![Answer::any(true); rays.len()];
    let query = |rays: &[Ray], answers: &mut [Answer]| match any {
        true => peer.any(rays, answers),
        false => peer.closest(rays, answers),
    };
    let (time, ()) = seconds(1, || query(rays, &mut answers));
    (time, answers)
}

fn compare(expected: &[Answer], answers: &[Answer]) -> Difference {
    let mut difference = Difference::default();
    for (ours, theirs) in expected.iter().zip(answers) {
        if ours.is_hit() != theirs.is_hit() {
            difference.hits += 1;
        } else if ours.is_hit() && (ours.t - theirs.t).abs() > TOLERANCE * ours.t {
            difference.distances += 1;
        }
        let bits = |answer: &Answer| ([answer.t, answer.u, answer.v].map(f32::to_bits), answer.primitive);
        difference.bits += usize::from(bits(ours) != bits(theirs));
    }
    difference
}

/// Lines about what must not be: rows that differ from our first in more than one ray of a thousand, and our own rows
/// that differ at all.
pub(crate) fn complaints(rows: &[Row<'_>], measured: &[Vec<Measured>], sets: &[Set]) -> Vec<String> {
    let mut lines = Vec::new();
    for (row, of_row) in rows.iter().zip(measured) {
        for ((of_set, set), name) in of_row.iter().zip(sets).zip(crate::rays::NAMES) {
            let Difference { hits, distances, bits } = of_set.difference;
            let title = Row::title(row.name, row.isa);
            if (hits + distances) * 1000 > set.rays.len() {
                lines.push(format!("{title}, {name}: {} of {} rays differ", hits + distances, set.rays.len()));
            }
            if row.name == ours::NAME && bits > 0 {
                lines.push(format!("{title}, {name}: {bits} answers have other bits than the first row's"));
            }
        }
    }
    lines
}

/// Makes something so many times, one at a time: the median of the seconds and the last one.
pub(crate) fn repeat<T>(times: usize, mut make: impl FnMut() -> Result<(f64, T), String>) -> Result<(f64, T), String> {
    let mut all = Vec::new();
    let mut last = None;
    for _ in 0..times {
        drop(last.take());
        let (time, made) = make()?;
        all.push(time);
        last = Some(made);
    }
    last.map(|last| (median(&mut all), last)).ok_or_else(|| "nothing was to be built".to_owned())
}

/// How long `work` takes, and what it makes: on one thread the time that this one has a processor, so that other
/// programs disturb less; on several the time that passes.
pub(crate) fn seconds<T>(threads: usize, work: impl FnOnce() -> T) -> (f64, T) {
    let clock = if threads == 1 { ClockId::ThreadCPUTime } else { ClockId::Monotonic };
    let now = || {
        let time = clock_gettime(clock);
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    };
    let start = now();
    let made = work();
    (now() - start, made)
}

/// The middle of the values; they are sorted.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}
