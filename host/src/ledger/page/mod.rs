//! The ledger as a page: one file that needs nothing beside it, neither scripts nor fonts nor a network.

mod again;
mod axis;
mod crops;
mod efficiency;
mod errors;
mod forecast;
mod labels;
mod markup;
mod pictures;
mod plot;
mod tables;
#[cfg(test)]
mod tests;

use super::Ledger;
use crate::film::Region;
use crate::output::ToneMap;
use markup::escape;

/// What a page says that a ledger does not know.
#[derive(Clone, Debug)]
pub struct Heading<'a> {
    /// The scene's file, as the command line has it.
    pub scene: &'a str,
    /// The size of the picture, where the command line asks for one.
    pub size: Option<[u32; 2]>,
    /// The whole film.
    pub whole: Region,
    /// Whether the command line asks for a number of bounces.
    pub has_max_bounces: bool,
    /// Whether it asks how dielectrics share light.
    pub has_fresnel: bool,
    /// Whether it asks where the numbers of samples come from.
    pub has_sampler: bool,
    /// How the scene's PNGs are made.
    pub tone: ToneMap,
    /// Seed of the first run.
    pub seed: u64,
}

const STYLE: &str = include_str!("style.css");

/// The page, as HTML that is XML too but for its first line.
pub fn html(ledger: &Ledger, heading: &Heading<'_>) -> String {
    let name = std::path::Path::new(heading.scene).file_name().map(|name| name.to_string_lossy().into_owned());
    let title = escape(&name.unwrap_or_else(|| heading.scene.to_owned()));
    let [what, reference] = ledger.how().map(|line| escape(&line));
    let sections = [
        ("Error against time", errors::section(ledger)),
        ("What each option is worth", efficiency::section(ledger)),
        ("What the first samples foretell", forecast::section(ledger)),
        ("Where the error is", pictures::maps(ledger)),
        ("What it looks like", crops::section(ledger, &heading.tone)),
        ("All levels", tables::levels(ledger) + &tables::rungs(ledger)),
        ("Do it again", again::section(ledger, heading)),
    ];
    let sections = sections.map(|(heading, content)| format!("<section>\n<h2>{heading}</h2>\n{content}</section>\n"));
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n\
         <meta name=\"color-scheme\" content=\"light dark\" />\n<title>{title}: what accuracy costs</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<div class=\"text\">\n<p class=\"kind\">Ocellus ledger: what accuracy costs in time</p>\n\
         <h1>{title}</h1>\n<p class=\"sentence\">{}.</p>\n<p class=\"how\">{what}<br />{reference}</p>\n</div>\n{}\n</header>\n\
         <main>\n{}</main>\n<footer>{}, {}</footer>\n</body>\n</html>\n",
        escape(&ledger.sentence()),
        pictures::scene(ledger, &heading.tone),
        sections.concat(),
        concat!("ocellus ", env!("CARGO_PKG_VERSION")),
        escape(heading.scene),
    )
}
