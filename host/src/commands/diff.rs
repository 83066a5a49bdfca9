//! `ocellus diff`.

use crate::cli::DiffArgs;
use crate::diff::{compare, error_map};
use crate::error::{Error, ExitCode};
use crate::input::read_picture_and_encoding;
use crate::output::check_output;

pub(super) fn run(args: &DiffArgs) -> Result<ExitCode, Error> {
    if args.tolerance.is_some_and(|tolerance| !(tolerance >= 0.0)) {
        return Err(Error::usage("--tolerance must be a number of 0 or more", "try --metric relmse --tolerance 0.01"));
    }
    if let Some(output) = &args.output {
        check_output(output)?;
    }
    let (a, a_encoding) = read_picture_and_encoding(&args.a)?;
    let (b, b_encoding) = read_picture_and_encoding(&args.b)?;
    let comparison = compare(&a, &b)?;
    if args.json {
        println!("{}", comparison.to_json());
    } else {
        println!("a  {} ({a_encoding})\nb  {} ({b_encoding})\n{comparison}", args.a.display(), args.b.display());
    }
    if let Some(output) = &args.output {
        error_map(&a, &b)?.write_png(output, &[])?;
        eprintln!("wrote {}", output.display());
    }
    let Some(tolerance) = args.tolerance else { return Ok(ExitCode::Done) };
    if comparison.is_within(args.metric, tolerance) {
        return Ok(ExitCode::Done);
    }
    eprintln!("{} is {}, above the tolerance of {tolerance}", args.metric, comparison.value(args.metric));
    Ok(ExitCode::AboveTolerance)
}
