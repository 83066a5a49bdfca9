//! The camera: from pixels and numbers to rays. Pinhole or thin lens, and where in the pixel a sample lies.

use crate::effects::{EffectSet, Effects};
use crate::error::CameraError;
use crate::ray::Ray;
use crate::real::{Real, Vec3, Vector, vec3_from_f64};
use crate::robust::normalize;
use crate::warp::{disk, gaussian, tent};

/// Pixel reconstruction filter, by where its samples lie; widths in pixels. Samples count equally.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Uniform over a square of this full width; 0 puts every sample on the pixel's centre.
    Box(f64),
    /// Falling linearly to zero at this distance in x and y.
    Tent(f64),
    /// Normal with this standard deviation (Box-Muller).
    Gaussian(f64),
}

/// What a camera is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSettings {
    /// Centre of the lens, scene units.
    pub position: [f64; 3],
    /// Point in the middle of the picture, scene units.
    pub look_at: [f64; 3],
    /// Direction that is up in the picture; any length.
    pub up: [f64; 3],
    /// Full horizontal field of view, radians, in 0..pi.
    pub field_of_view: f64,
    /// Pixels across, 1..=65,535.
    pub width: u32,
    /// Pixels down, 1..=65,535; pixels are square.
    pub height: u32,
    /// Lens radius, scene units; 0 is a pinhole.
    pub aperture_radius: f64,
    /// Distance from the lens to the plane in focus, along the view axis, scene units.
    pub focal_distance: f64,
    /// Pixel reconstruction filter.
    pub filter: Filter,
}

/// A camera, ready to make rays.
#[derive(Clone, Copy, Debug)]
pub struct Camera<R: Real> {
    position: Vec3<R>,
    /// Unit, right, up and forward in the picture.
    axes: [Vec3<R>; 3],
    /// Size of a pixel on the plane at distance 1.
    pixel_size: R,
    half_width: R,
    half_height: R,
    aperture_radius: R,
    focal_distance: R,
    filter: Filter,
    size: [u32; 2],
}

impl<R: Real> Camera<R> {
    /// Checks the settings and computes the axes, in f64.
    ///
    /// # Errors
    /// [`CameraError`] says which setting makes no camera.
    pub fn new(settings: &CameraSettings) -> Result<Self, CameraError> {
        let CameraSettings { width, height, aperture_radius, focal_distance, field_of_view, .. } = *settings;
        let vectors = [settings.position, settings.look_at, settings.up];
        let filter_width = match settings.filter {
            Filter::Box(width) | Filter::Tent(width) | Filter::Gaussian(width) => width,
        };
        let scalars = [field_of_view, aperture_radius, focal_distance, filter_width];
        // Finite in the precision of the camera, too.
        if !vectors.iter().flatten().chain(&scalars).all(|&x| R::from_f64(x).is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if !(1..=65_535).contains(&width) || !(1..=65_535).contains(&height) {
            return Err(CameraError::Size);
        }
        if !(field_of_view > 0.0 && field_of_view < core::f64::consts::PI) {
            return Err(CameraError::FieldOfView);
        }
        if aperture_radius < 0.0 || (aperture_radius > 0.0 && focal_distance <= 0.0) {
            return Err(CameraError::Lens);
        }
        if filter_width < 0.0 {
            return Err(CameraError::Filter);
        }
        let [position, look_at, up] = vectors.map(glam::DVec3::from_array);
        let forward = normalize::<f64>(look_at - position);
        let side = forward.cross(normalize::<f64>(up));
        // Below this sine an up that was meant to be parallel differs by rounding alone.
        if !(forward.dot(forward) > 0.5 && side.dot(side) > 1e-24) {
            return Err(CameraError::Orientation);
        }
        let right = normalize::<f64>(side);
        let half_fov = libm::tan(field_of_view * 0.5);
        Ok(Self {
            position: vec3_from_f64::<R>(settings.position),
            axes: [right, right.cross(forward), forward].map(|axis| vec3_from_f64::<R>(axis.to_array())),
            pixel_size: R::from_f64(2.0 * half_fov / f64::from(width)),
            half_width: R::from_f64(f64::from(width) * 0.5),
            half_height: R::from_f64(f64::from(height) * 0.5),
            aperture_radius: R::from_f64(aperture_radius),
            focal_distance: R::from_f64(focal_distance),
            filter: settings.filter,
            size: [width, height],
        })
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The effects that this camera needs.
    pub fn required_effects(&self) -> Effects {
        Effects::LENS
            .when(self.aperture_radius > R::ZERO)
            .union(Effects::FILTER.when(!matches!(self.filter, Filter::Box(_))))
    }

    /// The ray of a sample of the pixel in column `x` and row `y`; `numbers` place it on the film and the lens.
    ///
    /// Its direction has length 1. Pixels mirrored about the middle get exactly mirrored offsets from the axis.
    #[inline]
    pub fn ray<E: EffectSet>(&self, x: u32, y: u32, numbers: [u32; 4]) -> Ray<R> {
        let [u, v, lens_u, lens_v] = numbers.map(R::from_unit_bits);
        self.ray_through::<E>([x, y], self.offset::<E>(u, v), [lens_u, lens_v])
    }

    /// Where on the film a sample is, from the middle of its pixel, pixels.
    #[inline(always)]
    pub(crate) fn offset<E: EffectSet>(&self, u: R, v: R) -> [R; 2] {
        match self.filter {
            Filter::Gaussian(stdev) if const { E::EFFECTS.contains(Effects::FILTER) } => {
                gaussian(u, v).map(|offset| offset * R::from_f64(stdev))
            }
            Filter::Tent(radius) if const { E::EFFECTS.contains(Effects::FILTER) } => {
                [u, v].map(|number| tent(number) * R::from_f64(radius))
            }
            Filter::Box(width) | Filter::Tent(width) | Filter::Gaussian(width) => {
                [u, v].map(|number| (number - R::from_f64(0.5)) * R::from_f64(width))
            }
        }
    }

    /// The ray through an [`Camera::offset`] from the middle of a pixel, and through a point of the lens.
    #[inline(always)]
    pub(crate) fn ray_through<E: EffectSet>(&self, [x, y]: [u32; 2], [dx, dy]: [R; 2], [u, v]: [R; 2]) -> Ray<R> {
        let half = R::from_f64(0.5);
        let across = (R::from_f64(f64::from(x)) + half - self.half_width + dx) * self.pixel_size;
        let down = (R::from_f64(f64::from(y)) + half - self.half_height + dy) * self.pixel_size;
        let [right, up, forward] = self.axes;
        let direction = right * across - up * down + forward;
        if const { E::EFFECTS.contains(Effects::LENS) } && self.aperture_radius > R::ZERO {
            let [lens_x, lens_y] = disk(u, v);
            let on_lens = (right * lens_x + up * lens_y) * self.aperture_radius;
            let toward_focus = direction * self.focal_distance - on_lens;
            return Ray::new(self.position + on_lens, normalize::<R>(toward_focus));
        }
        Ray::new(self.position, normalize::<R>(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Everything;
    use glam::Vec3 as V;

    const SETTINGS: CameraSettings = CameraSettings {
        position: [0.0, 0.0, 55.0],
        look_at: [0.0, 0.0, 0.0],
        up: [0.0, 1.0, 0.0],
        field_of_view: core::f64::consts::FRAC_PI_3,
        width: 64,
        height: 48,
        aperture_radius: 0.0,
        focal_distance: 55.0,
        filter: Filter::Box(0.0),
    };

    #[test]
    fn corners_mirror_exactly_and_row_0_is_on_top() {
        let camera = Camera::<f32>::new(&SETTINGS).unwrap();
        let d = |x, y| camera.ray::<Everything>(x, y, [0; 4]).direction;
        let corner = d(0, 0);
        assert!(corner.x < 0.0 && corner.y > 0.0 && corner.z < 0.0);
        assert_eq!(d(63, 0), V::new(-corner.x, corner.y, corner.z));
        assert_eq!(d(0, 47), V::new(corner.x, -corner.y, corner.z));
    }

    #[test]
    fn the_horizontal_field_of_view_is_between_the_outer_edges() {
        let camera = Camera::<f64>::new(&CameraSettings { filter: Filter::Box(1.0), ..SETTINGS }).unwrap();
        let left = camera.ray::<Everything>(0, 24, [0, 0, 0, 0]).direction;
        assert!((libm::atan2(-left.x, -left.z) - core::f64::consts::FRAC_PI_6).abs() < 1e-9);
    }

    #[test]
    fn rays_of_one_pixel_meet_in_the_plane_of_focus() {
        let camera = Camera::<f64>::new(&CameraSettings { aperture_radius: 1.5, ..SETTINGS }).unwrap();
        let meet = |numbers| {
            let ray = camera.ray::<Everything>(5, 7, numbers);
            ray.origin + ray.direction * ((0.0 - ray.origin.z) / ray.direction.z)
        };
        let a = meet([0, 0, 0, 0]);
        let b = meet([0, 0, 1 << 31, 3 << 30]);
        assert!((a - b).abs().max_component() < 1e-12, "{a} {b}");
    }

    #[test]
    fn settings_that_make_no_camera_are_named() {
        let error = |settings: CameraSettings| Camera::<f32>::new(&settings).unwrap_err();
        assert_eq!(error(CameraSettings { width: 0, ..SETTINGS }), CameraError::Size);
        assert_eq!(error(CameraSettings { field_of_view: f64::NAN, ..SETTINGS }), CameraError::NotFinite);
        assert_eq!(error(CameraSettings { field_of_view: 4.0, ..SETTINGS }), CameraError::FieldOfView);
        assert_eq!(error(CameraSettings { look_at: SETTINGS.position, ..SETTINGS }), CameraError::Orientation);
        assert_eq!(error(CameraSettings { up: [0.0, 0.0, 2.0], ..SETTINGS }), CameraError::Orientation);
        assert_eq!(error(CameraSettings { aperture_radius: -1.0, ..SETTINGS }), CameraError::Lens);
        assert_eq!(error(CameraSettings { filter: Filter::Tent(-1.0), ..SETTINGS }), CameraError::Filter);
    }
}
