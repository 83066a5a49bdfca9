//! Instruction sets: what kernels are compiled for, and what this machine has of it.

use std::fmt;

use crate::error::Error;

/// Instructions that a kernel may be compiled for. They change the time, and no bit of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// Those that every machine of the target has.
    Baseline,
    /// AVX2 of x86-64.
    Avx2,
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
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Baseline => baseline(),
            Self::Avx2 => "avx2",
        })
    }
}

impl Isa {
    /// Those that this machine has, the least first.
    pub fn available() -> impl Iterator<Item = Self> {
        [Self::Baseline, Self::Avx2].into_iter().filter(|isa| *isa == Self::Baseline || has_avx2())
    }

    /// What this machine has of what is chosen.
    ///
    /// # Errors
    /// This machine does not have it.
    pub fn select(choice: IsaChoice) -> Result<Self, Error> {
        match choice {
            IsaChoice::Auto | IsaChoice::Avx2 if has_avx2() => Ok(Self::Avx2),
            IsaChoice::Auto | IsaChoice::Baseline => Ok(Self::Baseline),
            IsaChoice::Avx2 => Err(Error::usage("this machine has no AVX2", "use --isa auto")),
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
}

#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn has_avx2() -> bool {
    false
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
