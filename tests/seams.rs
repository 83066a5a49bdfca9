//! Where two walls meet, neither hides the light from the other.

use ocellus_kernel::camera::{Camera, CameraSettings, Filter};
use ocellus_kernel::path::PathOptions;
use ocellus_kernel::{Everything, Real, View};

use crate::support::in_both_precisions;
use crate::support::random::Random;
use crate::support::scene::{CAMERA, OwnedScene, STRUCTURES};
use crate::support::trials::{Trials, trials};
use crate::support::wedge::{WEDGES, direct_light, wedge};

in_both_precisions!(the_seam_of_round_walls_is_lit, the_seam_of_flat_walls_is_lit);

/// Whichever of two walls a ray is said to hit at their seam, its point is within rounding of the other.
fn the_seam_of_flat_walls_is_lit<R: Real>() {
    for (degrees, round) in WEDGES.into_iter().flat_map(|degrees| [(degrees, false), (degrees, true)]) {
        let walls = if round { "a flat and a round wall" } else { "two flat walls" };
        let lit = Trials::of::<R>("N24", &format!("the seam of {walls} that meet at {degrees} degrees"));
        let mut random = Random::new(42);
        for _ in 0..trials(20_000) / 10 {
            let (mut scene, ray) = wedge::<R>(&mut random, degrees, round);
            // Copies change nothing, in whatever order.
            if random.below(2) == 0 {
                scene.triangles = scene.triangles.repeat(3);
                let turn = random.below(scene.triangles.len());
                scene.triangles.rotate_left(turn);
                scene.attributes.resize(scene.triangles.len(), scene.attributes[0]);
            }
            let structure = STRUCTURES[random.below(3)];
            let light = direct_light::<R, Everything>(&scene, structure, ray);
            lit.holds(light != 0.0, || format!("{ray:?} {:?} {:?}", scene.positions, scene.lights));
        }
        lit.end(2000);
    }
}

/// Two huge spheres that cross at an angle, seen from between them exactly at the seam, with a lamp between them, too.
/// Whichever of the two a ray is said to hit, its point is within rounding of the other, on either side of it.
fn the_seam_of_round_walls_is_lit<R: Real>() {
    for degrees in WEDGES {
        let lit = Trials::of::<R>("N24", &format!("the seam of two round walls that meet at {degrees} degrees"));
        let mut random = Random::new(41);
        let half = 0.5 * degrees.to_radians();
        for _ in 0..trials(20_000) / 10 {
            let radius = libm::exp(random.between(3.0, 9.0));
            // Anywhere within the angle, at most as far from the seam as the walls are straight.
            let mut between = |reach: f64| {
                let (distance, angle) = (reach * random.between(0.1, 1.0), half * random.between(-0.9, 0.9));
                [distance * libm::sin(angle), distance * libm::cos(angle), random.between(-1.0, 1.0)]
            };
            let (position, lamp, away) = (between(10.0), between(10.0), between(1.0)[2]);
            let look_at = [0.0, 0.0, away];
            let mut scene = OwnedScene::<R>::default();
            let grey = scene.diffuse(0.5, 0.0);
            for side in [-1.0, 1.0] {
                scene.sphere([side * radius * libm::cos(half), -radius * libm::sin(half), away], radius, grey);
            }
            scene.point_light(lamp, 1.0);
            let settings =
                CameraSettings { position, look_at, width: 1, height: 1, filter: Filter::Box(0.0), ..CAMERA };
            let options = PathOptions { max_bounces: 1, indirect: false, ..PathOptions::default() };
            let camera = Camera::<R>::new(&settings).expect("a camera");
            let structure = STRUCTURES[random.below(3)];
            scene.lend(structure, |scene| {
                let path = View { scene, camera: &camera, options: &options }.sample::<Everything>(0, 0, 0);
                lit.holds(path.radiance != R::Vec3::default(), || format!("{settings:?} {:?}", scene.geometry()));
            });
        }
        lit.end(2000);
    }
}
