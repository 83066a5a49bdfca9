//! Samplers against their densities, and the generator behind them.

use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::sampler::{AddressedSampler, Block, Sampler, SamplerKind};
use ocellus_kernel::warp::{cone, cosine_hemisphere, disk, gaussian, tent, to_world};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::support::exact::{exact, root, to_f64};
use crate::support::in_both_precisions;
use crate::support::random::Random;
use crate::support::scene::v;
use crate::support::statistics::{Moments, assert_follows, assert_uniform};
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    the_cosine_hemisphere_follows_its_density,
    the_disk_is_uniform,
    the_cone_is_uniform_in_solid_angle,
    directions_to_a_sphere_are_uniform,
    the_gaussian_is_normal,
    the_tent_is_a_tent,
    corners_of_the_square_are_finite_and_in_range,
    far_cones_keep_their_solid_angle,
);

const SAMPLES: u32 = 1_000_000;
const ROWS: usize = 40;
const COLUMNS: usize = 80;

/// Pairs of the kernel's own numbers.
fn pairs<R: Real>() -> impl Iterator<Item = [R; 2]> {
    (0..SAMPLES).map(|sample| {
        let [a, b, ..] = AddressedSampler::new(5, 17, 4, sample).numbers(Block::Scatter);
        [a, b].map(R::from_unit_bits)
    })
}

/// The cell of a grid in which `(x, y)` of the unit square lies.
fn cell(x: f64, y: f64) -> usize {
    let at = |x: f64, cells: usize| ((x * cells as f64) as usize).min(cells - 1);
    at(x, ROWS) * COLUMNS + at(y, COLUMNS)
}

/// The angle of `(x, y)` as a fraction of a turn.
fn turn(x: f64, y: f64) -> f64 {
    let turns = libm::atan2(y, x) / std::f64::consts::TAU;
    if turns < 0.0 { turns + 1.0 } else { turns }
}

/// What each cell is due if rows have the given cumulative probability and columns are alike.
fn expected(cumulative: impl Fn(f64) -> f64) -> Vec<f64> {
    let row = |row: usize| {
        let [low, high] = [row, row + 1].map(|row| cumulative(row as f64 / ROWS as f64));
        (high - low) * f64::from(SAMPLES) / COLUMNS as f64
    };
    (0..ROWS).flat_map(|r| std::iter::repeat_n(row(r), COLUMNS)).collect()
}

/// pdf = cos / pi: below cosine c lies c^2 of the probability, at every azimuth alike. In a frame askew.
fn the_cosine_hemisphere_follows_its_density<R: Real>() {
    let n = ocellus_kernel::robust::normalize::<R>(v::<R>([0.3, -0.8, -0.4]));
    let [x, y] = ocellus_kernel::warp::frame::<R>(n);
    let mut counts = vec![0; ROWS * COLUMNS];
    for [a, b] in pairs::<R>() {
        let d = to_world::<R>(n, cosine_hemisphere(a, b));
        let [x, y, z] = [x, y, n].map(|axis| axis.dot(d).to_f64());
        assert!(
            z >= -tolerance::FRAME * u::<R>() && (d.dot(d).to_f64() - 1.0).abs() <= tolerance::UNIT_SAMPLE * u::<R>()
        );
        counts[cell(z.max(0.0), turn(x, y))] += 1;
    }
    assert_follows("cosine hemisphere", &counts, &expected(|cosine| cosine * cosine));
    Trials::passed::<R>("N34", "cosine hemisphere", pairs::<R>().count() as u32);
}

/// Within radius r lies r^2 of the probability.
fn the_disk_is_uniform<R: Real>() {
    let mut counts = vec![0; ROWS * COLUMNS];
    for [a, b] in pairs::<R>() {
        let [x, y] = disk(a, b).map(|c| c.to_f64());
        let radius = (x * x + y * y).sqrt();
        assert!(radius <= 1.0 + tolerance::UNIT_SAMPLE * u::<R>());
        counts[cell(radius, turn(x, y))] += 1;
    }
    assert_follows("disk", &counts, &expected(|radius| radius * radius));
    Trials::passed::<R>("N34", "disk", pairs::<R>().count() as u32);
}

/// Directions to a sphere from inside, from just off its surface and from afar, as its light forms them: uniform in solid
/// angle, at every azimuth alike. In a frame askew.
fn directions_to_a_sphere_are_uniform<R: Real>() {
    let toward = ocellus_kernel::robust::normalize::<R::Wide>(v::<R::Wide>([0.3, -0.8, -0.4]));
    let across = ocellus_kernel::warp::frame::<R::Wide>(toward);
    // Heights above the surface, in radii.
    for height in [-0.5, 1e-3, 0.1, 1.0, 100.0, 1e4] {
        let sine_square = if height < 0.0 { 1.5 } else { 1.0 / ((1.0 + height) * (1.0 + height)) };
        let versine = if height < 0.0 { 2.0 } else { sine_square / (1.0 + (1.0f64 - sine_square).sqrt()) };
        let mut counts = vec![0; ROWS * COLUMNS];
        for [a, b] in pairs::<R>() {
            let sample = cone(R::Wide::from_f64(sine_square), a.widen());
            let (sine, cosine) = b.sin_cos_turns();
            let local = Vector::new(cosine.widen() * sample.sine, sine.widen() * sample.sine, sample.cosine);
            let d = to_world::<R::Wide>(toward, local);
            let [x, y] = across.map(|axis| axis.dot(d).to_f64());
            let z = toward.dot(d).to_f64();
            // 1 - z, which would cancel.
            let drop = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
            counts[cell(drop / versine, turn(x, y))] += 1;
        }
        assert_follows("directions to a sphere", &counts, &expected(|drop| drop));
    }
    Trials::passed::<R>("N34", "directions to a sphere", 6 * pairs::<R>().count() as u32);
}

/// 1 - cos is uniform up to the edge, the sine belongs to the cosine, and the solid angle is `2 pi (1 - cos)`.
fn the_cone_is_uniform_in_solid_angle<R: Real>() {
    for sine_square in [0.999, 0.75, 0.01, 1e-6] {
        let versine = sine_square / (1.0 + (1.0f64 - sine_square).sqrt());
        let mut counts = vec![0; 1000];
        for [a, _] in pairs::<R>() {
            let sample = cone(R::from_f64(sine_square), a);
            let [cosine, sine, solid_angle] = [sample.cosine, sample.sine, sample.solid_angle].map(|x| x.to_f64());
            assert!((sine * sine + cosine * cosine - 1.0).abs() <= tolerance::UNIT_SAMPLE * u::<R>());
            let exact = std::f64::consts::TAU * versine;
            assert!((solid_angle - exact).abs() <= tolerance::SOLID_ANGLE * u::<R>() * exact, "{solid_angle} {exact}");
            // From the sine, which does not cancel where the cosine does.
            let drop = sine * sine / (1.0 + cosine) / versine;
            assert!(drop <= 1.0 + tolerance::UNIT_SAMPLE * u::<R>(), "{drop} beyond the edge");
            counts[((drop * 1000.0) as usize).min(999)] += 1;
        }
        assert_uniform("cone", &counts);
    }
    let sphere = cone(R::from_f64(1.5), R::from_f64(0.75));
    assert_eq!(sphere.cosine.to_f64(), -0.5);
    assert!((sphere.solid_angle.to_f64() / (4.0 * std::f64::consts::PI) - 1.0).abs() <= 2.0 * u::<R>());
    Trials::passed::<R>("N34", "cone", pairs::<R>().count() as u32);
}

/// Both numbers are normal and independent: their quantiles fill a square evenly.
fn the_gaussian_is_normal<R: Real>() {
    let normal = Normal::standard();
    let mut counts = vec![0; ROWS * COLUMNS];
    for [a, b] in pairs::<R>() {
        let [x, y] = gaussian(a, b).map(|x| normal.cdf(x.to_f64()));
        counts[cell(x, y)] += 1;
    }
    assert_uniform("gaussian", &counts);
    Trials::passed::<R>("N34", "normal numbers", pairs::<R>().count() as u32);
}

/// Density 1 - |x|.
fn the_tent_is_a_tent<R: Real>() {
    let mut counts = vec![0; ROWS * COLUMNS];
    let below = |x: f64| if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) };
    for [a, b] in pairs::<R>() {
        let [x, y] = [a, b].map(|u| tent(u).to_f64());
        assert!(x.abs() <= 1.0);
        counts[cell(0.5 * (x + 1.0), below(y))] += 1;
    }
    assert_follows("tent", &counts, &expected(|x| below(2.0 * x - 1.0)));
    Trials::passed::<R>("N34", "tent", pairs::<R>().count() as u32);
}

fn corners_of_the_square_are_finite_and_in_range<R: Real>() {
    let corners = [0, 1, 0x100, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FEFF, u32::MAX].map(R::from_unit_bits);
    let is_unit = |square: R| (square.to_f64() - 1.0).abs() <= tolerance::UNIT_SAMPLE * u::<R>();
    for (a, b) in corners.into_iter().flat_map(|a| corners.map(|b| (a, b))) {
        let d = cosine_hemisphere(a, b);
        assert!(is_unit(d.dot(d)) && d.z() >= R::ZERO, "{a:?} {b:?}: {d:?}");
        // Below 6.7 standard deviations: the root of -2 ln 2^-32.
        assert!(gaussian(a, b).iter().all(|x| x.is_finite() && x.to_f64().abs() < 6.7), "{a:?} {b:?}");
        for sine_square in [0.0, 1e-30, 1e-12, 0.5, 1.0] {
            let sample = cone(R::from_f64(sine_square), a);
            assert!(is_unit(sample.sine * sample.sine + sample.cosine * sample.cosine), "{sine_square} {a:?}");
            assert!(sample.solid_angle >= R::ZERO && (sine_square == 0.0 || sample.solid_angle > R::ZERO));
        }
    }
    Trials::passed::<R>("N35", "corners of the unit square", 49);
}

/// `1 - cos` of a light a million radii away would be 0; formed without cancellation it keeps its digits.
fn far_cones_keep_their_solid_angle<R: Real>() {
    let mut random = Random::new(31);
    let errors = Trials::measured::<R>("N35", "solid angles of far cones", tolerance::SOLID_ANGLE, "u");
    for _ in 0..trials(20_000) / 10 {
        let sine_square = R::from_f64(libm::exp10(random.between(-12.0, 0.0)));
        let s = exact(sine_square.to_f64());
        let versine = &s / (exact(1.0) + root(&(exact(1.0) - &s)));
        let truth = std::f64::consts::TAU * to_f64(&versine);
        let found = cone(sine_square, R::ZERO).solid_angle.to_f64();
        errors.error((found / truth - 1.0).abs() / u::<R>(), || format!("{sine_square:?}: {found} {truth}"));
    }
    errors.end(2000);
}

/// From a counter to (seed, column, row, sample, vertex).
pub(crate) type Walk = fn(u32) -> (u64, u32, u32, u32, u32);

/// How many addresses a walk visits.
pub(crate) const STEPS: u32 = 1 << 17;

/// Numbers along a walk through addresses fill a grid evenly: the top bits against the bits below them, the lowest
/// bits likewise, each lane against the next, and each address against its neighbour.
pub(crate) fn assert_even(name: &str, kind: SamplerKind, address: Walk) {
    for block in [Block::Scatter, Block::Light] {
        let numbers = |i: u32| {
            let (seed, x, y, sample, vertex) = address(i);
            let mut sampler = AddressedSampler::new(seed, x, y, sample).of_kind(kind);
            sampler.begin_vertex(vertex);
            sampler.numbers(block)
        };
        let mut counts = [vec![0u64; 4096], vec![0; 4096], vec![0; 4096], vec![0; 4096]];
        let mut mean = Moments::default();
        let mut previous = numbers(STEPS);
        for i in 0..STEPS {
            let now = numbers(i);
            for lane in 0..4 {
                let [here, next, before] = [now[lane], now[(lane + 1) % 4], previous[lane]];
                counts[0][(here >> 20) as usize] += 1;
                counts[1][(here & 0xFFF) as usize] += 1;
                counts[2][(here >> 26 << 6 | next >> 26) as usize] += 1;
                counts[3][(here >> 26 << 6 | before >> 26) as usize] += 1;
                mean.add(f64::from(here) / 4_294_967_296.0);
            }
            previous = now;
        }
        for (what, counts) in ["top bits", "low bits", "lanes", "neighbours"].into_iter().zip(&counts) {
            assert_uniform(&format!("{name} {block:?} {what}"), counts);
        }
        mean.assert_mean(&format!("{name} {block:?}"), 0.5, 0.0);
    }
}

/// Along every part of an address, counted up by ones as a renderer does.
#[test]
fn philox_is_even_along_every_part_of_the_address() {
    let walks: [(&str, Walk); 6] = [
        ("seed", |i| (u64::from(i), 3, 5, 0, 1)),
        ("high seed", |i| (u64::from(i) << 32, 3, 5, 0, 1)),
        ("column", |i| (7, i & 0xFFFF, 5, i >> 16, 1)),
        ("row", |i| (7, 3, i & 0xFFFF, i >> 16, 1)),
        ("sample", |i| (7, 3, 5, i, 1)),
        ("vertex", |i| (7, 3, 5, i >> 6, i & 63)),
    ];
    for (name, address) in walks {
        assert_even(name, SamplerKind::Independent, address);
    }
    Trials::passed::<f32>("N43", "numbers along every part of the address", 12 * STEPS);
}

/// No two pixels of the largest picture, and no two samples of a pixel, share numbers: Philox is a bijection of its
/// counter, so addresses must only be different.
#[test]
fn addresses_do_not_collide() {
    let mut seen = std::collections::HashSet::new();
    for (x, y) in
        [0, 1, 2, 255, 256, 32_767, 32_768, 65_535].into_iter().flat_map(|x| [0, 1, 256, 65_535].map(|y| (x, y)))
    {
        for (sample, vertex) in [0, 1, 65_536, u32::MAX].into_iter().flat_map(|s| [0, 1, 63].map(|v| (s, v))) {
            for block in [Block::Scatter, Block::Light] {
                let mut sampler = AddressedSampler::new(9, x, y, sample);
                sampler.begin_vertex(vertex);
                assert!(seen.insert(sampler.numbers(block)), "{x} {y} {sample} {vertex} {block:?}");
            }
        }
    }
    Trials::passed::<f32>("N43", "addresses", seen.len() as u32);
}
