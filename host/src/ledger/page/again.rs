//! How to make the first picture of each level again.

use super::Heading;
use super::markup::escape;
use crate::assemble::Accel;
use crate::film::Region;
use crate::isa::IsaChoice;
use crate::kernels::EffectChoice;
use crate::ledger::Ledger;
use crate::ledger::account::Account;
use crate::ledger::levels::Choice;
use crate::render::Precision;

/// A command line for each level, and what it prints.
pub(super) fn section(ledger: &Ledger, heading: &Heading<'_>) -> String {
    let rows = ledger.accounts.iter().map(|account| {
        format!(
            "<dt>{}</dt><dd><code>{}</code>{} <span class=\"hash\">image_hash {:016x}</span></dd>\n",
            escape(&account.name()),
            escape(&command(ledger.region, account, heading)),
            escape(edit(account).as_deref().unwrap_or_default()),
            account.measured.image_hash
        )
    });
    format!(
        "<p class=\"caption\">The first run of each level at its last rung, as a command. With <code>--json</code> it prints the hash \
         that is given here: the same bits on every machine, with any number of threads. Run k has a seed higher by k - 1.</p>\n\
         <dl>{}</dl>\n",
        rows.collect::<String>()
    )
}

fn command(region: Region, account: &Account, heading: &Heading<'_>) -> String {
    let level = &account.measured.level;
    let settings = &level.settings;
    let mut words = vec!["ocellus render".to_owned(), quoted(heading.scene)];
    let mut option = |name: &str, value: &dyn std::fmt::Display| words.push(format!("--{name} {value}"));
    option("seed", &heading.seed);
    option("spp", &account.top().spp);
    if let Some([width, height]) = heading.size {
        option("size", &format_args!("{width}x{height}"));
    }
    if region != heading.whole {
        let Region { x0, y0, x1, y1 } = region;
        option("crop", &format_args!("{x0},{y0},{x1},{y1}"));
    }
    if heading.has_max_bounces || level.choice == Some(Choice::MaxBounces) {
        option("max-bounces", &level.integrator.max_bounces);
    }
    if heading.has_fresnel || level.choice == Some(Choice::Fresnel) {
        option("fresnel", &name_of(&level.integrator.fresnel));
    }
    if heading.has_sampler || level.choice == Some(Choice::Sampler) {
        option("sampler", &name_of(&level.integrator.sampler));
    }
    if settings.precision != Precision::default() {
        option("precision", &name_of(&settings.precision));
    }
    if settings.accel != Accel::default() {
        option("accel", &name_of(&settings.accel));
    }
    if settings.effects != EffectChoice::Auto {
        option("effects", &name_of(&settings.effects));
    }
    if settings.isa != IsaChoice::Auto {
        option("isa", &name_of(&settings.isa));
    }
    let accuracy = crate::accuracy::describe(settings.accuracy);
    if accuracy != "robust" {
        words.push(accuracy);
    }
    words.join(" ")
}

/// The word that the command line has for a value.
fn name_of(value: &impl clap::ValueEnum) -> String {
    value.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// What has to be changed in the scene's file, where no option of the command line says it.
fn edit(account: &Account) -> Option<String> {
    let level = &account.measured.level;
    let line = match level.choice? {
        Choice::LightSampling => format!("light_sampling = \"{}\"", level.name),
        Choice::Roulette => match level.integrator.roulette_after {
            Some(after) => format!("roulette_after = {after}"),
            None => "no roulette_after".to_owned(),
        },
        Choice::Aim => format!("aim = {}", level.integrator.aim),
        _ => return None,
    };
    Some(format!(" with {line} in [integrator]"))
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |character: char| character.is_ascii_alphanumeric() || "/._-+=:,@%".contains(character);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_the_shell() {
        assert_eq!(quoted("a/b-1.toml"), "a/b-1.toml");
        assert_eq!(quoted("my scene's.toml"), "'my scene'\\''s.toml'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn options_are_those_of_the_command_line() {
        assert_eq!(name_of(&Precision::F64), "f64");
        assert_eq!(name_of(&EffectChoice::All), "all");
        assert_eq!(name_of(&Accel::None), "none");
    }
}
