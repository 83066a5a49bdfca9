//! What each alternative of the kernel's accuracy loses: rays that go wrong, and the worst error.
//!
//! The same inputs that the robust choice has to get right. `cargo bench -p ocellus-tests --bench prices` prints this
//! beside what each alternative saves.

use ocellus::kernels::{FastTriangles, NarrowSpheres, NarrowTriangles, UnpaddedBoxes, WideTriangles};
use ocellus_kernel::accuracy::RayOffset;
use ocellus_kernel::bvh::Structure;
use ocellus_kernel::material::fresnel::{Fresnel, Interface, reflectance};
use ocellus_kernel::path::{PathOptions, radiance};
use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::sampler::AddressedSampler;
use ocellus_kernel::shape::Sphere;
use ocellus_kernel::{Accuracy, EffectSet, Effects, Everything, Ray};

use super::random::Random;
use super::rays::{
    VANISHING, box_case, closed_meshes, flat_box, magnitude, ray_at_mesh, ray_in_box, sphere_case, sphere_truth,
    triangle_case, triangle_truth,
};
use super::scene::{OwnedScene, corners, one_material, one_triangle, v};
use super::tolerance::{self, u};
use super::wedge::{WEDGES, direct_light, wedge};

/// What came of the trials of one class.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Loss {
    pub(crate) trials: u64,
    /// Answers that are not merely inexact but wrong.
    pub(crate) failures: u64,
    /// Worst error of those that are right; 0 where nothing is measured.
    pub(crate) worst: f64,
}

impl Loss {
    fn holds(&mut self, success: bool) {
        self.trials += 1;
        self.failures += u64::from(!success);
    }

    fn error(&mut self, error: f64) {
        self.worst = self.worst.max(error);
    }
}

/// One class of inputs under one value of one choice.
pub(crate) struct Row {
    /// As on the command line.
    pub(crate) option: &'static str,
    pub(crate) class: &'static str,
    /// Limit of the worst error, and its unit; none where there are only right and wrong answers.
    pub(crate) limit: Option<(f64, &'static str)>,
    /// Whether it is within the limit without a failure: promised of the robust values, and known of the others.
    pub(crate) keeps: bool,
    pub(crate) measure: fn(u32) -> Loss,
}

impl Row {
    /// Whether there is no failure, and no error beyond the limit.
    pub(crate) fn is_kept(&self, loss: &Loss) -> bool {
        loss.failures == 0 && self.limit.is_none_or(|(limit, _)| loss.worst <= limit)
    }
}

/// The robust value of every choice, and each alternative.
pub(crate) fn rows<R: Real>() -> Vec<Row> {
    let wider = !R::WIDE_IS_SELF;
    let leaks = "rays at closed meshes";
    let triangles = "t of triangles";
    let plane = Some((tolerance::TRIANGLE_T, "u M"));
    // The problem's own roundings in the kernel's precision.
    let conditioned = Some((tolerance::by_precision::<R>(tolerance::ROUNDED, tolerance::SPHERE_T), "u cond"));
    let row = |option, class, limit, keeps, measure| Row { option, class, limit, keeps, measure };
    let fresnel = Some((tolerance::reflected_share::<R>(), ""));
    vec![
        row("--triangle-test watertight", leaks, None, true, mesh_leaks::<R, Everything>),
        row("--triangle-test fast", leaks, None, false, mesh_leaks::<R, FastTriangles>),
        row("--triangle-test narrow", leaks, None, true, mesh_leaks::<R, NarrowTriangles>),
        row("--triangle-test wide", leaks, None, true, mesh_leaks::<R, WideTriangles>),
        row("--triangle-test watertight", triangles, plane, true, triangle_errors::<R, Everything>),
        row("--triangle-test fast", triangles, plane, false, triangle_errors::<R, FastTriangles>),
        row("--triangle-test narrow", triangles, plane, false, triangle_errors::<R, NarrowTriangles>),
        row("--triangle-test wide", triangles, plane, true, triangle_errors::<R, WideTriangles>),
        row("--slab-test padded", "triangles in their boxes", None, true, box_losses::<R, Everything>),
        row("--slab-test unpadded", "triangles in their boxes", None, false, box_losses::<R, UnpaddedBoxes>),
        row("--sphere-test wide", "t of spheres", conditioned, true, sphere_errors::<R, Everything>),
        row("--sphere-test narrow", "t of spheres", conditioned, !wider, sphere_errors::<R, NarrowSpheres>),
        row("--ray-offset cleared", "rays that leave a plane", None, true, self_hits::<R, Cleared>),
        row("--ray-offset bounded", "rays that leave a plane", None, true, self_hits::<R, Bounded>),
        row("--ray-offset constant", "rays that leave a plane", None, !wider, self_hits::<R, Constant>),
        row("--ray-offset cleared", "rays in a flat box", None, true, box_escapes::<R, Cleared>),
        // Where its walls meet, once in some 30,000 rays of f32.
        row("--ray-offset bounded", "rays in a flat box", None, !wider, |count| {
            box_escapes::<R, Bounded>(count.max(1_000_000))
        }),
        row("--ray-offset constant", "rays in a flat box", None, false, box_escapes::<R, Constant>),
        row("--ray-offset cleared", "light at seams", None, true, dark_seams::<R, Cleared>),
        row("--ray-offset bounded", "light at seams", None, false, dark_seams::<R, Bounded>),
        row("--ray-offset constant", "light at seams", None, false, dark_seams::<R, Constant>),
        row("--fresnel exact", "reflected share", fresnel, true, fresnel_errors::<R, { Fresnel::Exact as u8 }>),
        row("--fresnel schlick", "reflected share", fresnel, false, fresnel_errors::<R, { Fresnel::Schlick as u8 }>),
        row("--fresnel none", "reflected share", fresnel, false, fresnel_errors::<R, { Fresnel::None as u8 }>),
    ]
}

/// N9. Rays from inside of closed meshes that meet nothing.
fn mesh_leaks<R: Real, E: EffectSet>(count: u32) -> Loss {
    let mut loss = Loss::default();
    let mut meshes = closed_meshes();
    // Where products of coordinates vanish, all rays leave without f64: that is known, and would hide the rest.
    meshes.retain(|(name, ..)| *name != VANISHING);
    for (_, mesh, center, radius) in &meshes {
        let mut random = Random::new(15);
        let mut scene = one_material::<R>();
        scene.mesh(mesh, 0);
        scene.lend(Some(Structure::Bvh), |scene| {
            for i in 0..count.div_ceil(meshes.len() as u32) {
                let of_mesh = |triangle| corners(scene.geometry(), triangle);
                let ray = ray_at_mesh::<R>(&mut random, i, *center, *radius, of_mesh, mesh.triangles.len());
                loss.holds(scene.intersect_in::<E>(&ray).is_some());
            }
        });
    }
    loss
}

/// N13. The error of t of one triangle, and clear hits and misses that are taken for the other.
fn triangle_errors<R: Real, E: EffectSet>(count: u32) -> Loss {
    let mut random = Random::new(12);
    let mut loss = Loss::default();
    // Exact arithmetic takes its time.
    for _ in 0..count / 10 {
        let (corners, origin, direction) = triangle_case(&mut random);
        let corners = corners.map(v::<R>);
        let ray = Ray::<R>::new(v::<R>(origin), v::<R>(direction));
        let Some(truth) = triangle_truth(&corners, &ray) else { continue };
        let hit = one_triangle(corners).lend(None, |scene| scene.intersect_in::<E>(&ray));
        let lost = hit.is_none() && truth.inside > tolerance::TRIANGLE_EDGE && !truth.behind;
        let made_up = hit.is_some() && (truth.inside < -tolerance::TRIANGLE_EDGE || truth.behind);
        loss.holds(!lost && !made_up);
        if let Some(hit) = hit {
            loss.error(truth.error(hit.t));
        }
    }
    loss
}

/// N6. Triangles that are hit, and lost because their own boxes are missed.
fn box_losses<R: Real, E: EffectSet>(count: u32) -> Loss {
    let mut random = Random::new(16);
    let mut loss = Loss::default();
    for case in 0..count {
        let (corners, ray) = box_case::<R>(&mut random, case);
        let prepared = ocellus_kernel::shape::PreparedRay::new(&ray);
        if ocellus_kernel::shape::triangle::intersect(&corners, &prepared, ray.tmax).is_some() {
            loss.holds(one_triangle(corners).lend(None, |scene| scene.intersect_in::<E>(&ray).is_some()));
        }
    }
    loss
}

/// N16 to N20. The error of t of one sphere, and clear hits and misses that are taken for the other.
fn sphere_errors<R: Real, E: EffectSet>(count: u32) -> Loss {
    let mut random = Random::new(11);
    let mut loss = Loss::default();
    for _ in 0..count / 10 {
        let (_, center, radius, origin, direction) = sphere_case(&mut random, u::<R>());
        let [center, origin, direction] = [center, origin, direction].map(v::<R>);
        let (ray, radius) = (Ray::<R>::new(origin, direction), R::from_f64(radius));
        let Some(truth) = sphere_truth(center, radius, &ray) else { continue };
        let mut scene = one_material::<R>();
        scene.spheres.push(Sphere { center, radius, material: 0, inverted: false });
        let hit = scene.lend(None, |scene| scene.intersect_in::<E>(&ray));
        loss.holds(hit.is_some() == truth.t.is_some());
        if let (Some(hit), Some(t)) = (hit, truth.t) {
            loss.error((hit.t.to_f64() - t).abs() / (u::<R>() * truth.condition));
        }
    }
    loss
}

macro_rules! with_offset {
    ($name:ident $offset:ident) => {
        #[derive(Clone, Copy)]
        struct $name;

        impl EffectSet for $name {
            const EFFECTS: Effects =
                Effects::TRIANGLES.union(Effects::BACKGROUND).union(Effects::POINT_LIGHT).union(Effects::INDIRECT);
            const ACCURACY: Accuracy = Accuracy { offset: RayOffset::$offset, ..Accuracy::ROBUST };
        }
    };
}

with_offset!(Cleared Cleared);
with_offset!(Bounded Bounded);
with_offset!(Constant Constant);

/// The light that a path of one bounce from `ray` finds, in a scene before a background of 1.
fn one_bounce<R: Real, E: EffectSet>(scene: &mut OwnedScene<R>, ray: Ray<R>, sample: u32) -> f64 {
    scene.background = [1.0; 3];
    let options = PathOptions { max_bounces: 1, ..PathOptions::default() };
    let mut numbers = AddressedSampler::new(1, 0, 0, sample);
    scene.lend(None, |scene| radiance::<R, E>(scene, &options, ray, &mut numbers).radiance.x().to_f64())
}

/// N21. Paths of one bounce off a grey triangle of any size, which see the background or else the triangle again.
fn self_hits<R: Real, E: EffectSet>(count: u32) -> Loss {
    let mut random = Random::new(21);
    let mut loss = Loss::default();
    for sample in 0..count {
        let size = magnitude(&mut random, -4.0, 6.0);
        let far = if random.below(2) == 0 { 0.0 } else { size * magnitude(&mut random, 0.0, 5.0) };
        let center = random.in_cube().map(|x| x * far);
        let positions: [[f64; 3]; 3] = std::array::from_fn(|_| {
            let offset = random.in_cube();
            std::array::from_fn(|i| center[i] + size * offset[i])
        });
        let mut scene = one_triangle(positions.map(v::<R>));
        let weights = random.barycentric();
        let target: [f64; 3] = std::array::from_fn(|i| (0..3).map(|k| positions[k][i] * weights[k]).sum());
        let toward = random.on_sphere();
        let origin: [f64; 3] = std::array::from_fn(|i| target[i] - size * toward[i]);
        let ray = Ray::new(v::<R>(origin), ocellus_kernel::robust::normalize::<R>(v::<R>(toward)));
        // The light is 1 beside the triangle, half of it from the triangle, and nothing from a ray that meets it again.
        let light = one_bounce::<R, E>(&mut scene, ray, sample);
        if light != 1.0 {
            loss.holds(light == 0.5);
        }
    }
    loss
}

/// N23. Paths of one bounce in a closed box that is flat, down to 64 ulps of its largest coordinate: no light gets in.
fn box_escapes<R: Real, E: EffectSet>(count: u32) -> Loss {
    let mut random = Random::new(23);
    let mut loss = Loss::default();
    for sample in 0..count {
        let mut scene = one_material::<R>();
        scene.mesh(&flat_box::<R>(&mut random, 1), 0);
        let ray = ray_in_box::<R>(&mut random, &scene.positions);
        loss.holds(one_bounce::<R, E>(&mut scene, ray, sample) == 0.0);
    }
    loss
}

/// N24. Seams of two walls that a lamp between them does not light.
fn dark_seams<R: Real, E: EffectSet>(count: u32) -> Loss {
    let mut random = Random::new(42);
    let mut loss = Loss::default();
    for case in 0..count as usize {
        let (scene, ray) = wedge::<R>(&mut random, WEDGES[case % WEDGES.len()], false);
        loss.holds(direct_light::<R, E>(&scene, None, ray) != 0.0);
    }
    loss
}

/// N32. The share of light that glass of index 1.5 reflects, both ways, at any angle.
fn fresnel_errors<R: Real, const MODEL: u8>(count: u32) -> Loss {
    let models = [Fresnel::None, Fresnel::Schlick, Fresnel::Exact];
    let model = models.into_iter().find(|model| *model as u8 == MODEL).expect("a model");
    let mut random = Random::new(32);
    let mut loss = Loss::default();
    for case in 0..count {
        let (ior_i, ior_t) = if case % 2 == 0 { (1.0, 1.5) } else { (1.5, 1.0) };
        let sine_t = random.unit().sqrt() * f64::min(1.0, ior_i / ior_t);
        let sine_i = sine_t * ior_t / ior_i;
        let [cos_i, cos_t] = [sine_i, sine_t].map(|sine| (1.0 - sine * sine).max(0.0).sqrt());
        // Unpolarised light by its angles (Born and Wolf, section 1.5.2, equation 34).
        let [angle_i, angle_t] = [sine_i, sine_t].map(libm::asin);
        let (apart, together) = (angle_i - angle_t, angle_i + angle_t);
        let shares = [libm::sin(apart) / libm::sin(together), libm::tan(apart) / libm::tan(together)];
        let exact = 0.5 * (shares[0] * shares[0] + shares[1] * shares[1]);
        let [cos_i, cos_t, ior_i, ior_t] = [cos_i, cos_t, ior_i, ior_t].map(|x| R::from_f64(x).widen());
        let found = reflectance(model, &Interface { cos_i, cos_t, ior_i, ior_t }).to_f64();
        loss.holds(found.is_finite());
        loss.error((found - exact).abs());
    }
    loss
}
