//! From a hit to a surface point, as detailed as the effect set asks.

use crate::effects::{EffectSet, Effects};
use crate::ray::{Hit, Ray};
use crate::real::{Real, Vec3, Vector, narrow};
use crate::robust::{normalize, normalize_wide, triangle_point_error};
use crate::scene::Scene;
use crate::shape::triangle::normal;

/// Everything that shading needs to know about a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<R: Real> {
    /// Position, scene units.
    pub p: Vec3<R>,
    /// Bound on the error of each component of `p`.
    pub p_error: Vec3<R>,
    /// Geometric normal: unit, to the front.
    pub ng: Vec3<R>,
    /// Shading normal: unit, on the side of `ng`.
    pub ns: Vec3<R>,
    /// Texture coordinates, v up; 0 where there are none.
    pub uv: [R; 2],
    /// Unit direction back to where the ray came from.
    pub wo: Vec3<R>,
    /// Index of the material.
    pub material: u32,
}

impl<R: Real> SurfacePoint<R> {
    /// Geometric and shading normal on the side of `wo`. A shading normal that faces away is replaced.
    #[inline(always)]
    pub fn toward_viewer<E: EffectSet>(&self) -> Facing<R> {
        let front = !(self.wo.dot(self.ng) < R::ZERO);
        let side = if front { R::ONE } else { -R::ONE };
        let ng = self.ng * side;
        if const { !E::EFFECTS.contains(Effects::SMOOTH_NORMALS) } {
            return Facing { ng, ns: ng, front };
        }
        let ns = self.ns * side;
        Facing { front, ng, ns: if self.wo.dot(ns) > R::ZERO { ns } else { ng } }
    }
}

/// The normals of a surface point on the viewer's side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing<R: Real> {
    /// Whether the viewer is in front.
    pub front: bool,
    /// Geometric normal.
    pub ng: Vec3<R>,
    /// Shading normal.
    pub ns: Vec3<R>,
}

/// The surface point of `hit`, a hit of `ray` in `scene`. The ray's direction must have length 1, since `wo` is its
/// opposite.
#[inline(always)]
pub(crate) fn surface_point<R: Real, E: EffectSet>(
    scene: &Scene<'_, R>,
    ray: &Ray<R>,
    hit: &Hit<R>,
) -> SurfacePoint<R> {
    let geometry = scene.geometry();
    let at = hit.primitive as usize;
    let wo = -ray.direction;
    let is_sphere =
        match (const { E::EFFECTS.contains(Effects::SPHERES) }, const { E::EFFECTS.contains(Effects::TRIANGLES) }) {
            (true, true) => at < geometry.spheres().len(),
            (spheres_only, _) => spheres_only,
        };
    if is_sphere {
        let sphere = &geometry.spheres()[at];
        let point = sphere.point_at(ray, hit.t);
        let ng = if sphere.inverted { -point.outward } else { point.outward };
        return SurfacePoint {
            p: point.p,
            p_error: point.p_error,
            ng,
            ns: ng,
            uv: [R::ZERO; 2],
            wo,
            material: sphere.material,
        };
    }

    let triangle = at - geometry.spheres().len();
    let attributes = &scene.attributes()[triangle];
    let corners = geometry.corners(at);
    let weights = [R::ONE - hit.u - hit.v, hit.u, hit.v];
    let ng = narrow::<R>(normalize_wide::<R>(normal::<R>(&corners)));
    let terms: [Vec3<R>; 3] = core::array::from_fn(|corner| corners[corner] * weights[corner]);
    let p = terms[0] + terms[1] + terms[2];
    let p_error = triangle_point_error::<R>(terms[0].abs() + terms[1].abs() + terms[2].abs(), &corners);
    let mut point = SurfacePoint { p, p_error, ng, ns: ng, uv: [R::ZERO; 2], wo, material: attributes.material };
    if const { E::EFFECTS.contains(Effects::SMOOTH_NORMALS) }
        && let Some(normals) = attributes.normals
    {
        let [a, b, c] = normals.map(|normal| scene.normals()[normal as usize]);
        let ns = normalize::<R>(a * weights[0] + b * weights[1] + c * weights[2]);
        let along = ns.dot(ng);
        // Zero or NaN keeps the geometric normal.
        if along > R::ZERO {
            point.ns = ns;
        } else if along < R::ZERO {
            point.ns = -ns;
        }
    }
    if const { E::EFFECTS.contains(Effects::TEXTURES) }
        && let Some(uvs) = attributes.uvs
    {
        let [a, b, c] = uvs.map(|uv| scene.uvs()[uv as usize]);
        point.uv = core::array::from_fn(|i| a[i] * weights[0] + b[i] * weights[1] + c[i] * weights[2]);
    }
    point
}
