//! What a renderer relies on: a closed, outward mesh on the ground, sound texture coordinates, the same bytes always.

use super::*;
use std::sync::OnceLock;

const TRIANGLES: u32 = 5000;

fn small() -> &'static CatModel {
    static MODEL: OnceLock<CatModel> = OnceLock::new();
    MODEL.get_or_init(|| make_cat(TRIANGLES))
}

fn large() -> &'static CatModel {
    static MODEL: OnceLock<CatModel> = OnceLock::new();
    MODEL.get_or_init(|| make_cat(4 * TRIANGLES))
}

/// Each side of each triangle as (from, to), sorted.
fn directed_sides(mesh: &Mesh) -> Vec<(u32, u32)> {
    let sides_of = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
    let mut sides: Vec<_> = mesh.triangles.iter().flat_map(sides_of).collect();
    sides.sort_unstable();
    sides
}

#[test]
fn every_edge_joins_two_triangles_in_opposite_directions() {
    for model in [small(), large()] {
        let sides = directed_sides(&model.mesh);
        assert!(sides.windows(2).all(|pair| pair[0] != pair[1]), "an edge is used twice in one direction");
        for &(from, to) in &sides {
            assert!(from != to && sides.binary_search(&(to, from)).is_ok(), "edge {from}-{to} is open");
        }
    }
}

#[test]
fn the_surface_is_one_sphere_without_handles() {
    for model in [small(), large()] {
        let edges = model.mesh.triangles.len() * 3 / 2;
        assert_eq!(model.mesh.positions.len() + model.mesh.triangles.len() - edges, 2);
        let mut used = vec![false; model.mesh.positions.len()];
        for &vertex in model.mesh.triangles.iter().flatten() {
            used[vertex as usize] = true;
        }
        assert!(used.iter().all(|&is_used| is_used));
        // A sphere beside a torus would have the same characteristic, so the mesh must also be one piece.
        let neighbours = model.mesh.neighbours();
        let mut reached = vec![false; neighbours.len()];
        let mut open = vec![0_u32];
        while let Some(triangle) = open.pop() {
            if !std::mem::replace(&mut reached[triangle as usize], true) {
                open.extend(neighbours[triangle as usize]);
            }
        }
        assert!(reached.iter().all(|&is_reached| is_reached));
    }
}

#[test]
fn the_mesh_is_a_cats_volume_and_turned_outward() {
    let volume = |model: &CatModel| -> f64 {
        let six_volumes = |triangle: usize| {
            let [a, b, c] = model.mesh.corners(triangle);
            a.cross(b).dot(c)
        };
        (0..model.mesh.triangles.len()).map(six_volumes).sum::<f64>() / 6.0
    };
    let (few, many) = (volume(small()), volume(large()));
    assert!((4000.0..9000.0).contains(&many), "{many}");
    // Fewer triangles cut corners, but not many.
    assert!((few / many - 1.0).abs() < 0.01, "{few} against {many}");
}

#[test]
fn the_triangle_count_is_as_asked() {
    assert_eq!(small().mesh.triangles.len(), TRIANGLES as usize);
    assert_eq!(large().mesh.triangles.len(), 4 * TRIANGLES as usize);
}

#[test]
fn triangles_are_well_shaped() {
    for model in [small(), large()] {
        let mut poor = 0;
        for triangle in 0..model.mesh.triangles.len() {
            let [a, b, c] = model.mesh.corners(triangle);
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            // Height over the longest side against that side: 0.87 for an equilateral triangle.
            let slimness = model.mesh.area_normal(triangle).length() / (longest * longest);
            assert!(slimness > 0.005, "triangle {triangle} is a sliver: {slimness}");
            poor += usize::from(slimness < 0.15);
        }
        assert!(poor * 100 < model.mesh.triangles.len(), "{poor} poor triangles");
    }
}

#[test]
fn normals_are_unit_and_agree_with_the_faces() {
    for model in [small(), large()] {
        assert_eq!(model.normals.len(), model.mesh.positions.len());
        assert!(model.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-12));
        let mut wrong = 0;
        for (triangle, corners) in model.mesh.triangles.iter().enumerate() {
            let face = model.mesh.area_normal(triangle);
            wrong += corners.iter().filter(|&&vertex| model.normals[vertex as usize].dot(face) <= 0.0).count();
        }
        assert!(wrong * 1000 < model.mesh.triangles.len() * 3, "{wrong} corners look inward");
    }
}

#[test]
fn texture_coordinates_stay_inside_and_never_cross_a_seam() {
    for model in [small(), large()] {
        let unwrapping = &model.unwrapping;
        assert!(unwrapping.coordinates.iter().flatten().all(|coordinate| (0.0..=1.0).contains(coordinate)));
        for corners in &unwrapping.corners {
            let at = corners.map(|corner| unwrapping.coordinates[corner as usize]);
            for axis in 0..2 {
                let place = at.map(|coordinate| coordinate[axis]);
                let extent = place.into_iter().fold(0.0, f64::max) - place.into_iter().fold(1.0, f64::min);
                assert!(extent < 0.1, "{extent}");
            }
        }
    }
}

#[test]
fn no_texel_serves_two_places() {
    for model in [small(), large()] {
        let mut owners = vec![0_u32; TEXTURE_SIZE * TEXTURE_SIZE];
        for corners in &model.unwrapping.corners {
            let at = corners
                .map(|corner| model.unwrapping.coordinates[corner as usize].map(|x| x * TEXTURE_SIZE as f64 - 0.5));
            raster::for_each_cell(at, [TEXTURE_SIZE; 2], |column, row, weights| {
                let is_inner = weights.iter().all(|&weight| weight > 1e-6);
                owners[row * TEXTURE_SIZE + column] += u32::from(is_inner);
            });
        }
        let used = owners.iter().filter(|&&count| count > 0).count();
        let shared = owners.iter().filter(|&&count| count > 1).count();
        assert!(used * 3 > owners.len(), "only {used} texels are used");
        assert!(shared * 1000 < used, "{shared} of {used} texels are used twice");
    }
}

#[test]
fn the_cat_stands_on_the_ground_in_its_box() {
    for model in [small(), large()] {
        let positions = &model.mesh.positions;
        let low = positions.iter().fold(DVec3::INFINITY, |low, &point| low.min(point));
        let high = positions.iter().fold(DVec3::NEG_INFINITY, |high, &point| high.max(point));
        assert_eq!(low.y, 0.0);
        // The figure's framing: tail tip, nose and ears at 0.6 scale in its picture.
        assert!((-35.5..-33.5).contains(&low.x) && (29.5..32.0).contains(&high.x), "{low} {high}");
        assert!((43.5..46.0).contains(&high.y), "{high}");
        assert!(high.z < 8.0 && low.z > -8.0, "{low} {high}");
        // More than four points touch the ground: all four soles are flat.
        assert!(positions.iter().filter(|point| point.y < 0.1).count() >= 12);
    }
}

#[test]
fn the_coat_has_its_colors() {
    let texels = &small().texture.texels;
    let count = |wanted: fn(&DVec3) -> bool| texels.iter().filter(|&texel| wanted(texel)).count();
    assert!(count(|texel| texel.x > 0.9 && texel.z > 0.75) > texels.len() / 3, "pale coat");
    assert!(count(|texel| texel.x > 0.7 && texel.z < 0.45) > texels.len() / 50, "ginger stripes");
    assert!(count(|texel| texel.y > texel.x + 0.05) > 20, "green eyes");
}

#[test]
fn the_same_request_gives_the_same_bytes_and_they_are_the_committed_ones() {
    let again = files(TRIANGLES).expect("the texture encodes");
    let obj = write::obj(small(), &command(TRIANGLES)).into_bytes();
    assert!(again[0].1 == obj, "two runs differ");
    for (name, bytes) in again {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/meshes").join(name);
        let committed = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(committed == bytes, "{} is stale; make it again: {}", path.display(), command(TRIANGLES));
    }
}
