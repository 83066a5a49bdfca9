//! The program `ocellus`: reads the command line, runs it, exits with its code.

use clap::Parser;
use ocellus::cli::Cli;

fn main() {
    let code = ocellus::commands::run(&Cli::parse()).unwrap_or_else(|error| {
        ocellus::commands::tell(format_args!("error: {error}"));
        error.code
    });
    std::process::exit(code as i32);
}
