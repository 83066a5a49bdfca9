//! `render --target-error` and `--time`: where they stop, what they say, and that the picture is one that `--spp` gives.

use crate::run::Folder;

#[test]
fn a_target_is_promised_kept_and_rendered_again() {
    let folder = Folder::with_ball();
    let report = folder.render(&["ball.toml", "--size", "24x24", "--target-error", "0.02", "--audit", "-o", "a.exr"]);
    let spp = report["spp"].as_u64().expect("samples per pixel");
    assert!(spp >= 16, "{report}");
    assert_eq!(report["target"]["met"], true, "{report}");
    let [expected, most] = ["expected", "most"].map(|key| report["promised_error"][key].as_f64().expect("an error"));
    assert!(0.0 < expected && expected < most && most <= 0.02, "{report}");
    let errors = report["audit"]["errors"].as_array().expect("errors").len();
    assert_eq!(errors, 9);
    assert!(report["audit"]["kept"].as_u64().is_some_and(|kept| kept >= 8), "{report}");

    let again = folder.render(&["ball.toml", "--size", "24x24", "--spp", &spp.to_string(), "-o", "b.exr"]);
    assert_eq!(again["image_hash"], report["image_hash"]);
    assert_eq!(folder.picture("a.exr"), folder.picture("b.exr"));
    // Threads change the time of looks, and no look.
    let single =
        folder.render(&["ball.toml", "--size", "24x24", "--target-error", "0.02", "--threads", "1", "-o", "c.exr"]);
    assert_eq!((&single["spp"], &single["image_hash"]), (&report["spp"], &report["image_hash"]));
}

#[test]
fn time_that_is_up_and_samples_that_are_spent_end_it_with_3() {
    let folder = Folder::with_ball();
    for limit in [["--time", "0.05"], ["--spp", "32"]] {
        let arguments =
            [&["render", "ball.toml", "--json", "--target-error", "1e-9", "-o", "a.png"][..], &limit].concat();
        let outcome = folder.run(&arguments).with_code(3);
        assert!(outcome.stderr.contains("the same bits again: --spp "), "{}", outcome.stderr);
        assert_eq!(outcome.json()["target"]["met"], false, "{}", outcome.stdout);
        // The picture is there all the same.
        assert_eq!(folder.picture("a.png").width, 8);
    }
    // Without a target, time that is up is what was asked for.
    let report = folder.render(&["ball.toml", "--time", "0.2", "-o", "a.exr"]);
    let spp = report["spp"].to_string();
    assert!(report["trace_seconds"].as_f64().is_some_and(|seconds| seconds < 2.0), "{report}");
    assert_eq!(folder.render(&["ball.toml", "--spp", &spp, "-o", "b.exr"])["image_hash"], report["image_hash"]);
}

#[test]
fn fields_decide_for_each_other_and_are_rendered_again() {
    let folder = Folder::with_ball();
    let scene = ["ball.toml", "--size", "24x24", "--seed", "3"];
    let render = |more: &[&str]| folder.render(&[&scene[..], more].concat());
    let report = render(&["--target-error", "0.02", "--unbiased", "--audit", "-o", "a.exr"]);
    assert_eq!(report["target"]["met"], true, "{report}");
    let [even, odd] = ["spp", "spp_odd_rows"].map(|key| report[key].as_u64().expect("a number").to_string());
    // Another seed might make them the same, and show less.
    assert_ne!(even, odd, "{report}");
    assert!(report["audit"]["kept"].as_u64().is_some_and(|kept| kept >= 8), "{report}");

    let again = render(&["--spp", &even, "--spp-odd-rows", &odd, "--threads", "1", "-o", "b.exr"]);
    assert_eq!(
        (&again["image_hash"], &again["spp_odd_rows"], &again["samples_per_pixel"]),
        (&report["image_hash"], &report["spp_odd_rows"], &report["samples_per_pixel"])
    );
    let picture = folder.picture("a.exr");
    assert_eq!(folder.picture("b.exr"), picture);
    // Rows are those of pictures with as many samples everywhere: nothing that only decided is left.
    for (parity, spp) in [even, odd].iter().enumerate() {
        assert!(render(&["--spp", spp, "-o", "c.exr"])["spp_odd_rows"].is_null());
        let plain = folder.picture("c.exr");
        for y in (parity..24).step_by(2) {
            assert_eq!(plain.pixels[24 * y..24 * (y + 1)], picture.pixels[24 * y..24 * (y + 1)], "{y}");
        }
    }
    // Rows are counted in the whole picture.
    render(&["--spp", "2", "--spp-odd-rows", "5", "--crop", "3,7,20,8", "-o", "d.exr"]);
    render(&["--spp", "5", "--crop", "3,7,20,8", "-o", "e.exr"]);
    assert_eq!(folder.picture("d.exr"), folder.picture("e.exr"));
}

#[test]
fn fields_end_with_what_others_end_with() {
    let folder = Folder::with_ball();
    let arguments =
        ["render", "ball.toml", "--json", "--target-error", "1e-9", "--unbiased", "--spp", "32", "-o", "a.png"];
    let outcome = folder.run(&arguments).with_code(3);
    assert!(outcome.stderr.contains("the same bits again: --spp 32 --spp-odd-rows 32"), "{}", outcome.stderr);
    let one_row = ["render", "ball.toml", "--target-error", "0.1", "--unbiased", "--crop", "0,3,8,4"];
    assert!(folder.run(&one_row).with_code(2).stderr.contains("there is one row"));
    for wrong in [
        &["--unbiased"][..],
        &["--unbiased", "--time", "1"],
        &["--unbiased", "--samples", "0..4"],
        &["--spp-odd-rows", "4"],
        &["--spp-odd-rows", "0", "--spp", "4"],
        &["--spp-odd-rows", "4", "--samples", "0..4"],
        &["--spp-odd-rows", "4", "--spp", "4", "--target-error", "1"],
        &["--spp-odd-rows", "4", "--spp", "4", "--time", "1"],
    ] {
        folder.run(&[&["render", "ball.toml"][..], wrong].concat()).with_code(2);
    }
}

#[test]
fn targets_are_read_or_refused_with_an_example() {
    let folder = Folder::with_ball();
    let report = folder.render(&["ball.toml", "--target-error", "rmse=1", "-o", "a.exr"]);
    assert_eq!(report["target"]["metric"], "RMSE");
    for wrong in ["flip=0.1", "relmse=", "-1", "0"] {
        let refused = folder.run(&["render", "ball.toml", &format!("--target-error={wrong}")]).with_code(2);
        assert!(refused.stderr.contains("relmse=0.01"), "{wrong}: {}", refused.stderr);
    }
    folder.run(&["render", "ball.toml", "--audit"]).with_code(2);
    folder.run(&["render", "ball.toml", "--audit", "--samples", "0..4"]).with_code(2);
    folder.run(&["render", "ball.toml", "--time", "1", "--samples", "0..4"]).with_code(2);
}
