//! `ocellus diff`.

use crate::run::{BALL, Folder};

/// Two renders with different seeds, `a.exr` and `b.exr`, and a smaller one, `small.exr`.
fn pictures() -> Folder {
    let folder = Folder::with_ball();
    for arguments in
        [&["-o", "a.exr", "-o", "a.png"][..], &["-o", "b.exr", "--seed", "1"], &["-o", "small.exr", "--size", "8x4"]]
    {
        folder.render(&[&["ball.toml"], arguments].concat());
    }
    folder
}

/// Ends with `code`, prints nothing on standard output, and names cause and remedy.
#[track_caller]
fn refuses(folder: &Folder, arguments: &[&str], code: i32, says: &[&str]) {
    let before = folder.names();
    let outcome = folder.run(&[&["diff"], arguments].concat()).with_code(code);
    assert_eq!(outcome.stdout, "");
    assert!(outcome.stderr.starts_with("error: "), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("\n  try: ") || outcome.stderr.contains("try '--help'"), "{}", outcome.stderr);
    for text in says {
        assert!(outcome.stderr.contains(text), "{text:?} is not in: {}", outcome.stderr);
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = pictures();
    folder.write("text.png", BALL);
    let half = std::fs::read(folder.path("a.exr")).expect("a picture");
    folder.write("half.exr", &half[..half.len() / 2]);
    refuses(&folder, &["a.exr", "none.exr"], 66, &["cannot read none.exr", "check the path"]);
    refuses(&folder, &["none.png", "a.exr"], 66, &["cannot read none.png", "check the path"]);
    refuses(&folder, &["a.exr", "text.png"], 65, &["text.png: ", "neither a PNG nor an EXR", "use a PNG"]);
    refuses(&folder, &["half.exr", "a.exr"], 65, &["half.exr: ", "cannot decode"]);
    refuses(&folder, &["a.exr", "a.png", "-o", "a.png"], 2, &["a.png is read here and would be replaced"]);
    refuses(&folder, &["a.exr", "small.exr"], 2, &["8x8", "8x4", "--size"]);
    refuses(&folder, &["a.exr"], 2, &["<B>"]);
    refuses(&folder, &["a.exr", "b.exr", "--tolerance", "nan"], 2, &["--tolerance", "0 or more"]);
    refuses(&folder, &["a.exr", "b.exr", "--tolerance=-1"], 2, &["--tolerance", "0 or more"]);
    refuses(&folder, &["a.exr", "b.exr", "--metric", "psnr"], 2, &["psnr", "rmse, relmse, flip or hdr-flip"]);
    refuses(&folder, &["a.exr", "b.exr", "-o", "map.exr"], 2, &["map.exr", ".png"]);
    refuses(&folder, &["a.exr", "b.exr", "-o", "none/map.png"], 73, &["cannot create none/map.png"]);
}

#[test]
fn the_tolerance_decides_the_exit_code() {
    let folder = pictures();
    let same = folder.run(&["diff", "a.exr", "a.exr", "--tolerance", "0"]).with_code(0);
    assert!(same.stdout.contains("a equals b in every pixel"), "{}", same.stdout);
    for metric in ["rmse", "relmse", "flip", "hdr-flip"] {
        let figures = folder.run(&["diff", "a.exr", "b.exr", "--json"]).with_code(0).json();
        let value = figures[metric.replace('-', "_")].as_f64().expect("a figure");
        assert!(value > 0.0);
        let at = |tolerance: f64| {
            folder.run(&["diff", "a.exr", "b.exr", "--metric", metric, "--tolerance", &tolerance.to_string()])
        };
        assert_eq!(at(value * 1.001).with_code(0).stderr, "");
        let above = at(value * 0.999).with_code(1);
        assert!(above.stderr.contains("above the tolerance"), "{}", above.stderr);
        assert!(above.stdout.contains("RMSE"), "the figures are printed all the same: {}", above.stdout);
    }
}

#[test]
fn hdr_flip_of_two_views_is_given_with_a_note() {
    let folder = pictures();
    for (a, b, note) in [("a.png", "a.png", true), ("a.png", "a.exr", false), ("a.exr", "b.exr", false)] {
        let outcome = folder.run(&["diff", a, b, "--metric", "hdr-flip"]).with_code(0);
        assert!(outcome.stdout.contains("HDR-FLIP"), "{}", outcome.stdout);
        assert_eq!(outcome.stderr.contains("note: neither picture is linear"), note, "{}", outcome.stderr);
        assert_eq!(folder.run(&["diff", a, b]).with_code(0).stderr, "");
    }
}

#[test]
fn a_view_of_a_picture_is_close_to_it_and_the_map_is_written() {
    let folder = pictures();
    let outcome = folder.run(&["diff", "a.png", "a.exr", "--metric", "flip", "-o", "map.png"]).with_code(0);
    assert!(outcome.stdout.contains("a  a.png (8-bit, decoded from sRGB)"), "{}", outcome.stdout);
    assert!(outcome.stdout.contains("b  a.exr (linear float)"), "{}", outcome.stdout);
    assert_eq!(outcome.stderr, "wrote map.png\n");
    let map = folder.picture("map.png");
    assert_eq!((map.width, map.height), (8, 8));
}
