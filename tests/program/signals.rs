//! Ctrl-C and SIGTERM: the first keeps the picture so far, the second ends the program.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::run::{BALL, Folder, Outcome};

/// How long anything may take that takes no time on an idle machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A render that would take days, in a state where it listens to signals.
fn start(folder: &Folder, arguments: &[&str]) -> Child {
    let endless = ["render", "ball.toml", "--json", "--spp", "4000000000", "-o", "a.png", "-o", "a.exr"];
    let mut command = folder.program(&[&endless, arguments].concat());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let start = Instant::now();
    while !listens(&child) {
        assert!(start.elapsed() < PATIENCE, "it never listens");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

/// Whether the process has handlers for SIGINT and SIGTERM, as the kernel's list of caught signals says.
#[cfg(target_os = "linux")]
fn listens(child: &Child) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).expect("a process");
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).expect("a mask");
    let caught = u64::from_str_radix(caught.trim(), 16).expect("a number");
    let both = 1 << (2 - 1) | 1 << (15 - 1);
    caught & both == both
}

/// Elsewhere, a while.
#[cfg(not(target_os = "linux"))]
fn listens(_: &Child) -> bool {
    std::thread::sleep(Duration::from_secs(2));
    true
}

/// Waits until it has worked for a while, and so has long begun to trace.
#[cfg(target_os = "linux")]
fn wait_until_it_traces(child: &Child) {
    /// In ticks of 10 ms.
    const WHILE: u64 = 30;
    let start = Instant::now();
    loop {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).expect("a process");
        // The name, in parentheses, is followed by fields 3 and on; user time is field 14.
        let (_, fields) = stat.rsplit_once(") ").expect("fields");
        let user = fields.split(' ').nth(14 - 3).expect("user time").parse::<u64>().expect("a number");
        if user >= WHILE {
            return;
        }
        assert!(start.elapsed() < PATIENCE, "it does not work");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Elsewhere, it has had its while already.
#[cfg(not(target_os = "linux"))]
fn wait_until_it_traces(_: &Child) {}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").arg(name).arg(child.id().to_string()).status().expect("`kill` is there");
    assert!(status.success());
}

fn end(child: Child) -> Outcome {
    Outcome::from(child.wait_with_output().expect("it ends"))
}

#[test]
fn a_signal_stops_the_render_and_keeps_the_picture() {
    for (name, code) in [("-INT", 130), ("-TERM", 143)] {
        let folder = Folder::with_ball();
        let child = start(&folder, &[]);
        wait_until_it_traces(&child);
        signal(&child, name);
        let outcome = end(child).with_code(code);
        assert!(outcome.stderr.contains("stopped early: "), "{}", outcome.stderr);
        assert!(outcome.stderr.contains(" of 4000000000 samples after "), "{}", outcome.stderr);
        assert!(outcome.stderr.contains("wrote a.png\nwrote a.exr\n"), "{}", outcome.stderr);

        let report = outcome.json();
        assert_eq!(report["interrupted"], true);
        let [fewest, most] = [0, 1].map(|index| report["samples_per_pixel"][index].as_u64().expect("a count"));
        assert!(fewest > 0 && fewest <= most && most < 4_000_000_000, "{report}");
        let paths = report["paths"].as_u64().expect("a count");
        assert!((64 * fewest..=64 * most).contains(&paths), "{report}");
        assert_eq!(folder.names(), ["a.exr", "a.png", "ball.toml"]);

        // Each pixel is what its own samples give, as a whole render of as many would have it.
        let partial = folder.picture("a.exr");
        let [few, many] = [fewest, most].map(|spp| {
            folder.render(&["ball.toml", "--spp", &spp.to_string(), "-o", "b.exr"]);
            folder.picture("b.exr")
        });
        for ((pixel, few), many) in partial.pixels.iter().zip(&few.pixels).zip(&many.pixels) {
            assert!(pixel == few || pixel == many, "{pixel:?} is neither {few:?} nor {many:?}");
        }
    }
}

#[test]
fn a_signal_before_the_first_pass_is_over_leaves_black_pixels_and_says_so() {
    let folder = Folder::with_ball();
    let child = start(&folder, &["--size", "1600x1200", "--threads", "1"]);
    signal(&child, "-INT");
    let outcome = end(child).with_code(130);
    let says = ["no sample was done in", "pixels have 0 to 1 of"];
    assert!(says.iter().any(|text| outcome.stderr.contains(text)), "{}", outcome.stderr);
    assert!(outcome.stderr.lines().next().is_some_and(|line| line.contains("black")), "{}", outcome.stderr);
    let report = outcome.json();
    assert_eq!(report["samples_per_pixel"][0], 0);
    let picture = folder.picture("a.exr");
    assert_eq!((picture.width, picture.height), (1600, 1200));
    let last_row = picture.pixels.len() - 1600..;
    assert!(picture.pixels[last_row].iter().all(|&pixel| pixel == [0.0; 3]));
}

/// In a white room no path ends before 65535 bounces, so a row takes minutes and the first signal has to wait for it.
#[test]
fn the_second_signal_ends_the_program_at_once() {
    for (first, second, code) in [("-INT", "-INT", 130), ("-TERM", "-INT", 130), ("-INT", "-TERM", 143)] {
        let folder = Folder::new();
        let room = BALL.replace("radius = 1\n", "radius = 100\n").replace("\"diffuse\"", "\"diffuse\"\nalbedo = 1");
        folder.write("ball.toml", room);
        let mut child = start(&folder, &["--size", "65535x1", "--max-bounces", "65535"]);
        wait_until_it_traces(&child);
        signal(&child, first);
        let start = Instant::now();
        // Signals that are close together may become one.
        while child.try_wait().expect("a state").is_none() {
            assert!(start.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(50));
            signal(&child, second);
        }
        assert_eq!(end(child).with_code(code).stdout, "");
        assert_eq!(folder.names(), ["ball.toml"]);
    }
}
