//! Fields at points in packs, `[b][field][p]`. Block b = 0 holds values; b = 1, if there is one, derivatives.

use tensor::pulp::Simd;
use tensor::{LaneNumber, Pack};

/// Some consecutive fields of such an array.
#[derive(Clone, Copy)]
pub(crate) struct Fields {
    /// Packs of a block.
    block: usize,
    points: usize,
    /// The first field.
    first: usize,
}

impl Fields {
    /// All of `count` fields at `points` points.
    #[inline(always)]
    pub(crate) fn new(count: usize, points: usize) -> Self {
        Fields { block: count * points, points, first: 0 }
    }

    /// The fields from number `first` on.
    #[inline(always)]
    pub(crate) fn from(self, first: usize) -> Self {
        Fields { first: self.first + first, ..self }
    }

    #[inline(always)]
    fn index(self, field: usize, p: usize) -> usize {
        (self.first + field) * self.points + p
    }

    /// One field at a point.
    #[inline(always)]
    pub(crate) fn one<G: LaneNumber<S>, S: Simd>(self, simd: S, array: &[Pack], p: usize, part: usize) -> G {
        G::load(simd, array, self.block, self.index(0, p), part)
    }

    /// C fields at a point.
    #[inline(always)]
    pub(crate) fn vector<const C: usize, G: LaneNumber<S>, S: Simd>(
        self,
        simd: S,
        array: &[Pack],
        p: usize,
        part: usize,
    ) -> [G; C] {
        let mut vector = [self.one(simd, array, p, part); C];
        for c in 1..C {
            vector[c] = G::load(simd, array, self.block, self.index(c, p), part);
        }
        vector
    }

    /// D x D fields at a point, `[direction][d]`.
    #[inline(always)]
    pub(crate) fn rows<const D: usize, G: LaneNumber<S>, S: Simd>(
        self,
        simd: S,
        array: &[Pack],
        p: usize,
        part: usize,
    ) -> [[G; D]; D] {
        let mut rows = [self.vector::<D, G, S>(simd, array, p, part); D];
        for j in 1..D {
            rows[j] = self.from(j * D).vector(simd, array, p, part);
        }
        rows
    }

    /// Writes a field at a point.
    #[inline(always)]
    pub(crate) fn store<G: LaneNumber<S>, S: Simd>(
        self,
        field: usize,
        value: G,
        array: &mut [Pack],
        p: usize,
        part: usize,
    ) {
        value.store(array, self.block, self.index(field, p), part);
    }
}
