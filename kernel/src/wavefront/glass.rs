//! Glass of spheres, in the lanes that hit it: gathered into groups, so that vectors have something to do.

use super::columns::{Column, GROUP, Lanes, Vectors};
use super::departures::{Arrivals, Departures};
use super::directions::{Directions, Kind};
use crate::accuracy::RayOffset;
use crate::departure::Departure;
use crate::effects::{EffectSet, Effects};
use crate::material::{Fresnel, Scattering, dielectric};
use crate::ray::NO_PRIMITIVE;
use crate::real::{Real, Vec3, Vector};

/// Whether a kernel's glass can be done in groups: all is spheres, whose rays start where [`Departure::off`] says.
pub(super) const fn in_groups<E: EffectSet>() -> bool {
    !E::EFFECTS.contains(Effects::TRIANGLES) && !matches!(E::ACCURACY.offset, RayOffset::Constant)
}

/// What scattering needs, and finds, of each of a group.
struct Group<R: Real> {
    p: Vectors<R, GROUP>,
    p_error: Vectors<R, GROUP>,
    wo: Vectors<R, GROUP>,
    ng: Vectors<R, GROUP>,
    facing: Vectors<R, GROUP>,
    t: [R; GROUP],
    /// On the viewer's side, and beyond.
    iors: [[R; GROUP]; 2],
    choice: [u32; GROUP],
    wi: Vectors<R, GROUP>,
    transmitted: [bool; GROUP],
    front: [bool; GROUP],
    origin: Vectors<R, GROUP>,
    error: [R; GROUP],
}

impl<R: Real> Group<R> {
    fn new() -> Self {
        Self {
            p: Vectors::ZERO,
            p_error: Vectors::ZERO,
            wo: Vectors::ZERO,
            ng: Vectors::ZERO,
            facing: Vectors::ZERO,
            t: [R::ZERO; GROUP],
            iors: [[R::ONE; GROUP]; 2],
            choice: [0; GROUP],
            wi: Vectors::ZERO,
            transmitted: [false; GROUP],
            front: [false; GROUP],
            origin: Vectors::ZERO,
            error: [R::ZERO; GROUP],
        }
    }

    /// [`dielectric::sample`] and the departure of its direction, for all of the group.
    #[inline(always)]
    fn scatter(&mut self, fresnel: Fresnel) {
        for k in 0..GROUP {
            let [ior_i, ior_t] = [self.iors[0][k].widen(), self.iors[1][k].widen()];
            let choice = R::Wide::from_unit_bits(self.choice[k]);
            let (wi, transmitted) =
                dielectric::scatter::<R>(self.wo.at(k), self.facing.at(k), ior_i, ior_t, fresnel, choice);
            let ng = self.ng.at(k);
            let front = wi.dot(ng) > R::ZERO;
            let side = if front { ng } else { -ng };
            let departure = Departure::off(self.p.at(k), self.p_error.at(k), self.t[k], side);
            self.wi.set(k, wi);
            self.transmitted[k] = transmitted;
            self.front[k] = front;
            self.origin.set(k, departure.origin);
            self.error[k] = departure.error;
        }
    }
}

/// Where the paths that hit glass go on, and from where.
#[inline(always)]
pub(super) fn scatter<R: Real>(
    fresnel: Fresnel,
    from: &Arrivals<'_, R>,
    kinds: &Column<Kind>,
    choices: &Column<u32>,
    departures: &mut Departures<R>,
    directions: &mut Directions<R>,
) {
    let (surfaces, materials) = (from.surfaces, from.few.scene.materials());
    let mut all = Lanes::that(|lane| kinds[lane] == Kind::Glass);
    let mut group = Group::new();
    loop {
        let (lanes, count) = all.next_group();
        let lanes = &lanes[..count];
        if lanes.is_empty() {
            return;
        }
        for (k, &lane) in lanes.iter().enumerate() {
            let Scattering::Dielectric(glass) = &materials[surfaces.material[lane] as usize].scattering else {
                continue;
            };
            let (wo, ng) = (surfaces.wo.at(lane), surfaces.ng.at(lane));
            group.p.set(k, surfaces.p.at(lane));
            group.p_error.set(k, surfaces.p_error.at(lane));
            group.wo.set(k, wo);
            group.ng.set(k, ng);
            group.facing.set(k, surfaces.facing_ng.at(lane));
            group.t[k] = from.hits.t[lane];
            [group.iors[0][k], group.iors[1][k]] = glass.iors(wo.dot(ng) >= R::ZERO);
            group.choice[k] = choices[lane];
            directions.weight.set(lane, glass.transmittance);
        }
        // Of each its own loop, without a switch.
        match fresnel {
            Fresnel::None => group.scatter(Fresnel::None),
            Fresnel::Schlick => group.scatter(Fresnel::Schlick),
            Fresnel::Exact => group.scatter(Fresnel::Exact),
        }
        for (k, &lane) in lanes.iter().enumerate() {
            directions.wi.set(lane, group.wi.at(k));
            directions.found[lane] = true;
            if !group.transmitted[k] {
                directions.weight.set(lane, Vec3::<R>::ONE);
            }
            let outside = (surfaces.inverted[lane] != 0) != group.front[k];
            let sphere = if outside { from.hits.primitive[lane] } else { NO_PRIMITIVE };
            departures.set(
                lane,
                Departure { origin: group.origin.at(k), error: group.error[k], sphere, light: NO_PRIMITIVE },
            );
        }
    }
}
