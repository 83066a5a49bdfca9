//! The fixtures and the reference page fit the code.

use super::{BALL, CAMERA, fixtures, scene};
use crate::load::load_scene_file;
use std::collections::{BTreeMap, BTreeSet};

#[test]
fn every_fixture_is_a_good_scene() {
    let mut count = 0;
    let mut faults = Vec::new();
    for folder in ["report", "features"] {
        let entries = std::fs::read_dir(fixtures().join(folder)).expect("the fixtures");
        let paths = entries.map(|entry| entry.expect("an entry").path());
        for path in paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml")) {
            count += 1;
            match load_scene_file(&path) {
                Ok(scene) => faults.extend(scene.warnings.iter().map(ToString::to_string)),
                Err(error) => faults.push(error.to_string()),
            }
        }
    }
    assert_eq!(faults, Vec::<String>::new());
    assert!(count >= 30, "only {count} scenes found");
}

/// The keys of each table, as the reader itself lists them when it meets one that it does not know.
fn known_keys() -> BTreeMap<&'static str, BTreeSet<String>> {
    let mut known = BTreeMap::<_, BTreeSet<String>>::new();
    for (table, texts) in [
        ("a scene file", &[""][..]),
        ("[camera]", &["position = [0, 0, 1]\nlook_at = [0, 0, 0]"]),
        ("[film]", &["filter = \"box\"", "filter = \"center\"", "filter = \"tent\"", "filter = \"gaussian\""]),
        ("[integrator]", &[""]),
        ("[surroundings]", &[""]),
        ("[materials.NAME]", &["kind = \"diffuse\"", "kind = \"mirror\"", "kind = \"dielectric\""]),
        ("[[spheres]]", &["center = [0, 0, 0]\nradius = 1\nmaterial = \"m\""]),
        ("[[meshes]]", &["file = \"a.obj\""]),
        (
            "[[lights]]",
            &[
                "kind = \"point\"\nposition = [0, 0, 0]\npower = 1",
                "kind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nradiance = 1",
            ],
        ),
    ] {
        for text in texts {
            let others = if table == "[camera]" { BALL.into() } else { [CAMERA, BALL].concat() };
            let others = if table == "[[spheres]]" { others.replace("spheres", "#") } else { others };
            let head = if table == "a scene file" { String::new() } else { format!("{table}\n") };
            let error = scene(&format!("{others}{head}{text}\nqqqqqq = 1\n")).expect_err("an unknown key");
            assert!(error.cause.contains("unknown key `qqqqqq`"), "{}", error.cause);
            let keys = error.remedy.strip_prefix("the keys here are ").expect("a list of keys");
            known.entry(table).or_default().extend(keys.split(", ").map(str::to_owned));
        }
    }
    known
}

#[test]
fn the_reference_page_lists_every_key_and_no_other() {
    let page = std::fs::read_to_string(fixtures().join("scene-reference.md")).expect("the reference page");
    let mut listed = BTreeMap::<&str, BTreeSet<String>>::new();
    let mut section = "";
    for line in page.lines() {
        if let Some(title) = line.strip_prefix("## `").and_then(|rest| rest.strip_suffix('`')) {
            section = title;
        } else if let Some(row) = line.strip_prefix("| `") {
            let key = row.split('`').next().expect("a key").to_owned();
            listed.entry(section).or_default().insert(key);
        }
    }
    let mut known = known_keys();
    let tables = known.remove("a scene file").expect("the tables");
    assert_eq!(listed, known);
    let sections = listed.keys().map(|title| title.trim_matches(['[', ']']).trim_end_matches(".NAME").to_owned());
    assert_eq!(sections.collect::<BTreeSet<_>>(), tables);
}
