//! One scene and seed, one picture: by whichever threads, structure, kernel and split.

use serde_json::Value;

use crate::run::{Folder, fixture};

/// Spheres with glass, a textured mesh, a lens, and roulette.
const SCENES: [&str; 4] =
    ["report/fig5c.toml", "features/mesh_smooth_textured.toml", "features/lens.toml", "features/roulette.toml"];

fn scene(name: &str) -> String {
    fixture(name).to_str().expect("a name in UTF-8").to_owned()
}

fn render(folder: &Folder, scene: &str, arguments: &[&str]) -> Value {
    folder.render(&[&[scene, "--size", "24x20", "-o", "a.exr"], arguments].concat())
}

#[test]
fn threads_structure_kernel_and_the_way_to_ask_change_no_bit() {
    let folder = Folder::new();
    for name in SCENES {
        let scene = scene(name);
        let of = |arguments: &[&str]| render(&folder, &scene, &[&["--spp", "8"], arguments].concat());
        let plain = of(&[]);
        assert_eq!(plain["accel"], "bvh");
        for (key, value, arguments) in [
            ("samples", serde_json::json!([0, 8]), &[][..]),
            ("threads", 1.into(), &["--threads", "1"]),
            ("threads", 2.into(), &["--threads", "2"]),
            ("threads", 5.into(), &["--threads", "5"]),
            ("accel", "none".into(), &["--accel", "none"]),
            ("accel", "box".into(), &["--accel", "box"]),
            ("kernel", "everything".into(), &["--effects", "all"]),
        ] {
            let other = of(arguments);
            assert_eq!(other[key], value, "{name} {arguments:?}");
            assert_eq!(other["image_hash"], plain["image_hash"], "{name} {arguments:?}");
            assert_eq!(other["rays"], plain["rays"], "{name} {arguments:?}");
        }
        let samples = render(&folder, &scene, &["--samples", "0..8"]);
        assert_eq!(samples["image_hash"], plain["image_hash"], "{name}");
    }
}

#[test]
fn seed_and_samples_change_the_picture() {
    let folder = Folder::new();
    let scene = scene(SCENES[0]);
    let mut hashes: Vec<String> = Vec::new();
    for arguments in [
        &["--spp", "8"][..],
        &["--spp", "8", "--seed", "1"],
        &["--spp", "8", "--seed", "18446744073709551615"],
        &["--spp", "4"],
        &["--samples", "4..8"],
        &["--spp", "8", "--max-bounces", "1"],
        &["--spp", "8", "--precision", "f64"],
    ] {
        let hash = render(&folder, &scene, arguments)["image_hash"].to_string();
        assert!(!hashes.contains(&hash), "{arguments:?}");
        hashes.push(hash);
    }
}

#[test]
fn a_crop_is_exactly_that_part_of_the_picture() {
    let folder = Folder::new();
    let [x0, y0, x1, y1] = [5, 3, 18, 11];
    for name in SCENES {
        let scene = scene(name);
        render(&folder, &scene, &["--spp", "4"]);
        let whole = folder.picture("a.exr");
        let report = render(&folder, &scene, &["--spp", "4", "--crop", "5,3,18,11"]);
        let part = folder.picture("a.exr");
        assert_eq!(report["crop"], serde_json::json!([x0, y0, x1, y1]));
        assert_eq!(report["paths"], (x1 - x0) * (y1 - y0) * 4);
        assert_eq!((part.width as usize, part.height as usize), (x1 - x0, y1 - y0));
        for y in y0..y1 {
            let row = &whole.pixels[y * whole.width as usize..][x0..x1];
            let bits = |pixels: &[[f32; 3]]| pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>();
            assert_eq!(bits(&part.pixels[(y - y0) * (x1 - x0)..][..x1 - x0]), bits(row), "{name}, row {y}");
        }
    }
}

/// Both precisions follow the same numbers, so what is between them is rounding and no noise: 1e-4 is 1 % of a value,
/// while pictures of two seeds are 100 times as far apart.
#[test]
fn the_precisions_agree_but_for_rounding() {
    let folder = Folder::new();
    for name in SCENES {
        let scene = scene(name);
        let of = |output: &str, arguments: &[&str]| {
            folder.render(&[&[&scene, "--size", "24x20", "--spp", "8", "-o", output], arguments].concat())
        };
        let single = of("f32.exr", &[]);
        let double = of("f64.exr", &["--precision", "f64"]);
        of("seed.exr", &["--seed", "1"]);
        assert_eq!((single["precision"].as_str(), double["precision"].as_str()), (Some("f32"), Some("f64")));
        assert_ne!(single["image_hash"], double["image_hash"], "{name}");
        let close = ["--metric", "relmse", "--tolerance", "1e-4"];
        folder.run(&[&["diff", "f32.exr", "f64.exr"], &close[..]].concat()).with_code(0);
        let apart = ["--metric", "relmse", "--tolerance", "1e-2"];
        folder.run(&[&["diff", "f32.exr", "seed.exr"], &apart[..]].concat()).with_code(1);
    }
}
