//! Effects: each is found where a scene asks for it, does something there, and a kernel that has just what the scene
//! asks for gives the same bits as the one that has everything.

use ocellus_kernel::camera::{CameraSettings, Filter};
use ocellus_kernel::light::LightSampling;
use ocellus_kernel::material::{Material, Scattering};
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::real::{Real, Vector};
use ocellus_kernel::sampler::{AddressedRng, AddressedSampler, ForeignSampler};
use ocellus_kernel::texture::Texture;
use ocellus_kernel::{EffectSet, Effects, Everything, SamplerKind, View};

use crate::support::in_both_precisions;
use crate::support::meshes::{cube, floor, icosphere};
use crate::support::scene::{CAMERA, OwnedScene, each_path, v, with_view};

in_both_precisions!(
    each_effect_is_found_and_its_kernel_equals_everything,
    what_all_effects_together_need_is_found,
    supersets_change_no_bit,
    a_foreign_generator_with_the_same_numbers_gives_the_same_bits,
    options_that_change_no_effect_still_agree,
);

/// Kernels, each of one set of effects.
macro_rules! kernels {
    ($($name:ident = $($effect:ident)|+;)*) => {
        $(
            #[derive(Clone, Copy)]
            struct $name;

            impl EffectSet for $name {
                const EFFECTS: Effects = Effects::NONE$(.union(Effects::$effect))+;
            }
        )*
    };
}

kernels! {
    Spheres = SPHERES | EMISSION;
    Triangles = TRIANGLES | EMISSION;
    Smooth = TRIANGLES | SMOOTH_NORMALS | POINT_LIGHT;
    Textured = TRIANGLES | TEXTURES | POINT_LIGHT;
    Mirrors = SPHERES | MIRROR | BACKGROUND;
    Glass = SPHERES | GLASS | BACKGROUND;
    PointLit = TRIANGLES | POINT_LIGHT;
    SphereLit = SPHERES | TRIANGLES | SPHERE_LIGHT;
    Emitters = SPHERES | TRIANGLES | EMISSION | INDIRECT;
    Sky = TRIANGLES | BACKGROUND | INDIRECT;
    Indirect = TRIANGLES | POINT_LIGHT | INDIRECT;
    Roulette = SPHERES | EMISSION | INDIRECT | ROULETTE;
    Aim = SPHERES | TRIANGLES | SPHERE_LIGHT | EMISSION | INDIRECT | AIM;
    Lens = TRIANGLES | POINT_LIGHT | LENS;
    Filtered = TRIANGLES | POINT_LIGHT | FILTER;
    Sobol = TRIANGLES | POINT_LIGHT | INDIRECT | SOBOL;
    SkyAndLamp = TRIANGLES | SPHERES | BACKGROUND | SPHERE_LIGHT | POINT_LIGHT | INDIRECT | MIRROR | GLASS;
}

/// A scene that asks for one effect, and how it is looked at.
pub(crate) struct Case<R: Real> {
    pub(crate) scene: OwnedScene<R>,
    pub(crate) settings: CameraSettings,
    pub(crate) options: PathOptions,
}

/// Direct light alone, unless a case says more.
const DIRECT: PathOptions = PathOptions {
    max_bounces: 5,
    indirect: false,
    light_sampling: LightSampling::Cone,
    fresnel: ocellus_kernel::material::Fresnel::Exact,
    roulette_after: None,
    aim: false,
    sampler: SamplerKind::Independent,
    seed: 77,
};

/// A corner of two walls, lit from a point.
fn corner<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    let grey = scene.diffuse(0.7, 0.0);
    scene.mesh(&floor(2.0).map(|[x, _, z]| [x, -1.0, z]), grey);
    scene.mesh(&floor(2.0).map(|[x, _, z]| [x, 1.0 - z, -1.5]), grey);
    scene.point_light([0.5, 0.8, 1.0], 5.0);
    scene
}

fn unlit<R: Real>(mut scene: OwnedScene<R>) -> OwnedScene<R> {
    scene.lights.clear();
    scene
}

/// Emitting balls: the least there is to see.
fn balls<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    let glow = scene.diffuse(0.5, 0.8);
    scene.sphere([-0.5, 0.0, 0.0], 0.8, glow);
    scene.sphere([0.9, 0.2, -0.4], 0.6, glow);
    scene
}

const TEXELS: [[f32; 3]; 6] =
    [[1.0, 0.1, 0.0], [0.0, 0.9, 0.2], [0.3, 0.0, 1.0], [0.5, 0.5, 0.5], [0.0, 0.0, 0.0], [1.0, 1.0, 0.0]];

fn in_a_furnace<R: Real>(scattering: impl Fn(&mut OwnedScene<R>) -> u32) -> OwnedScene<R> {
    let mut scene = OwnedScene { background: [0.5, 0.75, 1.0], ..OwnedScene::default() };
    let material = scattering(&mut scene);
    scene.sphere([0.0; 3], 1.0, material);
    scene
}

fn smooth<R: Real>() -> OwnedScene<R> {
    let mut scene = OwnedScene::default();
    let grey = scene.diffuse(0.7, 0.0);
    scene.mesh(&icosphere(1), grey);
    scene.normals = scene.positions.clone();
    for (attributes, corners) in scene.attributes.iter_mut().zip(&scene.triangles) {
        attributes.normals = Some(*corners);
    }
    scene.point_light([2.0, 3.0, 4.0], 30.0);
    scene
}

fn textured<R: Real>() -> OwnedScene<R> {
    let mut scene = corner::<R>();
    scene.textures = vec![Texture { width: 3, height: 2, texels: &TEXELS }];
    scene.uvs = scene.positions.iter().map(|p| [p.x(), p.y() + p.z()]).collect();
    for (attributes, corners) in scene.attributes.iter_mut().zip(&scene.triangles) {
        attributes.uvs = Some(*corners);
    }
    if let Material { scattering: Scattering::Diffuse(diffuse), .. } = &mut scene.materials[0] {
        diffuse.texture = Some(0);
    }
    scene
}

fn lamp<R: Real>() -> OwnedScene<R> {
    let mut scene = unlit(corner::<R>());
    scene.sphere_light([0.5, 0.6, 0.5], 0.3, 20.0);
    scene
}

fn emitters<R: Real>() -> OwnedScene<R> {
    let mut scene = unlit(corner::<R>());
    let glow = scene.diffuse(0.2, 5.0);
    scene.sphere([0.3, 0.0, 0.0], 0.7, glow);
    scene
}

/// One of everything.
pub(crate) fn all<R: Real>() -> Case<R> {
    let mut scene = textured::<R>();
    scene.background = [0.1, 0.2, 0.3];
    let [mirror, glass, glow] = [scene.mirror(0.9), scene.glass(1.5, 1.0, [0.9, 1.0, 0.9]), scene.diffuse(0.1, 2.0)];
    scene.sphere([-1.0, -0.3, 0.0], 0.6, mirror);
    scene.sphere([0.8, -0.4, 0.6], 0.5, glass);
    scene.sphere([0.0, 0.9, -0.6], 0.2, glow);
    let first = scene.triangles.len();
    scene.mesh(&icosphere(1).map(|[x, y, z]| [0.4 * x, 0.4 * y - 0.5, 0.4 * z - 0.3]), 0);
    scene.normals = scene.positions.iter().map(|p| *p - v::<R>([0.0, -0.5, -0.3])).collect();
    for (attributes, corners) in scene.attributes.iter_mut().zip(&scene.triangles).skip(first) {
        attributes.normals = Some(*corners);
        attributes.uvs = None;
    }
    scene.sphere_light([1.0, 1.5, 0.5], 0.3, 20.0);
    scene.aim([0.8, -0.4, 0.6], 0.5, 0.3);
    Case {
        scene,
        settings: CameraSettings { aperture_radius: 0.1, filter: Filter::Gaussian(0.5), ..CAMERA },
        options: PathOptions {
            indirect: true,
            roulette_after: Some(1),
            aim: true,
            sampler: SamplerKind::Sobol,
            ..DIRECT
        },
    }
}

/// What can be asked of a kernel, for each case: a visitor, since each set is a type.
pub(crate) trait Visit<R: Real> {
    fn visit<E: EffectSet>(&mut self, effect: Effects, case: &Case<R>);
}

pub(crate) fn for_each_case<R: Real>(mut visitor: impl Visit<R>) {
    let direct = |scene| Case { scene, settings: CAMERA, options: DIRECT };
    let indirect = |scene| Case { scene, settings: CAMERA, options: PathOptions { indirect: true, ..DIRECT } };
    let glowing = |mut scene: OwnedScene<R>| {
        scene.materials[0].emission = v::<R>([0.5; 3]);
        unlit(scene)
    };
    let mirror = in_a_furnace(|scene| scene.mirror(0.9));
    let glass = in_a_furnace(|scene| scene.glass(1.5, 1.0, [1.0; 3]));
    let sky = OwnedScene { background: [0.5, 0.75, 1.0], ..unlit(corner()) };
    visitor.visit::<Spheres>(Effects::SPHERES, &direct(balls()));
    visitor.visit::<Triangles>(Effects::TRIANGLES, &direct(glowing(corner())));
    visitor.visit::<Smooth>(Effects::SMOOTH_NORMALS, &direct(smooth()));
    visitor.visit::<Textured>(Effects::TEXTURES, &direct(textured()));
    visitor.visit::<Mirrors>(Effects::MIRROR, &direct(mirror));
    visitor.visit::<Glass>(Effects::GLASS, &direct(glass));
    visitor.visit::<PointLit>(Effects::POINT_LIGHT, &direct(corner()));
    visitor.visit::<SphereLit>(Effects::SPHERE_LIGHT, &direct(lamp()));
    visitor.visit::<Emitters>(Effects::EMISSION, &indirect(emitters()));
    visitor.visit::<Sky>(Effects::BACKGROUND, &indirect(sky));
    visitor.visit::<Indirect>(Effects::INDIRECT, &indirect(corner()));
    let roulette = PathOptions { indirect: true, roulette_after: Some(0), ..DIRECT };
    let case = Case { options: roulette, ..direct(balls()) };
    visitor.visit::<Roulette>(Effects::ROULETTE, &case);
    let mut aimed = emitters();
    aimed.aim([0.3, 0.0, 0.0], 0.7, 1.0);
    aimed.sphere_light([1.0, 1.5, 0.5], 0.3, 20.0);
    let aim = PathOptions { indirect: true, aim: true, ..DIRECT };
    visitor.visit::<Aim>(Effects::AIM, &Case { options: aim, ..direct(aimed) });
    let lens = CameraSettings { aperture_radius: 0.2, focal_distance: 4.0, ..CAMERA };
    visitor.visit::<Lens>(Effects::LENS, &Case { settings: lens, ..direct(corner()) });
    let sobol = PathOptions { indirect: true, sampler: SamplerKind::Sobol, ..DIRECT };
    visitor.visit::<Sobol>(Effects::SOBOL, &Case { options: sobol, ..direct(corner()) });
    for filter in [Filter::Gaussian(0.5), Filter::Tent(1.0)] {
        let settings = CameraSettings { filter, ..CAMERA };
        visitor.visit::<Filtered>(Effects::FILTER, &Case { settings, ..direct(corner()) });
    }
}

/// The radiance of every path, as bits.
fn paths<R: Real, E: EffectSet>(view: &View<'_, R>) -> Vec<[u64; 3]> {
    let mut paths = Vec::new();
    each_path::<R, E>(view, 8, &mut |radiance| paths.push(radiance.map(f64::to_bits)));
    paths
}

struct EqualsEverything {
    seen: Effects,
}

impl<R: Real> Visit<R> for &mut EqualsEverything {
    fn visit<E: EffectSet>(&mut self, effect: Effects, case: &Case<R>) {
        let name = effect.names().next().expect("a name");
        with_view(&case.scene, &case.settings, &case.options, |view| {
            let required = view.required_effects();
            assert_eq!(required, E::EFFECTS, "{name}: needs {:?}", required.names().collect::<Vec<_>>());
            let everything = paths::<R, Everything>(view);
            assert!(paths::<R, E>(view) == everything, "{name}: paths differ");
            let black = [0.0; 3].map(f64::to_bits);
            assert!(everything.iter().any(|radiance| *radiance != black), "{name}: nothing to see");
        });
        self.seen = self.seen.union(effect);
    }
}

fn each_effect_is_found_and_its_kernel_equals_everything<R: Real>() {
    let mut visitor = EqualsEverything { seen: Effects::NONE };
    for_each_case::<R>(&mut visitor);
    assert_eq!(visitor.seen, Effects::EVERYTHING, "an effect has no case here");
}

/// The kernel for everything but one effect: the code behind the bit is what makes the difference.
struct IsMissed;

/// Everything without the effect whose bit is `BIT`.
#[derive(Clone, Copy)]
struct Without<const BIT: usize>;

impl<const BIT: usize> EffectSet for Without<BIT> {
    const EFFECTS: Effects = Effects::EVERYTHING.without(Effects::ALL[BIT].0);
}

impl<R: Real> Visit<R> for IsMissed {
    fn visit<E: EffectSet>(&mut self, effect: Effects, case: &Case<R>) {
        let name = effect.names().next().expect("a name");
        with_view(&case.scene, &case.settings, &case.options, |view| {
            let without = match Effects::ALL.iter().position(|(known, _)| *known == effect).expect("a known effect") {
                // A kernel without a shape must not be given one: what is left is tested by the other cases.
                0 | 1 => return,
                2 => paths::<R, Without<2>>(view),
                3 => paths::<R, Without<3>>(view),
                4 => paths::<R, Without<4>>(view),
                5 => paths::<R, Without<5>>(view),
                6 => paths::<R, Without<6>>(view),
                7 => paths::<R, Without<7>>(view),
                // Spheres that emit are seen by kernels with sphere lights, too.
                8 => paths::<R, WithoutEmission>(view),
                9 => paths::<R, Without<9>>(view),
                10 => paths::<R, Without<10>>(view),
                11 => paths::<R, Without<11>>(view),
                12 => paths::<R, Without<12>>(view),
                13 => paths::<R, Without<13>>(view),
                14 => paths::<R, Without<14>>(view),
                15 => paths::<R, Without<15>>(view),
                bit => panic!("effect {bit} is new: give it a row"),
            };
            assert!(without != paths::<R, Everything>(view), "{name}: nothing changes without it");
        });
    }
}

#[derive(Clone, Copy)]
struct WithoutEmission;

impl EffectSet for WithoutEmission {
    const EFFECTS: Effects = Effects::EVERYTHING.without(Effects::EMISSION.union(Effects::SPHERE_LIGHT));
}

/// In one precision: which code a bit guards is the same in both, and these are many large kernels.
#[test]
fn an_effect_that_is_left_out_is_missed() {
    for_each_case::<f32>(IsMissed);
}

fn what_all_effects_together_need_is_found<R: Real>() {
    let Case { scene, settings, options } = all::<R>();
    with_view(&scene, &settings, &options, |view| assert_eq!(view.required_effects(), Effects::EVERYTHING));
    // Nothing asks for nothing; a material that no primitive uses asks for nothing either.
    let mut empty = OwnedScene::<R>::default();
    empty.mirror(1.0);
    empty.glass(1.5, 1.0, [1.0; 3]);
    empty.diffuse(0.5, 3.0);
    with_view(&empty, &CAMERA, &DIRECT, |view| {
        assert_eq!(view.required_effects(), Effects::NONE);
        assert!(paths::<R, Everything>(view).iter().all(|radiance| *radiance == [0; 3]));
    });
    // The emission of a sampled light asks for no search by chance; a mesh of that material does.
    let mut lit = lamp::<R>();
    with_view(&lit, &CAMERA, &DIRECT, |view| assert!(!view.required_effects().intersects(Effects::EMISSION)));
    let emitting = lit.spheres[0].material;
    lit.mesh(&cube(1), emitting);
    with_view(&lit, &CAMERA, &DIRECT, |view| assert!(view.required_effects().contains(Effects::EMISSION)));
}

fn supersets_change_no_bit<R: Real>() {
    for scene in [corner::<R>(), lamp(), OwnedScene { background: [0.2; 3], ..lamp() }] {
        let options = PathOptions { indirect: true, ..DIRECT };
        with_view(&scene, &CAMERA, &options, |view| {
            assert!(SkyAndLamp::EFFECTS.contains(view.required_effects()));
            assert!(paths::<R, SkyAndLamp>(view) == paths::<R, Everything>(view));
        });
    }
}

/// The kernel's numbers through `rand_core`, drawn in order, for the scene of all effects.
fn a_foreign_generator_with_the_same_numbers_gives_the_same_bits<R: Real>() {
    let Case { scene, settings, options } = all::<R>();
    with_view(&scene, &settings, &options, |view| {
        for (x, y, sample) in (0..16).flat_map(|x| (0..16).flat_map(move |y| (0..4).map(move |s| (x, y, s)))) {
            let own = AddressedSampler::new(options.seed, x, y, sample).of_kind(options.sampler);
            let mut foreign = ForeignSampler::new(AddressedRng::new(own));
            let drawn = view.sample_with::<Everything>(x, y, &mut foreign);
            let addressed = view.sample::<Everything>(x, y, sample);
            assert_eq!(drawn, addressed, "{x} {y} {sample}");
        }
    });
}

/// Every way to sample lights and to share light in glass agrees between the kernels, too.
fn options_that_change_no_effect_still_agree<R: Real>() {
    use ocellus_kernel::material::Fresnel;
    let mut scene = OwnedScene { background: [0.2; 3], ..lamp::<R>() };
    let glass = scene.glass(1.5, 1.0, [1.0; 3]);
    scene.sphere([-0.5, -0.3, 0.5], 0.6, glass);
    let mirror = scene.mirror(0.8);
    scene.sphere([-1.0, 0.8, -0.5], 0.4, mirror);
    for light_sampling in [LightSampling::Cone, LightSampling::Hemisphere, LightSampling::None] {
        for fresnel in [Fresnel::None, Fresnel::Schlick, Fresnel::Exact] {
            let options = PathOptions { light_sampling, fresnel, indirect: true, ..DIRECT };
            with_view(&scene, &CAMERA, &options, |view| {
                assert!(paths::<R, SkyAndLamp>(view) == paths::<R, Everything>(view), "{light_sampling:?} {fresnel:?}");
            });
        }
    }
}
