//! Building a hierarchy and tracing never allocate: counted, on this thread, with every effect on.

use std::hint::black_box;

use ocellus_kernel::bvh::{BuildItem, BvhStorage, Structure, required_nodes};
use ocellus_kernel::camera::Camera;
use ocellus_kernel::real::Real;
use ocellus_kernel::sampler::{AddressedRng, AddressedSampler, ForeignSampler};
use ocellus_kernel::{Effects, Everything, ImageHash, Pixel, Scene, SceneParts, View};

use crate::effects::all;
use crate::support::counting_allocator::allocations;
use crate::support::in_both_precisions;

in_both_precisions!(building_and_tracing_never_allocate);

#[test]
fn the_counter_counts() {
    let before = allocations();
    let boxed = black_box(vec![1u8; 100]);
    assert_eq!(allocations() - before, 1);
    let mut grown = black_box(boxed);
    grown.reserve_exact(1000);
    assert_eq!(allocations() - before, 2);
    let other = std::thread::spawn(|| black_box(vec![0u8; 100]).len()).join();
    assert_eq!(other.expect("a thread that ends"), 100);
    let zeroed = black_box(vec![0u64; 50]);
    assert!(allocations() - before >= 3 && zeroed.len() == 50);
}

fn building_and_tracing_never_allocate<R: Real>() {
    const PRIMITIVES: usize = 128;
    let case = all::<R>();
    // Outside of the count: what the caller owns.
    let parts = case.scene.parts();
    let mut storage = BvhStorage::<R, { required_nodes(PRIMITIVES) }, PRIMITIVES, PRIMITIVES>::EMPTY;
    let mut scratch = [BuildItem::EMPTY; PRIMITIVES];
    let mut pixels = [Pixel::EMPTY; 16];

    let before = allocations();
    let bvh = storage.build(&parts.geometry, Structure::Bvh, &mut scratch);
    let scene = bvh.map(|bvh| Scene::new(SceneParts { bvh: Some(bvh), ..parts }));
    let camera = Camera::<R>::new(&case.settings);
    let mut work = ocellus_kernel::Work::default();
    let mut hash = ImageHash::new(16, 16);
    let mut required = Effects::NONE;
    if let (Ok(Ok(scene)), Ok(camera)) = (&scene, &camera) {
        let view = View { scene, camera, options: &case.options };
        required = view.required_effects();
        for y in 0..16 {
            work = work + view.render::<Everything>(0, y, 0..8, &mut pixels);
            pixels.iter().for_each(|pixel| hash.add(pixel.mean()));
            let rng = AddressedRng::new(AddressedSampler::new(1, 0, y, 0));
            black_box(view.sample_with::<Everything>(0, y, &mut ForeignSampler::new(rng)));
        }
    }
    black_box(hash.finish());
    assert_eq!(allocations() - before, 0);
    assert_eq!((required, work.paths), (Effects::EVERYTHING, 16 * 16 * 8));
    assert!(work.rays > 2 * work.paths, "{work:?}");
}
