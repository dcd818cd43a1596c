//! The instruction sets for which kernels are compiled.
//!
//! Every set that `pulp` knows of this family of processors, the best of which is chosen where the program runs. With the feature
//! `this-machine` it is that of the machine that compiles alone, in a third of the time; its kernels are the same, bit by bit.

#[cfg(not(any(instructions = "v3", instructions = "v4")))]
mod chosen {
    pub use pulp::Arch;

    /// Whether kernels can run on this machine: those of any can.
    pub fn runs_here() -> bool {
        true
    }
}

#[cfg(any(instructions = "v3", instructions = "v4"))]
mod chosen {
    #[cfg(instructions = "v3")]
    use pulp::x86::V3 as Best;
    #[cfg(instructions = "v4")]
    use pulp::x86::V4 as Best;
    use pulp::{Simd, WithSimd};

    /// The instruction set of the machine that compiled.
    #[derive(Clone, Copy, Debug)]
    pub struct Arch(Best);

    impl Arch {
        /// The proof that this machine has it.
        ///
        /// # Panics
        /// If it has not: ask [`runs_here`] first.
        #[expect(clippy::new_without_default, reason = "as that of `pulp`, whose place it takes")]
        pub fn new() -> Self {
            Arch(Best::try_new().expect("the program asks at its start whether kernels run here"))
        }

        /// Runs `kernel` with these instructions.
        #[inline(always)]
        pub fn dispatch<K: WithSimd>(self, kernel: K) -> K::Output {
            // The set has a method of this name too.
            Simd::vectorize(self.0, kernel)
        }
    }

    /// Whether kernels can run on this machine: only on one like that which compiled them.
    pub fn runs_here() -> bool {
        Best::is_available()
    }
}

pub use chosen::{Arch, runs_here};
