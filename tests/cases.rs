//! The hard cases by their numbers: which tests hold them, and what of them is still open.
//!
//! N1 to N47 are numerical cases, A1 to A11 scenes with answers in closed form. `cargo test -p ocellus-tests cases --
//! --nocapture` prints the table.

use std::collections::BTreeMap;
use std::process::Command;

/// A numbered case.
struct Case {
    number: &'static str,
    what: &'static str,
    /// Tests of this suite, without the module of their precision.
    tests: &'static [&'static str],
    /// What no test holds yet, if anything.
    open: &'static str,
}

const fn case(number: &'static str, what: &'static str, tests: &'static [&'static str], open: &'static str) -> Case {
    Case { number, what, tests, open }
}

const SLABS: &[&str] = &["slabs::slabs_never_miss_what_exact_rays_meet"];
const SPHERES: &[&str] = &["intersections::spheres_agree_with_exact_arithmetic"];

const CASES: &[Case] = &[
    case("N1", "slab: zero component, origin on the plane", SLABS, ""),
    case("N2", "slab: ray in a face or along an edge", SLABS, ""),
    case("N3", "slab: signed zeros", SLABS, ""),
    case("N4", "slab: denormal and tiny components", SLABS, ""),
    case(
        "N5",
        "slab: rays at corners and edges",
        &[
            "slabs::slabs_never_miss_what_exact_rays_meet",
            "intersections::no_structure_loses_what_a_triangle_of_many_would_hit",
        ],
        "",
    ),
    case(
        "N6",
        "triangles behind their own box",
        &[
            "intersections::rays_toward_triangle_corners_and_edges_hit_behind_boxes",
            "intersections::no_structure_loses_what_a_triangle_of_many_would_hit",
        ],
        "",
    ),
    case(
        "N7",
        "infinite and empty boxes, overflow",
        &["hard_cases::infinite_boxes_are_hit_and_empty_ones_are_not"],
        "",
    ),
    case(
        "N8",
        "rays that are no rays",
        &["bvh::invalid_rays_miss", "hard_cases::rays_that_are_no_rays_end_at_once"],
        "",
    ),
    case("N9", "closed meshes do not leak", &["intersections::closed_meshes_do_not_leak"], ""),
    case("N10", "no fused operations", &["machine_code::no_kernel_fuses_operations"], ""),
    case("N11", "rays along grid lines", &["intersections::rays_along_the_grid_of_a_cube_do_not_leak"], ""),
    case(
        "N12",
        "exactly once on shared edges",
        &["crossings::closed_meshes_are_left_an_odd_number_of_times", "crossings::rays_along_a_grid_leave_a_cube_once"],
        "",
    ),
    case(
        "N13",
        "accuracy of t and of the point",
        &[
            "intersections::triangles_agree_with_exact_arithmetic",
            "intersections::triangle_points_lie_within_their_error_bound",
        ],
        "",
    ),
    case(
        "N14",
        "triangles without area or with NaN",
        &["hard_cases::degenerate_triangles_between_others_open_no_gap"],
        "",
    ),
    case("N15", "rays that once were bugs", &["kept_rays::kept_rays_hit_and_miss_as_they_should"], ""),
    case("N16", "far spheres", SPHERES, ""),
    case("N17", "grazed spheres", SPHERES, ""),
    case("N18", "tiny and huge spheres", SPHERES, ""),
    case(
        "N19",
        "rays from inside and from the surface",
        &[
            "intersections::spheres_agree_with_exact_arithmetic",
            "hard_cases::rays_from_the_centre_of_a_sphere_go_one_radius",
            "hard_cases::rays_from_near_the_centre_of_a_sphere_keep_the_bound",
        ],
        "",
    ),
    case(
        "N20",
        "extreme scales and directions of any length",
        &[
            "intersections::spheres_agree_with_exact_arithmetic",
            "hard_cases::spheres_at_extreme_scales_agree_with_exact_arithmetic",
        ],
        "",
    ),
    case(
        "N21",
        "rays leave planes",
        &[
            "vectors::spawned_rays_leave_triangles",
            "departures::rays_that_leave_triangles_among_others_never_meet_their_plane",
            "departures::rays_that_leave_a_convex_mesh_meet_nothing",
        ],
        "",
    ),
    case(
        "N22",
        "rays leave spheres",
        &["vectors::spawned_rays_leave_spheres", "departures::rays_that_leave_spheres_among_others_never_meet_them"],
        "",
    ),
    case(
        "N23",
        "a second surface close by",
        &["vectors::offsets_are_a_few_ulps", "departures::nothing_leaves_a_box_as_thin_as_64_ulps"],
        "",
    ),
    case(
        "N24",
        "corners and contacts",
        &[
            "furnace::glass_is_entered_as_often_as_it_is_left",
            "furnace::glass_aimed_at_its_edges_is_nearly_always_left",
            "seams::the_seam_of_round_walls_is_lit",
            "seams::the_seam_of_flat_walls_is_lit",
        ],
        "0.85 % of paths through glass of triangles that are aimed at its edges; sharp corners of three walls",
    ),
    case(
        "N25",
        "shadow rays",
        &["closed_forms::walls_stop_light_and_open_air_does_not", "light_cases::lights_that_touch_a_floor_light_it"],
        "",
    ),
    case("N26", "next larger and smaller numbers", &["vectors::neighbours_are_one_place_apart"], ""),
    case("N27", "frames", &["vectors::frames_are_orthonormal_and_right_handed"], ""),
    case("N28", "unit vectors", &["vectors::normalize_is_unit_and_keeps_the_direction"], ""),
    case(
        "N29",
        "mirrors in a chain",
        &["light_cases::paths_among_mirrors_lose_nothing", "light_cases::a_chain_of_mirrors_does_not_drift"],
        "",
    ),
    case("N30", "refracted directions", &["light_cases::refraction_agrees_with_exact_arithmetic"], ""),
    case(
        "N31",
        "total reflection",
        &["furnace::glass_reflects_what_fresnel_says", "light_cases::refraction_agrees_with_exact_arithmetic"],
        "",
    ),
    case(
        "N32",
        "Fresnel",
        &["furnace::reflectance_is_a_fraction_that_equals_its_oracle"],
        "waits for conductors in part",
    ),
    case(
        "N33",
        "glass in a furnace",
        &["furnace::every_path_in_a_furnace_weighs_one", "light_cases::refraction_agrees_with_exact_arithmetic"],
        "",
    ),
    case(
        "N34",
        "samplers follow their densities",
        &[
            "sampling::the_cosine_hemisphere_follows_its_density",
            "sampling::the_disk_is_uniform",
            "sampling::the_cone_is_uniform_in_solid_angle",
            "sampling::directions_to_a_sphere_are_uniform",
            "sampling::the_gaussian_is_normal",
            "sampling::the_tent_is_a_tent",
        ],
        "waits for rough surfaces in part",
    ),
    case(
        "N35",
        "corners of the unit square",
        &["sampling::corners_of_the_square_are_finite_and_in_range", "sampling::far_cones_keep_their_solid_angle"],
        "",
    ),
    case("N36", "inverse warps", &[], "waits for importance sampling that inverts"),
    case(
        "N37",
        "camera",
        &[
            "camera::mirrored_pixels_get_mirrored_rays",
            "camera::pixels_lie_where_the_field_of_view_puts_them",
            "camera::lens_rays_of_a_pixel_meet_in_focus",
            "camera::directions_do_not_depend_on_the_position",
        ],
        "",
    ),
    case("N38", "hostile builds", &["bvh::hostile_input_builds_within_the_depth_limit"], ""),
    case(
        "N39",
        "structures change no bit",
        &[
            "bvh::structures_agree_bit_for_bit",
            "bvh::coplanar_copies_go_to_the_lowest_primitive",
            "invariance::structures_change_no_bit",
            "hard_cases::a_grazed_floor_is_the_same_through_every_structure",
        ],
        "",
    ),
    case("N40", "any hit agrees with the closest", &["bvh::occlusion_agrees_with_the_closest_hit"], ""),
    case(
        "N41",
        "sums",
        &["film::many_samples_do_not_drift", "film::samples_that_are_no_numbers_are_counted_and_kept_out"],
        "",
    ),
    case("N42", "order and resume", &["film::order_and_split_change_no_bit", "invariance::threads_change_no_bit"], ""),
    case(
        "N43",
        "random numbers",
        &[
            "sampling::philox_is_even_along_every_part_of_the_address",
            "sampling::addresses_do_not_collide",
            "sobol::aligned_samples_are_a_net",
            "sobol::numbers_are_even_along_every_other_part_of_the_address",
            "sobol::sequences_are_unrelated",
            "sobol::means_are_unbiased",
        ],
        "",
    ),
    case(
        "N44",
        "picture files",
        &["picture_files::floats_keep_their_bits_in_an_exr", "picture_files::codes_of_a_png_are_the_nearest"],
        "half floats are read by a library, and not tested",
    ),
    case("N45", "powers of two", &["furnace::power_of_two_scales_change_no_bit"], ""),
    case(
        "N46",
        "translation",
        &["hard_cases::moved_meshes_are_hit_alike", "light_cases::moved_furnaces_stay_the_same"],
        "",
    ),
    case("N47", "the same bits on every target", &["figures::golden_hashes"], "tests/same_bits/run, not here"),
    case("A1", "a closed emitter", &["closed_forms::a_closed_emitter_is_a_geometric_series"], ""),
    case("A2", "a lamp in a sphere", &["closed_forms::a_lamp_in_a_closed_sphere_is_a_geometric_series"], ""),
    case(
        "A3",
        "a point light over a plane",
        &["closed_forms::a_point_light_over_a_plane_falls_with_cosine_and_square"],
        "",
    ),
    case(
        "A4",
        "a sphere light over a plane",
        &["form_factors::a_sphere_light_over_a_plane_has_its_form_factor"],
        "a bias may hide below 0.2 % with cones, 1.2 % with hemispheres, 4 % by chance, not 0.1 %",
    ),
    case(
        "A5",
        "a polygon light",
        &["form_factors::polygon_lights_have_their_form_factor"],
        "a bias below 0.4 % may hide, not 0.1 %",
    ),
    case(
        "A6",
        "coaxial discs",
        &["form_factors::coaxial_discs_have_their_form_factor"],
        "a bias below 0.4 % may hide, not 0.1 %",
    ),
    case("A7", "furnaces", &["furnace::every_path_in_a_furnace_weighs_one"], "waits for rough surfaces in part"),
    case("A8", "reciprocity", &[], "waits for BSDFs that can be evaluated"),
    case(
        "A9",
        "estimators agree",
        &["form_factors::estimators_agree"],
        "waits for multiple importance sampling in part",
    ),
    case(
        "A10",
        "depth and roulette",
        &[
            "closed_forms::roulette_keeps_the_mean",
            "closed_forms::aim_keeps_the_mean",
            "closed_forms::bounces_are_counted_as_documented",
        ],
        "",
    ),
    case("A11", "radiance in glass", &["furnace::the_centre_of_a_glass_ball_sees_the_furnace"], ""),
];

#[test]
fn every_numbered_case_is_listed_once_with_tests_that_exist() {
    let numbers: Vec<_> = (1..=47).map(|n| format!("N{n}")).chain((1..=11).map(|n| format!("A{n}"))).collect();
    assert_eq!(CASES.iter().map(|case| case.number).collect::<Vec<_>>(), numbers);

    let program = std::env::current_exe().expect("this program");
    let listed =
        Command::new(program).args(["--list", "--format", "terse"]).output().expect("the list of tests").stdout;
    let listed = String::from_utf8(listed).expect("names");
    let names: Vec<String> = listed
        .lines()
        .filter_map(|line| line.strip_suffix(": test"))
        .map(|name| name.replace("::single::", "::").replace("::double::", "::"))
        .collect();
    for Case { number, what, tests, open } in CASES {
        let open = if open.is_empty() { String::new() } else { format!("; open: {open}") };
        println!("{number:<4} {what:<42} {}{open}", if tests.is_empty() { "-".to_owned() } else { tests.join(" ") });
        for test in *tests {
            assert!(names.iter().any(|name| name == test), "{number}: no test {test}");
        }
        assert!(!tests.is_empty() || !open.is_empty(), "{number}: neither a test nor a word on what is open");
    }
}

/// With `OCELLUS_TRIALS_TABLE` set to what `OCELLUS_TRIALS_FILE` collected: prints it in the order of the cases, with
/// what is open, and fails for a case with tests that left no line there. `tests/hard_cases` does both.
#[test]
fn table_of_trials() {
    let Some(path) = std::env::var_os("OCELLUS_TRIALS_TABLE") else { return };
    let lines = std::fs::read_to_string(&path).expect("OCELLUS_TRIALS_TABLE can be read");
    let mut rows: BTreeMap<&str, Vec<Vec<&str>>> = BTreeMap::new();
    for line in lines.lines() {
        let cells: Vec<&str> = line.split('\t').collect();
        rows.entry(cells[0]).or_default().push(cells[1..].to_vec());
    }
    println!("case in  trials    failures worst      limit                what");
    let mut silent = Vec::new();
    for Case { number, what, tests, open } in CASES {
        println!("{number:<4} {what}{}", if open.is_empty() { String::new() } else { format!(" (open: {open})") });
        let mut rows = rows.remove(number).unwrap_or_default();
        if rows.is_empty() && !tests.is_empty() {
            silent.push(number);
        }
        rows.sort_by_key(|row| (row[1].to_owned(), row[0].to_owned()));
        for row in rows {
            let [precision, class, count, failures, worst, limit] = row[..] else { panic!("{row:?}") };
            println!("     {precision} {count:<9} {failures:<8} {worst:<10} {limit:<20} {class}");
        }
    }
    assert!(rows.is_empty(), "trials of cases that are not listed: {rows:?}");
    assert!(silent.is_empty(), "no trials were written down for {silent:?}");
}
