//! Messages between the ranks that own the blocks.

use crate::ElasticityError;
use faer::Mat;
use ranks::Sums;
use std::sync::Arc;

/// The ranks that own the blocks.
pub(super) struct Exchange {
    sums: Arc<Sums>,
}

impl Exchange {
    pub(super) fn new(sums: Arc<Sums>) -> Self {
        Exchange { sums }
    }

    /// The first of the own blocks.
    pub(super) fn first_own(&self) -> usize {
        self.sums.own().start
    }

    /// Whether this rank owns a block.
    pub(super) fn owns(&self, block: usize) -> bool {
        self.sums.own().contains(&block)
    }

    /// The parts of all blocks on all ranks, from those of the own ones. Block b has `length(b)` numbers.
    pub(super) fn gather(&self, own: Vec<Vec<f64>>, length: impl Fn(usize) -> usize) -> Vec<Vec<f64>> {
        let communicator = self.sums.communicator();
        if communicator.size() == 1 {
            return own;
        }
        let of_rank = |blocks: &std::ops::Range<usize>| blocks.clone().map(&length).sum();
        let lengths: Vec<usize> = self.sums.blocks_of_rank().iter().map(of_rank).collect();
        let all = communicator.all_gather_known(&own.concat(), &lengths);
        let mut rest = &all[..];
        let split = |block| {
            let (part, behind) = rest.split_at(length(block));
            rest = behind;
            part.to_vec()
        };
        (0..self.sums.blocks()).map(split).collect()
    }

    /// This rank.
    pub(super) fn rank(&self) -> usize {
        self.sums.communicator().rank()
    }

    /// The rank that owns a block.
    pub(super) fn rank_of(&self, block: usize) -> usize {
        self.sums.blocks_of_rank().partition_point(|blocks| blocks.end <= block)
    }

    /// Sends `message(rank)` to all other ranks and receives `length(rank)` numbers from each; nothing where there are none.
    pub(super) fn between_ranks(
        &self,
        message: impl Fn(usize) -> Vec<f64>,
        length: impl Fn(usize) -> usize,
    ) -> Vec<(usize, Vec<f64>)> {
        let communicator = self.sums.communicator();
        let others = || (0..communicator.size()).filter(|&rank| rank != communicator.rank());
        let messages: Vec<(usize, Vec<f64>)> =
            others().map(|rank| (rank, message(rank))).filter(|(_, message)| !message.is_empty()).collect();
        let buffers = others().map(|rank| (rank, vec![0.0; length(rank)]));
        let mut received: Vec<(usize, Vec<f64>)> = buffers.filter(|(_, buffer)| !buffer.is_empty()).collect();
        let sends: Vec<(usize, &[f64])> = messages.iter().map(|(rank, message)| (*rank, &message[..])).collect();
        let mut receives: Vec<(usize, &mut [f64])> =
            received.iter_mut().map(|(rank, buffer)| (*rank, &mut buffer[..])).collect();
        communicator.exchange(&sends, &mut receives);
        received
    }

    /// Ok on all ranks, or the error of the first rank with one on all.
    pub(super) fn agree<T>(&self, own: Result<T, ElasticityError>) -> Result<T, ElasticityError> {
        let encode = |error: &ElasticityError| error.to_string().into_bytes();
        let decode = |bytes: &[u8]| ElasticityError::NotDefinite { cause: String::from_utf8_lossy(bytes).into_owned() };
        ranks::agree(&**self.sums.communicator(), own, encode, decode)
    }
}

/// The entries of a symmetric matrix on and below its diagonal, column by column.
pub(super) fn packed(matrix: &Mat<f64>) -> Vec<f64> {
    (0..matrix.ncols()).flat_map(|j| matrix.col_as_slice(j)[j..].iter().copied()).collect()
}

/// The symmetric matrix of `size` rows that is [`packed`].
pub(super) fn unpacked(entries: &[f64], size: usize) -> Mat<f64> {
    let mut matrix = Mat::zeros(size, size);
    let mut next = entries.iter();
    for j in 0..size {
        for i in j..size {
            let entry = *next.next().expect("a triangle of this size");
            matrix[(i, j)] = entry;
            matrix[(j, i)] = entry;
        }
    }
    matrix
}

/// The number of entries of a [`packed`] matrix.
pub(super) fn packed_length(size: usize) -> usize {
    size * (size + 1) / 2
}
