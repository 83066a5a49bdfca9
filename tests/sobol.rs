//! Sobol's numbers: evenly spread within a pixel, unrelated between pixels, vertices, blocks and seeds, and right on
//! average whatever is integrated.

use ocellus::description::SamplerDescription;
use ocellus_kernel::SamplerKind;
use ocellus_kernel::sampler::{AddressedSampler, Block, Sampler};

use crate::sampling::{STEPS, Walk, assert_even};
use crate::support::noise::Noise;
use crate::support::pictures::{film, fixture, scene};
use crate::support::statistics::Moments;
use crate::support::trials::Trials;

/// A sequence: all of an address but the sample.
#[derive(Clone, Copy, Debug)]
struct Sequence {
    kind: SamplerKind,
    seed: u64,
    x: u32,
    y: u32,
    vertex: u32,
    block: Block,
}

const FIRST: Sequence = Sequence { kind: SamplerKind::Sobol, seed: 0, x: 0, y: 0, vertex: 0, block: Block::Scatter };

impl Sequence {
    fn numbers(self, sample: u32) -> [u32; 4] {
        let mut sampler = AddressedSampler::new(self.seed, self.x, self.y, sample).of_kind(self.kind);
        sampler.begin_vertex(self.vertex);
        sampler.numbers(self.block)
    }

    fn point(self, sample: u32) -> [f64; 4] {
        self.numbers(sample).map(|number| f64::from(number) / 4_294_967_296.0)
    }

    /// The mean of `f` over the first `samples` samples.
    fn mean(self, samples: u32, f: impl Fn([f64; 4]) -> f64) -> f64 {
        (0..samples).map(|sample| f(self.point(sample))).sum::<f64>() / f64::from(samples)
    }

    /// Mean of the mean of `f` and its spread over `count` pixels.
    fn moments(self, count: u32, samples: u32, f: impl Fn([f64; 4]) -> f64) -> Moments {
        let mut moments = Moments::default();
        for pixel in 0..count {
            moments.add(Self { x: pixel & 255, y: pixel >> 8, ..self }.mean(samples, &f));
        }
        moments
    }
}

const SEQUENCES: [Sequence; 6] = [
    FIRST,
    Sequence { seed: 1, ..FIRST },
    Sequence { seed: u64::MAX, x: 65_535, y: 65_535, ..FIRST },
    Sequence { x: 1, vertex: 1, ..FIRST },
    Sequence { y: 1, vertex: 7, block: Block::Light, ..FIRST },
    Sequence { seed: 1 << 40, x: 640, y: 480, vertex: 65_536, block: Block::Light, ..FIRST },
];

/// The highest `bits` bits.
fn top(number: u32, bits: u32) -> usize {
    (u64::from(number) << bits >> 32) as usize
}

/// N43. Of `2^m` samples from a multiple of `2^m` on, exactly one lies in each rectangle of area `2^-m` of dimensions 0
/// and 1, whatever its shape, and one in each interval of length `2^-m` of every dimension.
#[test]
fn aligned_samples_are_a_net() {
    let nets = Trials::of::<f32>("N43", "elementary intervals hold one of 2^m samples each");
    for (sequence, m) in SEQUENCES.into_iter().flat_map(|sequence| (0..=10).map(move |m| (sequence, m))) {
        // The last block ends with the last sample of all.
        for start in [0, 1, 2, 5, 1000, (u32::MAX >> m) / 3, u32::MAX >> m].map(|block: u32| block.wrapping_shl(m)) {
            let points: Vec<_> = (0..1 << m).map(|offset: u32| sequence.numbers(start + offset)).collect();
            let once = |cell: &dyn Fn(&[u32; 4]) -> usize| {
                let mut seen = vec![false; 1 << m];
                points.iter().all(|point| !std::mem::replace(&mut seen[cell(point)], true))
            };
            for across in 0..=m {
                let held = once(&|point| top(point[0], across) << (m - across) | top(point[1], m - across));
                nets.holds(held, || format!("{sequence:?} from {start}: 2^{across} by 2^{}", m - across));
            }
            for lane in 0..4 {
                let held = once(&|point| top(point[lane], m));
                nets.holds(held, || format!("{sequence:?} from {start}: dimension {lane}, 2^{m}"));
            }
        }
    }
    nets.end(4000);
}

/// Each sample on its own is as random as an independent one.
#[test]
fn numbers_are_even_along_every_other_part_of_the_address() {
    let walks: [(&str, Walk); 6] = [
        ("seed", |i| (u64::from(i), 3, 5, 0, 1)),
        ("high seed", |i| (u64::from(i) << 32, 3, 5, 1, 1)),
        ("column", |i| (7 + u64::from(i >> 16), i & 0xFFFF, 5, 2, 1)),
        ("row", |i| (7 + u64::from(i >> 16), 3, i & 0xFFFF, 1023, 1)),
        ("vertex", |i| (7, 3, 5, 1 << 31, i)),
        ("everything", |i| (u64::from(i), i & 0xFFFF, i >> 1 & 0xFFFF, u32::MAX - i, i)),
    ];
    for (name, address) in walks {
        assert_even(name, SamplerKind::Sobol, address);
    }
    Trials::passed::<f32>("N43", "Sobol's numbers along every part of the address but the sample", 12 * STEPS);
}

/// From a sequence to one beside it.
type Step = fn(Sequence) -> Sequence;

/// Two sequences that differ in one part of their addresses only. Their scrambling is unrelated: of what their numbers
/// say of each other, sample by sample, nothing is left on average. And so is their order: in few pixels do they go
/// together. Looked at through Walsh functions, each the parity of some of the highest bits.
#[test]
fn sequences_are_unrelated() {
    const PIXELS: u32 = 4096;
    const SAMPLES: u32 = 16;
    const WALSH: [u32; 4] = [1 << 31, 1 << 30, 3 << 30, 5 << 29];
    let neighbours: [(&str, Step); 6] = [
        ("columns", |of| Sequence { x: of.x + 1, ..of }),
        ("rows", |of| Sequence { y: of.y + 1, ..of }),
        ("vertices", |of| Sequence { vertex: of.vertex + 1, ..of }),
        ("blocks", |of| Sequence { block: Block::Light, ..of }),
        ("seeds", |of| Sequence { seed: of.seed + 1, ..of }),
        ("high seeds", |of| Sequence { seed: of.seed + (1 << 32), ..of }),
    ];
    for (name, neighbour) in neighbours {
        let mut products = vec![[Moments::default(); 2]; 4 * 4 * WALSH.len()];
        // Every other one, so that pairs have nothing in common.
        for pixel in 0..PIXELS {
            let here = Sequence { x: 2 * (pixel & 63), y: 2 * (pixel >> 6), vertex: 1, ..FIRST };
            let there = neighbour(here);
            let pairs: Vec<_> = (0..SAMPLES).map(|sample| (here.numbers(sample), there.numbers(sample))).collect();
            for (at, [product, square]) in products.iter_mut().enumerate() {
                let (a, b, walsh) = (at % 4, at / 4 % 4, WALSH[at / 16]);
                let sign = |(here, there): &([u32; 4], [u32; 4])| ((here[a] ^ there[b]) & walsh).count_ones() % 2;
                let odd: u32 = pairs.iter().map(sign).sum();
                let mean = 1.0 - 2.0 * f64::from(odd) / f64::from(SAMPLES);
                product.add(mean);
                square.add(mean * mean);
            }
        }
        for (at, [product, square]) in products.iter().enumerate() {
            let what = format!("{name}, dimensions {} and {}, {:#x}", at % 4, at / 4 % 4, WALSH[at / 16]);
            product.assert_mean(&what, 0.0, 0.0);
            // In the same order it would be 1; two by two samples take opposite signs at once, hence not 1 / 16.
            assert!(square.mean() < 0.15, "{what}: in step by {}", square.mean());
        }
    }
    Trials::passed::<f32>("N43", "pairs of neighbouring sequences", 6 * PIXELS);
}

/// The volume of what of the unit cube in four dimensions has coordinates that add to less than `sum`, 1 to 2.
fn corner(sum: f64) -> f64 {
    let [all, beyond] = [sum, sum - 1.0].map(|side| side * side * side * side);
    (all - 4.0 * beyond) / 24.0
}

/// The variance of `a` as a multiple of that of `b`.
fn variance_ratio(a: &Moments, b: &Moments) -> f64 {
    let ratio = a.spread() / b.spread();
    ratio * ratio
}

/// What jumps is integrated without bias, by few samples or many, in number a power of two or not; and with less
/// error than by independent numbers.
#[test]
fn means_are_unbiased() {
    for (samples, precise) in [(1, 0.01), (7, 0.003), (16, 0.003), (100, 0.001)] {
        let disk = |sequence: Sequence| {
            sequence.moments(20_000, samples, |[x, y, ..]| f64::from(u8::from(x * x + y * y < 1.0)))
        };
        let cut = |sequence: Sequence| {
            sequence.moments(20_000, samples, |x| f64::from(u8::from(x.iter().sum::<f64>() < 1.7)))
        };
        let independent = Sequence { kind: SamplerKind::Independent, ..FIRST };
        for (what, sobol, other, exact) in [
            ("quarter of a disk", disk(FIRST), disk(independent), std::f64::consts::FRAC_PI_4),
            ("corner of a cube", cut(FIRST), cut(independent), corner(1.7)),
        ] {
            sobol.assert_mean(&format!("{what}, {samples} samples"), exact, 0.0);
            sobol.assert_precise(what, 2.0 * precise);
            let ratio = variance_ratio(&other, &sobol);
            println!("{what}, {samples} samples: variance {ratio:.2} times below independent numbers");
            assert!(ratio > if samples == 1 { 0.95 } else { 1.3 }, "{what}: {ratio}");
        }
    }
    Trials::passed::<f32>("N43", "means of what jumps", 8 * 20_000);
}

/// Of a smooth function of two numbers, variance falls with the third power of the number of samples.
#[test]
fn smooth_functions_have_far_less_variance() {
    let smooth = |x: f64, y: f64| libm::exp(x) * libm::sin(2.0 * y + x);
    for (a, b, least) in [(0, 1, 1000.0), (1, 2, 10.0), (2, 3, 10.0), (0, 3, 10.0)] {
        let moments = |kind| Sequence { kind, ..FIRST }.moments(400, 256, |x| smooth(x[a], x[b]));
        let ratio = variance_ratio(&moments(SamplerKind::Independent), &moments(SamplerKind::Sobol));
        println!("dimensions {a} and {b}: variance {ratio:.0} times below independent numbers");
        assert!(ratio > least, "dimensions {a} and {b}: {ratio}");
    }
}

/// Quadrants of whole pictures, over seeds: the same means by both samplers.
#[test]
fn pictures_are_the_same_on_average() {
    const SIZE: u32 = 16;
    let scenes = ["features/sphere_light", "features/lens", "features/roulette", "features/emission", "report/fig5c"];
    for name in scenes {
        let mut scene = scene(fixture(&format!("{name}.toml")), SIZE);
        let [independent, sobol] = [SamplerDescription::Independent, SamplerDescription::Sobol].map(|sampler| {
            scene.integrator.sampler = sampler;
            let mut quadrants = [Moments::default(); 4];
            for seed in 0..96 {
                scene.integrator.seed = seed;
                let film = film(&scene, |settings| settings.samples = 0..16);
                let mut sums = [0.0; 4];
                for (at, pixel) in (0u32..).zip(film.pixels()) {
                    let quadrant = 2 * (at / SIZE / (SIZE / 2)) + at % SIZE / (SIZE / 2);
                    sums[quadrant as usize] += pixel.mean().iter().map(|&channel| f64::from(channel)).sum::<f64>();
                }
                quadrants.iter_mut().zip(sums).for_each(|(moments, sum)| moments.add(sum));
            }
            quadrants
        });
        for (quadrant, (independent, sobol)) in independent.iter().zip(&sobol).enumerate() {
            sobol.assert_same_mean(&format!("{name}, quadrant {quadrant}"), independent);
            sobol.assert_precise(&format!("{name}, quadrant {quadrant}"), 0.02);
        }
    }
}

/// What samples that avoid each other are for.
#[test]
fn pictures_have_less_noise() {
    // The light and the film are most of what is to be integrated; then light that comes by many ways.
    for (name, most) in [("features/sphere_light", 0.7), ("features/lens", 0.8), ("report/fig5c", 0.95)] {
        let scene = scene(fixture(&format!("{name}.toml")), 24);
        let rmse = |sampler| Noise::of(&scene, sampler, 64, 12).rmse();
        let ratio = rmse(SamplerDescription::Sobol) / rmse(SamplerDescription::Independent);
        println!("{name}: RMSE {ratio:.3} of that of independent numbers");
        assert!(ratio < most, "{name}: {ratio}");
    }
}
