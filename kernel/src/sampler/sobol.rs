//! Sobol's sequence, scrambled: numbers whose samples avoid each other.
//!
//! The four numbers of a block are the first four dimensions of the sequence. Of any `2^m` samples that start at a
//! multiple of `2^m` one falls into each of the `2^m` parts of each dimension, and one into each of the `2^m` equal
//! rectangles, of any shape in powers of two, of dimensions 0 and 1 (a (0, m, 2)-net). Each block of each vertex has a
//! sequence of its own: same points, other order, other scrambling, so that blocks are independent of each other
//! (Burley: Practical hash-based Owen scrambling. JCGT 9:4, 2020, sections 3 to 5).
//!
//! Bits are kept reversed, the highest of a number in bit 0, since [`scramble`] works upwards; see there.

use super::philox::{ROUNDS, philox};
use super::{Block, key, pixel};

/// A primitive polynomial over GF(2) and where its recurrence starts (Joe and Kuo: Constructing Sobol sequences with
/// better two-dimensional projections. SIAM J. Sci. Comput. 30:5, 2008, file new-joe-kuo-6.21201).
struct Dimension {
    degree: usize,
    /// The coefficients between the first and the last, highest first.
    coefficients: u32,
    /// The first `degree` numbers m.
    start: [u32; 3],
}

/// Dimensions 1 to 3; dimension 0 is van der Corput's sequence.
const DIMENSIONS: [Dimension; 3] = [
    Dimension { degree: 1, coefficients: 0, start: [1, 0, 0] },
    Dimension { degree: 2, coefficients: 1, start: [1, 3, 0] },
    Dimension { degree: 3, coefficients: 1, start: [1, 3, 1] },
];

/// Direction numbers of a dimension, m_k / 2^k as 32-bit fractions: bit k of the index adds number k (Bratley and Fox:
/// Algorithm 659. ACM TOMS 14:1, 1988, equation 2).
const fn directions(dimension: usize) -> [u32; 32] {
    let mut v = [0; 32];
    let mut k = 0;
    while k < 32 {
        v[k] = if dimension == 0 {
            1 << (31 - k)
        } else {
            let Dimension { degree, coefficients, start } = DIMENSIONS[dimension - 1];
            if k < degree {
                start[k] << (31 - k)
            } else {
                let mut next = v[k - degree] ^ (v[k - degree] >> degree);
                let mut back = 1;
                while back < degree {
                    if coefficients >> (degree - 1 - back) & 1 == 1 {
                        next ^= v[k - back];
                    }
                    back += 1;
                }
                next
            }
        };
        k += 1;
    }
    v
}

/// What each value of each four bits of a reversed index adds to the four reversed numbers: 2 KiB, which saves looking
/// at 32 bits one by one.
const SUMS: [[[u32; 4]; 16]; 8] = {
    let mut sums = [[[0; 4]; 16]; 8];
    let mut dimension = 0;
    while dimension < 4 {
        let v = directions(dimension);
        let mut bit = 0;
        while bit < 32 {
            let direction = v[31 - bit].reverse_bits();
            let mut value = 0;
            while value < 16 {
                if value >> (bit % 4) & 1 == 1 {
                    sums[bit / 4][value][dimension] ^= direction;
                }
                value += 1;
            }
            bit += 1;
        }
        dimension += 1;
    }
    sums
};

/// The four reversed coordinates of the point with a reversed index.
#[inline(always)]
fn point(reversed_index: u32) -> [u32; 4] {
    let mut sum = [0; 4];
    for (digit, sums) in SUMS.iter().enumerate() {
        let add = &sums[(reversed_index >> (4 * digit) & 15) as usize];
        for (sum, add) in sum.iter_mut().zip(add) {
            *sum ^= add;
        }
    }
    sum
}

/// [`point`] without a table, for vectors, which have none.
#[inline(always)]
fn point_bit_by_bit(reversed_index: u32) -> [u32; 4] {
    let mut sum = [0; 4];
    // Byte by byte: compilers unroll short loops, and only then are the sums in registers.
    add_byte::<0>(reversed_index, &mut sum);
    add_byte::<1>(reversed_index, &mut sum);
    add_byte::<2>(reversed_index, &mut sum);
    add_byte::<3>(reversed_index, &mut sum);
    sum
}

#[inline(always)]
fn add_byte<const BYTE: usize>(reversed_index: u32, sum: &mut [u32; 4]) {
    for bit in 8 * BYTE..8 * BYTE + 8 {
        let is_set = (reversed_index >> bit & 1).wrapping_neg();
        for (sum, add) in sum.iter_mut().zip(&SUMS[bit / 4][1 << (bit % 4)]) {
            *sum ^= add & is_set;
        }
    }
}

/// Nested uniform scrambling of reversed bits: each bit is flipped or not, as `seed` and the bits below it say. A
/// multiplication only carries upwards, so hashing by additions and multiplications does that (Laine and Karras:
/// Stratified sampling for stochastic transparency. EGSR 2011, section 3.1), here with the steps and constants of
/// Vegdahl (Building a better LK hash. 2021), which come closest to flipping at random. Seeds must be well mixed.
#[inline(always)]
fn scramble(reversed: u32, seed: u32) -> u32 {
    let mut x = reversed;
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^ x.wrapping_mul(0x53A2_2864)
}

/// What the sequences of all vertices and blocks of one pixel are scrambled by: random words.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place([u32; 4]);

impl Place {
    /// Of a pixel under a seed.
    #[inline(always)]
    pub(super) fn new(pixel: u32, key: [u32; 2]) -> Self {
        // No vertex of an independent path has this number.
        Self(philox::<ROUNDS>([pixel, 0, u32::MAX, u32::MAX], key))
    }

    /// Four numbers: those of sample `sample` in the sequence that belongs to a block of a vertex.
    #[inline(always)]
    pub(super) fn numbers(&self, [vertex, block]: [u32; 2], sample: u32) -> [u32; 4] {
        let (index, seeds) = self.scrambled([vertex, block], sample);
        let point = point(index);
        core::array::from_fn(|lane| scramble(point[lane], seeds[lane]).reverse_bits())
    }

    /// The reversed index of a sample's point, and what the point's coordinates are scrambled by.
    #[inline(always)]
    fn scrambled(&self, [vertex, block]: [u32; 2], sample: u32) -> (u32, [u32; 4]) {
        let counter = vertex.wrapping_mul(2).wrapping_add(block).wrapping_mul(0x9E37_79B9);
        let seeds = self.0.map(|word| mix(word.wrapping_add(counter)));
        // Two of the four for a fifth: each of them alone scrambles a number, too, so they are mixed once more.
        let order = mix(seeds[0] ^ seeds[1].rotate_left(16));
        // Scrambling the index keeps aligned blocks of 2^m samples together, whichever place they move to.
        (scramble(sample.reverse_bits(), order), seeds)
    }
}

/// [`Place`]s of several pixels side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places<const N: usize>([[u32; N]; 4]);

impl<const N: usize> Places<N> {
    /// Of no pixels yet.
    pub(crate) const NONE: Self = Self([[0; N]; 4]);

    /// Of pixels of a row under a seed.
    #[inline(always)]
    pub(crate) fn new(seed: u64, columns: &[u32; N], row: u32) -> Self {
        let mut places = Self::NONE;
        for (at, &column) in columns.iter().enumerate() {
            places.set(at, Place::new(pixel(column, row), key(seed)));
        }
        places
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, at: usize, place: Place) {
        self.0.iter_mut().zip(place.0).for_each(|(words, word)| words[at] = word);
    }

    #[inline(always)]
    pub(crate) fn at(&self, at: usize) -> Place {
        Place(core::array::from_fn(|word| self.0[word][at]))
    }

    /// [`Place::numbers`] of each.
    #[inline(always)]
    pub(crate) fn numbers(&self, vertices: &[u32; N], block: Block, samples: &[u32; N]) -> [[u32; N]; 4] {
        let mut numbers = [[0; N]; 4];
        for at in 0..N {
            let (index, seeds) = self.at(at).scrambled([vertices[at], block as u32], samples[at]);
            let point = point_bit_by_bit(index);
            for ((numbers, x), seed) in numbers.iter_mut().zip(point).zip(seeds) {
                numbers[at] = scramble(x, seed).reverse_bits();
            }
        }
        numbers
    }
}

/// A permutation of words in which each bit hangs on all (Wellons, Prospecting for hash functions, 2018: multiplications
/// between shifts, with constants found by search).
#[inline(always)]
fn mix(word: u32) -> u32 {
    let x = (word ^ word >> 16).wrapping_mul(0x21F0_AAAD);
    let x = (x ^ x >> 15).wrapping_mul(0xD35A_2D97);
    x ^ x >> 15
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points in the order of the Gray code, as generators publish them, times 32.
    const PUBLISHED: [[u32; 4]; 16] = [
        [0, 0, 0, 0],
        [16, 16, 16, 16],
        [24, 8, 8, 8],
        [8, 24, 24, 24],
        [12, 12, 20, 28],
        [28, 28, 4, 12],
        [20, 4, 28, 20],
        [4, 20, 12, 4],
        [6, 10, 30, 14],
        [22, 26, 14, 30],
        [30, 2, 22, 6],
        [14, 18, 6, 22],
        [10, 6, 10, 18],
        [26, 22, 26, 2],
        [18, 14, 2, 26],
        [2, 30, 18, 10],
    ];

    #[test]
    fn points_are_the_published_ones() {
        for (at, expected) in (0u32..).zip(PUBLISHED) {
            let index = at ^ at >> 1;
            assert_eq!(point(index.reverse_bits()).map(u32::reverse_bits), expected.map(|x| x << 27), "point {at}");
        }
    }

    #[test]
    fn many_numbers_are_those_of_each() {
        let mut places = Places::<8>::NONE;
        for round in 0..200u32 {
            let word = |at: usize, k: u32| mix(round * 64 + at as u32 * 8 + k);
            let [vertices, samples] = [0, 1].map(|k| core::array::from_fn(|at| word(at, k) >> (round % 32)));
            (0..8).for_each(|at| places.set(at, Place(core::array::from_fn(|k| word(at, 2 + k as u32)))));
            let block = if round % 2 == 0 { Block::Scatter } else { Block::Light };
            let many = places.numbers(&vertices, block, &samples);
            for at in 0..8 {
                let four = places.at(at).numbers([vertices[at], block as u32], samples[at]);
                assert_eq!(many.map(|column| column[at]), four);
            }
        }
    }

    /// The recurrences of the polynomials x + 1, x^2 + x + 1 and x^3 + x + 1, written out.
    #[test]
    fn tables_hold_the_recurrences() {
        let mut m = [[1u64; 32], [1; 32], [1; 32], [1; 32]];
        (m[2][1], m[3][1]) = (3, 3);
        for k in 1..32 {
            m[1][k] = m[1][k - 1] << 1 ^ m[1][k - 1];
            if k >= 2 {
                m[2][k] = m[2][k - 1] << 1 ^ m[2][k - 2] << 2 ^ m[2][k - 2];
            }
            if k >= 3 {
                m[3][k] = m[3][k - 2] << 2 ^ m[3][k - 3] << 3 ^ m[3][k - 3];
            }
        }
        for k in 0..32 {
            let found = point((1u32 << k).reverse_bits()).map(|x| u64::from(x.reverse_bits()));
            assert_eq!(found, m.map(|m| m[k] << (31 - k)), "bit {k}");
        }
        let [a, b] = [0x9E37_79B9, 0x0F1E_2D3C];
        let sum: [u32; 4] = core::array::from_fn(|lane| point(a)[lane] ^ point(b)[lane]);
        assert_eq!(point(a ^ b), sum, "what several bits add is the sum of what each adds");
    }

    #[test]
    fn scrambling_is_nested() {
        // Numbers that share their highest n bits keep sharing exactly these, and no two become one.
        for seed in [0, 1, 0x8000_0000, 0xDEAD_BEEF, u32::MAX]
            .into_iter()
            .chain((0..2000).map(|k: u32| k.wrapping_mul(0x9E37_79B9)))
        {
            for x in [0, 1, 0x5555_5555, u32::MAX, seed ^ 0x1234_5678] {
                for bit in 0..32 {
                    let changed = scramble(x, seed) ^ scramble(x ^ 1 << bit, seed);
                    assert_eq!(changed.trailing_zeros(), bit, "{x:#x} {seed:#x}");
                }
            }
        }
    }
}
