//! One scene and seed give one picture, bit for bit, however it is rendered.

use std::ops::Range;

use ocellus::accuracy::describe;
use ocellus::assemble::{Accel, with_view};
use ocellus::description::{SamplerDescription, SceneDescription};
use ocellus::film::{Film, Region};
use ocellus::isa::{Isa, IsaChoice};
use ocellus::kernels::{ALTERNATIVES, EffectChoice, Row, TABLE, TableReal};
use ocellus::render::{Precision, RenderSettings, Unmonitored, render};
use ocellus_kernel::bvh::{BuildItem, BvhStorage, Structure, required_nodes};
use ocellus_kernel::{Accuracy, Everything, ImageHash, Pixel, Real, Scene, SceneParts, View};

use crate::support::in_both_precisions;
use crate::support::pictures::{FIGURES, PRECISIONS, figure, film, fixture, scene};
use crate::support::tolerance;
use crate::support::trials::Trials;

in_both_precisions!(a_hierarchy_on_the_stack_is_as_good_as_one_on_the_heap);

/// Pixels across and down: enough to meet every surface of a figure.
const SIZE: u32 = 24;

/// The figures; a scene of many balls and triangles, since the few balls of most figures need no hierarchy; and one by
/// Sobol's numbers, for which every sample must know its place as well.
fn scenes() -> impl Iterator<Item = (&'static str, SceneDescription)> {
    let crowd = ("crowd", scene(fixture("features/crowd.toml"), SIZE));
    let mut sobol = ("fig5c by Sobol's numbers", figure("fig5c", SIZE));
    sobol.1.integrator.sampler = SamplerDescription::Sobol;
    FIGURES.into_iter().map(|name| (name, figure(name, SIZE))).chain([crowd, sobol])
}

/// Every scene in every precision.
fn for_each_scene(test: impl Fn(&str, &SceneDescription, &dyn Fn(&mut RenderSettings))) {
    for (name, description) in scenes() {
        for precision in PRECISIONS {
            test(&format!("{name} in {precision}"), &description, &|settings| {
                settings.samples = 0..4;
                settings.precision = precision;
            });
        }
    }
}

#[test]
fn structures_change_no_bit() {
    for_each_scene(|what, description, settings| {
        let [none, one_box, bvh] = [Accel::None, Accel::Box, Accel::Bvh].map(|accel| {
            film(description, |own| {
                settings(own);
                own.samples = 0..2;
                own.accel = accel;
            })
            .image_hash()
        });
        assert_eq!((none, one_box), (bvh, bvh), "{what}");
    });
    Trials::passed::<f32>("N39", "pictures: all, box, BVH; both precisions", 66);
}

/// An alternative of accuracy may lose rays, but the same ones whichever way they are found; and few enough that the
/// picture is about as bright.
#[test]
fn structures_change_no_bit_of_less_accurate_pictures() {
    for (name, precision) in [("fig4", Precision::F32), ("fig5c", Precision::F32), ("crowd", Precision::F64)] {
        let (_, description) = scenes().find(|(other, _)| *other == name).expect("a scene");
        let mean = |film: &Film| {
            let sum: f32 = film.pixels().iter().map(|pixel| pixel.mean().iter().sum::<f32>()).sum();
            sum / film.pixels().len() as f32
        };
        let of = |accuracy, accel| {
            film(&description, |own| {
                (own.samples, own.precision, own.accel) = (0..2, precision, accel);
                (own.effects, own.accuracy) = (EffectChoice::All, accuracy);
            })
        };
        let robust = mean(&of(Accuracy::ROBUST, Accel::Bvh));
        for Row { accuracy, .. } in ALTERNATIVES {
            let [none, one_box, bvh] = [Accel::None, Accel::Box, Accel::Bvh].map(|accel| of(*accuracy, accel));
            let what = format!("{name} in {precision} with {}", describe(*accuracy));
            assert_eq!((none.image_hash(), one_box.image_hash()), (bvh.image_hash(), bvh.image_hash()), "{what}");
            assert!(
                (mean(&bvh) / robust - 1.0).abs() < tolerance::ALTERNATIVE_MEAN,
                "{what}: {} is not {robust}",
                mean(&bvh)
            );
        }
    }
    Trials::passed::<f32>("N39", "pictures of less accurate kernels: all, box, BVH", 18);
}

#[test]
fn instruction_sets_change_no_bit() {
    let choices = [IsaChoice::Avx2, IsaChoice::Avx512].into_iter().filter(|choice| Isa::select(*choice).is_ok());
    let choices: Vec<_> = choices.collect();
    if choices.is_empty() {
        println!("skipped: this machine has no instructions beyond the baseline");
        return;
    }
    for_each_scene(|what, description, settings| {
        let with = |isa| {
            film(description, |own| {
                settings(own);
                own.isa = isa;
            })
        };
        let baseline = with(IsaChoice::Baseline);
        for choice in &choices {
            assert_eq!(baseline, with(*choice), "{what} with {choice:?}");
        }
    });
}

#[test]
fn threads_change_no_bit() {
    for_each_scene(|what, description, settings| {
        let [one, two, five] = [1, 2, 5].map(|threads| {
            film(description, |own| {
                settings(own);
                own.threads = threads;
            })
        });
        assert_eq!(one, two, "{what}");
        assert_eq!(one, five, "{what}");
    });
    Trials::passed::<f32>("N42", "pictures: 1, 2 and 5 threads; both precisions", 66);
}

#[test]
fn samples_in_parts_and_merged_change_no_bit() {
    for_each_scene(|what, description, settings| {
        let part = |samples: Range<u32>| {
            film(description, |own| {
                settings(own);
                own.region = Region { x0: 4, y0: 8, x1: 20, y1: 20 };
                own.samples = samples;
            })
        };
        let whole = part(0..64);
        let merged = |first: &Film, second: &Film| {
            let mut film = first.clone();
            film.merge(second).expect("the same region");
            assert!(film.pixels().iter().all(|pixel| pixel.count() == 64));
            film.image_hash()
        };
        let (start, rest) = (part(0..20), part(20..64));
        assert_eq!(merged(&start, &rest), whole.image_hash(), "{what}");
        assert_eq!(merged(&rest, &start), whole.image_hash(), "{what}");
        let same = start.image_hash() == whole.image_hash();
        assert_eq!(same, what.starts_with("fig2a"), "{what}: only without anti-aliasing are all samples the same");
    });
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    for_each_scene(|what, description, settings| {
        let whole = film(description, settings);
        let region = Region { x0: 3, y0: 7, x1: 22, y1: 18 };
        let crop = film(description, |own| {
            settings(own);
            own.region = region;
        });
        for (y, row) in (region.y0..).zip(crop.pixels().chunks(region.width() as usize)) {
            let start = (y * SIZE + region.x0) as usize;
            assert_eq!(row, &whole.pixels()[start..start + row.len()], "{what}, row {y}");
        }
    });
}

/// The kernel for just the scene's effects against the one for all, on every figure and on every scene of
/// `fixtures/features`.
#[test]
fn specialised_kernels_change_no_bit() {
    let of_feature = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("a readable folder").path();
    let features = std::fs::read_dir(fixture("features")).expect("fixtures/features").map(of_feature);
    let features: Vec<_> = features.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    assert!(features.len() >= 15, "one scene for each feature: {features:?}");
    let figures = FIGURES.map(|name| fixture(&format!("report/{name}.toml")));
    let mut rows = std::collections::BTreeSet::new();
    for path in figures.iter().chain(&features) {
        let description = scene(path, SIZE);
        for precision in PRECISIONS {
            let [specialised, everything] = [EffectChoice::Auto, EffectChoice::All].map(|effects| {
                let settings = RenderSettings { samples: 0..4, precision, effects, ..RenderSettings::of(&description) };
                render(&description, &settings, &Unmonitored).unwrap_or_else(|error| panic!("{error}"))
            });
            assert_eq!(everything.row.name, "everything");
            let what = format!("{} in {precision}, {}", path.display(), specialised.row.name);
            assert!(specialised.row.effects.contains(specialised.required), "{what}");
            assert_eq!(specialised.film, everything.film, "{what}");
            assert_eq!(specialised.work, everything.work, "{what}");
            if figures.contains(path) {
                assert_ne!(specialised.row.name, "everything", "{what}: the figures have kernels of their own");
                rows.insert(specialised.row.name);
            }
        }
    }
    assert!(TABLE.len() >= 5 && rows.len() >= 5, "kernels in use: {rows:?}");
}

/// Room for any figure's primitives.
const PRIMITIVES: usize = 8192;
const NODES: usize = required_nodes(PRIMITIVES);

fn a_hierarchy_on_the_stack_is_as_good_as_one_on_the_heap<R: TableReal>() {
    // The storage and what it is made from outgrow the 2 MiB of a test's stack.
    let on_a_large_stack = std::thread::Builder::new().stack_size(64 << 20).spawn(|| {
        for (name, description) in scenes() {
            let compare = with_view::<R, _>(&description, Accel::Bvh, |view, _| {
                let nodes = view.scene.bvh().map_or(0, |bvh| bvh.nodes().len());
                assert!(nodes > 1 || !["crowd", "fig4"].contains(&name), "{name}: a hierarchy of {nodes} nodes");
                (hash(view), hash_from_stack(view))
            });
            let (heap, stack) = compare.unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(heap, stack, "{name}");
        }
    });
    on_a_large_stack.expect("a thread").join().expect("the same pictures");
}

/// The hash of the view with a hierarchy built in storage on the stack.
fn hash_from_stack<R: Real>(view: &View<'_, R>) -> u64 {
    let scene = view.scene;
    let mut storage = BvhStorage::<R, NODES, 64, PRIMITIVES>::EMPTY;
    let mut scratch = [BuildItem::EMPTY; PRIMITIVES];
    let bvh = storage.build(scene.geometry(), Structure::Bvh, &mut scratch).expect("enough room");
    assert_eq!(scene.bvh().map(|bvh| bvh.nodes().len()), Some(bvh.nodes().len()));
    let scene = Scene::new(SceneParts {
        geometry: *scene.geometry(),
        bvh: Some(bvh),
        attributes: scene.attributes(),
        normals: scene.normals(),
        uvs: scene.uvs(),
        materials: scene.materials(),
        textures: scene.textures(),
        lights: scene.lights(),
        aims: scene.aims(),
        background: scene.background(),
    });
    hash(&View { scene: &scene.expect("the same scene"), ..*view })
}

fn hash<R: Real>(view: &View<'_, R>) -> u64 {
    let mut hash = ImageHash::new(SIZE, SIZE);
    let mut row = [Pixel::EMPTY; SIZE as usize];
    for y in 0..SIZE {
        row.fill(Pixel::EMPTY);
        view.render::<Everything>(0, y, 0..2, &mut row);
        row.iter().for_each(|pixel| hash.add(pixel.mean()));
    }
    hash.finish()
}
