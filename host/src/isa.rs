//! Instruction sets: what kernels are compiled for, and what this machine has of it.

use std::fmt;
use std::marker::PhantomData;

use ocellus_kernel::{Accuracy, EffectSet, Effects};

use crate::error::Error;

/// How far apart what is fetched lies, in bytes: two cache lines, since processors fetch a line's neighbour with it.
#[cfg(target_arch = "x86_64")]
const FETCHED_APART: usize = 128;

/// Instructions that a kernel may be compiled for. They change the time, and no bit of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// Those that every machine of the target has.
    Baseline,
    /// AVX2 of x86-64.
    Avx2,
    /// AVX-512 of x86-64, as processors have had it since 2017: F, BW, DQ and VL.
    Avx512,
}

/// Which instructions a render may use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum IsaChoice {
    /// The most that this machine has.
    #[default]
    Auto,
    /// Those that every machine of the target has.
    Baseline,
    /// AVX2 of x86-64.
    Avx2,
    /// AVX-512 of x86-64.
    Avx512,
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Baseline => baseline(),
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        })
    }
}

impl Isa {
    /// Those that this machine has, the least first.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        [Self::Baseline, Self::Avx2, Self::Avx512].into_iter().filter(|isa| match isa {
            Self::Baseline => true,
            Self::Avx2 => has_avx2(),
            Self::Avx512 => has_avx512(),
        })
    }

    /// What this machine has of what is chosen.
    ///
    /// # Errors
    /// This machine does not have it.
    pub fn select(choice: IsaChoice) -> Result<Self, Error> {
        let wanted = match choice {
            IsaChoice::Auto => return Ok(Self::available().next_back().unwrap_or(Self::Baseline)),
            IsaChoice::Baseline => Self::Baseline,
            IsaChoice::Avx2 => Self::Avx2,
            IsaChoice::Avx512 => Self::Avx512,
        };
        let has = Self::available().any(|isa| isa == wanted);
        has.then_some(wanted).ok_or_else(|| Error::usage(format!("this machine has no {wanted}"), "use --isa auto"))
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
}

#[cfg(target_arch = "x86_64")]
pub(crate) fn has_avx512() -> bool {
    use std::arch::is_x86_feature_detected as has;
    has_avx2() && has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl")
}

#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn has_avx2() -> bool {
    false
}

#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn has_avx512() -> bool {
    false
}

/// What kernels for this machine do, with its instruction for fetching what is about to be read.
#[derive(Clone, Copy, Debug)]
pub struct Prefetching<E>(PhantomData<E>);

impl<E: EffectSet> EffectSet for Prefetching<E> {
    const EFFECTS: Effects = E::EFFECTS;
    const ACCURACY: Accuracy = E::ACCURACY;

    #[inline(always)]
    fn prefetch<T>(soon: &T) {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            let start = std::ptr::from_ref(soon).cast::<i8>();
            for line in (0..size_of::<T>()).step_by(FETCHED_APART) {
                // SAFETY: the address is one of the value's; and the instruction reads nothing, whatever it is.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(line)) };
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = soon;
    }
}

/// What all of this program was compiled for.
const fn baseline() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "avx512"
    } else if cfg!(target_feature = "avx2") {
        "avx2"
    } else if cfg!(target_feature = "sse2") {
        "sse2"
    } else if cfg!(target_feature = "neon") {
        "neon"
    } else {
        "scalar"
    }
}
