//! Vectors of eight floats or four doubles: the only module that depends on instruction sets, and the only one with `unsafe`.
//!
//! An algorithm is written once, generic over [`Lanes`], as a [`Kernel`]. [`Simd::run`] compiles it for AVX2 with FMA and
//! portably, and picks by the processor's features. Both give the same bits: every operation used is correctly rounded by
//! IEEE 754, fused multiply-add included (the C library computes it if the processor lacks it), and Rust never contracts
//! or reorders floating point.

/// Instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Simd {
    /// The target's baseline.
    Portable,
    /// AVX2, FMA and bit counting. A value proves that the processor has them, because only [`Simd::detect`] creates one.
    #[cfg(target_arch = "x86_64")]
    Avx2(Detected),
}

/// Proof of detection, which only this module can create.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Detected(());

/// Four doubles.
pub(crate) trait Doubles: Copy {
    /// The same value in every lane.
    fn splat(value: f64) -> Self;
    /// Lane k from `values[k]`.
    fn load(values: &[f32; 4]) -> Self;
    /// Each lane rounded to single precision.
    fn store(self, values: &mut [f32; 4]);
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self − other`.
    fn sub(self, other: Self) -> Self;
    /// `self · other`.
    fn mul(self, other: Self) -> Self;
    /// `self` where `signs` is positive, `−self` where it is negative.
    fn flip(self, signs: Self) -> Self;
    /// `self` where `test` is not zero, else `other`.
    fn unless_zero(self, test: Self, other: Self) -> Self;
}

/// Eight floats.
pub(crate) trait Lanes: Copy {
    /// Half as many doubles.
    type Doubles: Doubles;
    /// The same value in every lane.
    fn splat(value: f32) -> Self;
    /// Lane k from `values[k]`.
    fn load(values: &[f32; 8]) -> Self;
    /// The lanes in order.
    fn to_array(self) -> [f32; 8];
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self − other`.
    fn sub(self, other: Self) -> Self;
    /// `self · other`.
    fn mul(self, other: Self) -> Self;
    /// `self · factor + term`, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// The smaller; neither may be NaN.
    fn min(self, other: Self) -> Self;
    /// The larger; neither may be NaN.
    fn max(self, other: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Bitwise or: the sign bit of a lane is set where either is.
    fn or(self, other: Self) -> Self;
    /// Bit k is the sign bit of lane k.
    fn signs(self) -> u32;
}

/// An algorithm to be compiled for each instruction set.
pub(crate) trait Kernel {
    /// Result of the algorithm.
    type Output;
    /// Runs the algorithm. Implementations and everything they call must be `#[inline(always)]`; otherwise the inner loops are
    /// not compiled for the instruction set.
    fn run<L: Lanes>(self) -> Self::Output;
}

impl Simd {
    /// Returns the best instruction set of this processor.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            if has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt") {
                return Self::Avx2(Detected(()));
            }
        }
        Self::Portable
    }

    /// Runs a kernel with these instructions.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Portable => kernel.run::<PortableLanes>(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the variant exists only if every feature of `run_avx2` was detected.
            #[allow(unsafe_code)]
            Self::Avx2(_) => unsafe { x86::run_avx2(kernel) },
        }
    }
}

/// Eight floats in portable code.
#[derive(Clone, Copy)]
pub(crate) struct PortableLanes([f32; 8]);

impl PortableLanes {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }
}

/// Four doubles in portable code.
#[derive(Clone, Copy)]
pub(crate) struct PortableDoubles([f64; 4]);

impl PortableDoubles {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }
}

impl Doubles for PortableDoubles {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn load(values: &[f32; 4]) -> Self {
        Self(values.map(f64::from))
    }

    #[inline(always)]
    fn store(self, values: &mut [f32; 4]) {
        *values = self.0.map(|v| v as f32);
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn flip(self, signs: Self) -> Self {
        self.zip(signs, |a, s| if s.is_sign_negative() { -a } else { a })
    }

    #[inline(always)]
    fn unless_zero(self, test: Self, other: Self) -> Self {
        Self(std::array::from_fn(|k| if test.0[k] == 0.0 { other.0[k] } else { self.0[k] }))
    }
}

impl Lanes for PortableLanes {
    type Doubles = PortableDoubles;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([value; 8])
    }

    #[inline(always)]
    fn load(values: &[f32; 8]) -> Self {
        Self(*values)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        self.0
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].mul_add(factor.0[k], term.0[k])))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self.zip(other, |a, b| f32::from_bits(a.to_bits() | b.to_bits()))
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        self.0.iter().enumerate().fold(0, |bits, (k, v)| bits | v.to_bits() >> 31 << k)
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
mod x86 {
    //! AVX2 and FMA.

    use std::arch::x86_64::*;

    use super::{Doubles, Kernel, Lanes};

    /// Runs a kernel, with everything it inlines, compiled for AVX2 and FMA.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2Lanes>()
    }

    /// Eight floats in one register. Only kernels under [`run_avx2`] use it.
    #[derive(Clone, Copy)]
    struct Avx2Lanes(__m256);

    /// Four doubles in one register. Used like [`Avx2Lanes`].
    #[derive(Clone, Copy)]
    pub(super) struct Avx2Doubles(__m256d);

    // SAFETY: as for `Avx2Lanes` below, with arrays of exactly four floats.
    impl Doubles for Avx2Doubles {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(value) })
        }

        #[inline(always)]
        fn load(values: &[f32; 4]) -> Self {
            Self(unsafe { _mm256_cvtps_pd(_mm_loadu_ps(values.as_ptr())) })
        }

        #[inline(always)]
        fn store(self, values: &mut [f32; 4]) {
            unsafe { _mm_storeu_ps(values.as_mut_ptr(), _mm256_cvtpd_ps(self.0)) }
        }

        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Self(unsafe { _mm256_add_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            Self(unsafe { _mm256_sub_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(unsafe { _mm256_mul_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn flip(self, signs: Self) -> Self {
            Self(unsafe { _mm256_xor_pd(self.0, _mm256_and_pd(signs.0, _mm256_set1_pd(-0.0))) })
        }

        #[inline(always)]
        fn unless_zero(self, test: Self, other: Self) -> Self {
            Self(unsafe {
                let is_zero = _mm256_cmp_pd::<_CMP_EQ_OQ>(test.0, _mm256_setzero_pd());
                _mm256_blendv_pd(self.0, other.0, is_zero)
            })
        }
    }

    // SAFETY, for every block below: the type is private and only reaches kernels under `run_avx2`, which runs only if AVX2
    // and FMA were detected; loads and stores are unaligned forms over arrays of exactly eight floats.
    impl Lanes for Avx2Lanes {
        type Doubles = Avx2Doubles;

        #[inline(always)]
        fn splat(value: f32) -> Self {
            Self(unsafe { _mm256_set1_ps(value) })
        }

        #[inline(always)]
        fn load(values: &[f32; 8]) -> Self {
            Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
        }

        #[inline(always)]
        fn to_array(self) -> [f32; 8] {
            let mut values = [0.0; 8];
            unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) };
            values
        }

        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Self(unsafe { _mm256_add_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            Self(unsafe { _mm256_sub_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(unsafe { _mm256_mul_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn mul_add(self, factor: Self, term: Self) -> Self {
            Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, term.0) })
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }

        #[inline(always)]
        fn or(self, other: Self) -> Self {
            Self(unsafe { _mm256_or_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn signs(self) -> u32 {
            unsafe { _mm256_movemask_ps(self.0) as u32 }
        }
    }
}
