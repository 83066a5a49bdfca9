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
fn targets_are_read_or_refused_with_an_example() {
    let folder = Folder::with_ball();
    let report = folder.render(&["ball.toml", "--target-error", "rmse=1", "-o", "a.exr"]);
    assert_eq!(report["target"]["metric"], "RMSE");
    for wrong in ["flip=0.1", "relmse=", "-1", "0"] {
        let refused = folder.run(&["render", "ball.toml", &format!("--target-error={wrong}")]).with_code(2);
        assert!(refused.stderr.contains("relmse=0.01"), "{wrong}: {}", refused.stderr);
    }
    folder.run(&["render", "ball.toml", "--audit"]).with_code(2);
    folder.run(&["render", "ball.toml", "--time", "1", "--samples", "0..4"]).with_code(2);
}
