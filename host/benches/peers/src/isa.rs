//! Instruction sets, and loops over rays compiled for each of them.
#![allow(unsafe_code, reason = "a machine's instructions are known at run time only")]

use std::fmt;

/// Instructions that a loop over rays is compiled for, as `ocellus::isa` has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Isa {
    /// Those of every x86-64; Embree's least is SSE4.2.
    Baseline,
    /// AVX2.
    Avx2,
    /// AVX-512 with its extensions for short vectors.
    Avx512,
}

/// A loop over rays.
pub(crate) trait Work {
    /// Does it. To be `#[inline(always)]`, and so all that it calls as far as instructions matter: what is not inlined
    /// is compiled for the baseline. `ISA` only makes each instruction set's copy a function of its own.
    fn run<const ISA: u8>(self);
}

impl Isa {
    /// All of them, the least first.
    pub(crate) const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// Those that this machine has.
    pub(crate) fn available() -> impl DoubleEndedIterator<Item = Self> {
        Self::ALL.into_iter().filter(|isa| isa.is_available())
    }

    /// The most that this machine has.
    pub(crate) fn best() -> Self {
        Self::available().next_back().unwrap_or(Self::Baseline)
    }

    #[cfg(target_arch = "x86_64")]
    fn is_available(self) -> bool {
        let avx2 = std::arch::is_x86_feature_detected!("avx2");
        match self {
            Self::Baseline => true,
            Self::Avx2 => avx2,
            Self::Avx512 => {
                avx2 && std::arch::is_x86_feature_detected!("avx512f")
                    && std::arch::is_x86_feature_detected!("avx512bw")
                    && std::arch::is_x86_feature_detected!("avx512dq")
                    && std::arch::is_x86_feature_detected!("avx512vl")
            }
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_available(self) -> bool {
        self == Self::Baseline
    }

    /// Does `work` with these instructions, or with the baseline's where this machine does not have them.
    pub(crate) fn run(self, work: impl Work) {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx2")]
            fn with_avx2(work: impl Work) {
                work.run::<{ Isa::Avx2 as u8 }>();
            }

            #[target_feature(enable = "avx2,avx512f,avx512bw,avx512dq,avx512vl")]
            fn with_avx512(work: impl Work) {
                work.run::<{ Isa::Avx512 as u8 }>();
            }

            if self != Self::Baseline && self.is_available() {
                // SAFETY: the machine has what the function was compiled for.
                return unsafe { if self == Self::Avx512 { with_avx512(work) } else { with_avx2(work) } };
            }
        }
        work.run::<{ Isa::Baseline as u8 }>();
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Baseline => "sse",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        })
    }
}
