//! The camera: its symmetries, its angles, its focus. Round trips and reflections, not sampled values.

use ocellus_kernel::camera::{Camera, CameraSettings, Filter};
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::{EffectSet, Effects, Everything, Ray};
use proptest::prelude::*;

use crate::support::in_both_precisions;
use crate::support::property::{direction, for_all};
use crate::support::scene::{CAMERA, v};
use crate::support::tolerance::{self, u};
use crate::support::trials::{Trials, trials};

in_both_precisions!(
    mirrored_pixels_get_mirrored_rays,
    the_centre_ray_looks_at_the_target,
    pixels_lie_where_the_field_of_view_puts_them,
    directions_are_unit,
    lens_rays_of_a_pixel_meet_in_focus,
    lens_rays_start_on_the_lens,
    samples_stay_within_their_filter,
    a_filter_that_is_compiled_out_falls_back_to_a_box,
    directions_do_not_depend_on_the_position,
);

/// Field of view from 1e-3 to 179 degrees, sizes from one pixel to 16,384, and one of the pixels.
fn framings() -> impl Strategy<Value = (CameraSettings, u32, u32)> {
    let field = prop_oneof![1e-3..1.0, 1.0..179.0].prop_map(f64::to_radians);
    let size = || prop_oneof![1u32..4, 4u32..16_384];
    (field, size(), size()).prop_flat_map(|(field_of_view, width, height)| {
        let settings = CameraSettings { field_of_view, width, height, ..CAMERA };
        (Just(settings), 0..width, 0..height)
    })
}

fn camera<R: Real>(settings: &CameraSettings) -> Camera<R> {
    Camera::new(settings).expect("a camera")
}

/// Numbers whose place in the pixel has an exact mirror image in both precisions.
fn mirrored(numbers: [u32; 4]) -> ([u32; 4], [u32; 4]) {
    let numbers = numbers.map(|n| (n & 0xFFFF_FF00).max(1 << 8));
    (numbers, numbers.map(|n| 0u32.wrapping_sub(n)))
}

fn mirrored_pixels_get_mirrored_rays<R: Real>() {
    let filters = prop::sample::select(vec![Filter::Box(0.0), Filter::Box(1.0), Filter::Tent(1.5)]);
    for_all(trials(2000), (framings(), filters, any::<[u32; 4]>()), |((settings, x, y), filter, numbers)| {
        let camera = camera::<R>(&CameraSettings { filter, ..settings });
        let (numbers, opposite) = mirrored(numbers);
        let at = |x, y, numbers| camera.ray::<Everything>(x, y, numbers).direction.to_array();
        let [dx, dy, dz] = at(x, y, numbers);
        let (across, down) = (settings.width - 1 - x, settings.height - 1 - y);
        let flipped_x = [opposite[0], numbers[1], numbers[2], numbers[3]];
        let flipped_y = [numbers[0], opposite[1], numbers[2], numbers[3]];
        prop_assert_eq!(at(across, y, flipped_x), [-dx, dy, dz]);
        prop_assert_eq!(at(x, down, flipped_y), [dx, -dy, dz]);
        Ok(())
    });
    Trials::passed::<R>("N37", "mirrored pixels, bit for bit", trials(2000));
}

fn the_centre_ray_looks_at_the_target<R: Real>() {
    let inputs = (direction(), prop::array::uniform3(-100.0..100.0), 0.1..1000.0);
    for_all(2000, inputs, |(view, position, distance)| {
        prop_assume!(view.iter().any(|x| x.abs() > 1e-3));
        let look_at = std::array::from_fn(|i| position[i] + view[i] * distance);
        // An up that is never along the view.
        let up = if view[0].abs() > view[1].abs() { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
        let settings = CameraSettings { position, look_at, up, width: 33, height: 21, ..CAMERA };
        let ray = camera::<R>(&settings).ray::<Everything>(16, 10, [0; 4]);
        let exact = std::array::from_fn::<f64, 3, _>(|i| look_at[i] - position[i]);
        let length = exact.iter().map(|x| x * x).sum::<f64>().sqrt();
        for (found, exact) in ray.direction.to_array().into_iter().zip(exact) {
            let error = (found.to_f64() - exact / length).abs();
            prop_assert!(error <= tolerance::CAMERA_AXIS * u::<R>(), "{} u", error / u::<R>());
        }
        Ok(())
    });
}

/// The picture is a plane at distance 1: pixel centres in units of `tan(fov / 2)`, right and down.
fn pixels_lie_where_the_field_of_view_puts_them<R: Real>() {
    for_all(trials(3000), framings(), |(settings, x, y)| {
        let d = camera::<R>(&settings).ray::<Everything>(x, y, [0; 4]).direction.to_array().map(|c| c.to_f64());
        let half = libm::tan(settings.field_of_view * 0.5);
        let across = (2.0 * f64::from(x) + 1.0 - f64::from(settings.width)) / f64::from(settings.width) * half;
        let down = (2.0 * f64::from(y) + 1.0 - f64::from(settings.height)) / f64::from(settings.width) * half;
        let length = (across * across + down * down + 1.0).sqrt();
        for (found, exact) in d.into_iter().zip([across, -down, -1.0]) {
            let error = (found - exact / length).abs();
            prop_assert!(error <= tolerance::CAMERA_PIXEL * u::<R>(), "{} u", error / u::<R>());
        }
        Ok(())
    });
    Trials::passed::<R>("N37", "pixel directions", trials(3000));
}

/// A camera askew, with a lens.
fn askew(aperture_radius: f64, focal_distance: f64, filter: Filter) -> CameraSettings {
    CameraSettings {
        position: [3.0, -4.0, 7.5],
        look_at: [-1.0, 2.0, 0.5],
        aperture_radius,
        focal_distance,
        filter,
        ..CAMERA
    }
}

fn directions_are_unit<R: Real>() {
    for_all(2000, (any::<[u32; 4]>(), 0u32..16, 0u32..16, 0.0..2.0), |(numbers, x, y, aperture)| {
        let settings = askew(aperture, 4.0, Filter::Gaussian(0.5));
        let d = camera::<R>(&settings).ray::<Everything>(x, y, numbers).direction.to_array().map(|c| c.to_f64());
        let square: f64 = d.iter().map(|x| x * x).sum();
        prop_assert!((square - 1.0).abs() <= 2.0 * (tolerance::unit_length::<R>() + 1.0) * u::<R>(), "{square}");
        Ok(())
    });
}

/// Where a ray crosses the plane in focus of the camera [`askew`].
fn in_focus<R: Real>(ray: &Ray<R>, forward: Vec3<R>, position: Vec3<R>, focal_distance: f64) -> Vec3<R> {
    let along = R::from_f64(focal_distance) - (ray.origin - position).dot(forward);
    ray.origin + ray.direction * (along / ray.direction.dot(forward))
}

fn lens_rays_of_a_pixel_meet_in_focus<R: Real>() {
    let inputs = (any::<[u32; 4]>(), 0u32..16, 0u32..16, 0.01..2.0, 1.0..100.0);
    for_all(trials(2000), inputs, |(numbers, x, y, aperture, focal_distance)| {
        let pinhole = camera::<R>(&askew(0.0, focal_distance, Filter::Box(1.0)));
        let lens = camera::<R>(&askew(aperture, focal_distance, Filter::Box(1.0)));
        let odd = CameraSettings { width: 1, height: 1, filter: Filter::Box(0.0), ..askew(0.0, 1.0, Filter::Box(0.0)) };
        let axis = camera::<R>(&odd).ray::<Everything>(0, 0, [0; 4]);
        let meet = |camera: &Camera<R>| {
            let ray = camera.ray::<Everything>(x, y, numbers);
            in_focus(&ray, axis.direction, axis.origin, focal_distance)
        };
        let error = (meet(&lens) - meet(&pinhole)).abs().max_component().to_f64();
        let scale = focal_distance + 10.0;
        prop_assert!(error <= tolerance::FOCUS * u::<R>() * scale, "{} u", error / (u::<R>() * scale));
        Ok(())
    });
    Trials::passed::<R>("N37", "rays through a lens", trials(2000));
}

fn lens_rays_start_on_the_lens<R: Real>() {
    let odd = CameraSettings { width: 1, height: 1, ..askew(0.0, 1.0, Filter::Box(0.0)) };
    let axis = camera::<R>(&odd).ray::<Everything>(0, 0, [0; 4]);
    let lens = camera::<R>(&askew(2.0, 4.0, Filter::Box(1.0)));
    let mut widest = 0.0f64;
    for_all(2000, any::<[u32; 4]>(), |numbers| {
        let offset = lens.ray::<Everything>(3, 4, numbers).origin - axis.origin;
        let [along, square] = [offset.dot(axis.direction), offset.dot(offset)].map(|x| x.to_f64());
        let bound = tolerance::FOCUS * u::<R>() * 10.0;
        prop_assert!(along.abs() <= bound && square.sqrt() <= 2.0 + bound, "{along} {square}");
        Ok(())
    });
    for corner in 0..64u32 {
        let offset = lens.ray::<Everything>(3, 4, [0, 0, corner << 26, u32::MAX]).origin - axis.origin;
        widest = widest.max(offset.dot(offset).to_f64());
    }
    assert!(widest > 3.99, "the edge of the lens is never reached: {widest}");
}

/// The film position that a ray came through, in pixels, by inverting the projection of [`CAMERA`].
fn film_position<R: Real>(ray: &Ray<R>) -> [f64; 2] {
    let [x, y, z] = ray.direction.to_array().map(|c| c.to_f64());
    let pixels_per_unit = 8.0 / libm::tan(CAMERA.field_of_view * 0.5);
    [8.0 - x / z * pixels_per_unit, 8.0 + y / z * pixels_per_unit]
}

fn samples_stay_within_their_filter<R: Real>() {
    let filters = [(Filter::Box(1.0), 0.5), (Filter::Box(2.0), 1.0), (Filter::Tent(1.5), 1.5), (Filter::Box(0.0), 0.0)];
    for (filter, reach) in filters {
        let camera = camera::<R>(&CameraSettings { filter, ..CAMERA });
        let mut farthest = 0.0f64;
        for i in 0..4096u32 {
            let numbers = [i << 20, (4095 - i) << 20 | 0xF_FFFF, 0, 0];
            let [x, y] = film_position(&camera.ray::<Everything>(3, 11, numbers));
            farthest = farthest.max((x - 3.5).abs()).max((y - 11.5).abs());
        }
        let rounding = tolerance::FILM_POSITION * u::<R>();
        assert!(farthest <= reach + rounding && farthest >= reach * 0.97 - rounding, "{filter:?}: {farthest}");
    }
}

#[derive(Clone, Copy)]
struct NoFilter;

impl EffectSet for NoFilter {
    const EFFECTS: Effects = Effects::EVERYTHING.without(Effects::FILTER);
}

fn a_filter_that_is_compiled_out_falls_back_to_a_box<R: Real>() {
    let [a, b] = [Filter::Tent(1.5), Filter::Box(1.5)].map(|filter| {
        let camera = camera::<R>(&CameraSettings { filter, ..CAMERA });
        camera.ray::<NoFilter>(3, 4, [1 << 28, 5 << 28, 0, 0])
    });
    assert_eq!(a, b);
}

fn directions_do_not_depend_on_the_position<R: Real>() {
    for_all(
        trials(1000),
        (framings(), prop::array::uniform3(-1_000_000i32..1_000_000)),
        |((settings, x, y), shift)| {
            let shifted = |p: [f64; 3]| std::array::from_fn(|i| p[i] + f64::from(shift[i]));
            let moved =
                CameraSettings { position: shifted(settings.position), look_at: shifted(settings.look_at), ..settings };
            let [here, there] = [&settings, &moved].map(|s| camera::<R>(s).ray::<Everything>(x, y, [0; 4]));
            prop_assert_eq!(here.direction, there.direction);
            prop_assert_eq!(there.origin, v::<R>(moved.position));
            Ok(())
        },
    );
    Trials::passed::<R>("N37", "far cameras", trials(1000));
}
