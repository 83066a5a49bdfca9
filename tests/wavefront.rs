//! Paths that are followed side by side have the same bits as paths alone.

use ocellus_kernel::camera::CameraSettings;
use ocellus_kernel::light::LightSampling;
use ocellus_kernel::material::Fresnel;
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::{Camera, EffectSet, Effects, Everything, Pixel, SamplerKind, View, Work};

use crate::effects::{Case, Visit, all, for_each_case};
use crate::support::in_both_precisions;
use crate::support::scene::{CAMERA, OwnedScene, STRUCTURES, v};

in_both_precisions!(every_effect_alone_and_all_together, options_and_stretches_of_any_length, scenes_of_any_scale,);

/// The picture and the work of a case both ways, for a number of pixels and samples.
fn both_ways<R: Real, E: EffectSet>(view: &View<'_, R>, pixels: usize, samples: std::ops::Range<u32>) {
    let [width, height] = view.camera.size();
    for y in [0, height / 2, height - 1] {
        let stretch = || vec![Pixel::EMPTY; pixels.min(width as usize)];
        let (mut alone, mut side_by_side) = (stretch(), stretch());
        let work: [Work; 2] = [
            view.render::<E>(0, y, samples.clone(), &mut alone),
            view.render_wavefront::<E>(0, y, samples.clone(), &mut side_by_side),
        ];
        assert_eq!(work[0], work[1], "row {y}");
        assert!(alone == side_by_side, "row {y}: {:?}", view.required_effects().names().collect::<Vec<_>>());
    }
}

/// [`both_ways`] with each structure.
fn check<R: Real, E: EffectSet>(case: &Case<R>, pixels: usize, samples: std::ops::Range<u32>) {
    let camera = Camera::new(&case.settings).expect("a camera");
    for structure in STRUCTURES {
        case.scene.lend(structure, |scene| {
            let view = View { scene, camera: &camera, options: &case.options };
            both_ways::<R, E>(&view, pixels, samples.clone());
        });
    }
}

struct Check;

impl<R: Real> Visit<R> for Check {
    fn visit<E: EffectSet>(&mut self, _: Effects, case: &Case<R>) {
        check::<R, E>(case, usize::MAX, 0..8);
    }
}

fn every_effect_alone_and_all_together<R: Real>() {
    for_each_case::<R>(Check);
    check::<R, Everything>(&all::<R>(), usize::MAX, 0..16);
}

fn options_and_stretches_of_any_length<R: Real>() {
    let Case { scene, settings, options } = all::<R>();
    let plain = PathOptions { sampler: SamplerKind::Independent, aim: false, roulette_after: None, ..options };
    for options in [
        plain,
        PathOptions { max_bounces: 0, ..plain },
        PathOptions { max_bounces: 1, ..plain },
        PathOptions { indirect: false, ..plain },
        PathOptions { light_sampling: LightSampling::None, ..plain },
        PathOptions { light_sampling: LightSampling::Hemisphere, ..plain },
        PathOptions { fresnel: Fresnel::None, roulette_after: Some(0), ..plain },
        PathOptions { fresnel: Fresnel::Schlick, aim: true, ..plain },
    ] {
        check::<R, Everything>(&Case { scene: scene.clone(), settings, options }, 16, 0..16);
    }
    // No sample, one, fewer than there are lanes, and so many that those that end early have to wait.
    for (pixels, samples) in [(3, 5..5), (0, 0..9), (1, 7..8), (5, 2..9), (2, 0..2000)] {
        check::<R, Everything>(&Case { scene: scene.clone(), settings, options: plain }, pixels, samples);
    }
    // Nothing that shines: paths that end before they start.
    let mut dark = OwnedScene::<R>::default();
    let grey = dark.diffuse(0.5, 0.0);
    dark.sphere([0.0; 3], 1.0, grey);
    let options = PathOptions { max_bounces: 0, ..plain };
    check::<R, Everything>(&Case { scene: dark, settings, options }, 16, 0..2);
}

/// Balls of glass and mirrors in a room of huge spheres, at a scale.
fn room<R: Real>(scale: f64) -> Case<R> {
    let mut scene = OwnedScene::<R>::default();
    let [wall, glass, mirror] = [scene.diffuse(0.7, 0.0), scene.glass(1.5, 1.0, [1.0; 3]), scene.mirror(0.9)];
    let at = |p: [f64; 3]| p.map(|x| x * scale);
    for axis in 0..3 {
        for side in [-1000.0, 1000.0] {
            let mut center = [0.0; 3];
            center[axis] = side;
            scene.sphere(at(center), 996.0 * scale, wall);
        }
    }
    scene.sphere(at([-1.2, -1.0, 0.0]), scale, glass);
    let hollow = scene.sphere(at([-1.2, -1.0, 0.0]), 0.9 * scale, glass);
    scene.spheres[hollow as usize].inverted = true;
    scene.sphere(at([1.2, -1.0, -0.5]), scale, mirror);
    scene.sphere_light(at([0.5, 2.5, 0.5]), 0.4 * scale, 30.0);
    let settings = CameraSettings { position: at([0.0, 0.0, 3.5]), look_at: [0.0; 3], ..CAMERA };
    let options = PathOptions { max_bounces: 9, ..PathOptions::default() };
    Case { scene, settings, options }
}

/// Where the bounds on hits prove nothing, paths are followed one by one; nobody sees it.
fn scenes_of_any_scale<R: Real>() {
    let mut bright = 0;
    for scale in [1e-13, 1e-9, 1e-4, 1.0, 1e5, 1e9, 1e12] {
        let case = room::<R>(scale);
        check::<R, Everything>(&case, usize::MAX, 0..8);
        let camera = Camera::new(&case.settings).expect("a camera");
        case.scene.lend(None, |scene| {
            let view = View { scene, camera: &camera, options: &case.options };
            let mut pixels = [Pixel::EMPTY; 4];
            view.render_wavefront::<Everything>(2, 5, 0..8, &mut pixels);
            bright += usize::from(v::<f32>(pixels[0].mean().map(f64::from)).max_component() > 0.0);
        });
    }
    assert!(bright > 4, "{bright} of 7 scenes show something");
}
