//! `ocellus diff`.

use super::streams::{print, tell};
use crate::cli::DiffArgs;
use crate::diff::{Metric, compare, error_map};
use crate::error::{Error, ExitCode};
use crate::input::{Encoding, read_picture_and_encoding};
use crate::output::{Format, check_output, check_replaces_nothing};

pub(super) fn run(args: &DiffArgs) -> Result<ExitCode, Error> {
    if args.tolerance.is_some_and(|tolerance| !(tolerance >= 0.0)) {
        return Err(Error::usage("--tolerance must be a number of 0 or more", "try --metric relmse --tolerance 0.01"));
    }
    if let Some(output) = &args.output
        && check_output(output)? != Format::Png
    {
        let cause = format!("{} is not a PNG, but the map of the error is one", output.display());
        return Err(Error::usage(cause, "name an output that ends in .png"));
    }
    check_replaces_nothing(args.output.as_slice(), &[&args.a, &args.b])?;
    let (a, a_encoding) = read_picture_and_encoding(&args.a)?;
    let (b, b_encoding) = read_picture_and_encoding(&args.b)?;
    let comparison = compare(&a, &b)?;
    if args.json {
        print(comparison.to_json())?;
    } else {
        let (a, b) = (args.a.display(), args.b.display());
        print(format_args!("a  {a} ({a_encoding})\nb  {b} ({b_encoding})\n{comparison}"))?;
    }
    // The figure stands, since it was asked for by name, but few who ask for it of such pictures mean to.
    if args.metric == Metric::HdrFlip && a_encoding != Encoding::Linear && b_encoding != Encoding::Linear {
        tell("note: neither picture is linear; they are clipped at white, and FLIP says more of them than HDR-FLIP");
    }
    if let Some(output) = &args.output {
        error_map(&a, &b)?.write_png(output, &[])?;
        tell(format_args!("wrote {}", output.display()));
    }
    let Some(tolerance) = args.tolerance else { return Ok(ExitCode::Done) };
    if comparison.is_within(args.metric, tolerance) {
        return Ok(ExitCode::Done);
    }
    let value = comparison.value(args.metric);
    tell(if value <= tolerance {
        "pixels are finite in one picture alone, which no tolerance allows".to_owned()
    } else {
        format!("{} is {value}, above the tolerance of {tolerance}", args.metric)
    });
    Ok(ExitCode::AboveTolerance)
}
