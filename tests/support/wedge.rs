//! Two flat walls that meet, and the light at their seam.

use ocellus_kernel::bvh::Structure;
use ocellus_kernel::path::{PathOptions, radiance};
use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::robust::normalize;
use ocellus_kernel::sampler::AddressedSampler;
use ocellus_kernel::{EffectSet, Ray};

use super::meshes::Mesh;
use super::random::Random;
use super::scene::{OwnedScene, v};

/// Angles at which walls meet, degrees.
pub(crate) const WEDGES: [f64; 3] = [90.0, 30.0, 1.0];

/// Two grey walls anywhere that meet at an angle, one of them perhaps `round`, a lamp between them, and a ray from between
/// them that is aimed at their seam.
pub(crate) fn wedge<R: Real>(random: &mut Random, degrees: f64, round: bool) -> (OwnedScene<R>, Ray<R>) {
    let half = 0.5 * degrees.to_radians();
    let far = libm::exp(random.between(0.0, 6.0));
    let center = random.in_cube().map(|x| x * far);
    let at = |p: [f64; 3]| std::array::from_fn(|i| center[i] + p[i]);
    let mut between = || {
        let (distance, angle) = (10.0 * random.between(0.1, 1.0), half * random.between(-0.9, 0.9));
        at([distance * libm::sin(angle), distance * libm::cos(angle), random.between(-1.0, 1.0)])
    };
    let (eye, lamp) = (between(), between());
    let along = random.between(-1.0, 1.0);
    let target = v::<R>(at([0.0, 0.0, along]));
    let end = |side: f64, z: f64| at([side * 20.0 * libm::sin(half), 20.0 * libm::cos(half), z]);
    // A round wall only touches the seam: the flat one has to go on into it.
    let beyond = if round { 20.0 } else { 0.0 };
    let seam = [-20.0, 20.0].map(|z| at([beyond * libm::sin(half), -beyond * libm::cos(half), z]));
    let positions = vec![seam[0], seam[1], end(-1.0, -20.0), end(-1.0, 20.0), end(1.0, -20.0), end(1.0, 20.0)];
    let triangles = [[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5]][..if round { 2 } else { 4 }].to_vec();
    let mut scene = OwnedScene::<R>::default();
    let grey = scene.diffuse(0.5, 0.0);
    scene.mesh(&Mesh { positions, triangles }, grey);
    if round {
        let radius = libm::exp(random.between(3.0, 9.0));
        scene.sphere(at([radius * libm::cos(half), -radius * libm::sin(half), along]), radius, grey);
    }
    scene.point_light(lamp, 1.0);
    let eye = v::<R>(eye);
    (scene, Ray::new(eye, normalize::<R>(target - eye)))
}

/// The light of lamps that the surface sends back along `ray`.
pub(crate) fn direct_light<R: Real, E: EffectSet>(
    scene: &OwnedScene<R>,
    structure: Option<Structure>,
    ray: Ray<R>,
) -> f64 {
    let options = PathOptions { max_bounces: 1, indirect: false, ..PathOptions::default() };
    let mut numbers = AddressedSampler::new(1, 0, 0, 0);
    scene.lend(structure, |scene| radiance::<R, E>(scene, &options, ray, &mut numbers).radiance.x().to_f64())
}
