//! The builder on any spheres and triangles: the hierarchy keeps its promises, and changes no bit of an answer.

use std::collections::BTreeSet;

use crate::numbers::{AnyRay, Float, Number, vector};
use arbitrary::{Arbitrary, Result, Unstructured};
use ocellus_kernel::bvh::{self, Branch, BuildItem, Bvh, BvhSlices, Child, MAX_DEPTH, Node, Structure, required_nodes};
use ocellus_kernel::real::{Real, Vec3, Vector};
use ocellus_kernel::shape::{Geometry, Sphere, SphereQuad, TriangleQuad};
use ocellus_kernel::{Everything, Hit, Ray};

/// Enough for several levels, few enough for thousands of scenes a second.
const MOST_PRIMITIVES: usize = 300;

/// A sphere or a triangle, and copies of it.
#[derive(Debug)]
struct Shape {
    is_sphere: bool,
    /// Corners; of a sphere the centre, and the radius in the first number of the second row.
    numbers: [[Number; 3]; 3],
    copies: u8,
    /// What all coordinates of each copy are multiplied by: chains of shrinking boxes make deep trees.
    factor: Number,
}

impl<'a> Arbitrary<'a> for Shape {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> Result<Self> {
        let kind: u8 = bytes.arbitrary()?;
        let is_sphere = kind % 2 == 1;
        let copied = kind >= 192;
        let (copies, factor) = if copied { bytes.arbitrary()? } else { (0, Number::Grid(8)) };
        let first = bytes.arbitrary()?;
        let others = if is_sphere {
            [[bytes.arbitrary()?, Number::Grid(0), Number::Grid(0)], [Number::Grid(0); 3]]
        } else {
            bytes.arbitrary()?
        };
        Ok(Self { is_sphere, numbers: [first, others[0], others[1]], copies: copies % 128, factor })
    }
}

#[derive(Debug)]
struct Case {
    shapes: Vec<Shape>,
    rays: Vec<AnyRay>,
}

impl<'a> Arbitrary<'a> for Case {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> Result<Self> {
        let [shapes, rays]: [u8; 2] = bytes.arbitrary()?;
        let shapes = (0..shapes % 32).map(|_| bytes.arbitrary()).collect::<Result<_>>()?;
        let rays = (0..1 + rays % 16).map(|_| bytes.arbitrary()).collect::<Result<_>>()?;
        Ok(Self { shapes, rays })
    }
}

/// Checks the scene that `data` describes, in both precisions.
pub fn check(data: &[u8]) {
    // Bytes that run out are zeros, so there is always a case.
    let Ok(case) = Case::arbitrary(&mut Unstructured::new(data)) else { return };
    check_in::<f32>(&case);
    check_in::<f64>(&case);
}

fn check_in<R: Float>(case: &Case) {
    let (mut spheres, mut positions, mut triangles) = (Vec::new(), Vec::<Vec3<R>>::new(), Vec::new());
    for shape in &case.shapes {
        let factor = shape.factor.real::<R>();
        let mut rows = shape.numbers.map(vector::<R>);
        for _ in 0..=shape.copies {
            if spheres.len() + triangles.len() == MOST_PRIMITIVES {
                break;
            }
            if shape.is_sphere {
                let sphere = Sphere { center: rows[0], radius: rows[1].x(), material: 0, inverted: false };
                let usable = rows[0].is_finite() && rows[1].x().is_finite() && rows[1].x() > R::ZERO;
                assert_eq!(Geometry::new(&[sphere], &[], &[]).is_ok(), usable, "{sphere:?}");
                spheres.extend(usable.then_some(sphere));
            } else {
                let first = positions.len() as u32;
                positions.extend(rows);
                triangles.push([first, first + 1, first + 2]);
            }
            rows = rows.map(|row| row * factor);
        }
    }
    let geometry = Geometry::new(&spheres, &positions, &triangles).expect("what it takes");
    let points: Vec<Vec3<R>> = spheres.iter().map(|sphere| sphere.center).chain(positions.iter().copied()).collect();
    let rays: Vec<Ray<R>> = case.rays.iter().map(|ray| ray.ray(&points)).collect();
    let expected: Vec<_> = rays.iter().map(|ray| answer(&geometry, None, ray)).collect();
    for structure in [Structure::Box, Structure::Bvh] {
        let mut nodes = vec![Node::EMPTY; structure.required_nodes(&geometry)];
        let mut sphere_quads = vec![SphereQuad::EMPTY; spheres.len()];
        let mut triangle_quads = vec![TriangleQuad::EMPTY; triangles.len()];
        let mut scratch = vec![BuildItem::EMPTY; geometry.len()];
        let slices =
            BvhSlices { nodes: &mut nodes, sphere_quads: &mut sphere_quads, triangle_quads: &mut triangle_quads };
        let bvh = bvh::build(&geometry, structure, slices, &mut scratch).expect("room for all");
        check_hierarchy(&geometry, &bvh);
        for (ray, expected) in rays.iter().zip(&expected) {
            let found = answer(&geometry, Some(&bvh), ray);
            assert_eq!(&found, expected, "{structure:?}\n{ray:?}\n{spheres:?}\n{positions:?}");
        }
    }
}

/// The closest hit as bits, so that NaN and -0 would show, whether there is any, and all crossings.
type Answer = (Option<([u64; 3], u32)>, bool, Vec<([u64; 3], u32)>);

fn answer<R: Real>(geometry: &Geometry<'_, R>, bvh: Option<&Bvh<'_, R>>, ray: &Ray<R>) -> Answer {
    let hit = bvh::intersect::<R, Everything>(geometry, bvh, ray);
    let occluded = bvh::occluded::<R, Everything>(geometry, bvh, ray);
    assert_eq!(hit.is_some(), occluded, "{ray:?}");
    assert!(hit.is_none() || ray.is_valid(), "an invalid ray hits: {ray:?} {hit:?}");
    if let Some(hit) = &hit {
        assert!(hit.t > ray.tmin && hit.t <= ray.tmax, "{ray:?} {hit:?}");
    }
    let bits = |hit: Hit<R>| ([hit.t, hit.u, hit.v].map(|x| x.to_f64().to_bits()), hit.primitive);
    let mut crossings = Vec::new();
    bvh::crossings::<R, Everything>(geometry, bvh, ray, |hit| {
        assert!(hit.t > ray.tmin && hit.t <= ray.tmax && ray.is_valid(), "{ray:?} {hit:?}");
        crossings.push(bits(hit));
    });
    crossings.sort_unstable();
    (hit.map(bits), occluded, crossings)
}

/// Every primitive is in one leaf, no deeper than traversal has a stack for.
fn check_hierarchy<R: Real>(geometry: &Geometry<'_, R>, bvh: &Bvh<'_, R>) {
    assert!(bvh.nodes().len() <= required_nodes(geometry.len()));
    let mut times = vec![0; geometry.len()];
    let mut visited = 0;
    let mut waiting = if bvh.nodes().is_empty() { vec![] } else { vec![(0, 1)] };
    while let Some((at, depth)) = waiting.pop() {
        assert!(depth <= MAX_DEPTH, "{depth}");
        visited += 1;
        let node = &bvh.nodes()[at];
        for Branch { primitives: count, child, .. } in bvh.children(node) {
            let primitives: BTreeSet<u32> = match child {
                Child::Node(child) => {
                    waiting.push((child, depth + 1));
                    continue;
                }
                Child::Triangles(range) => {
                    bvh.triangle_quads()[range].iter().flat_map(|quad| quad.triangles()).map(|found| found.0).collect()
                }
                Child::Spheres(range) => bvh.sphere_quads()[range].iter().flat_map(|quad| *quad.primitives()).collect(),
            };
            assert_eq!(primitives.len(), count);
            primitives.iter().for_each(|&primitive| times[primitive as usize] += 1);
        }
    }
    assert_eq!(visited, bvh.nodes().len());
    assert!(times.iter().all(|&times| times == 1), "a primitive is not in exactly one leaf: {times:?}");
}
