//! `[[lights]]`.

use crate::description::LightDescription;
use crate::error::Error;
use crate::load::table::{Given, Table};
use crate::load::value::{Kind, LIGHT, POSITIVE, TRIPLE, choice};
use glam::DVec3;
use std::f64::consts::PI;

#[derive(Clone, Copy)]
enum Shape {
    Point,
    Sphere,
}

const SHAPE: Kind<Shape> = Kind {
    wanted: "one of \"point\", \"sphere\"",
    example: "\"point\"",
    read: |value| choice(value, [("point", Shape::Point), ("sphere", Shape::Sphere)]),
};

/// Keys that belong to one kind of light only.
const SHAPE_KEYS: [(&str, &str); 4] = [
    ("position", "kind = \"point\""),
    ("center", "kind = \"sphere\""),
    ("radius", "kind = \"sphere\""),
    ("radiance", "kind = \"sphere\""),
];

pub(super) fn read_light(mut table: Table<'_>) -> Result<LightDescription, Error> {
    let origin = table.origin.clone();
    let light = match table.require("kind", SHAPE)?.value {
        Shape::Point => LightDescription::Point {
            origin,
            position: table.require("position", TRIPLE)?.value,
            power: table.require("power", LIGHT)?.value,
        },
        Shape::Sphere => {
            let center = table.require("center", TRIPLE)?.value;
            let radius = table.require("radius", POSITIVE)?.value;
            let radiance = sphere_radiance(&mut table, radius)?;
            LightDescription::Sphere { origin, center, radius, radiance }
        }
    };
    table.finish(&SHAPE_KEYS)?;
    Ok(light)
}

/// `radiance`, or what gives `power`: a sphere of radiance L sends pi L through each of its 4 pi radius^2 units of area.
fn sphere_radiance(table: &mut Table<'_>, radius: f64) -> Result<DVec3, Error> {
    let radiance = table.get("radiance", LIGHT)?;
    let power = table.get("power", LIGHT)?;
    match (radiance, power) {
        (Some(radiance), None) => Ok(radiance.value),
        (None, Some(power)) => radiance_of_power(power, radius),
        (Some(_), Some(power)) => Err(Error::bad_scene(
            power.origin,
            format!("{} has `power` and `radiance`, which say the same thing", table.title),
            "remove one of them",
        )),
        (None, None) => Err(table.missing("power", LIGHT.wanted, LIGHT.example)),
    }
}

fn radiance_of_power(power: Given<DVec3>, radius: f64) -> Result<DVec3, Error> {
    let radiance = power.value / (4.0 * PI * PI * radius * radius);
    if radiance.as_vec3().is_finite() {
        return Ok(radiance);
    }
    Err(Error::bad_scene(
        power.origin,
        format!("`power` on a radius of {radius} is more radiance than a number can hold"),
        "take less power or a larger radius",
    ))
}
