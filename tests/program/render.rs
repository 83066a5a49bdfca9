//! `ocellus render`: the files, the report, and what each option changes.

use std::io::BufReader;

use exr::prelude::{AttributeValue, MetaData, Text};
use ocellus::output::{ATTRIBUTE_PREFIX, ToneMap};
use ocellus::picture::Picture;
use ocellus_kernel::ImageHash;
use serde_json::{Value, json};

use crate::run::{BALL, Folder, fixture};

fn hash(picture: &Picture) -> String {
    let mut hash = ImageHash::new(picture.width, picture.height);
    picture.pixels.iter().for_each(|pixel| hash.add(*pixel));
    format!("{:016x}", hash.finish())
}

/// The 8-bit codes of a PNG and what stands beside them.
fn codes(folder: &Folder, name: &str) -> (Vec<u8>, png::Info<'static>) {
    let file = std::fs::File::open(folder.path(name)).expect("the picture");
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().expect("a PNG");
    let mut codes = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut codes).expect("all pixels");
    (codes, reader.info().clone())
}

#[test]
fn both_formats_hold_the_picture_whose_hash_is_reported() {
    let folder = Folder::with_ball();
    let outcome = folder.run(&["render", "ball.toml", "--json", "-o", "a.png", "-o", "b.EXR"]).with_code(0);
    assert!(outcome.stderr.contains("wrote a.png\nwrote b.EXR\n"), "{}", outcome.stderr);
    let linear = folder.picture("b.EXR");
    assert_eq!((linear.width, linear.height), (8, 8));
    assert_eq!(outcome.json()["image_hash"], hash(&linear));
    assert_eq!(codes(&folder, "a.png").0, ToneMap::default().encode_picture(&linear));
    assert!(linear.pixels.as_flattened().iter().any(|&value| value > 0.1), "a black picture");
    assert_eq!(folder.names(), ["a.png", "b.EXR", "ball.toml"]);
}

#[test]
fn the_picture_is_named_after_the_scene_and_lies_in_the_current_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("scenes")).expect("a folder");
    folder.write("scenes/a.ball.toml", BALL);
    let outcome = folder.run(&["render", "scenes/a.ball.toml"]).with_code(0);
    assert_eq!(outcome.stdout, "");
    assert!(outcome.stderr.contains("wrote a.ball.png\n"), "{}", outcome.stderr);
    assert_eq!(folder.names(), ["a.ball.png", "scenes"]);
    let first = std::fs::read(folder.path("a.ball.png")).expect("the picture");
    folder.run(&["render", "scenes/a.ball.toml", "--seed", "1"]).with_code(0);
    assert_ne!(std::fs::read(folder.path("a.ball.png")).expect("the picture"), first, "its own picture is replaced");
    assert_eq!(folder.names(), ["a.ball.png", "scenes"]);
}

#[test]
fn the_report_has_every_key() {
    let folder = Folder::with_ball();
    let arguments =
        ["ball.toml", "--seed", "7", "--samples", "2..5", "--crop", "1,2,7,8", "--threads", "2", "-o", "a.exr"];
    let report = folder.render(&arguments);
    for (key, value) in [
        ("program", json!(concat!("ocellus ", env!("CARGO_PKG_VERSION")))),
        ("scene", json!("ball.toml")),
        ("seed", json!(7)),
        ("size", json!([8, 8])),
        ("crop", json!([1, 2, 7, 8])),
        ("spp", json!(3)),
        ("samples", json!([2, 5])),
        ("samples_per_pixel", json!([3, 3])),
        ("max_bounces", json!(7)),
        ("fresnel", json!("exact")),
        ("sampler", json!("independent")),
        ("effects", json!(["spheres", "sphere-light", "indirect"])),
        ("precision", json!("f32")),
        ("accuracy", json!("robust")),
        ("accel", json!("bvh")),
        ("threads", json!(2)),
        ("paths", json!(6 * 6 * 3)),
        ("non_finite", json!(0)),
        ("first_non_finite_pixel", Value::Null),
        ("interrupted", json!(false)),
        ("image_hash", json!(hash(&folder.picture("a.exr")))),
    ] {
        assert_eq!(report[key], value, "{key}");
    }
    for key in ["kernel", "isa"] {
        assert!(report[key].as_str().is_some_and(|text| !text.is_empty()), "{key}");
    }
    for key in ["load_seconds", "setup_seconds", "trace_seconds", "estimated_rmse"] {
        assert!(report[key].as_f64().is_some_and(|number| number > 0.0), "{key}: {}", report[key]);
    }
    assert!(report["rays"].as_u64() >= report["paths"].as_u64());
    let one = folder.render(&["ball.toml", "--spp", "1", "-o", "a.exr"]);
    assert!(one["estimated_rmse"].is_null(), "one sample tells nothing about its error");
}

#[test]
fn choices_are_reported() {
    let folder = Folder::with_ball();
    let robust = folder.render(&["ball.toml", "-o", "a.exr"]);
    let arguments = ["ball.toml", "--sphere-test", "narrow", "--triangle-test", "watertight", "-o", "b.exr"];
    let narrow = folder.render(&arguments);
    assert_eq!((&narrow["accuracy"], &narrow["kernel"]), (&json!("--sphere-test narrow"), &json!("everything")));
    assert_ne!(narrow["image_hash"], robust["image_hash"], "less exact spheres change some bits");
    let explained = folder.run(&["explain", "ball.toml", "--ray-offset", "constant"]).with_code(0);
    assert!(explained.stdout.contains("\naccuracy --ray-offset constant\n"), "{}", explained.stdout);
    let schlick = folder.render(&["ball.toml", "--fresnel", "schlick", "-o", "d.exr"]);
    assert_eq!(schlick["fresnel"], json!("schlick"));
    let sobol = folder.render(&["ball.toml", "--sampler", "sobol", "-o", "e.exr"]);
    assert_eq!(sobol["sampler"], json!("sobol"));
    assert_ne!(sobol["image_hash"], robust["image_hash"]);
    let summary = folder.run(&["render", "ball.toml", "--slab-test", "unpadded", "-o", "c.exr"]).with_code(0).stderr;
    assert!(summary.contains("kernel everything with --slab-test unpadded"), "{summary}");
}

#[test]
fn pictures_say_how_they_were_made() {
    let folder = Folder::with_ball();
    let report = folder.render(&["ball.toml", "-o", "a.png", "-o", "a.exr"]);
    let report = report.as_object().expect("an object");
    let info = codes(&folder, "a.png").1;
    let header = &MetaData::read_from_file(folder.path("a.exr"), true).expect("an EXR").headers[0];
    let of_machine = |key: &str| key.ends_with("_seconds") || ["threads", "isa"].contains(&key);
    for (key, value) in report.iter().filter(|(key, _)| !of_machine(key)) {
        let expected = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let text = info.uncompressed_latin1_text.iter().find(|text| text.keyword == *key);
        assert_eq!(text.map(|text| &text.text), Some(&expected), "{key} in the PNG");
        let name = Text::from(format!("{ATTRIBUTE_PREFIX}{key}").as_str());
        match header.own_attributes.other.get(&name) {
            Some(AttributeValue::Text(text)) => assert_eq!(text.to_string(), expected, "{key} in the EXR"),
            other => panic!("{key} in the EXR: {other:?}"),
        }
    }
    // Nothing of the machine or of the moment is in them: the same render gives the same files.
    folder.render(&["ball.toml", "--threads", "1", "-o", "b.png", "-o", "b.exr"]);
    for [a, b] in [["a.png", "b.png"], ["a.exr", "b.exr"]] {
        let [a, b] = [a, b].map(|name| std::fs::read(folder.path(name)).expect("a picture"));
        assert!(a == b, "the files differ");
    }
}

#[test]
fn an_existing_picture_is_replaced_whole() {
    let folder = Folder::with_ball();
    for name in ["a.png", "a.exr"] {
        folder.write(name, vec![b'x'; 1 << 16]);
        folder.render(&["ball.toml", "-o", name]);
        assert_eq!(folder.picture(name).pixels.len(), 64);
        let size = std::fs::metadata(folder.path(name)).expect("the picture").len();
        assert!(size < 1 << 16, "rests of the old file");
    }
    assert_eq!(folder.names(), ["a.exr", "a.png", "ball.toml"]);
}

#[test]
fn without_bounces_only_emitters_are_seen() {
    let folder = Folder::new();
    folder.write("a.toml", BALL.replace("spp = 4", "spp = 4\nfilter = \"center\""));
    let size = ["--size", "32x32", "-o", "a.exr", "--max-bounces"];
    let seen = |bounces: &str| {
        folder.render(&[&["a.toml"], &size[..], &[bounces]].concat());
        let pixels = folder.picture("a.exr").pixels;
        let lamp = pixels.iter().filter(|&&pixel| pixel == [10.0; 3]).count();
        let black = pixels.iter().filter(|&&pixel| pixel == [0.0; 3]).count();
        (lamp, black, pixels.len())
    };
    let (lamp, black, all) = seen("0");
    assert!(lamp > 20, "the lamp fills {lamp} pixels");
    assert_eq!(lamp + black, all);
    let (lamp_with_direct_light, black, all) = seen("1");
    assert_eq!(lamp_with_direct_light, lamp);
    assert!(all - lamp - black > 30, "the ball is lit");
}

#[test]
fn gamma_and_exposure_change_the_view_and_not_the_truth() {
    let folder = Folder::with_ball();
    let mut plain = None;
    for (arguments, exposure_ev, gamma) in [
        (&[][..], 0.0, None),
        (&["--gamma", "2.2"], 0.0, Some(2.2)),
        (&["--gamma", "1"], 0.0, Some(1.0)),
        (&["--exposure", "1.5"], 1.5, None),
        (&["--exposure", "-2"], -2.0, None),
    ] {
        let report = folder.render(&[&["ball.toml", "-o", "a.png", "-o", "a.exr"], arguments].concat());
        let linear = folder.picture("a.exr");
        let (codes, info) = codes(&folder, "a.png");
        assert_eq!(codes, ToneMap { exposure_ev, gamma }.encode_picture(&linear), "{arguments:?}");
        assert_eq!(
            (info.srgb.is_some(), info.gama_chunk.is_some()),
            (gamma.is_none(), gamma.is_some()),
            "{arguments:?}"
        );
        assert_eq!(report["image_hash"], hash(&linear));
        let (plain_codes, plain_linear) = plain.get_or_insert_with(|| (codes.clone(), linear.clone()));
        assert_eq!(&linear, plain_linear, "{arguments:?}");
        assert_eq!(&codes == plain_codes, arguments.is_empty(), "{arguments:?}");
    }
}

#[test]
fn the_scene_s_own_gamma_and_exposure_hold_unless_the_command_line_has_others() {
    let folder = Folder::new();
    folder.write("a.toml", BALL.replace("spp = 4", "spp = 4\ngamma = 2.2\nexposure = -1"));
    folder.render(&["a.toml", "-o", "a.png", "-o", "a.exr"]);
    let linear = folder.picture("a.exr");
    let of = |exposure_ev, gamma| ToneMap { exposure_ev, gamma }.encode_picture(&linear);
    assert_eq!(codes(&folder, "a.png").0, of(-1.0, Some(2.2)));
    folder.render(&["a.toml", "-o", "a.png", "--gamma", "1.8", "--exposure", "1"]);
    assert_eq!(codes(&folder, "a.png").0, of(1.0, Some(1.8)));
}

#[test]
fn a_bare_mesh_gets_a_camera_and_a_light() {
    let folder = Folder::new();
    let cat = fixture("meshes/cat.obj");
    let report = folder.render(&[cat.to_str().expect("UTF-8"), "--size", "48x48", "--spp", "4", "-o", "cat.exr"]);
    assert_eq!(report["non_finite"], 0);
    let picture = folder.picture("cat.exr");
    let brightness: Vec<f32> = picture.pixels.iter().map(|pixel| pixel.iter().sum::<f32>() / 3.0).collect();
    // The surround has radiance 0.5; the cat is what differs from it.
    let cat = brightness.iter().filter(|&&value| (value - 0.5).abs() > 1e-3).count();
    assert!((300..2000).contains(&cat), "the cat fills {cat} of 2304 pixels");
    assert!(brightness.iter().all(|&value| value > 0.0 && value < 20.0));
}
