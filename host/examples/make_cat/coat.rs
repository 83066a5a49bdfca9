//! The cat's looks: sRGB color for each place of its surface. A cream coat with ginger tabby stripes, white below,
//! green eyes, pink nose.

use crate::body::{Cat, EYE};
use crate::shape::unit;
use core::f64::consts::TAU;
use glam::DVec3;

pub(crate) const CREAM: DVec3 = DVec3::new(0.955, 0.905, 0.825);
const WHITE: DVec3 = DVec3::new(0.985, 0.975, 0.955);
const GINGER: DVec3 = DVec3::new(0.790, 0.560, 0.360);
const SHADE: DVec3 = DVec3::new(0.900, 0.790, 0.650);
const PINK: DVec3 = DVec3::new(0.930, 0.660, 0.620);
const NOSE: DVec3 = DVec3::new(0.800, 0.430, 0.410);
const DARK: DVec3 = DVec3::new(0.150, 0.110, 0.100);
const IRIS: DVec3 = DVec3::new(0.520, 0.680, 0.260);

/// 0 below `low`, 1 above `high`, smooth between; `low` may be the larger one.
fn ramp(low: f64, high: f64, value: f64) -> f64 {
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Color of the coat at a point of the surface.
pub(crate) fn color(cat: &Cat, point: DVec3) -> DVec3 {
    let wobble = noise(point * 0.22);
    let patch = noise(point * 0.09 + DVec3::splat(31.0));
    let head = cat.head_point(point);
    let on_head = ramp(6.0, 4.6, libm::sqrt(head.dot(head)).max(1.35 * (0.6 - head.x)));
    let tail = cat.tail_station(point);
    let on_tail = ramp(0.10, 0.26, tail);

    let body_stripes = flank_stripes(point, wobble) * (1.0 - on_tail);
    let tail_stripes = bands(tail * 9.0 + 0.3 * wobble).max(ramp(0.9, 0.96, tail)) * on_tail;
    let stripes = mix_number(body_stripes.max(tail_stripes), face_stripes(head, wobble), on_head);

    let belly = ramp(18.5, 15.5, point.y - 0.8 * wobble)
        * ramp(3.6, 2.2, point.z.abs())
        * ramp(11.0, 14.0, point.y)
        * (1.0 - on_head);
    let paws = ramp(3.4, 2.5, cat.paw_gap(point) - 0.4 * wobble);
    let muzzle = head - DVec3::new(4.1, -2.0, 0.0);
    let muzzle = ramp(2.7, 1.9, libm::sqrt(muzzle.dot(muzzle)) + 0.2 * wobble) * on_head;
    let bib = ramp(11.5, 14.5, point.x) * ramp(21.0, 19.0, point.y - 0.35 * (point.x - 14.0) - 1.2 * wobble);
    let bib = bib * ramp(3.6, 2.4, point.z.abs()) * ramp(12.0, 15.0, point.y);
    let white = belly.max(paws).max(muzzle).max(bib);

    let base = mix(CREAM, SHADE, 0.55 * ramp(-0.1, 0.6, patch) + 0.25 * ramp(25.0, 28.5, point.y) * (1.0 - on_head));
    let fur = mix(mix(base, GINGER, stripes), WHITE, white);
    let inner_ear = ramp(0.22, -0.02, cat.ear_hollow(point)) * ramp(2.5, 3.3, head.y);
    face(mix(fur, PINK, inner_ear), head)
}

/// Soft stripes of period 1: 1 in the middle of a stripe, 0 between stripes.
fn bands(phase: f64) -> f64 {
    ramp(0.0, 0.65, libm::sin(TAU * phase))
}

/// Stripes down the sides and around the legs, a dark line along the back.
fn flank_stripes(point: DVec3, wobble: f64) -> f64 {
    let slant = 0.16 * (point.y - 22.0) - 0.02 * point.x * (point.y - 22.0) / 3.0;
    let side = bands((point.x + slant + 1.9 * wobble) / 3.3) * ramp(15.5, 19.0, point.y + 1.5 * wobble);
    let side = side * ramp(18.5, 15.5, point.x - 0.4 * (point.y - 22.0));
    // Stripes of a real coat break up and fade out in places.
    let side = side * (0.55 + 0.45 * ramp(-0.45, 0.15, noise(point * DVec3::new(0.35, 0.2, 0.35) + DVec3::splat(7.0))));
    let spine = ramp(1.1, 0.5, point.z.abs() + 0.3 * wobble) * ramp(25.0, 27.0, point.y);
    let leg = bands((point.y + 0.9 * wobble) / 2.7) * ramp(15.5, 13.5, point.y) * ramp(2.5, 4.0, point.y);
    side.max(spine).max(leg)
}

/// The M on a tabby's forehead and the lines that run back from its eyes.
fn face_stripes(head: DVec3, wobble: f64) -> f64 {
    let side = head.z.abs();
    let forehead = bands(side / 1.15 + 0.27 + 0.1 * wobble) * ramp(1.3, 2.2, head.y) * ramp(2.6, 1.7, side);
    let forehead = forehead * ramp(4.2, 3.2, head.x) * ramp(-4.0, -2.5, head.x);
    let cheek = bands(head.y / 1.5 + 0.12 * head.x + 0.1) * ramp(2.0, 2.9, side) * ramp(3.2, 1.8, head.x);
    forehead.max(cheek * ramp(1.2, 0.4, head.y))
}

/// Eyes, nose and mouth over the fur.
fn face(fur: DVec3, head: DVec3) -> DVec3 {
    let mirrored = DVec3::new(head.x, head.y, head.z.abs());
    let mut color = fur;

    // Measured on the eyeball, from the direction the eye looks in.
    let gaze = unit(DVec3::new(1.0, 0.02, 0.42));
    let sideways = unit(gaze.cross(DVec3::Y));
    let upward = sideways.cross(gaze);
    let offset = mirrored - EYE;
    if offset.dot(gaze) > 0.2 {
        let (across, up) = (offset.dot(sideways), offset.dot(upward));
        let tilted = up - 0.28 * across;
        let size = libm::sqrt(across * across / 0.92 + tilted * tilted / 0.56);
        color = mix(color, WHITE, 0.6 * ramp(1.5, 1.15, size));
        color = mix(color, DARK, ramp(1.06, 0.96, size));
        let depth = 0.75 + 0.25 * ramp(-0.6, 0.6, up);
        color = mix(color, IRIS * depth, ramp(0.86, 0.76, size));
        let pupil = libm::sqrt(across * across / 0.055 + tilted * tilted / 0.42);
        color = mix(color, DARK, ramp(1.1, 0.85, pupil));
        let glint = DVec3::new(0.0, up - 0.28, across - 0.2);
        color = mix(color, WHITE, ramp(0.2, 0.12, libm::sqrt(glint.dot(glint))));
    }

    // The nose is a triangle, wide at the top; below it the lips' line.
    let half_width = 0.62 * ramp(-1.75, -0.75, head.y);
    let nose = ramp(0.12, -0.05, mirrored.z - half_width) * ramp(-0.45, -0.6, head.y) * ramp(4.7, 4.95, head.x);
    let nose = nose * ramp(-1.75, -1.55, head.y);
    color = mix(color, NOSE, nose);
    let lip_height = -1.75 - 0.45 * mirrored.z;
    let lip = ramp(0.16, 0.07, (head.y - lip_height).abs()) * ramp(1.15, 0.85, mirrored.z);
    let groove = ramp(0.12, 0.05, mirrored.z) * ramp(-1.9, -1.8, head.y) * ramp(-1.3, -1.4, head.y);
    mix(color, NOSE * 0.75, 0.8 * lip.max(groove) * ramp(4.7, 5.0, head.x))
}

fn mix(from: DVec3, to: DVec3, share: f64) -> DVec3 {
    from + (to - from) * share
}

fn mix_number(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

/// Smooth noise between -1 and 1 with features about one unit wide: random numbers on the integer grid,
/// interpolated.
fn noise(point: DVec3) -> f64 {
    let base = DVec3::new(libm::floor(point.x), libm::floor(point.y), libm::floor(point.z));
    let share = (point - base).to_array().map(|x| x * x * (3.0 - 2.0 * x));
    let at = |x: i32, y: i32, z: i32| random(base.x as i32 + x, base.y as i32 + y, base.z as i32 + z);
    let along_x = |y: i32, z: i32| mix_number(at(0, y, z), at(1, y, z), share[0]);
    let along_y = |z: i32| mix_number(along_x(0, z), along_x(1, z), share[1]);
    mix_number(along_y(0), along_y(1), share[2])
}

/// A fixed number between -1 and 1 for a grid point: an integer hash.
fn random(x: i32, y: i32, z: i32) -> f64 {
    let mut bits = 0x2545_f491_u32;
    for coordinate in [x, y, z] {
        bits = (bits ^ coordinate as u32).wrapping_mul(0x9e37_79b1);
        bits ^= bits >> 15;
        bits = bits.wrapping_mul(0x85eb_ca77);
        bits ^= bits >> 13;
    }
    f64::from(bits) / f64::from(u32::MAX) * 2.0 - 1.0
}
