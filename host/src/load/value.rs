//! What a key of a scene file may hold: one [`Kind`] for each meaning, so that a wrong type and a wrong range give the same
//! message.

use glam::DVec3;
use toml::de::DeValue;

/// What may stand behind a key, and how it is read.
pub(crate) struct Kind<T> {
    /// What is accepted, as a message says it.
    pub(crate) wanted: &'static str,
    /// A value that is accepted.
    pub(crate) example: &'static str,
    /// The value, or `None` where it is of another type or out of range.
    pub(crate) read: fn(&DeValue<'_>) -> Option<T>,
}

/// A length, an index of refraction: more than nothing.
pub(crate) const POSITIVE: Kind<f64> = Kind {
    wanted: "a finite number greater than 0",
    example: "1.5",
    read: |value| number(value).filter(|&x| is_positive(x)),
};

/// A length that may be absent.
pub(crate) const NON_NEGATIVE: Kind<f64> =
    Kind { wanted: "a finite number, 0 or greater", example: "0.5", read: |value| number(value).filter(|&x| x >= 0.0) };

/// A full field of view, degrees.
pub(crate) const FIELD_OF_VIEW: Kind<f64> = Kind {
    wanted: "an angle between 0 and 180 degrees",
    example: "60",
    read: |value| number(value).filter(|&x| is_positive(x) && x < 180.0),
};

/// Stops of exposure; beyond 64 every picture is black or white.
pub(crate) const EXPOSURE: Kind<f64> = Kind {
    wanted: "a number of stops from -64 to 64",
    example: "1.5",
    read: |value| number(value).filter(|x| x.abs() <= 64.0),
};

/// The exponent of the PNG's transfer curve.
pub(crate) const GAMMA: Kind<f64> = Kind {
    wanted: "a number from 0.1 to 10",
    example: "2.2",
    read: |value| number(value).filter(|x| (0.1..=10.0).contains(x)),
};

/// A point, a direction, three angles.
pub(crate) const TRIPLE: Kind<DVec3> = Kind { wanted: "three finite numbers", example: "[0, 1, 5]", read: triple };

/// Factors along the axes.
pub(crate) const SCALE: Kind<DVec3> = Kind {
    wanted: "one or three finite numbers greater than 0",
    example: "0.5",
    read: |value| one_or_three(value).filter(|v| v.to_array().into_iter().all(is_positive)),
};

/// Fractions of light per channel.
pub(crate) const FRACTION: Kind<DVec3> = Kind {
    wanted: "one or three numbers from 0 to 1",
    example: "[0.9, 0.4, 0.3]",
    read: |value| one_or_three(value).filter(|v| v.cmpge(DVec3::ZERO).all() && v.cmple(DVec3::ONE).all()),
};

/// Amounts of light per channel.
pub(crate) const LIGHT: Kind<DVec3> = Kind {
    wanted: "one or three finite numbers, 0 or greater",
    example: "[1.0, 0.9, 0.8]",
    read: |value| one_or_three(value).filter(|v| v.cmpge(DVec3::ZERO).all()),
};

/// Pixels along one side of the picture.
pub(crate) const PIXELS: Kind<u32> = Kind {
    wanted: "a whole number from 1 to 65535",
    example: "512",
    read: |value| whole(value, 1, 65_535).and_then(|n| n.try_into().ok()),
};

/// Samples per pixel.
pub(crate) const SAMPLES: Kind<u32> = Kind {
    wanted: "a whole number from 1 to 4294967295",
    example: "64",
    read: |value| whole(value, 1, u32::MAX.into()).and_then(|n| n.try_into().ok()),
};

/// Scattering events along a path.
pub(crate) const BOUNCES: Kind<u32> = Kind {
    wanted: "a whole number from 0 to 65535",
    example: "7",
    read: |value| whole(value, 0, 65_535).and_then(|n| n.try_into().ok()),
};

/// The seed of the sample numbers.
pub(crate) const SEED: Kind<u64> = Kind {
    wanted: "a whole number from 0 to 18446744073709551615",
    example: "7",
    read: |value| whole(value, 0, u64::MAX),
};

/// On or off.
pub(crate) const FLAG: Kind<bool> = Kind { wanted: "true or false", example: "true", read: |value| value.as_bool() };

/// A name of the user's own.
pub(crate) const NAME: Kind<String> = Kind { wanted: "a name in quotes", example: "\"glass\"", read: text };

/// The name of a file, relative to the file that names it.
pub(crate) const FILE: Kind<String> =
    Kind { wanted: "the name of a file in quotes", example: "\"cat.obj\"", read: text };

/// The choice that a word stands for.
pub(crate) fn choice<T>(value: &DeValue<'_>, choices: impl IntoIterator<Item = (&'static str, T)>) -> Option<T> {
    let word = value.as_str()?;
    choices.into_iter().find_map(|(name, choice)| (name == word).then_some(choice))
}

/// A value as a message shows it.
pub(crate) fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("the text {:?}", text.as_ref()),
        DeValue::Integer(number) => format!("{number}"),
        DeValue::Float(number) => format!("{number}"),
        DeValue::Boolean(flag) => format!("{flag}"),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(items) if items.len() <= 4 && items.iter().all(|item| is_number(item.get_ref())) => {
            let items: Vec<String> = items.iter().map(|item| describe(item.get_ref())).collect();
            format!("[{}]", items.join(", "))
        }
        DeValue::Array(items) => format!("a list of length {}", items.len()),
        DeValue::Table(_) => "a table".into(),
    }
}

fn is_number(value: &DeValue<'_>) -> bool {
    value.is_integer() || value.is_float()
}

/// Positive in both precisions: what is 0 in f32 is refused here and not met as 0 there.
fn is_positive(x: f64) -> bool {
    x as f32 > 0.0
}

/// An integer or a float that is finite in both precisions.
fn number(value: &DeValue<'_>) -> Option<f64> {
    let number = match value {
        DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).ok()? as f64,
        DeValue::Float(float) => float.as_str().parse().ok()?,
        _ => return None,
    };
    (number as f32).is_finite().then_some(number)
}

fn whole(value: &DeValue<'_>, least: u64, most: u64) -> Option<u64> {
    let integer = value.as_integer()?;
    let number = u64::from_str_radix(integer.as_str(), integer.radix()).ok()?;
    (least..=most).contains(&number).then_some(number)
}

fn triple(value: &DeValue<'_>) -> Option<DVec3> {
    let items = value.as_array().filter(|items| items.len() == 3)?;
    let item = |i: usize| number(items.get(i)?.get_ref());
    Some(DVec3::new(item(0)?, item(1)?, item(2)?))
}

fn one_or_three(value: &DeValue<'_>) -> Option<DVec3> {
    number(value).map(DVec3::splat).or_else(|| triple(value))
}

fn text(value: &DeValue<'_>) -> Option<String> {
    value.as_str().filter(|text| !text.is_empty()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<T>(kind: Kind<T>, text: &str) -> Option<T> {
        (kind.read)(DeValue::parse(text).expect("valid TOML").get_ref())
    }

    /// Every kind accepts its own example, so that the messages' advice can be followed.
    #[test]
    fn examples_are_accepted() {
        assert_eq!(read(POSITIVE, POSITIVE.example), Some(1.5));
        assert_eq!(read(NON_NEGATIVE, NON_NEGATIVE.example), Some(0.5));
        assert_eq!(read(FIELD_OF_VIEW, FIELD_OF_VIEW.example), Some(60.0));
        assert_eq!(read(EXPOSURE, EXPOSURE.example), Some(1.5));
        assert_eq!(read(GAMMA, GAMMA.example), Some(2.2));
        assert_eq!(read(TRIPLE, TRIPLE.example), Some(DVec3::new(0.0, 1.0, 5.0)));
        assert_eq!(read(SCALE, SCALE.example), Some(DVec3::splat(0.5)));
        assert_eq!(read(FRACTION, FRACTION.example), Some(DVec3::new(0.9, 0.4, 0.3)));
        assert_eq!(read(LIGHT, LIGHT.example), Some(DVec3::new(1.0, 0.9, 0.8)));
        assert_eq!(read(PIXELS, PIXELS.example), Some(512));
        assert_eq!(read(SAMPLES, SAMPLES.example), Some(64));
        assert_eq!(read(BOUNCES, BOUNCES.example), Some(7));
        assert_eq!(read(SEED, SEED.example), Some(7));
        assert_eq!(read(FLAG, FLAG.example), Some(true));
        assert_eq!(read(NAME, NAME.example).as_deref(), Some("glass"));
        assert_eq!(read(FILE, FILE.example).as_deref(), Some("cat.obj"));
    }

    #[test]
    fn numbers_in_every_notation() {
        const ANY: Kind<f64> = Kind { wanted: "any number", example: "1", read: number };
        for (text, number) in [
            ("3", 3.0),
            ("-3", -3.0),
            ("+3.5", 3.5),
            ("1_000", 1000.0),
            ("1_000.5", 1000.5),
            ("0x10", 16.0),
            ("1e-3", 0.001),
            ("9223372036854775807", 9.223372036854776e18),
        ] {
            assert_eq!(read(ANY, text), Some(number), "{text}");
        }
        for text in ["nan", "inf", "-inf", "1e39", "1e999", "true", "\"1\"", "[1]", "1979-05-27"] {
            assert_eq!(read(ANY, text), None, "{text}");
        }
    }

    #[test]
    fn ranges_end_where_they_say() {
        for text in ["0", "-1", "1e-60", "nan"] {
            assert_eq!(read(POSITIVE, text), None, "{text}");
            assert_eq!(read(SCALE, &format!("[1, {text}, 1]")), None, "{text}");
        }
        assert_eq!(read(NON_NEGATIVE, "0"), Some(0.0));
        assert_eq!(read(NON_NEGATIVE, "-0.1"), None);
        assert_eq!(read(FIELD_OF_VIEW, "180"), None);
        assert_eq!(read(FRACTION, "1"), Some(DVec3::ONE));
        assert_eq!(read(FRACTION, "[1, 1, 1.01]"), None);
        assert_eq!(read(LIGHT, "[1, -1, 1]"), None);
        assert_eq!(read(TRIPLE, "[1, 2]"), None);
        assert_eq!(read(TRIPLE, "[1, 2, 3, 4]"), None);
        assert_eq!(read(TRIPLE, "[1, 2, inf]"), None);
        assert_eq!(read(PIXELS, "65535"), Some(65_535));
        assert_eq!((read(PIXELS, "0"), read(PIXELS, "65536"), read(PIXELS, "2.0")), (None, None, None));
        assert_eq!(read(SAMPLES, "4294967295"), Some(u32::MAX));
        assert_eq!((read(SAMPLES, "0"), read(SAMPLES, "4294967296")), (None, None));
        assert_eq!((read(BOUNCES, "0"), read(BOUNCES, "-1")), (Some(0), None));
        assert_eq!(read(SEED, "18446744073709551615"), Some(u64::MAX));
        assert_eq!((read(SEED, "0xff"), read(SEED, "18446744073709551616")), (Some(255), None));
        assert_eq!(read(NAME, "\"\""), None);
    }

    #[test]
    fn values_are_shown_as_written() {
        for (text, shown) in [
            ("-1", "-1"),
            ("nan", "nan"),
            ("\"a\\nb\"", "the text \"a\\nb\""),
            ("[1, 2.5]", "[1, 2.5]"),
            ("[1, 2, 3, 4, 5]", "a list of length 5"),
            ("[true]", "a list of length 1"),
            ("{ a = 1 }", "a table"),
            ("false", "false"),
        ] {
            assert_eq!(describe(DeValue::parse(text).expect("valid TOML").get_ref()), shown, "{text}");
        }
    }
}
