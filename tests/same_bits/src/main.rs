//! Prints a line for each item: its name, its precision and its hash over the number of queries that is the first
//! argument (10,000 without one, and always on machines that have no arguments).

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
use semihosting::println;

use ocellus_same_bits::ITEMS;

const QUERIES: u32 = 10_000;

fn report(queries: u32) {
    for item in ITEMS {
        println!("{} {} {:016x}", item.name, item.precision, (item.hash)(queries));
    }
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    let argument = std::env::args().nth(1);
    match argument.map_or(Ok(QUERIES), |argument| argument.parse()) {
        Ok(queries) => {
            report(queries);
            std::process::ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("not a number of queries: {error}");
            std::process::ExitCode::from(2)
        }
    }
}

#[cfg(all(target_arch = "arm", target_os = "none"))]
#[cortex_m_rt::entry]
fn main() -> ! {
    report(QUERIES);
    semihosting::process::exit(0)
}

#[cfg(all(target_arch = "riscv32", target_os = "none"))]
#[riscv_rt::entry]
fn main() -> ! {
    report(QUERIES);
    semihosting::process::exit(0)
}
