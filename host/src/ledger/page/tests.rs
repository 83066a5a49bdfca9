//! The page of ledgers that are as they should be, and of those that are not.

use super::*;
use crate::diff::Metric;
use crate::ledger::account::accounts;
use crate::ledger::estimate::Ratio;
use crate::ledger::figures::Figures;
use crate::ledger::levels::Choice;
use crate::ledger::measure::{Measured, Rung};
use crate::ledger::spread::Spread;
use crate::ledger::{Order, open};
use crate::picture::Picture;
use crate::promise::Target;
use crate::render::{Monitor, RenderSettings};

struct ToTheEnd;

impl Monitor for ToTheEnd {
    fn advance(&self, _paths: u64) {}

    fn stopped(&self) -> bool {
        false
    }
}

const SCENE: &str = "\
[camera]
position = [0, 0, 4]
look_at = [0, 0, 0]

[film]
width = 8
height = 6

[materials]
glass = { kind = \"dielectric\", ior = 1.5 }
grey = { kind = \"diffuse\", albedo = 0.5 }

[[spheres]]
center = [0, 0, 0]
radius = 1
material = \"glass\"

[[spheres]]
center = [0, 0, 0]
radius = 9
material = \"grey\"
inverted = true

[[lights]]
kind = \"sphere\"
center = [0, 4, 2]
radius = 1
power = 100
";

fn measured() -> Ledger {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, SCENE).expect("a scene");
    let scene = crate::load::load_scene(&path).expect("a scene");
    let settings = RenderSettings { threads: 1, ..RenderSettings::of(&scene) };
    let order = Order {
        vary: vec![
            Choice::Sampler,
            Choice::LightSampling,
            Choice::Fresnel,
            Choice::MaxBounces,
            Choice::Accel,
            Choice::SphereTest,
        ],
        runs: 3,
        seconds: 0.3,
        target: Target { metric: Metric::RelMse, value: 0.01 },
        reference: None,
    };
    open(&scene, &settings, &order, &ToTheEnd).expect("a ledger")
}

fn page(ledger: &Ledger) -> String {
    let heading = Heading {
        scene: "some where/a <scene> & \"more\".toml",
        size: Some([8, 6]),
        whole: Region::whole(8, 6),
        has_max_bounces: false,
        has_fresnel: true,
        has_sampler: false,
        tone: ToneMap::default(),
        seed: 1,
    };
    html(ledger, &heading)
}

/// What a reader sees: the page without addresses of pictures, whose letters mean nothing.
fn without_pictures(page: &str) -> String {
    let mut parts = page.split("\"data:image/png;base64,");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.map(|part| part.split_once('"').expect("a closing quote").1).collect::<String>()
}

/// Checks that each tag is closed in its place and each attribute quoted; gives the text between tags.
fn text_of_well_formed(page: &str) -> String {
    let mut open = Vec::new();
    let mut text = String::new();
    let mut rest = page.strip_prefix("<!doctype html>").expect("HTML");
    while let Some((before, tag)) = rest.split_once('<') {
        assert!(!before.contains('>'), "{before}");
        text += before;
        text.push(' ');
        let (tag, after) = tag.split_once('>').expect("a tag's end");
        let name = tag.trim_start_matches('/').split_whitespace().next().expect("a tag's name");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "{tag} in {open:?}");
        } else {
            assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
            let values = tag.split('"').step_by(2).skip(1);
            assert!(values.into_iter().all(|between| between.starts_with([' ', '/']) || between.is_empty()), "{tag}");
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
        rest = after;
    }
    assert_eq!(open, Vec::<&str>::new());
    text
}

/// Checks what must hold for every ledger.
fn check(ledger: &Ledger, what: &str) -> String {
    let page = page(ledger);
    let seen = without_pictures(&page);
    let text = text_of_well_formed(&seen);
    for account in &ledger.accounts {
        assert!(text.contains(&escape(&account.name())), "{what}: no {}", account.name());
    }
    // The style has the words of its language.
    let (_, body) = seen.split_once("</style>").expect("a style");
    for line in body.lines() {
        let lower = line.to_lowercase();
        let mut words = lower.split(|character: char| !character.is_ascii_alphabetic());
        assert!(!words.any(|word| ["nan", "inf", "infinity"].contains(&word)), "{what}: {line}");
        assert!(!lower.contains("http") && !lower.contains("..."), "{what}: {line}");
        let longest = lower.split(|character: char| !character.is_ascii_digit()).map(str::len).max();
        assert!(longest < Some(17), "{what}: {line}");
    }
    assert!(!STYLE.to_lowercase().contains("http"));
    page
}

/// The ledger with other measurements.
fn with(ledger: &Ledger, change: impl Fn(&mut Measured)) -> Ledger {
    let mut measured: Vec<_> = ledger.accounts.iter().map(|account| account.measured.clone()).collect();
    measured.iter_mut().for_each(change);
    Ledger { accounts: accounts(measured, &ledger.reference, ledger.target), ..ledger.clone() }
}

#[test]
fn the_page_is_whole_whatever_was_measured() {
    let ledger = measured();
    let page = check(&ledger, "as measured");
    assert!(page.contains("with light_sampling = &quot;hemisphere&quot; in [integrator]"));
    assert!(page.contains("--max-bounces ") && page.contains("--accel box") && page.contains("--sampler sobol"));
    assert!(page.contains("some where/a &lt;scene&gt; &amp; &quot;more&quot;.toml"));
    assert!(page.len() < 3_000_000, "{}", page.len());

    let part = check(&Ledger { is_part: true, ..ledger.clone() }, "a part");
    assert!(part.contains("at two samples per pixel"));
    check(&with(&ledger, |measured| measured.rungs.truncate(1)), "one rung");
    let one_run = |rung: &mut Rung| rung.runs.truncate(1);
    check(&with(&ledger, |measured| measured.rungs.iter_mut().for_each(one_run)), "one run");
    let two_runs = |rung: &mut Rung| rung.runs.truncate(2);
    check(&with(&ledger, |measured| measured.rungs.iter_mut().for_each(two_runs)), "two runs");
    for value in [1e-12, 1e12] {
        let target = Target { value, ..ledger.target };
        check(&with(&Ledger { target, ..ledger.clone() }, |_| {}), "a target out of reach");
    }
    let target = Target { metric: Metric::Rmse, value: 0.1 };
    check(&with(&Ledger { target, ..ledger.clone() }, |_| {}), "RMSE");
    check(&Ledger { accounts: ledger.accounts[..1].to_vec(), ..ledger.clone() }, "nothing varied");
    check(&Ledger { accounts: Vec::new(), ..ledger.clone() }, "nothing measured");
}

#[test]
fn endless_intervals_and_better_than_the_reference_are_told_in_words() {
    let mut ledger = measured();
    let endless = Ratio { value: 2.0, interval: [0.0, f64::INFINITY] };
    for account in &mut ledger.accounts {
        (account.to_target, account.efficiency) = (Some([endless, endless]), Some(endless));
        account.foretold = Some(endless);
    }
    check(&ledger, "endless intervals");
    for account in &mut ledger.accounts {
        (account.to_target, account.efficiency, account.foretold, account.slope) = (None, None, None, None);
    }
    check(&ledger, "nothing known");
    let better = with(&ledger, |measured| {
        for run in measured.rungs.iter_mut().flat_map(|rung| &mut rung.runs) {
            (run.figures.mse, run.figures.rel_mse) = (-1e-9, -1e-9);
        }
    });
    check(&better, "better than the reference");
}

#[test]
fn the_sentence_compares_times_that_are_sure_to_differ() {
    let mut ledger = measured();
    let times = |value: f64| Some(Ratio { value, interval: [0.9 * value, 1.1 * value] });
    for account in &mut ledger.accounts {
        account.bias = None;
        account.to_target = times(1.0).zip(times(64.0)).map(|(seconds, spp)| [seconds, spp]);
        // What each sample is worth is another question.
        (account.sooner, account.efficiency) = (times(1.05), times(9.0));
    }
    let asked = "as asked, the picture reaches relMSE 0.01 in 1.00 s (900 ms to 1.10 s)";
    assert_eq!(ledger.sentence(), format!("{asked}; no option that was varied changes that for sure"));
    let [second, third, fourth] = [1, 2, 3].map(|at| ledger.accounts[at].name());
    (ledger.accounts[1].sooner, ledger.accounts[2].sooner) = (times(1.4), times(2.0));
    ledger.accounts[3].sooner = times(0.25);
    assert_eq!(ledger.sentence(), format!("{asked}, 2.0x sooner with {third}, 4.0x later with {fourth}"));
    // A target that less than a sample meets is no matter of time.
    let mut at_once = ledger.clone();
    at_once.accounts[2].to_target = times(1.0).zip(times(0.5)).map(|(seconds, spp)| [seconds, spp]);
    assert_eq!(at_once.sentence(), format!("{asked}, 1.4x sooner with {second}, 4.0x later with {fourth}"));
    // What is not seen to get there is not compared.
    ledger.accounts[2].to_target = None;
    assert_eq!(ledger.sentence(), format!("{asked}, 1.4x sooner with {second}, 4.0x later with {fourth}"));
}

#[test]
fn a_black_picture_has_a_page() {
    let mut ledger = measured();
    let black = |picture: &mut Picture| picture.pixels.fill([0.0; 3]);
    black(&mut ledger.reference.picture);
    ledger.reference.variance.fill([0.0; 3]);
    let reference = ledger.reference.clone();
    let ledger = with(&ledger, |measured| {
        let mut spread = Spread::new(ledger.region);
        for _ in 0..3 {
            spread.add(&reference.picture);
        }
        measured.spread = spread;
        measured.crops.iter_mut().for_each(black);
        for run in measured.rungs.iter_mut().flat_map(|rung| &mut rung.runs) {
            run.figures = Figures::of(&reference.picture, &reference);
        }
    });
    check(&ledger, "black");
    // A picture without one finite pixel has no figures.
    let mut empty = ledger.clone();
    empty.reference.picture.pixels.fill([f32::NAN; 3]);
    let reference = empty.reference.clone();
    let empty = with(&empty, |measured| {
        for run in measured.rungs.iter_mut().flat_map(|rung| &mut rung.runs) {
            run.figures = Figures::of(&reference.picture, &reference);
        }
    });
    check(&empty, "not finite");
}
