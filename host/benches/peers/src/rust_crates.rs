//! The Rust crates: obvhs and parry3d, as their documentation uses them.

use std::time::Duration;

use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use parry3d::query::{Ray as ParryRay, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh};
use rayon::ThreadPoolBuilder;

use crate::isa::{Isa, Work};
use crate::measure::{repeat, seconds};
use crate::mesh::Mesh;
use crate::peer::{Answer, Peer, Ray, Row};

/// The rows that are wanted. Their loops are compiled for the most that this machine has.
pub(crate) fn rows(mesh: &Mesh, builds: usize, wanted: impl Fn(&str) -> bool) -> Result<Vec<Row<'static>>, String> {
    let isa = Isa::best();
    let wanted = |name| wanted(&Row::title(name, isa));
    let mut rows = Vec::new();
    let mut add = |name, build_seconds, bytes: usize, peer| {
        let bytes_per_triangle = bytes as f64 / mesh.triangles.len() as f64;
        rows.push(Row { name, isa, build_seconds, bytes_per_triangle, peer });
    };
    if wanted("obvhs 2-wide") {
        let (times, peer) = obvhs(mesh, builds, build_bvh2_from_tris)?;
        let bytes = size_of_val(peer.bvh.nodes.as_slice()) + peer.bytes();
        add("obvhs 2-wide", times, bytes, Box::new(peer) as Box<dyn Peer>);
    }
    if wanted("obvhs 8-wide") {
        let (times, peer) = obvhs(mesh, builds, build_cwbvh_from_tris)?;
        let bytes = size_of_val(peer.bvh.nodes.as_slice()) + peer.bytes();
        add("obvhs 8-wide", times, bytes, Box::new(peer));
    }
    if wanted("parry3d") {
        let (time, built) = repeat(builds, || {
            let (time, made) = seconds(1, || {
                let positions = mesh.positions.iter().map(|&position| position.into()).collect();
                TriMesh::new(positions, mesh.triangles.clone())
            });
            Ok((time, made.map_err(|error| error.to_string())?))
        })?;
        // It counts its copies of the mesh's own arrays.
        let bytes = built.heap_memory_size().saturating_sub(mesh.bytes());
        add("parry3d", [Some(time), None], bytes, Box::new(Parry(built)));
    }
    Ok(rows)
}

/// A hierarchy of obvhs with the triangles in the order of its leaves.
struct Obvhs<T> {
    bvh: T,
    triangles: Vec<RtTriangle>,
    order: Vec<u32>,
}

impl<T> Obvhs<T> {
    /// Of all but the nodes.
    fn bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice()) + size_of_val(self.order.as_slice())
    }
}

/// A hierarchy of obvhs, of two kinds.
trait Hierarchy: 'static {
    fn take_order(&mut self) -> Vec<u32>;
    fn closest(&self, ray: ObvhsRay, hit: &mut RayHit, test: impl FnMut(&ObvhsRay, usize) -> f32) -> bool;
    fn misses(&self, ray: ObvhsRay, test: impl FnMut(&ObvhsRay, usize) -> f32) -> bool;
}

macro_rules! hierarchies {
    ($($name:ident)*) => {$(
        impl Hierarchy for $name {
            fn take_order(&mut self) -> Vec<u32> {
                std::mem::take(&mut self.primitive_indices)
            }

            #[inline(always)]
            fn closest(&self, ray: ObvhsRay, hit: &mut RayHit, test: impl FnMut(&ObvhsRay, usize) -> f32) -> bool {
                self.ray_traverse(ray, hit, test)
            }

            #[inline(always)]
            fn misses(&self, ray: ObvhsRay, test: impl FnMut(&ObvhsRay, usize) -> f32) -> bool {
                self.ray_traverse_miss(ray, test)
            }
        }
    )*};
}

hierarchies! { Bvh2 CwBvh }

/// Builds with the crate's middle settings, which "try to be around the same build time as embree".
fn obvhs<T: Hierarchy + Send>(
    mesh: &Mesh,
    builds: usize,
    build: fn(&[Triangle], BvhBuildParams, &mut Duration) -> T,
) -> Result<([Option<f64>; 2], Obvhs<T>), String> {
    let ready = || {
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| mesh.positions[corner as usize].into());
        let triangles: Vec<Triangle> =
            mesh.triangles.iter().map(corners).map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect();
        let mut bvh = build(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let order = bvh.take_order();
        let triangles = order.iter().map(|&index| RtTriangle::from(&triangles[index as usize])).collect();
        Obvhs { bvh, triangles, order }
    };
    let on = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
        repeat(builds, || Ok(pool.install(|| seconds(threads, ready))))
    };
    let (on_two, _) = on(2)?;
    let (on_one, peer) = on(1)?;
    Ok(([Some(on_one), Some(on_two)], peer))
}

impl<T: Hierarchy> Peer for Obvhs<T> {
    fn closest(&self, rays: &[Ray], answers: &mut [Answer]) {
        Isa::best().run(Loop::<_, false> { peer: self, rays, answers });
    }

    fn any(&self, rays: &[Ray], answers: &mut [Answer]) {
        Isa::best().run(Loop::<_, true> { peer: self, rays, answers });
    }
}

struct Parry(TriMesh);

impl Peer for Parry {
    fn closest(&self, rays: &[Ray], answers: &mut [Answer]) {
        Isa::best().run(Loop::<_, false> { peer: self, rays, answers });
    }

    fn any(&self, rays: &[Ray], answers: &mut [Answer]) {
        Isa::best().run(Loop::<_, true> { peer: self, rays, answers });
    }
}

/// A loop over rays, for any hit or the closest.
struct Loop<'a, P, const ANY: bool> {
    peer: &'a P,
    rays: &'a [Ray],
    answers: &'a mut [Answer],
}

impl<T: Hierarchy, const ANY: bool> Work for Loop<'_, Obvhs<T>, ANY> {
    #[inline(always)]
    fn run<const ISA: u8>(self) {
        let Obvhs { bvh, triangles, order } = self.peer;
        let test = |ray: &ObvhsRay, at: usize| triangles[at].intersect(ray);
        for (ray, answer) in self.rays.iter().zip(self.answers) {
            let ray = ObvhsRay::new(ray.origin.into(), ray.direction.into(), ray.tnear, ray.tfar);
            *answer = if ANY {
                Answer::any(!bvh.misses(ray, test))
            } else {
                let mut hit = RayHit::none();
                match bvh.closest(ray, &mut hit, test) {
                    true => Answer { t: hit.t, primitive: order[hit.primitive_id as usize], ..Answer::MISS },
                    false => Answer::MISS,
                }
            };
        }
    }
}

impl<const ANY: bool> Work for Loop<'_, Parry, ANY> {
    #[inline(always)]
    fn run<const ISA: u8>(self) {
        let mesh = &self.peer.0;
        for (ray, answer) in self.rays.iter().zip(self.answers) {
            let tfar = ray.tfar;
            let ray = ParryRay::new(ray.origin.into(), ray.direction.into());
            *answer = if ANY {
                // It has no query for any hit; one that counts as zero away ends the search for a closer one.
                let test = |at, _| mesh.triangle(at).cast_local_ray(&ray, tfar, false).map(|_| 0.0);
                Answer::any(mesh.bvh().cast_ray(&ray, tfar, test).is_some())
            } else {
                match CompositeShapeRef(mesh).cast_local_ray(&ray, tfar, false) {
                    Some((primitive, t)) => Answer { t, primitive, ..Answer::MISS },
                    None => Answer::MISS,
                }
            };
        }
    }
}
