//! The instruction sets for which kernels are compiled.
//!
//! `pulp` supports several instruction sets of a processor family; the program chooses the best one at run time. With the feature
//! `this-machine` only the set of the compiling machine is compiled, in a third of the time. Its kernels are the same, bit by
//! bit.

#[cfg(not(any(instructions = "v3", instructions = "v4")))]
mod chosen {
    pub use pulp::Arch;

    /// Whether the kernels can run on this machine: always, since each instruction set is compiled.
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

    /// The instruction set of the compiling machine.
    #[derive(Clone, Copy, Debug)]
    pub struct Arch(Best);

    impl Arch {
        /// The proof that this machine has the instruction set.
        ///
        /// # Panics
        /// If it lacks the set: call [`runs_here`] first.
        #[expect(clippy::new_without_default, reason = "as that of `pulp`, whose place it takes")]
        pub fn new() -> Self {
            Arch(Best::try_new().expect("the program asks at its start whether kernels run here"))
        }

        /// Runs `kernel` with these instructions.
        #[inline(always)]
        pub fn dispatch<K: WithSimd>(self, kernel: K) -> K::Output {
            // The set has a method of the same name.
            Simd::vectorize(self.0, kernel)
        }
    }

    /// Whether the kernels can run on this machine: only if it has the instruction set of the compiling machine.
    pub fn runs_here() -> bool {
        Best::is_available()
    }
}

pub use chosen::{Arch, runs_here};
