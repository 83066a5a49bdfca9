//! Elementary functions that have no single instruction, the same bits on every target.

/// `a * b` as value and error, exactly (Dekker 1971, Veltkamp's splitting).
#[inline]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    const SPLIT: f64 = 134_217_729.0; // 2^27 + 1
    let split = |x: f64| {
        let c = SPLIT * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let p = a * b;
    let (a1, a2) = split(a);
    let (b1, b2) = split(b);
    (p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2)
}

/// `a + b` as value and error, exactly (Knuth 1969).
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let from_b = sum - a;
    (sum, (a - (sum - from_b)) + (b - from_b))
}

/// `(-1)^k / (2 k + first)!` for the Taylor series of sine (`first` = 1) and cosine (`first` = 0).
const fn taylor<const TERMS: usize>(first: u32) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        let (mut factorial, mut i) = (1.0, 2);
        while i <= 2 * k as u32 + first {
            factorial *= i as f64;
            i += 1;
        }
        terms[k] = if k % 2 == 0 { 1.0 } else { -1.0 } / factorial;
        k += 1;
    }
    terms
}

/// Sine and cosine of `2 pi turns`: exact reduction to an eighth of a turn, then `TERMS` terms of Taylor's series,
/// then the quadrant's swap and signs by bit operations (no branch to predict).
#[inline(always)]
pub(crate) fn sin_cos_turns<const TERMS: usize>(turns: f64) -> (f64, f64) {
    // Added to a number, 3 * 2^51 rounds it to an integer, which is then in the low bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let quadrants = turns * 4.0;
    let rounded = quadrants + ROUND;
    let quadrant = rounded.to_bits();
    let angle = (quadrants - (rounded - ROUND)) * core::f64::consts::FRAC_PI_2;
    let square = angle * angle;
    let series = |terms: [f64; TERMS]| terms.iter().rev().fold(0.0, |sum, term| sum * square + term);
    let sine = (series(const { taylor::<TERMS>(1) }) * angle).to_bits();
    let cosine = series(const { taylor::<TERMS>(0) }).to_bits();
    let swap = (sine ^ cosine) & 0u64.wrapping_sub(quadrant & 1);
    let sine_sign = (quadrant & 2) << 62;
    let cosine_sign = ((quadrant + 1) & 2) << 62;
    (f64::from_bits(sine ^ swap ^ sine_sign), f64::from_bits(cosine ^ swap ^ cosine_sign))
}
