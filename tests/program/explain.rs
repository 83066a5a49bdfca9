//! `ocellus explain` against what a render says it needs, on every scene among the fixtures.

use std::path::Path;

use serde_json::Value;

use crate::run::{Folder, Outcome, fixture_scenes, program, repository};

/// What must stand in the block of lines that asks for an effect.
const WORDS: [(&str, &[&str]); 16] = [
    ("spheres", &["center"]),
    ("triangles", &["[[meshes]]"]),
    ("smooth-normals", &["vn "]),
    ("textures", &["texture", "map_Kd"]),
    ("mirror", &["mirror", "illum 3"]),
    ("glass", &["dielectric", "illum 7"]),
    ("point-light", &["\"point\""]),
    ("sphere-light", &["\"sphere\""]),
    ("emission", &["emission", "Ke "]),
    ("background", &["background"]),
    ("indirect", &["indirect", "[integrator]"]),
    ("roulette", &["roulette_after"]),
    ("aim", &["aim"]),
    ("lens", &["aperture_radius"]),
    ("filter", &["filter"]),
    ("sobol", &["sampler"]),
];

fn in_repository(arguments: &[&str]) -> Outcome {
    Outcome::of(&mut program(repository(), arguments)).with_code(0)
}

/// The lines from `line`, counted from 1, to the next blank one or head of a table.
fn block(file: &Path, line: usize) -> String {
    let text = std::fs::read_to_string(file).expect("the file that asks");
    let mut lines = text.lines().skip(line - 1);
    let first = lines.next().expect("a line of the file");
    let rest = lines.take_while(|line| !line.trim().is_empty() && !line.starts_with('['));
    // An entry of a list is a block of its own.
    if first.trim_start().starts_with('{') { first.to_owned() } else { [first].into_iter().chain(rest).collect() }
}

#[test]
fn the_listed_effects_are_those_of_the_render_and_each_line_asks_for_them() {
    let folder = Folder::new();
    let picture = folder.path("a.exr");
    let picture = picture.to_str().expect("a name in UTF-8");
    for scene in fixture_scenes() {
        let scene = scene.to_str().expect("a name in UTF-8");
        let explanation = in_repository(&["explain", "--json", scene]).json();
        let report = in_repository(&["render", "--json", "--size", "2x2", "--spp", "1", "-o", picture, scene]).json();
        let effects = explanation["effects"].as_object().expect("effects by name");
        let mut on = Vec::new();
        for (name, words) in WORDS {
            let origins = effects[name].as_array().expect("a list of places");
            if !origins.is_empty() {
                on.push(Value::from(name));
            }
            for origin in origins {
                let origin = origin.as_str().expect("a place");
                // The end of a path is a number only where it is a line.
                let (file, line) = origin.rsplit_once(':').unwrap_or((origin, "0"));
                let file = repository().join(file);
                match line.parse().expect("a line") {
                    0 => assert_eq!((name, file), ("indirect", repository().join(scene)), "{scene}"),
                    line => {
                        let block = block(&file, line);
                        assert!(words.iter().any(|word| block.contains(word)), "{scene}: {name} at {origin}: {block}");
                    }
                }
            }
        }
        assert_eq!(effects.len(), WORDS.len());
        assert_eq!(Value::from(on), report["effects"], "{scene}");
        assert_eq!(explanation["kernel"], report["kernel"], "{scene}");
    }
}

#[test]
fn the_text_names_all_effects_within_100_columns() {
    for scene in fixture_scenes().iter().map(|path| path.as_path()).chain([Path::new("fixtures/meshes/cat.obj")]) {
        let scene = scene.to_str().expect("a name in UTF-8");
        let text = in_repository(&["explain", scene]).stdout;
        for line in text.lines() {
            assert!(line.chars().count() <= 100, "{scene}: {line}");
            assert_eq!(line.trim_end(), line, "{scene}");
        }
        for (name, _) in WORDS {
            assert!(text.contains(name), "{scene}: no {name} in {text}");
        }
        assert!(!text.contains(" 1 lights") && !text.contains(" 1 spheres"), "{text}");
    }
}

#[test]
fn the_report_s_figure_is_explained_line_by_line() {
    let text = in_repository(&["explain", "fixtures/report/fig5c.toml"]).stdout;
    for line in [
        "scene    fixtures/report/fig5c.toml",
        "         10 spheres, 1 light, 8 materials",
        "picture  512 x 512 pixels, 128 samples each, up to 9 bounces",
        "  spheres         fixtures/report/fig5c.toml:6-15,44",
        "  mirror          fixtures/report/fig5c.toml:41",
        "  glass           fixtures/report/fig5c.toml:42",
        "  film         20.0 MiB",
    ] {
        assert!(text.lines().any(|found| found == line), "no line {line:?} in {text}");
    }
}

#[test]
fn what_the_command_line_changes_is_explained() {
    let folder = Folder::with_ball();
    let of =
        |arguments: &[&str]| folder.run(&[&["explain", "ball.toml", "--json"], arguments].concat()).with_code(0).json();
    let plain = of(&[]);
    assert_eq!(plain["precision"], "f32");
    assert_eq!(plain["film_bytes"], 8 * 8 * 80);
    assert_ne!(plain["kernel"], "everything");
    assert!(plain["bvh"].is_object());
    assert_eq!(of(&["--size", "16x8"])["film_bytes"], 2 * 8 * 8 * 80);
    assert_eq!(of(&["--effects", "all"])["kernel"], "everything");
    assert_eq!(of(&["--sampler", "sobol"])["effects"]["sobol"], serde_json::json!(["--sampler"]));
    let none = of(&["--accel", "none", "--precision", "f64"]);
    assert_eq!((none["precision"].as_str(), none["bvh"].is_null(), &none["bvh_bytes"]), (Some("f64"), true, &0.into()));
}

/// Where no file says what is wanted, the file as a whole is named.
#[test]
fn a_bare_mesh_is_explained() {
    let text = in_repository(&["explain", "fixtures/meshes/cat.obj"]).stdout;
    for line in [
        "  triangles       fixtures/meshes/cat.obj",
        "  background      fixtures/meshes/cat.obj (by default)",
        "  textures        fixtures/meshes/cat.mtl:4",
    ] {
        assert!(text.lines().any(|found| found == line), "no line {line:?} in {text}");
    }
}
