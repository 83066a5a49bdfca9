//! What the program refuses: each with its exit code, the place, the cause and what to try.

use crate::run::{BALL, Folder};

/// A wrong input: files beside `ball.toml`, arguments, the exit code, and what standard error must say.
struct Refusal<'a> {
    files: &'a [(&'a str, &'a str)],
    arguments: &'a [&'a str],
    code: i32,
    says: &'a [&'a str],
}

impl Refusal<'_> {
    #[track_caller]
    fn check(&self) {
        let folder = Folder::with_ball();
        for (name, content) in self.files {
            folder.write(name, content);
        }
        self.check_in(&folder);
    }

    #[track_caller]
    fn check_in(&self, folder: &Folder) {
        let before = folder.names();
        let outcome = folder.run(self.arguments).with_code(self.code);
        assert_eq!(outcome.stdout, "");
        assert_eq!(folder.names(), before, "something was left behind");
        let stderr = outcome.stderr;
        assert!(stderr.starts_with("error: "), "{stderr}");
        // What clap refuses ends in `try '--help'`.
        assert!(stderr.contains("\n  try: ") || stderr.contains("try '--help'"), "no remedy: {stderr}");
        assert!(!stderr.contains('\u{1b}'), "escape codes: {stderr}");
        for text in self.says {
            assert!(stderr.contains(text), "{text:?} is not in: {stderr}");
        }
    }
}

/// One test for each wrong scene file: [`BALL`] with one part replaced.
macro_rules! wrong_scenes {
    ($($name:ident: $part:literal => $wrong:literal, $code:literal, $says:expr;)*) => {$(
        #[test]
        fn $name() {
            assert!(BALL.contains($part));
            let scene = BALL.replacen($part, $wrong, 1);
            let (files, arguments) = (&[("a.toml", scene.as_str())], &["render", "a.toml", "-o", "a.png"]);
            Refusal { files, arguments, code: $code, says: &$says }.check();
        }
    )*};
}

wrong_scenes! {
    an_unknown_key: "radius = 1\n" => "raduis = 1\n", 65, ["a.toml:16: ", "unknown key `raduis`", "did you mean `radius`?"];
    an_unknown_table: "[film]" => "[flim]", 65, ["a.toml:6: ", "unknown key `flim`", "did you mean `film`?"];
    a_wrong_type: "radius = 1\n" => "radius = \"one\"\n", 65, ["a.toml:16: ", "`radius`", "is wanted", "as in `radius = "];
    text_that_is_not_toml: "[film]" => "[film", 65, ["a.toml:6: ", "not TOML", "scene-reference.md"];
    a_material_that_is_not_there: "material = \"grey\"" => "material = \"gray\"", 65,
        ["a.toml:17: ", "no material `gray`", "did you mean `grey`?"];
    a_picture_without_width: "width = 8" => "width = 0", 65, ["a.toml:7: ", "`width`", "1 to 65535"];
    a_picture_without_height: "height = 8" => "height = 0", 65, ["a.toml:8: ", "`height`", "1 to 65535"];
    a_picture_of_negative_width: "width = 8" => "width = -8", 65, ["a.toml:7: ", "`width`"];
    no_samples: "spp = 4" => "spp = 0", 65, ["a.toml:9: ", "`spp`"];
    a_field_of_view_that_is_no_number: "fov_degrees = 70" => "fov_degrees = nan", 65,
        ["a.toml:4: ", "`fov_degrees`", "between 0 and 180"];
    a_field_of_view_of_zero: "fov_degrees = 70" => "fov_degrees = 0", 65, ["a.toml:4: ", "between 0 and 180"];
    a_camera_at_infinity: "position = [0, 0, 4]" => "position = [0, 0, inf]", 65,
        ["a.toml:2: ", "`position`", "three finite numbers"];
    a_camera_that_is_no_number: "look_at = [0, 0, 0]" => "look_at = [nan, 0, 0]", 65,
        ["a.toml:3: ", "`look_at`", "three finite numbers"];
    a_camera_too_far_for_32_bits: "position = [0, 0, 4]" => "position = [0, 0, 1e39]", 65, ["a.toml:2: ", "`position`"];
    a_camera_that_looks_at_itself: "look_at = [0, 0, 0]" => "look_at = [0, 0, 4]", 65,
        ["a.toml:3: ", "where the camera is", "move one of them"];
    a_camera_that_looks_up: "look_at = [0, 0, 0]" => "look_at = [0, 9, 4]", 65, ["a.toml:1: ", "`up`", "across the view"];
    a_sphere_without_size: "radius = 1\n" => "radius = 0\n", 65, ["a.toml:16: ", "greater than 0"];
    a_missing_texture: "kind = \"diffuse\"" => "kind = \"diffuse\"\ntexture = \"none.png\"", 66,
        ["a.toml:13: ", "cannot read none.png", "relative to that file's folder"];
    a_texture_that_is_no_picture: "kind = \"diffuse\"" => "kind = \"diffuse\"\ntexture = \"ball.toml\"", 65,
        ["a.toml:13: ", "cannot decode the texture ball.toml", "use a PNG"];
    a_missing_mesh: "[[spheres]]" => "[[meshes]]\nfile = \"none.obj\"\n[[spheres]]", 66,
        ["a.toml:15: ", "cannot read none.obj", "check the path"];
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// One test for each wrong mesh: the content of `a.obj`, rendered as it is and through a scene.
macro_rules! wrong_meshes {
    ($($name:ident: $text:expr, $code:literal, $says:expr;)*) => {$(
        #[test]
        fn $name() {
            let text: String = $text.into();
            let scene = BALL.replacen("[[spheres]]", "[[meshes]]\nfile = \"a.obj\"\n[[spheres]]", 1);
            let files = &[("a.obj", text.as_str()), ("a.toml", scene.as_str()), ("bad.png", "no picture")];
            for scene in ["a.obj", "a.toml"] {
                let arguments = &["render", scene, "-o", "a.png"];
                Refusal { files, arguments, code: $code, says: &$says }.check();
            }
        }
    )*};
}

wrong_meshes! {
    an_index_out_of_range: format!("{TRIANGLE}f 1 2 4\n"), 65,
        ["a.obj:5: ", "position 4", "3 `v` lines", "indices count from 1"];
    an_index_before_the_first: format!("{TRIANGLE}f 1 2 -4\n"), 65, ["a.obj:5: ", "position -4"];
    an_index_of_zero: format!("{TRIANGLE}f 0 1 2\n"), 65, ["a.obj:5: ", "index 0"];
    a_texture_coordinate_out_of_range: format!("vt 0 0\n{TRIANGLE}f 1/1 2/2 3/1\n"), 65,
        ["a.obj:6: ", "texture coordinate 2", "1 `vt` line"];
    a_vertex_that_is_no_number: format!("{TRIANGLE}v 1 two 3\nf 1 2 4\n"), 65, ["a.obj:5: ", "two"];
    a_vertex_that_is_not_finite: format!("{TRIANGLE}v 1 nan 3\nf 1 2 4\n"), 65, ["a.obj:5: "];
    an_empty_file: "", 65, ["a.obj: ", "the mesh is empty", "`f` lines"];
    a_mesh_without_faces: "v 0 0 0\nv 1 0 0\nv 0 1 0\n", 65, ["a.obj: ", "the mesh is empty", "`f` lines"];
    a_mesh_of_collapsed_faces: "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3 1\n", 65, ["a.obj: ", "the mesh is empty", "export"];
    a_mesh_without_size: "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3 1\n", 65, ["a.obj: ", "try: "];
    a_missing_material_library: format!("mtllib none.mtl\n{TRIANGLE}"), 66,
        ["a.obj:1: ", "cannot read none.mtl", "check the path"];
}

#[test]
fn a_texture_of_a_material_library() {
    let obj = format!("mtllib a.mtl\nusemtl m\n{TRIANGLE}");
    for (texture, code, says) in
        [("none.png", 66, "cannot read none.png"), ("bad.png", 65, "cannot decode the texture")]
    {
        let mtl = format!("newmtl m\nmap_Kd {texture}\n");
        let files = &[("a.obj", obj.as_str()), ("a.mtl", mtl.as_str()), ("bad.png", "no picture")];
        let arguments = &["render", "a.obj", "-o", "a.png"];
        Refusal { files, arguments, code, says: &["a.mtl:2: ", says] }.check();
    }
}

/// One test for each wrong command line, most of them about `ball.toml`.
macro_rules! wrong_commands {
    ($($name:ident: [$($argument:literal),*], $code:literal, $says:expr;)*) => {$(
        #[test]
        fn $name() {
            Refusal { files: &[], arguments: &[$($argument),*], code: $code, says: &$says }.check();
        }
    )*};
}

wrong_commands! {
    a_missing_scene: ["render", "none.toml"], 66, ["cannot read none.toml", "check the path"];
    a_missing_scene_to_explain: ["explain", "none.toml"], 66, ["cannot read none.toml", "check the path"];
    a_missing_bare_mesh: ["render", "none.obj"], 66, ["cannot read none.obj", "check the path"];
    a_file_that_is_no_scene: ["render", "ball.txt"], 2, ["ball.txt", ".toml", ".obj"];
    a_folder_as_scene: ["render", "."], 2, [".toml", ".obj"];
    no_scene: ["render"], 2, ["<SCENE>"];
    an_unknown_command: ["rendr", "ball.toml"], 2, ["rendr", "render"];
    an_unknown_flag: ["render", "ball.toml", "--sppp", "1"], 2, ["--sppp", "--spp"];
    a_size_without_height: ["render", "ball.toml", "--size", "640"], 2, ["--size", "640x480"];
    a_size_of_zero: ["render", "ball.toml", "--size", "0x8"], 2, ["--size", "1 to 65535"];
    a_size_too_large: ["render", "ball.toml", "--size", "8x65536"], 2, ["--size", "1 to 65535"];
    zero_spp: ["render", "ball.toml", "--spp", "0"], 2, ["--spp", "1.."];
    negative_spp: ["render", "ball.toml", "--spp=-1"], 2, ["--spp", "1.."];
    an_empty_range_of_samples: ["render", "ball.toml", "--samples", "4..4"], 2, ["--samples", "0..64"];
    samples_that_are_no_range: ["render", "ball.toml", "--samples", "4"], 2, ["--samples", "0..64"];
    spp_beside_samples: ["render", "ball.toml", "--spp", "4", "--samples", "0..4"], 2, ["--spp", "--samples"];
    a_crop_outside_of_the_picture: ["render", "ball.toml", "-o", "a.png", "--crop", "0,0,9,8"], 2,
        ["0,0,9,8", "not part of the picture", "x1 <= 8"];
    an_empty_crop: ["render", "ball.toml", "--crop", "4,4,4,8"], 2, ["--crop", "x0 < x1"];
    more_threads_than_sense: ["render", "ball.toml", "--threads", "100000000"], 2, ["--threads", "1024"];
    a_number_of_threads_past_64_bits: ["render", "ball.toml", "--threads", "99999999999999999999"], 2, ["--threads"];
    more_bounces_than_a_scene_may_have: ["render", "ball.toml", "--max-bounces", "65536"], 2, ["--max-bounces", "65535"];
    a_gamma_of_zero: ["render", "ball.toml", "-o", "a.png", "--gamma", "0"], 2, ["gamma of 0", "2.2"];
    a_gamma_that_is_no_number: ["render", "ball.toml", "-o", "a.png", "--gamma", "nan"], 2, ["gamma", "2.2"];
    an_exposure_that_is_no_number: ["render", "ball.toml", "-o", "a.png", "--exposure", "inf"], 2, ["exposure"];
    an_unknown_precision: ["render", "ball.toml", "--precision", "f16"], 2, ["--precision", "f32, f64"];
    an_unknown_structure: ["render", "ball.toml", "--accel", "grid"], 2, ["--accel", "none, box, bvh"];
    an_unknown_choice_of_effects: ["render", "ball.toml", "--effects", "some"], 2, ["--effects", "auto, all"];
    a_seed_that_is_no_number: ["render", "ball.toml", "--seed", "many"], 2, ["--seed"];
    an_output_without_a_format: ["render", "ball.toml", "-o", "picture"], 2, ["picture", ".png", ".exr"];
    an_output_of_an_unknown_format: ["render", "ball.toml", "-o", "a.jpg"], 2, ["a.jpg", ".png", ".exr"];
    one_bad_output_of_two: ["render", "ball.toml", "-o", "a.png", "-o", "a.jpg"], 2, ["a.jpg", ".png", ".exr"];
    an_output_in_a_missing_folder: ["render", "ball.toml", "-o", "none/a.png"], 73, ["cannot create none/a.png", "-o"];
    an_output_below_a_file: ["render", "ball.toml", "-o", "ball.toml/a.png"], 73, ["cannot create ball.toml/a.png"];
}

#[test]
fn an_output_that_is_a_folder() {
    let folder = Folder::with_ball();
    for name in ["a.png", "a.exr"] {
        std::fs::create_dir(folder.path(name)).expect("a folder");
        let says = ["cannot create", name, "-o"];
        Refusal { files: &[], arguments: &["render", "ball.toml", "-o", name], code: 73, says: &says }
            .check_in(&folder);
    }
}

#[test]
fn an_output_that_is_write_protected_stays_as_it_is() {
    let folder = Folder::with_ball();
    folder.write("a.png", "mine");
    let mut permissions = std::fs::metadata(folder.path("a.png")).expect("the file").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(folder.path("a.png"), permissions).expect("one's own file");
    let says = ["cannot create a.png", "write-protected", "-o"];
    Refusal { files: &[], arguments: &["render", "ball.toml", "-o", "a.png"], code: 73, says: &says }.check_in(&folder);
    assert_eq!(std::fs::read(folder.path("a.png")).expect("still there"), b"mine");
}

/// Beside `cat.obj` often lies its texture `cat.png`.
#[test]
fn a_picture_of_someone_else_is_not_replaced_unless_it_is_named() {
    let folder = Folder::with_ball();
    folder.write("ball.png", "a texture, say");
    let says = ["ball.png exists", "-o"];
    Refusal { files: &[], arguments: &["render", "ball.toml"], code: 2, says: &says }.check_in(&folder);
    assert_eq!(std::fs::read(folder.path("ball.png")).expect("still there"), b"a texture, say");
    folder.run(&["render", "ball.toml", "-o", "ball.png"]).with_code(0);
    folder.picture("ball.png");
}

#[cfg(unix)]
#[test]
fn an_output_that_is_a_texture_of_the_scene_or_named_twice() {
    let folder = Folder::with_ball();
    let texture = crate::run::repository().join("fixtures/features/tiles.png");
    folder.write("tiles.png", std::fs::read(&texture).expect("a fixture"));
    folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
    folder.write("a.mtl", "newmtl a\nmap_Kd tiles.png\n");
    let arguments = &["render", "a.obj", "-o", "tiles.png"];
    let says = &["tiles.png is read here and would be replaced", "-o"];
    Refusal { files: &[], arguments, code: 2, says }.check_in(&folder);
    assert_eq!(std::fs::read(folder.path("tiles.png")).expect("the texture"), std::fs::read(texture).expect("it"));
    let arguments = &["render", "ball.toml", "-o", "a.png", "-o", "./a.png"];
    Refusal { files: &[], arguments, code: 2, says: &["./a.png is named twice"] }.check_in(&folder);
}

#[test]
fn two_accuracies_at_once_that_no_kernel_has() {
    let arguments = ["render", "ball.toml", "--triangle-test", "fast", "--slab-test", "unpadded", "-o", "a.png"];
    let says = [
        "no kernel has --triangle-test fast --slab-test unpadded",
        "--triangle-test fast, --triangle-test narrow, --triangle-test wide, --slab-test unpadded, --sphere-test narrow",
    ];
    Refusal { files: &[], arguments: &arguments, code: 2, says: &says }.check();
}

#[test]
fn an_output_that_is_a_device() {
    let folder = Folder::with_ball();
    std::os::unix::fs::symlink("/dev/null", folder.path("null.png")).expect("a link");
    let says = ["cannot create null.png", "not an ordinary file"];
    Refusal { files: &[], arguments: &["render", "ball.toml", "-o", "null.png"], code: 73, says: &says }
        .check_in(&folder);
}

/// A limit on the size of files stands for a full disk; the shell's `trap` turns its signal into an error.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_picture_and_no_temporary_file() {
    let folder = Folder::with_ball();
    folder.write("a.exr", "old");
    let before = folder.names();
    let script = "trap '' XFSZ; ulimit -f 2; exec \"$0\" render ball.toml --size 64x64 --spp 1 -o a.exr";
    let mut shell = std::process::Command::new("sh");
    shell.arg("-c").arg(script).arg(env!("CARGO_BIN_EXE_ocellus")).current_dir(folder.path(""));
    let outcome = crate::run::Outcome::of(&mut shell).with_code(74);
    assert!(outcome.stderr.contains("error: cannot write a.exr"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("\n  try: check the free space"), "{}", outcome.stderr);
    assert_eq!(folder.names(), before);
    assert_eq!(std::fs::read(folder.path("a.exr")).expect("still there"), b"old");
}

/// The limit makes the system refuse what it might otherwise promise and not have.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_larger_than_memory() {
    let folder = Folder::with_ball();
    let script = "ulimit -v 8000000; exec \"$0\" render ball.toml --size 65535x65535 --spp 1 -o a.png";
    let mut shell = std::process::Command::new("sh");
    shell.arg("-c").arg(script).arg(env!("CARGO_BIN_EXE_ocellus")).current_dir(folder.path(""));
    let outcome = crate::run::Outcome::of(&mut shell).with_code(2);
    assert!(outcome.stderr.contains("65535 x 65535"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("\n  try: ask for a smaller --size"), "{}", outcome.stderr);
    assert_eq!(folder.names(), ["ball.toml"]);
}
