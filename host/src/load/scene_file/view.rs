//! `[camera]`, `[film]` and `[integrator]`.

use super::Surroundings;
use crate::description::{
    CameraDescription, FilmDescription, FilterDescription, FresnelDescription, IntegratorDescription,
    LightSamplingDescription, SamplerDescription,
};
use crate::error::Error;
use crate::load::table::Table;
use crate::load::value::{
    BOUNCES, EXPOSURE, FIELD_OF_VIEW, FLAG, GAMMA, Kind, NON_NEGATIVE, PIXELS, POSITIVE, SAMPLES, SEED, TRIPLE, choice,
};
use glam::DVec3;

/// The filters, each with its default width.
const FILTER: Kind<FilterDescription> = Kind {
    wanted: "one of \"box\", \"center\", \"tent\", \"gaussian\"",
    example: "\"box\"",
    read: |value| {
        choice(
            value,
            [
                ("box", FilterDescription::Box { width: 1.0 }),
                ("center", FilterDescription::Center),
                ("tent", FilterDescription::Tent { radius: 1.0 }),
                ("gaussian", FilterDescription::Gaussian { stdev: 0.5 }),
            ],
        )
    },
};

/// Keys that belong to one filter only.
const FILTER_KEYS: [(&str, &str); 3] = [
    ("filter_width", "filter = \"box\""),
    ("filter_radius", "filter = \"tent\""),
    ("filter_stdev", "filter = \"gaussian\""),
];

const LIGHT_SAMPLING: Kind<LightSamplingDescription> = Kind {
    wanted: "one of \"cone\", \"hemisphere\", \"none\"",
    example: "\"cone\"",
    read: |value| {
        choice(
            value,
            [
                ("cone", LightSamplingDescription::Cone),
                ("hemisphere", LightSamplingDescription::Hemisphere),
                ("none", LightSamplingDescription::None),
            ],
        )
    },
};

const FRESNEL: Kind<FresnelDescription> = Kind {
    wanted: "one of \"exact\", \"schlick\", \"none\"",
    example: "\"exact\"",
    read: |value| {
        choice(
            value,
            [
                ("exact", FresnelDescription::Exact),
                ("schlick", FresnelDescription::Schlick),
                ("none", FresnelDescription::None),
            ],
        )
    },
};

const SAMPLER: Kind<SamplerDescription> = Kind {
    wanted: "one of \"independent\", \"sobol\"",
    example: "\"sobol\"",
    read: |value| {
        choice(value, [("independent", SamplerDescription::Independent), ("sobol", SamplerDescription::Sobol)])
    },
};

/// Below this sine between `up` and the view axis, rounding would choose what is up.
const LEAST_SINE_TO_UP: f64 = 1e-6;

pub(super) fn read_camera(mut table: Table<'_>) -> Result<CameraDescription, Error> {
    let origin = table.origin.clone();
    let position = table.require("position", TRIPLE)?.value;
    let look_at = table.require("look_at", TRIPLE)?;
    let up = table.get_or("up", TRIPLE, DVec3::Y)?;
    let view = look_at.value - position;
    // As f32, since that is what a kernel of that precision gets.
    if view.length() as f32 == 0.0 {
        return Err(Error::bad_scene(
            look_at.origin,
            "`look_at` in [camera] is where the camera is, so it has no direction",
            "move one of them: the camera looks from `position` to `look_at`",
        ));
    }
    let across = view.cross(up.value);
    if across.length() <= LEAST_SINE_TO_UP * view.length() * up.value.length() {
        return Err(Error::bad_scene(
            up.origin,
            "`up` in [camera] is zero or lies along the view, so nothing says what is up",
            "give a direction across the view, as in `up = [0, 0, -1]` for a camera that looks down",
        ));
    }
    let aperture = table.get_or("aperture_radius", NON_NEGATIVE, 0.0)?;
    let camera = CameraDescription {
        origin,
        position,
        look_at: look_at.value,
        up: up.value,
        fov_degrees: table.get_or("fov_degrees", FIELD_OF_VIEW, 60.0)?.value,
        aperture_radius: aperture.value,
        focal_distance: table.get_or("focal_distance", POSITIVE, view.length())?.value,
        lens_origin: aperture.origin,
    };
    table.finish(&[])?;
    Ok(camera)
}

pub(super) fn read_film(mut table: Table<'_>) -> Result<FilmDescription, Error> {
    let origin = table.origin.clone();
    let filter = table.get_or("filter", FILTER, FilterDescription::Box { width: 1.0 })?;
    let film = FilmDescription {
        origin,
        width: table.get_or("width", PIXELS, 512)?.value,
        height: table.get_or("height", PIXELS, 512)?.value,
        spp: table.get_or("spp", SAMPLES, 64)?.value,
        filter: match filter.value {
            FilterDescription::Center => FilterDescription::Center,
            FilterDescription::Box { width } => {
                FilterDescription::Box { width: table.get_or("filter_width", POSITIVE, width)?.value }
            }
            FilterDescription::Tent { radius } => {
                FilterDescription::Tent { radius: table.get_or("filter_radius", POSITIVE, radius)?.value }
            }
            FilterDescription::Gaussian { stdev } => {
                FilterDescription::Gaussian { stdev: table.get_or("filter_stdev", POSITIVE, stdev)?.value }
            }
        },
        filter_origin: filter.origin,
        exposure: table.get_or("exposure", EXPOSURE, 0.0)?.value,
        gamma: table.get("gamma", GAMMA)?.map(|gamma| gamma.value),
    };
    table.finish(&FILTER_KEYS)?;
    Ok(film)
}

pub(super) fn read_integrator(
    mut table: Table<'_>,
    surroundings: Surroundings,
) -> Result<IntegratorDescription, Error> {
    let origin = table.origin.clone();
    let indirect = table.get_or("indirect", FLAG, true)?;
    let roulette = table.get("roulette_after", BOUNCES)?;
    let aim = table.get_or("aim", FLAG, false)?;
    let sampler = table.get_or("sampler", SAMPLER, SamplerDescription::Independent)?;
    let integrator = IntegratorDescription {
        max_bounces: table.get_or("max_bounces", BOUNCES, 7)?.value,
        indirect: indirect.value,
        indirect_origin: indirect.origin,
        light_sampling: table.get_or("light_sampling", LIGHT_SAMPLING, LightSamplingDescription::Cone)?.value,
        fresnel: table.get_or("fresnel", FRESNEL, FresnelDescription::Exact)?.value,
        roulette_after: roulette.as_ref().map(|given| given.value),
        roulette_origin: roulette.map_or_else(|| origin.clone(), |given| given.origin),
        aim: aim.value,
        aim_origin: aim.origin,
        background: surroundings.background,
        background_origin: surroundings.background_origin,
        sampler: sampler.value,
        sampler_origin: sampler.origin,
        seed: table.get_or("seed", SEED, 0)?.value,
        origin,
    };
    table.finish(&[])?;
    Ok(integrator)
}
