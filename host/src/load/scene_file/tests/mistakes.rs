//! What is wrong with a scene file, as the user is told.

use super::{BALL, CAMERA, scene};
use crate::error::ExitCode;
use crate::load::load_scene_file;
use crate::load::test_folder::TestFolder;

/// A file that is wrong, the line that is to blame, and parts of the cause and of the remedy.
struct Wrong(&'static str, usize, &'static str, &'static str);

#[test]
fn every_mistake_is_named_with_its_line_and_a_remedy() {
    // CAMERA and BALL stand before each of these, unless it has its own; line 0 is the file as a whole.
    let cases = [
        Wrong("film.spp = = 3\n", 1, "not TOML", "scene-reference.md"),
        Wrong("\nfilm.spp = 3\nfilm.spp = 4\n", 3, "duplicate key", "scene-reference.md"),
        Wrong("\nfilms.spp = 3\n", 2, "unknown key `films` in a scene file", "did you mean `film`?"),
        Wrong("film.fliter = \"box\"\n", 1, "unknown key `fliter` in [film]", "did you mean `filter`?"),
        Wrong("film.zoom = 1\n", 1, "unknown key `zoom` in [film]", "the keys here are filter, width, height"),
        Wrong("film.filter_stdev = 1\n", 1, "`filter_stdev` in [film] belongs to filter = \"gaussian\"", "remove it"),
        Wrong("film.width = 0\n", 1, "`width` in [film] is 0", "from 1 to 65535"),
        Wrong("film.width = 1.5\n", 1, "`width` in [film] is 1.5", "whole number"),
        Wrong("film.height = 65536\n", 1, "is 65536, but a whole number from 1 to 65535 is wanted", "height = 512"),
        Wrong("film.spp = \"many\"\n", 1, "is the text \"many\"", "spp = 64"),
        Wrong("film.filter = \"lanczos\"\n", 1, "one of \"box\", \"center\", \"tent\", \"gaussian\"", "\"box\""),
        Wrong("film.gamma = 0\n", 1, "`gamma` in [film] is 0", "2.2"),
        Wrong("film = 3\n", 1, "[film] is 3, but a table is wanted", "on a line of its own"),
        Wrong("[[film]]\nspp = 3\n", 1, "a table is wanted", "write [film]"),
        Wrong("integrator.indirect = 1\n", 1, "`indirect` in [integrator] is 1", "true or false"),
        Wrong("integrator.max_bounces = -1\n", 1, "is -1, but a whole number", "max_bounces = 7"),
        Wrong("integrator.fresnel = true\n", 1, "is true", "\"exact\""),
        Wrong("integrator.light_sampling = \"area\"\n", 1, "is the text \"area\"", "\"hemisphere\""),
        Wrong("integrator.sampler = \"halton\"\n", 1, "one of \"independent\", \"sobol\"", "\"sobol\""),
        Wrong("surroundings.background = [1, 2]\n", 1, "is [1, 2]", "one or three finite numbers"),
        Wrong("surroundings.ambient_ior = 0\n", 1, "`ambient_ior` in [surroundings] is 0", "greater than 0"),
        Wrong("materials.x.albedo = 0.5\n", 1, "[materials.x] has no `kind`", "kind = \"diffuse\""),
        Wrong("materials.x.kind = \"shiny\"\n", 1, "one of \"diffuse\", \"mirror\", \"dielectric\"", "kind = "),
        Wrong("materials.x = { kind = \"mirror\", ior = 2 }\n", 1, "belongs to kind = \"dielectric\"", "choose kind ="),
        Wrong(
            "materials.x = { kind = \"diffuse\", albedo = 1.5 }\n",
            1,
            "`albedo` in [materials.x] is 1.5",
            "from 0 to 1",
        ),
        Wrong("materials.x = { kind = \"diffuse\", emission = -1 }\n", 1, "is -1", "0 or greater"),
        Wrong("[[materials]]\nkind = \"mirror\"\n", 1, "a table is wanted", "write [materials]"),
        Wrong("camera.look_at = [0, 0, 0]\n", 1, "[camera] has no `position`", "position = [0, 1, 5]"),
        Wrong("film.spp = 1\n[integrator]\n[camera]\n", 3, "[camera] has no `position`", "add three finite numbers"),
        Wrong(
            "camera = { position = [nan, 0, 0], look_at = [0, 0, 0] }\n",
            1,
            "is [nan, 0, 0]",
            "three finite numbers",
        ),
        Wrong(
            "camera = { position = [0, 0, inf], look_at = [0, 0, 0] }\n",
            1,
            "is [0, 0, inf]",
            "three finite numbers",
        ),
        Wrong(
            "[camera]\nposition = [0, 0, 1]\nlook_at = [0, 0, 1]\n",
            3,
            "`look_at` in [camera] is where the camera is",
            "move one",
        ),
        Wrong(
            "[camera]\nposition = [0, 5, 0]\nlook_at = [0, 0, 0]\n",
            1,
            "`up` in [camera] is zero or lies along the view",
            "up = [0, 0, -1]",
        ),
        Wrong(
            "[camera]\nposition = [0, 0, 1]\nlook_at = [0, 0, 0]\nup = [0, 0, 0]\n",
            4,
            "`up` in [camera] is zero",
            "give",
        ),
        Wrong(
            "[camera]\nposition = [0, 0, 1]\nlook_at = [0, 0, 0]\nfov_degrees = 180\n",
            4,
            "`fov_degrees` in [camera] is 180",
            "between 0 and 180",
        ),
        Wrong(
            "[camera]\nposition = [0, 0, 1]\nlook_at = [0, 0, 0]\nfov = 50\n",
            4,
            "unknown key `fov`",
            "did you mean `fov_degrees`?",
        ),
        Wrong(
            "[[spheres]]\ncenter = [0, 0, 0]\nraduis = 1\nmaterial = \"m\"\n",
            3,
            "unknown key `raduis` in [[spheres]]",
            "did you mean `radius`?",
        ),
        Wrong("[[spheres]]\ncenter = [0, 0, 0]\nmaterial = \"m\"\n", 1, "[[spheres]] has no `radius`", "radius = 1.5"),
        Wrong("[[spheres]]\ncenter = [0, 0, 0]\nradius = -2\n", 3, "`radius` in [[spheres]] is -2", "greater than 0"),
        Wrong(
            "[materials.glass]\nkind = \"dielectric\"\n[[spheres]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"glas\"\n",
            6,
            "there is no material `glas`",
            "did you mean `glass`?",
        ),
        Wrong(
            "[materials.glass]\nkind = \"dielectric\"\n[[spheres]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"stone\"\n",
            6,
            "there is no material `stone`",
            "take one of glass",
        ),
        Wrong(
            "[spheres]\ncenter = [0, 0, 0]\n",
            1,
            "a list of tables is wanted",
            "write [[spheres]], with two brackets",
        ),
        Wrong("[[meshes]]\nscale = 2\n", 1, "[[meshes]] has no `file`", "file = \"cat.obj\""),
        Wrong(
            "[[meshes]]\nfile = \"a.obj\"\nscale = [1, 0, 1]\n",
            3,
            "`scale` in [[meshes]] is [1, 0, 1]",
            "greater than 0",
        ),
        Wrong("[[meshes]]\nfile = \"a.obj\"\nmaterial = \"m2\"\n", 3, "there is no material `m2`", "[materials.m2]"),
        Wrong("[[lights]]\nkind = \"sun\"\n", 2, "is the text \"sun\"", "one of \"point\", \"sphere\""),
        Wrong(
            "[[lights]]\nkind = \"point\"\nposition = [0, 1, 0]\n",
            1,
            "[[lights]] has no `power`",
            "add one or three",
        ),
        Wrong(
            "[[lights]]\nkind = \"point\"\nposition = [0, 1, 0]\npower = 1\nradius = 1\n",
            5,
            "`radius` in [[lights]] belongs to kind = \"sphere\"",
            "choose kind = \"sphere\"",
        ),
        Wrong(
            "[[lights]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\npower = 1\nradiance = 1\n",
            5,
            "`power` and `radiance`",
            "remove one",
        ),
        Wrong(
            "[[lights]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\n",
            1,
            "[[lights]] has no `power`",
            "power = ",
        ),
        Wrong(
            "[[lights]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1e-18\npower = 1e5\n",
            5,
            "more radiance than a number can hold",
            "larger radius",
        ),
        Wrong("spheres = []\n", 0, "empty scene", "[[spheres]]"),
    ];
    for Wrong(text, line, cause, remedy) in cases {
        let camera = if text.contains("camera") { "" } else { CAMERA };
        let ball = if ["spheres", "meshes", "materials"].iter().any(|own| text.contains(own)) { "" } else { BALL };
        let before = [camera, ball].concat();
        let error = scene(&[&before, text].concat()).expect_err(text);
        assert!(error.cause.contains(cause), "{text}: cause {:?}, expected {cause:?}", error.cause);
        assert!(error.remedy.contains(remedy), "{text}: remedy {:?}, expected {remedy:?}", error.remedy);
        let expected = if line == 0 { 0 } else { before.lines().count() + line };
        assert_eq!(error.origin.map(|origin| origin.line), Some(expected), "{text}: {}", error.cause);
        assert_eq!(error.code, ExitCode::BadScene);
    }
}

#[test]
fn files_that_are_missing_are_named_with_the_line_that_asked() {
    let folder = TestFolder::new();
    let nowhere = load_scene_file(&folder.path("none.toml")).expect_err("no such file");
    assert_eq!((nowhere.code, nowhere.origin), (ExitCode::MissingInput, None));
    for (text, line) in [
        (format!("{CAMERA}[[meshes]]\nfile = \"none.obj\"\n"), 3),
        (format!("{CAMERA}{BALL}[materials.t]\nkind = \"diffuse\"\ntexture = \"none.png\"\n"), 6),
    ] {
        let path = folder.write("a.toml", &text);
        let error = load_scene_file(&path).expect_err(&text);
        assert_eq!(error.code, ExitCode::MissingInput, "{error}");
        assert_eq!(error.origin.as_ref().map(|origin| origin.line), Some(line), "{error}");
        assert_eq!(error.file(), Some(path));
        assert!(error.cause.contains("none."), "{error}");
    }
}

#[test]
fn text_that_is_not_utf8_is_an_error_with_its_line() {
    let folder = TestFolder::new();
    let error = load_scene_file(&folder.write("a.toml", b"[camera]\n# caf\xe9\n")).expect_err("not UTF-8");
    assert_eq!(error.origin.map(|origin| origin.line), Some(2));
}
