//! The kernel's operations, each on inputs of all kinds.

use ocellus_kernel::bvh::{Bounds, BuildItem, BvhStorage, Structure, intersect, occluded};
use ocellus_kernel::camera::{CameraSettings, Filter};
use ocellus_kernel::material::fresnel::{Fresnel, Interface, reflectance};
use ocellus_kernel::real::{Real, Vec3, Vector, widen};
use ocellus_kernel::shape::{Geometry, PreparedRay, Sphere, triangle};
use ocellus_kernel::texture::Texture;
use ocellus_kernel::{Camera, Everything, Ray, robust, warp};

use crate::numbers::{Hash, Numbers};

/// The hash of what `one` adds for each query.
fn each(operation: u32, queries: u32, mut one: impl FnMut(&mut Numbers, &mut Hash)) -> u64 {
    let mut hash = Hash::new();
    for query in 0..queries {
        one(&mut Numbers::new(operation, query), &mut hash);
    }
    hash.finish()
}

pub fn square_root<R: Real>(queries: u32) -> u64 {
    each(1, queries, |numbers, hash| hash.real(numbers.any::<R>().sqrt()))
}

pub fn sine_and_cosine<R: Real>(queries: u32) -> u64 {
    each(2, queries, |numbers, hash| {
        let (sine, cosine) = numbers.unit::<R>().sin_cos_turns();
        hash.reals([sine, cosine]);
    })
}

pub fn logarithm<R: Real>(queries: u32) -> u64 {
    each(3, queries, |numbers, hash| hash.real(numbers.any::<R>().ln()))
}

pub fn normalise<R: Real>(queries: u32) -> u64 {
    each(4, queries, |numbers, hash| {
        let v = numbers.vector(Numbers::any::<R>);
        hash.reals(robust::normalize::<R>(v).to_array());
        hash.reals(robust::normalize_wide::<R>(widen::<R>(v)).to_array());
    })
}

pub fn frame<R: Real>(queries: u32) -> u64 {
    each(5, queries, |numbers, hash| {
        let n = robust::normalize::<R>(numbers.vector(Numbers::signed::<R>));
        warp::frame::<R>(n).iter().for_each(|axis| hash.reals(axis.to_array()));
        let local = warp::cosine_hemisphere::<R>(numbers.unit(), numbers.unit());
        hash.reals(warp::to_world::<R>(n, local).to_array());
    })
}

pub fn warps<R: Real>(queries: u32) -> u64 {
    each(6, queries, |numbers, hash| {
        let [u, v]: [R; 2] = [numbers.unit(), numbers.unit()];
        hash.reals(warp::cosine_hemisphere::<R>(u, v).to_array());
        hash.reals(warp::disk(u, v));
        hash.reals(warp::gaussian(u, v));
        hash.real(warp::tent(u));
        let cone = warp::cone(v * v, u);
        hash.reals([cone.cosine, cone.sine, cone.sine_square, cone.solid_angle]);
    })
}

pub fn difference_of_products<R: Real>(queries: u32) -> u64 {
    each(7, queries, |numbers, hash| {
        let [a, b, c, d]: [R; 4] = core::array::from_fn(|_| numbers.any());
        hash.real(R::difference_of_products(a, b, c, d));
        // Close products: all that is left is what rounding would have taken.
        hash.real(R::difference_of_products(a, b, a.next_up(), b.next_down()));
    })
}

/// A ray from anywhere to somewhere about `target`; one in four is not of unit length or runs along an axis.
fn ray<R: Real>(numbers: &mut Numbers, target: Vec3<R>) -> Ray<R> {
    let origin = numbers.vector(Numbers::any::<R>);
    let direction = target - origin;
    let direction = match numbers.bits() & 7 {
        0 => direction,
        1 => Vec3::<R>::new(R::ZERO, -R::ZERO, direction.z()),
        _ => robust::normalize::<R>(direction),
    };
    Ray::new(origin, direction)
}

pub fn slab<R: Real>(queries: u32) -> u64 {
    each(8, queries, |numbers, hash| {
        let [a, b] = [numbers.vector(Numbers::any::<R>), numbers.vector(Numbers::any::<R>)];
        let mut bounds = Bounds::EMPTY;
        bounds.grow(a);
        bounds.grow(b);
        let ray = ray::<R>(numbers, a);
        let entry = bounds.entry(&PreparedRay::new(&ray), ray.tmax);
        hash.integer(u64::from(entry.is_some()));
        hash.real(entry.unwrap_or(R::ZERO));
        hash.real(bounds.half_area());
    })
}

pub fn triangle<R: Real>(queries: u32) -> u64 {
    each(9, queries, |numbers, hash| {
        let corners: [Vec3<R>; 3] = core::array::from_fn(|_| numbers.vector(Numbers::any::<R>));
        let [u, v]: [R; 2] = [numbers.unit(), numbers.unit()];
        let inside = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * (v * (R::ONE - u));
        let ray = ray::<R>(numbers, inside);
        let found = triangle::intersect(&corners, &PreparedRay::new(&ray), ray.tmax);
        hash.integer(u64::from(found.is_some()));
        let (t, u, v) = found.unwrap_or((R::ZERO, R::ZERO, R::ZERO));
        hash.reals([t, u, v]);
    })
}

fn random_sphere<R: Real>(numbers: &mut Numbers) -> Sphere<R> {
    let radius = numbers.any::<R>().abs() + R::MIN_POSITIVE;
    Sphere { center: numbers.vector(Numbers::any::<R>), radius, material: 0, inverted: false }
}

/// A point inside of a sphere, or near it.
fn near<R: Real>(numbers: &mut Numbers, sphere: &Sphere<R>) -> Vec3<R> {
    sphere.center + numbers.vector(Numbers::signed::<R>) * sphere.radius
}

pub fn sphere<R: Real>(queries: u32) -> u64 {
    each(10, queries, |numbers, hash| {
        let sphere = random_sphere::<R>(numbers);
        let target = near(numbers, &sphere);
        let ray = ray::<R>(numbers, target);
        let found = sphere.intersect(&PreparedRay::new(&ray), ray.tmax);
        hash.integer(u64::from(found.is_some()));
        hash.real(found.unwrap_or(R::ZERO));
    })
}

pub fn four_spheres<R: Real>(queries: u32) -> u64 {
    each(11, queries, |numbers, hash| {
        let spheres: [Sphere<R>; 4] = core::array::from_fn(|_| random_sphere(numbers));
        let target = near(numbers, &spheres[0]);
        let ray = ray::<R>(numbers, target);
        let geometry = Geometry::new(&spheres, &[], &[]).expect("spheres");
        let mut storage = BvhStorage::<R, 1, 4, 0>::EMPTY;
        let bvh = storage.build(&geometry, Structure::Bvh, &mut [BuildItem::EMPTY; 4]).expect("room");
        let hit = intersect::<R, Everything>(&geometry, Some(&bvh), &ray);
        hash.integer(u64::from(hit.map_or(u32::MAX, |hit| hit.primitive)));
        hash.real(hit.map_or(R::ZERO, |hit| hit.t));
        let short = Ray { tmax: numbers.any::<R>().abs(), ..ray };
        hash.integer(u64::from(occluded::<R, Everything>(&geometry, Some(&bvh), &short)));
    })
}

pub fn offset<R: Real>(queries: u32) -> u64 {
    each(12, queries, |numbers, hash| {
        let p = numbers.vector(Numbers::any::<R>);
        let error = p.abs() * robust::gamma::<R>(7);
        let normal = robust::normalize::<R>(numbers.vector(Numbers::signed::<R>));
        let toward = numbers.vector(Numbers::signed::<R>);
        hash.reals(robust::offset_ray_origin::<R>(p, error, normal, toward).to_array());
    })
}

pub fn fresnel<R: Real>(queries: u32) -> u64 {
    each(13, queries, |numbers, hash| {
        let ior = |numbers: &mut Numbers| R::ONE + numbers.unit::<R>() * R::from_f64(1.5);
        let at = Interface { cos_i: numbers.unit(), cos_t: numbers.unit(), ior_i: ior(numbers), ior_t: ior(numbers) };
        hash.reals([Fresnel::None, Fresnel::Schlick, Fresnel::Exact].map(|model| reflectance::<R>(model, &at)));
    })
}

/// Three by two texels.
pub const TEXELS: [[f32; 3]; 6] =
    [[0.9, 0.1, 0.1], [0.1, 0.9, 0.1], [0.1, 0.1, 0.9], [0.8, 0.8, 0.2], [0.2, 0.8, 0.8], [0.5, 0.4, 0.3]];

pub fn texture<R: Real>(queries: u32) -> u64 {
    let texture = Texture { width: 3, height: 2, texels: &TEXELS };
    each(14, queries, |numbers, hash| {
        let uv = [numbers.any::<R>(), numbers.signed::<R>() * R::from_f64(4.0)];
        hash.reals(texture.lookup::<R>(uv).to_array());
    })
}

pub fn camera<R: Real>(queries: u32) -> u64 {
    let filters = [Filter::Box(1.0), Filter::Tent(1.0), Filter::Gaussian(0.5)];
    let cameras = filters.map(|filter| {
        let settings = CameraSettings {
            position: [3.0, -2.0, 5.5],
            look_at: [0.25, 0.5, -1.0],
            up: [0.1, 1.0, 0.0],
            field_of_view: 0.9,
            width: 640,
            height: 480,
            aperture_radius: 0.3,
            focal_distance: 7.0,
            filter,
        };
        Camera::<R>::new(&settings).expect("a camera")
    });
    each(15, queries, |numbers, hash| {
        let [x, y] = [numbers.bits() % 640, numbers.bits() % 480];
        let block = [numbers.bits(), numbers.bits(), numbers.bits(), numbers.bits()];
        for camera in &cameras {
            let ray = camera.ray::<Everything>(x, y, block);
            hash.reals(ray.origin.to_array());
            hash.reals(ray.direction.to_array());
        }
    })
}
