//! Where the paths of all lanes go on.

use super::columns::{Column, LANES, Vectors};
use super::departures::{Arrivals, Departures};
use super::glass;
use crate::aim;
use crate::effects::{EffectSet, Effects};
use crate::material::{BsdfSample, Scattering, dielectric, diffuse, mirror};
use crate::path::PathOptions;
use crate::real::{Real, Vector};

/// What a lane's surface does to light.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum Kind {
    /// Nothing: the path ends.
    Ends,
    Diffuse,
    Mirror,
    Glass,
}

impl Kind {
    /// In a kernel of some effects.
    #[inline(always)]
    pub(super) fn of<R: Real, E: EffectSet>(scattering: &Scattering<R>) -> Self {
        match scattering {
            Scattering::Mirror(_) if const { E::EFFECTS.contains(Effects::MIRROR) } => Self::Mirror,
            Scattering::Dielectric(_) if const { E::EFFECTS.contains(Effects::GLASS) } => Self::Glass,
            Scattering::Diffuse(_) => Self::Diffuse,
            _ => Self::Ends,
        }
    }
}

/// A sampled direction of each lane: see [`BsdfSample`].
pub(super) struct Directions<R: Real> {
    pub(super) wi: Vectors<R>,
    pub(super) weight: Vectors<R>,
    /// Whether there is one.
    pub(super) found: Column<bool>,
}

impl<R: Real> Directions<R> {
    pub(super) fn none() -> Self {
        Self { wi: Vectors::ZERO, weight: Vectors::ZERO, found: [false; LANES] }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, sample: Option<BsdfSample<R>>) {
        self.found[lane] = sample.is_some();
        if let Some(sample) = sample {
            self.wi.set(lane, sample.wi);
            self.weight.set(lane, sample.weight);
        }
    }

    /// Off diffuse surfaces.
    #[inline(always)]
    pub(super) fn diffuse<E: EffectSet>(
        &mut self,
        options: &PathOptions,
        from: &Arrivals<'_, R>,
        kinds: &Column<Kind>,
        albedos: &Vectors<R>,
        numbers: &[Column<u32>; 4],
    ) {
        let surfaces = from.surfaces;
        if const { E::EFFECTS.contains(Effects::AIM) } && options.aim {
            for lane in 0..LANES {
                if kinds[lane] == Kind::Diffuse {
                    let four = core::array::from_fn(|k| numbers[k][lane]);
                    let (point, facing) = (surfaces.point(lane), surfaces.facing(lane));
                    self.set(lane, aim::sample(from.few.scene.aims(), &point, &facing, albedos.at(lane), four));
                }
            }
            return;
        }
        for lane in 0..LANES {
            let [u, v] = [numbers[0][lane], numbers[1][lane]].map(R::from_unit_bits);
            let facing = surfaces.facing(lane);
            let wi = diffuse::direction(&facing, u, v);
            self.wi.set(lane, wi);
            self.found[lane] = facing.ng.dot(wi) > R::ZERO;
        }
        self.weight = *albedos;
    }

    /// Off mirrors, and glass where it is not done in groups ([`super::glass`]), and where they leave from.
    #[inline(always)]
    pub(super) fn one_by_one<E: EffectSet>(
        &mut self,
        options: &PathOptions,
        from: &Arrivals<'_, R>,
        kinds: &Column<Kind>,
        numbers: &[Column<u32>; 4],
        departures: &mut Departures<R>,
    ) {
        for lane in 0..LANES {
            if !(kinds[lane] == Kind::Mirror || kinds[lane] == Kind::Glass && !glass::in_groups::<E>()) {
                continue;
            }
            let (point, facing) = (from.surfaces.point(lane), from.surfaces.facing(lane));
            match &from.few.scene.materials()[point.material as usize].scattering {
                Scattering::Mirror(glossy) => self.set(lane, Some(mirror::sample(point.wo, &facing, glossy))),
                Scattering::Dielectric(glass) => {
                    let sample = dielectric::sample(&point, &facing, glass, options.fresnel, numbers[2][lane]);
                    departures.scatter::<E>(lane, from, sample.wi);
                    self.set(lane, Some(sample));
                }
                Scattering::Diffuse(_) => {}
            }
        }
    }
}
