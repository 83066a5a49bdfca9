//! What diffuse surfaces may aim at: spheres around what shines, and around mirrors and glass.

use glam::DVec3;

use crate::description::{
    LightDescription, LightSamplingDescription, MeshDescription, ScatteringDescription, SceneDescription,
};

/// More than so many are not aimed at, since each takes time at every bounce: the others are found by chance.
const MOST: usize = 16;

/// A sphere around an object, and what it is worth to aim at ([`ocellus_kernel::Aim`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AimDescription {
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    pub(crate) worth: f64,
}

/// The spheres of a scene; none where nothing shines that has a size.
pub(crate) fn aims(scene: &SceneDescription) -> Vec<AimDescription> {
    let around = |wanted: &dyn Fn(usize) -> bool| -> Vec<AimDescription> {
        if !(0..scene.materials.len()).any(wanted) {
            return Vec::new();
        }
        // The inside of a hollow ball is in the ball.
        let balls = scene.spheres.iter().filter(|sphere| !sphere.inverted && wanted(sphere.material));
        let balls = balls.map(|ball| AimDescription { center: ball.center, radius: ball.radius, worth: 1.0 });
        balls.chain(scene.meshes.iter().filter_map(|mesh| around_mesh(mesh, wanted))).collect()
    };
    let scattering = |material: usize| &scene.materials[material].scattering;
    let emitters = around(&|material| scene.materials[material].emission != DVec3::ZERO);
    let gather = |material| !matches!(scattering(material), ScatteringDescription::Diffuse { .. });
    let mut gatherers = around(&gather);
    let has_glass = (0..scene.materials.len())
        .any(|material| matches!(scattering(material), ScatteringDescription::Dielectric { .. }));
    let lamps: Vec<AimDescription> = scene
        .lights
        .iter()
        .filter_map(|light| match light {
            LightDescription::Sphere { center, radius, .. } => {
                Some(AimDescription { center: *center, radius: *radius, worth: 1.0 })
            }
            LightDescription::Point { .. } => None,
        })
        .collect();
    for gatherer in &mut gatherers {
        let angle = |light: &AimDescription| {
            let distance = light.center.distance(gatherer.center);
            if light.radius < distance { light.radius / distance } else { 1.0 }
        };
        // How large it shows the largest light.
        gatherer.worth = emitters.iter().chain(&lamps).map(angle).fold(0.0, f64::max);
    }
    let mut all = emitters;
    // Where no glass hides them, lamps are sampled as lights, if that is asked for.
    let sampled = scene.integrator.light_sampling != LightSamplingDescription::None;
    all.extend(lamps.into_iter().filter(|_| has_glass || !sampled));
    all.extend(gatherers.into_iter().filter(|gatherer| gatherer.worth > 0.0));
    all.sort_by(|a, b| (b.worth * b.radius * b.radius).total_cmp(&(a.worth * a.radius * a.radius)));
    all.truncate(MOST);
    all
}

/// Around the triangles of a mesh that have one of the wanted materials: from the middle of their box to the farthest
/// corner.
fn around_mesh(mesh: &MeshDescription, wanted: &dyn Fn(usize) -> bool) -> Option<AimDescription> {
    let corners = || {
        let triangles = mesh.triangles.iter().filter(|triangle| wanted(triangle.material as usize));
        triangles.flat_map(|triangle| triangle.positions).map(|corner| {
            let position = DVec3::from_array(mesh.positions[corner as usize].map(f64::from));
            mesh.world_from_mesh.transform_point3(position)
        })
    };
    let (low, high) = corners().map(|corner| (corner, corner)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let center = 0.5 * (low + high);
    let radius = corners().map(|corner| corner.distance(center)).fold(0.0, f64::max);
    (radius > 0.0).then_some(AimDescription { center, radius, worth: 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::load_scene;
    use std::path::Path;

    fn of_fixture(name: &str) -> Vec<AimDescription> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name);
        aims(&load_scene(&path).expect("a good scene"))
    }

    #[test]
    fn balls_of_glass_and_mirror_and_the_lamp_are_aimed_at() {
        let found = of_fixture("report/fig5c.toml");
        let lamp = DVec3::new(-10.0, 25.0, -10.0);
        assert_eq!(found.len(), 4, "{found:?}");
        for aim in found {
            if aim.center == lamp {
                assert_eq!((aim.radius, aim.worth), (5.0, 1.0));
            } else {
                assert_eq!((aim.center.y, aim.center.z, aim.radius), (0.0, 0.0, 10.0));
                assert!((aim.worth - 5.0 / aim.center.distance(lamp)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn nothing_is_aimed_at_where_nothing_can_be_gathered() {
        // Lights that are points, and none.
        assert_eq!(of_fixture("report/fig5a.toml"), []);
        assert_eq!(of_fixture("features/roulette.toml"), []);
        // A lamp that no glass can hide.
        assert_eq!(of_fixture("features/sphere_light.toml"), []);
    }

    #[test]
    fn a_mesh_is_aimed_at_where_it_has_the_material() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/features/mesh_flat.toml");
        let mut scene = load_scene(&path).expect("a good scene");
        // Of its mirror alone.
        let [mirror] = aims(&scene)[..] else { panic!("one part gathers light") };
        assert!(mirror.worth < 1.0);
        let material = scene.meshes[0].triangles[0].material as usize;
        scene.materials[material].emission = DVec3::ONE;
        let mesh = &scene.meshes[0];
        let found = aims(&scene).into_iter().find(|aim| aim.worth == 1.0).expect("what emits");
        for triangle in mesh.triangles.iter().filter(|triangle| triangle.material as usize == material) {
            for corner in triangle.positions {
                let corner = DVec3::from_array(mesh.positions[corner as usize].map(f64::from));
                let world = mesh.world_from_mesh.transform_point3(corner);
                assert!(world.distance(found.center) <= found.radius);
            }
        }
    }
}
