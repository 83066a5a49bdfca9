//! How much light a smooth dielectric reflects.

use crate::real::Real;

/// How dielectrics share light between reflection and refraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fresnel {
    /// Refract wherever refraction is possible.
    None,
    /// Schlick's polynomial (1994), with the cosine on the thin side: it never exceeds 1 and is continuous where
    /// total reflection begins.
    Schlick,
    /// The Fresnel equations for unpolarised light.
    #[default]
    Exact,
}

/// Both sides of one refraction, with `sin_t < 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface<R: Real> {
    /// Cosine on the side that light comes from, 0..=1.
    pub cos_i: R,
    /// Cosine on the side that light goes to, 0..=1.
    pub cos_t: R,
    /// Index of refraction on the side that light comes from.
    pub ior_i: R,
    /// Index of refraction on the side that light goes to.
    pub ior_t: R,
}

/// The reflected fraction, 0..=1.
#[inline(always)]
pub fn reflectance<R: Real>(model: Fresnel, at: &Interface<R>) -> R {
    match model {
        Fresnel::None => R::ZERO,
        Fresnel::Schlick => schlick(at),
        Fresnel::Exact => exact(at),
    }
}

#[inline(always)]
fn schlick<R: Real>(at: &Interface<R>) -> R {
    let ratio = (at.ior_i - at.ior_t) / (at.ior_i + at.ior_t);
    let normal = ratio * ratio;
    let cosine = if at.ior_i > at.ior_t { at.cos_t } else { at.cos_i };
    let c = R::ONE - cosine;
    let square = c * c;
    normal + (R::ONE - normal) * square * square * c
}

#[inline(always)]
fn exact<R: Real>(at: &Interface<R>) -> R {
    if at.ior_i == at.ior_t {
        return R::ZERO;
    }
    let (s_i, s_t) = (at.ior_i * at.cos_i, at.ior_t * at.cos_t);
    let (p_i, p_t) = (at.ior_t * at.cos_i, at.ior_i * at.cos_t);
    let (s, p) = ((s_i - s_t) / (s_i + s_t), (p_i - p_t) / (p_i + p_t));
    (s * s + p * p) * R::from_f64(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interface(ior_i: f64, ior_t: f64, cos_i: f64) -> Interface<f64> {
        let sin_t = ior_i / ior_t * (1.0 - cos_i * cos_i).sqrt();
        Interface { cos_i, cos_t: (1.0 - sin_t * sin_t).max(0.0).sqrt(), ior_i, ior_t }
    }

    #[test]
    fn known_values() {
        // At normal incidence ((n - 1) / (n + 1))^2, either way round; at Brewster's angle only s remains.
        for (a, b) in [(1.0, 1.5), (1.5, 1.0)] {
            for model in [Fresnel::Schlick, Fresnel::Exact] {
                assert!((reflectance(model, &interface(a, b, 1.0)) - 0.04).abs() < 1e-15);
            }
        }
        let brewster = interface(1.0, 1.5, 1.0 / (1.0f64 + 2.25).sqrt());
        let s = (1.0f64 - 2.25) / (1.0 + 2.25);
        assert!((reflectance(Fresnel::Exact, &brewster) - 0.5 * s * s).abs() < 1e-15);
        assert_eq!(reflectance(Fresnel::Exact, &interface(1.5, 1.5, 0.0)), 0.0);
        assert_eq!(reflectance(Fresnel::None, &interface(1.0, 1.5, 0.1)), 0.0);
    }

    #[test]
    fn schlick_stays_near_the_exact_value_on_both_sides() {
        for (a, b) in [(1.0, 1.5), (1.5, 1.0)] {
            for i in 1..=100 {
                let at = interface(a, b, f64::from(i) / 100.0);
                if at.cos_t > 0.0 {
                    let error = reflectance(Fresnel::Schlick, &at) - reflectance(Fresnel::Exact, &at);
                    assert!(error.abs() < 0.05, "{at:?}: {error}");
                }
            }
        }
    }
}
