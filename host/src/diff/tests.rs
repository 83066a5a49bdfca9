use super::*;

fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Picture { width, height, pixels: places.map(|(x, y)| pixel(x, y)).collect() }
}

fn grey(value: f32) -> Picture {
    picture(4, 2, |_, _| [value; 3])
}

#[test]
fn metrics_have_names_in_any_case() {
    for metric in [Metric::Rmse, Metric::RelMse, Metric::Flip, Metric::HdrFlip] {
        assert_eq!(metric.to_string().parse::<Metric>().unwrap(), metric);
        assert_eq!(metric.to_string().to_uppercase().parse::<Metric>().unwrap(), metric);
    }
    let error = "psnr".parse::<Metric>().unwrap_err();
    assert_eq!(error.code, ExitCode::Usage);
    assert!(error.cause.contains("psnr") && error.remedy.contains("relmse"));
}

#[test]
fn pictures_of_two_sizes_are_a_usage_error_that_says_both() {
    let error = compare(&grey(1.0), &picture(3, 5, |_, _| [1.0; 3])).unwrap_err();
    assert_eq!(error.code, ExitCode::Usage);
    assert!(error.cause.contains("4x2") && error.cause.contains("3x5"), "{error}");
}

#[test]
fn pictures_that_cannot_be_compared_are_errors() {
    let empty = Picture { width: 0, height: 0, pixels: vec![] };
    assert_eq!(compare(&empty, &empty).unwrap_err().code, ExitCode::BadScene);
    let short = Picture { width: 4, height: 2, pixels: vec![[1.0; 3]; 7] };
    assert_eq!(compare(&grey(1.0), &short).unwrap_err().code, ExitCode::BadScene);
    assert_eq!(compare(&grey(f32::NAN), &grey(1.0)).unwrap_err().code, ExitCode::BadScene);
}

#[test]
fn equal_pictures_are_said_to_be_equal() {
    let comparison = compare(&grey(0.5), &grey(0.5)).unwrap();
    for metric in [Metric::Rmse, Metric::RelMse, Metric::Flip, Metric::HdrFlip] {
        assert_eq!(comparison.value(metric), 0.0);
        assert!(comparison.is_within(metric, 0.0));
    }
    assert_eq!(comparison.sentence(), "a equals b in every pixel");
}

#[test]
fn a_difference_is_said_in_per_cent_of_the_reference() {
    let comparison = compare(&grey(2.02), &grey(2.0)).unwrap();
    assert_eq!(comparison.sentence(), "a is 1.00 % RMSE from b");
    assert!((comparison.mean_ratio()[1].unwrap() - 1.01).abs() < 1e-7);
    assert!(comparison.is_within(Metric::Rmse, 0.021) && !comparison.is_within(Metric::Rmse, 0.019));
    assert!(comparison.is_within(Metric::RelMse, 1.0e-4) && !comparison.is_within(Metric::RelMse, 0.9e-4));
    // Both are white on a screen, but not where it is exposed for the reference.
    assert!(comparison.is_within(Metric::Flip, 0.0) && !comparison.is_within(Metric::HdrFlip, 1e-3));
    assert_eq!(compare(&grey(0.5), &grey(0.0)).unwrap().sentence(), "a is 0.500 RMSE from b");
}

#[test]
fn a_pixel_that_is_finite_in_one_picture_alone_is_above_any_tolerance() {
    let mut broken = grey(0.5);
    broken.pixels[5][0] = f32::INFINITY;
    for (a, b) in [(&broken, &grey(0.5)), (&grey(0.5), &broken)] {
        let comparison = compare(a, b).unwrap();
        for metric in [Metric::Rmse, Metric::Flip, Metric::HdrFlip] {
            assert_eq!(comparison.value(metric), 0.0);
        }
        assert!(!comparison.is_within(Metric::Rmse, f64::INFINITY));
        assert_eq!(comparison.sentence(), "a equals b in every finite pixel, and some pixels are finite in one alone");
        assert!(comparison.to_string().contains("1 pixels, first at x 1, y 1"));
    }
    let both = compare(&broken, &broken).unwrap();
    assert!(both.is_within(Metric::RelMse, 0.0));
    assert_eq!(both.sentence(), "a equals b in every finite pixel");
}

#[test]
fn the_text_holds_every_figure_and_fits_80_columns() {
    let a = picture(64, 64, |x, y| [x as f32 * 1e5, -1.0 / (y + 1) as f32, 1e-9]);
    let mut b = picture(64, 64, |x, y| [y as f32 * 1.1e5, 0.25 / (x + 1) as f32, 0.0]);
    b.pixels[4095][0] = f32::NAN;
    for comparison in [compare(&a, &b).unwrap(), compare(&b, &a).unwrap(), compare(&grey(0.0), &grey(0.0)).unwrap()] {
        let text = comparison.to_string();
        assert!(text.lines().all(|line| line.chars().count() <= 80 && line.trim_end() == line), "{text}");
        for part in
            ["RMSE", "relMSE", REL_MSE_FORMULA, "  FLIP", "HDR-FLIP", "max |a-b|", "a / b", &comparison.sentence()]
        {
            assert!(text.contains(part), "{part} in {text}");
        }
    }
    assert!(REL_MSE_FORMULA.contains(&REL_MSE_EPSILON.to_string()));
}

#[test]
fn the_text_as_it_stands() {
    let mut a = grey(2.02);
    a.pixels[6][1] = 2.5;
    let mut b = grey(2.0);
    b.pixels[0][2] = f32::NAN;
    let expected = "  RMSE      0.1108      5.54 % of the mean of b
  relMSE    0.003064    mean((a-b)^2 / (b^2 + 0.01))
  FLIP      0           0 looks the same, 1 is worst; 67 pixels per degree
  HDR-FLIP  0.04097     worst of 2 exposures, 0.1 to 0.1 stops
  max |a-b| 0.5000      channel G at x 2, y 1

  mean      R           G           B
  a         2.02000     2.08857     2.02000
  b         2.00000     2.00000     2.00000
  a / b     1.01000     1.04429     1.01000

  not finite, left out of every figure above:
  a         0 pixels
  b         1 pixels, first at x 0, y 0

a is 5.54 % RMSE from b, and some pixels are finite in one alone";
    // RMSE by hand: sqrt((20 * 0.02^2 + 0.5^2) / 21).
    let comparison = compare(&a, &b).unwrap();
    let figures = format!("\n{comparison}\n");
    assert!((comparison.statistics.rmse - ((20.0 * 0.02f64 * 0.02 + 0.25) / 21.0).sqrt()).abs() < 1e-6, "{figures}");
    assert_eq!(comparison.to_string(), expected, "{figures}");
}

#[test]
fn json_holds_the_same_figures_and_null_for_what_is_not_there() {
    let mut a = grey(1.5);
    a.pixels[6] = [f32::NAN; 3];
    let comparison = compare(&a, &picture(4, 2, |_, _| [0.0, 1.0, 1.0])).unwrap();
    let json = comparison.to_json();
    assert_eq!(json["width"], 4);
    assert_eq!(json["pixels_compared"], 7);
    assert_eq!(json["rmse"], comparison.value(Metric::Rmse));
    assert_eq!(json["relmse"], comparison.value(Metric::RelMse));
    assert_eq!(json["relmse_epsilon"], 0.01);
    assert_eq!(json["flip"], comparison.value(Metric::Flip));
    assert_eq!(json["hdr_flip"], comparison.value(Metric::HdrFlip));
    // All pixels of b have one luminance.
    assert_eq!(json["hdr_flip_exposures"]["count"], 2);
    assert_eq!(json["hdr_flip_exposures"]["start"], json["hdr_flip_exposures"]["stop"]);
    assert_eq!(json["max_abs_difference"], 1.5);
    assert_eq!(json["max_at"], json!({ "x": 0, "y": 0, "channel": "R" }));
    assert_eq!(json["mean_a_over_b"], json!([null, 1.5, 1.5]));
    assert_eq!(json["non_finite_a"], json!({ "pixels": 1, "first": [2, 1] }));
    assert_eq!(json["non_finite_b"], json!({ "pixels": 0, "first": null }));
}

#[test]
fn numbers_keep_their_digits() {
    for (value, text) in [
        (0.0, "0"),
        (1.0, "1.000"),
        (9.9996, "10.00"),
        (-123.456, "-123.5"),
        (0.000_123_456, "0.0001235"),
        (0.000_012_345_6, "1.235e-5"),
        (1_234_567.0, "1234567"),
        (12_345_678.0, "1.235e7"),
        (f64::NAN, "NaN"),
    ] {
        assert_eq!(significant(value, 4), text);
    }
}
