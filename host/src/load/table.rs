//! A table of a TOML file, read key by key: it knows the line of every value and which keys were asked for, so that a
//! key that nobody asks for is found and the right one suggested.

use super::value::{Kind, describe};
use crate::error::{Error, Origin};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Turns byte offsets of a file into lines.
pub(crate) struct Lines {
    file: Origin,
    /// Offset of each line's first byte.
    starts: Vec<usize>,
}

impl Lines {
    /// Finds the lines of `text`, the content of `file`.
    pub(crate) fn new(file: Origin, text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        let starts = std::iter::once(0).chain(ends.map(|(offset, _)| offset + 1)).collect();
        Self { file, starts }
    }

    /// The line that holds the byte at `offset`.
    pub(crate) fn at(&self, offset: usize) -> Origin {
        self.file.at(self.starts.partition_point(|&start| start <= offset))
    }
}

/// A value with its place in the file.
#[derive(Clone, Debug)]
pub(crate) struct Given<T> {
    /// The value, or the default.
    pub(crate) value: T,
    /// The line of the key, or of the table where the default was taken.
    pub(crate) origin: Origin,
}

/// A table that is being read; an absent one reads as empty.
pub(crate) struct Table<'t> {
    lines: &'t Lines,
    entries: Option<&'t DeTable<'t>>,
    asked: Vec<&'static str>,
    /// The table as the file writes it, `[camera]` or `[[spheres]]`.
    pub(crate) title: String,
    /// The line of the table's head; the file as a whole where it is absent.
    pub(crate) origin: Origin,
}

impl<'t> Table<'t> {
    /// The file as a whole.
    pub(crate) fn root(lines: &'t Lines, entries: &'t DeTable<'t>) -> Self {
        let title = "a scene file".into();
        Self { lines, entries: Some(entries), asked: Vec::new(), title, origin: lines.file.clone() }
    }

    /// A table below this one; `title` as the file writes it.
    fn child(&self, title: String, value: &'t Spanned<DeValue<'t>>) -> Result<Self, Error> {
        let origin = self.lines.at(value.span().start);
        match value.get_ref() {
            DeValue::Table(entries) => {
                Ok(Self { lines: self.lines, entries: Some(entries), asked: Vec::new(), title, origin })
            }
            other => Err(Error::bad_scene(
                origin,
                format!("{title} is {}, but a table is wanted", describe(other)),
                format!("write {title} on a line of its own and its keys below"),
            )),
        }
    }

    /// The entry of `key`, which counts as known from now on.
    fn ask(&mut self, key: &'static str) -> Option<(Origin, &'t Spanned<DeValue<'t>>)> {
        self.asked.push(key);
        let (name, value) = self.entries?.get_key_value(key)?;
        Some((self.lines.at(name.span().start), value))
    }

    /// The value of `key`, if the table has one.
    pub(crate) fn get<T>(&mut self, key: &'static str, kind: Kind<T>) -> Result<Option<Given<T>>, Error> {
        let Some((origin, value)) = self.ask(key) else { return Ok(None) };
        match (kind.read)(value.get_ref()) {
            Some(value) => Ok(Some(Given { value, origin })),
            None => Err(Error::bad_scene(
                origin,
                format!("`{key}` in {} is {}, but {} is wanted", self.title, describe(value.get_ref()), kind.wanted),
                format!("write {}, as in `{key} = {}`", kind.wanted, kind.example),
            )),
        }
    }

    /// The value of `key`, or `default` with the table's own line.
    pub(crate) fn get_or<T>(&mut self, key: &'static str, kind: Kind<T>, default: T) -> Result<Given<T>, Error> {
        let given = self.get(key, kind)?;
        Ok(given.unwrap_or_else(|| Given { value: default, origin: self.origin.clone() }))
    }

    /// The value of `key`, which the table must have.
    pub(crate) fn require<T>(&mut self, key: &'static str, kind: Kind<T>) -> Result<Given<T>, Error> {
        let Kind { wanted, example, .. } = kind;
        self.get(key, kind)?.ok_or_else(|| self.missing(key, wanted, example))
    }

    /// The table `[key]`, empty where the file has none.
    pub(crate) fn table(&mut self, key: &'static str) -> Result<Self, Error> {
        let title = format!("[{key}]");
        match self.ask(key) {
            Some((_, value)) => self.child(title, value),
            None => {
                Ok(Self { lines: self.lines, entries: None, asked: Vec::new(), title, origin: self.origin.clone() })
            }
        }
    }

    /// The tables `[[key]]` in file order.
    pub(crate) fn tables(&mut self, key: &'static str) -> Result<Vec<Self>, Error> {
        let title = format!("[[{key}]]");
        match self.ask(key) {
            None => Ok(Vec::new()),
            Some((_, value)) => match value.get_ref() {
                DeValue::Array(items) => items.iter().map(|item| self.child(title.clone(), item)).collect(),
                other => Err(Error::bad_scene(
                    self.lines.at(value.span().start),
                    format!("`{key}` is {}, but a list of tables is wanted", describe(other)),
                    format!("write {title}, with two brackets, above each of them"),
                )),
            },
        }
    }

    /// The tables `[key.NAME]` with their names, in file order.
    pub(crate) fn named_tables(&mut self, key: &'static str) -> Result<Vec<(String, Self)>, Error> {
        let Some((_, value)) = self.ask(key) else { return Ok(Vec::new()) };
        let parent = self.child(format!("[{key}]"), value)?;
        let mut named: Vec<_> = parent.entries.into_iter().flat_map(|entries| entries.iter()).collect();
        named.sort_by_key(|(name, _)| name.span().start);
        named
            .into_iter()
            .map(|(name, value)| {
                let name = name.get_ref().to_string();
                let table = self.child(format!("[{key}.{name}]"), value)?;
                Ok((name, table))
            })
            .collect()
    }

    /// Ends the reading. `elsewhere` lists keys that this table could have with another choice, and that choice.
    ///
    /// # Errors
    /// The first key of the table that was never asked for.
    pub(crate) fn finish(self, elsewhere: &[(&'static str, &'static str)]) -> Result<(), Error> {
        let Some((key, origin)) = self.unknown().into_iter().next() else { return Ok(()) };
        if let Some((_, choice)) = elsewhere.iter().find(|(other, _)| *other == key) {
            return Err(Error::bad_scene(
                origin,
                format!("`{key}` in {} belongs to {choice}", self.title),
                format!("remove it, or choose {choice}"),
            ));
        }
        let known = self.asked.iter().copied().chain(elsewhere.iter().map(|(other, _)| *other));
        let remedy = match nearest(key, known) {
            Some(known) => format!("did you mean `{known}`?"),
            None => format!("the keys here are {}", self.asked.join(", ")),
        };
        Err(Error::bad_scene(origin, format!("unknown key `{key}` in {}", self.title), remedy))
    }

    /// The error that `key` is absent; a key that looks like it is named instead, since that is what went wrong.
    pub(crate) fn missing(&self, key: &'static str, wanted: &str, example: &str) -> Error {
        let unknown = self.unknown();
        let misspelt = nearest(key, unknown.iter().map(|(name, _)| *name));
        match unknown.iter().find(|(name, _)| Some(*name) == misspelt) {
            Some((name, origin)) => Error::bad_scene(
                origin.clone(),
                format!("unknown key `{name}` in {}", self.title),
                format!("did you mean `{key}`?"),
            ),
            None => Error::bad_scene(
                self.origin.clone(),
                match self.entries {
                    Some(_) => format!("{} has no `{key}`", self.title),
                    None => format!("the scene has no {}, which must have `{key}`", self.title),
                },
                format!("add {wanted}, as in `{key} = {example}`"),
            ),
        }
    }

    /// The keys that nobody has asked for, in file order.
    fn unknown(&self) -> Vec<(&'t str, Origin)> {
        let mut unknown: Vec<_> = self.entries.into_iter().flat_map(|entries| entries.keys()).collect();
        unknown.retain(|key| !self.asked.contains(&key.get_ref().as_ref()));
        unknown.sort_by_key(|key| key.span().start);
        unknown.into_iter().map(|key| (key.get_ref().as_ref(), self.lines.at(key.span().start))).collect()
    }
}

/// The known name that `name` was probably meant to be.
pub(crate) fn nearest<'n>(name: &str, known: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    /// Below this share of equal letters two names are taken for different words.
    const ALIKE: f64 = 0.6;
    let likeness = |known: &str| {
        // An abbreviation shares few letters with the whole, but means it.
        let abbreviated = name.len() >= 3 && known.starts_with(name);
        if abbreviated { 1.0 } else { strsim::normalized_damerau_levenshtein(name, known) }
    };
    known
        .into_iter()
        .map(|known| (likeness(known), known))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::value::{EXPOSURE, POSITIVE};
    use std::path::Path;

    const TEXT: &str = "\u{feff}[ball]\r\nradius = 2\r\n\r\n[[dots]]\r\nx = 1\r\n[[dots]]\r\nx = 2\r\n\
                        [kinds.zinc]\r\nx = 1\r\n[kinds.acid]\r\nx = 2\r\n";

    fn with_root<T>(text: &str, read: impl FnOnce(Table<'_>) -> T) -> T {
        let tree = DeTable::parse(text).expect("valid TOML");
        let lines = Lines::new(Origin::file(Path::new("a.toml")), text);
        read(Table::root(&lines, tree.get_ref()))
    }

    #[test]
    fn lines_survive_byte_order_mark_and_carriage_returns() {
        with_root(TEXT, |mut root| {
            let mut ball = root.table("ball").expect("a table");
            assert_eq!(ball.origin.line, 1);
            let radius = ball.require("radius", POSITIVE).expect("a number");
            assert_eq!((radius.value, radius.origin.line), (2.0, 2));
            let gloss = ball.get_or("gloss", EXPOSURE, 5.0).expect("a default");
            assert_eq!((gloss.value, gloss.origin.line), (5.0, 1));
            ball.finish(&[]).expect("every key is known");
            let dots = root.tables("dots").expect("tables");
            assert_eq!(dots.iter().map(|dot| dot.origin.line).collect::<Vec<_>>(), [4, 6]);
            let kinds = root.named_tables("kinds").expect("tables");
            let kinds: Vec<_> = kinds.iter().map(|(name, kind)| (name.as_str(), kind.origin.line)).collect();
            assert_eq!(kinds, [("zinc", 8), ("acid", 10)]);
            root.finish(&[]).expect("every table is known");
        });
    }

    #[test]
    fn an_absent_table_is_empty_and_stands_for_the_file() {
        with_root(TEXT, |mut root| {
            let mut camera = root.table("camera").expect("an empty table");
            assert_eq!(camera.origin.line, 0);
            assert!(camera.get("fov", EXPOSURE).expect("nothing").is_none());
            let cause = camera.require("x", EXPOSURE).expect_err("absent").cause;
            assert_eq!(cause, "the scene has no [camera], which must have `x`");
            camera.finish(&[]).expect("nothing is unknown");
        });
    }

    #[test]
    fn the_first_unknown_key_in_file_order_is_reported() {
        with_root("size = 1\nzzz = 1\naaa = 2\nsmall = 1\n", |mut root| {
            root.get("size", EXPOSURE).expect("a number");
            let error = root.finish(&[("small", "kind = \"x\"")]).expect_err("unknown keys");
            assert_eq!(error.cause, "unknown key `zzz` in a scene file");
            assert_eq!(error.remedy, "the keys here are size");
            assert_eq!(error.origin.map(|origin| origin.line), Some(2));
        });
    }

    #[test]
    fn the_nearest_name_is_found() {
        let known = ["radius", "center", "fov_degrees", "material"];
        for (name, meant) in [
            ("raduis", Some("radius")),
            ("centre", Some("center")),
            ("fov", Some("fov_degrees")),
            ("Material", Some("material")),
            ("colour", None),
            ("r", None),
        ] {
            assert_eq!(nearest(name, known), meant, "{name}");
        }
    }
}
