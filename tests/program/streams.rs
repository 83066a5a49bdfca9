//! Where the program writes what, and what it does when that fails.

use std::process::Stdio;

use crate::run::{Folder, Outcome};

#[test]
fn nothing_is_colored_where_nobody_looks() {
    let folder = Folder::with_ball();
    for (arguments, code) in [
        (&["render", "ball.toml", "-o", "a.png"][..], 0),
        (&["render", "ball.toml", "--size", "big"], 2),
        (&["render", "none.toml"], 66),
        (&["explain", "ball.toml"], 0),
        (&["--help"], 0),
    ] {
        let plain = folder.run(arguments).with_code(code);
        let without = Outcome::of(folder.program(arguments).env("NO_COLOR", "1")).with_code(code);
        for text in [&plain.stdout, &plain.stderr, &without.stdout, &without.stderr] {
            assert!(!text.contains('\u{1b}') && !text.contains('\r'), "{text:?}");
        }
    }
}

#[test]
fn a_render_tells_people_in_a_few_lines() {
    let folder = Folder::with_ball();
    let outcome = folder.run(&["render", "ball.toml", "-o", "a.png"]).with_code(0);
    let lines: Vec<_> = outcome.stderr.lines().collect();
    assert!(
        matches!(lines[..], [first, second, "wrote a.png"]
        if first.starts_with("4 samples per pixel in ") && second.contains(" paths/s, ") && second.contains("image hash ")),
        "{lines:#?}"
    );
    assert!(lines.iter().all(|line| line.len() <= 100), "{lines:#?}");
}

#[test]
fn warnings_name_their_line_and_do_not_stop_the_work() {
    let folder = Folder::new();
    let dark = crate::run::BALL.split("[[lights]]").next().expect("a part");
    folder.write("dark.toml", dark);
    let outcome = folder.run(&["render", "dark.toml"]).with_code(0);
    assert!(outcome.stderr.contains("warning: dark.toml: nothing gives light"), "{}", outcome.stderr);
}

/// Like `ocellus explain scene.toml | head -1`.
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = Folder::with_ball();
    for arguments in [&["explain", "ball.toml"][..], &["render", "ball.toml", "--json", "-o", "a.png"]] {
        let mut child =
            folder.program(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop(child.stdout.take());
        let outcome = Outcome::from(child.wait_with_output().expect("it ends")).with_code(0);
        assert!(!outcome.stderr.contains("error"), "{}", outcome.stderr);
    }
}

#[cfg(target_os = "linux")]
mod full {
    use std::fs::File;

    use super::*;

    fn full() -> File {
        File::options().write(true).open("/dev/full").expect("a device that is always full")
    }

    #[test]
    fn data_that_cannot_be_printed_are_an_error() {
        let folder = Folder::with_ball();
        folder.render(&["ball.toml", "-o", "a.exr"]);
        for arguments in [
            &["explain", "ball.toml"][..],
            &["explain", "ball.toml", "--json"],
            &["render", "ball.toml", "--json", "-o", "a.png"],
            &["diff", "a.exr", "a.exr"],
        ] {
            let child = folder.program(arguments).stdout(full()).stderr(Stdio::piped()).spawn().expect("it starts");
            let outcome = Outcome::from(child.wait_with_output().expect("it ends")).with_code(74);
            assert!(outcome.stderr.contains("error: cannot write to standard output"), "{}", outcome.stderr);
            assert!(outcome.stderr.contains("\n  try: "), "{}", outcome.stderr);
        }
    }

    #[test]
    fn people_who_cannot_be_told_do_not_stop_the_work() {
        let folder = Folder::with_ball();
        let mut render = folder.program(&["render", "ball.toml", "-o", "a.png"]);
        assert_eq!(render.stderr(full()).status().expect("it runs").code(), Some(0));
        folder.picture("a.png");
        let mut missing = folder.program(&["render", "none.toml"]);
        assert_eq!(missing.stderr(full()).status().expect("it runs").code(), Some(66));
    }
}
