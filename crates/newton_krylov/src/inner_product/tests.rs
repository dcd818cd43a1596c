use super::*;
use crate::test_problems::{bits, scattered, with_threads};

/// Longer than one chunk, and a multiple neither of a chunk nor of a pack.
const LENGTH: usize = 100_003;

#[test]
fn sums_of_small_integers_are_exact() {
    let x: Vec<f64> = (0..LENGTH).map(|i| (i % 7) as f64).collect();
    let w: Vec<f64> = (0..LENGTH).map(|i| (i % 3) as f64).collect();
    let squares: u64 = (0..LENGTH as u64).map(|i| (i % 7).pow(2)).sum();
    let weighted: u64 = (0..LENGTH as u64).map(|i| (i % 3) * (i % 7).pow(2)).sum();
    let within: u64 = (5_000..70_001_u64).map(|i| (i % 7).pow(2)).sum();
    assert_eq!(Euclidean.dot(&x, &x), squares as f64);
    assert_eq!(Euclidean.dot_on(5_000..70_001, &x, &x), within as f64);
    assert_eq!(Weighted::new(w.clone()).dot(&x, &x), weighted as f64);
    let (columns, mut products) = (vec![x.clone(), w.clone(), x.clone()], vec![0.0; 3]);
    let norm = dots(&Weighted::new(w), &columns, &x, &mut Vec::new(), &mut products);
    let cubes: u64 = (0..LENGTH as u64).map(|i| (i % 3).pow(2) * (i % 7)).sum();
    assert_eq!((products, norm), (vec![weighted as f64, cubes as f64, weighted as f64], (weighted as f64).sqrt()));
}

#[test]
fn padding_of_weight_zero_does_not_count() {
    let inner_product = Weighted::new(vec![1.0, 0.0, 2.0]);
    assert_eq!(inner_product.dot(&[1.0, 5.0, 3.0], &[2.0, 7.0, 1.0]), 8.0);
    assert_eq!(inner_product.norm(&[0.0, 5.0, 0.0]), 0.0);
}

#[test]
fn a_sum_is_as_accurate_as_its_tree_is_deep() {
    let tenths = vec![0.1; 1 << 22];
    let ones = vec![1.0; 1 << 22];
    let exact = 0.1 * (1 << 22) as f64;
    assert!((Euclidean.dot(&tenths, &ones) - exact).abs() <= 1e-13 * exact);
}

#[test]
fn many_products_at_once_are_those_one_by_one_bit_by_bit() {
    let of = |length: usize, count: u8| {
        let x = scattered(length);
        let column = |j| x.iter().map(|x_i| (f64::from(j) * x_i).sin()).collect();
        let columns: Vec<Vec<f64>> = (1..=count).map(column).collect();
        (x, columns)
    };
    for (length, count) in [(1, 5), (7, 3), (CHUNK, 0), (CHUNK + 1, 4), (3 * CHUNK, 8), (LENGTH, 6)] {
        let (x, columns) = of(length, count);
        let mut products = vec![f64::NAN; columns.len()];
        dots(&Euclidean, &columns, &x, &mut Vec::new(), &mut products);
        let single: Vec<f64> = columns.iter().map(|column| Euclidean.dot(column, &x)).collect();
        assert_eq!(bits(&products), bits(&single), "{length}");
        let weighted = Weighted::new(x.iter().map(|x_i| x_i.abs()).collect());
        let norm = dots(&weighted, &columns, &x, &mut Vec::new(), &mut products);
        let single: Vec<f64> = columns.iter().map(|column| weighted.dot(column, &x)).collect();
        assert_eq!(bits(&products), bits(&single), "{length}");
        assert_eq!(norm.to_bits(), weighted.norm(&x).to_bits(), "{length}");
        let (mut together, mut apart) = (x.clone(), x.clone());
        let norm = add_combination_and_norm(&weighted, &products, &columns, &mut together, &mut Vec::new());
        add_combination(&products, &columns, &mut apart);
        assert_eq!(bits(&together), bits(&apart), "{length}");
        assert_eq!(norm.to_bits(), weighted.norm(&apart).to_bits(), "{length}");
    }
}

#[test]
fn every_operation_has_the_same_bits_on_one_two_and_three_threads() {
    let x = scattered(LENGTH);
    let run = || {
        let columns = vec![x.clone(), x.iter().map(|x_i| x_i.sin()).collect()];
        let mut y = x.iter().map(|x_i| x_i.cos()).collect::<Vec<_>>();
        axpy(0.3, &x, &mut y);
        xpay(&x, -0.7, &mut y);
        scale(1.1, &mut y);
        add_combination(&[0.2, 1.0 / 3.0], &columns, &mut y);
        let weighted = Weighted::new(x.iter().map(|x_i| x_i.abs()).collect());
        let mut numbers = vec![0.0; 2];
        let norm = dots(&weighted, &columns, &y, &mut Vec::new(), &mut numbers);
        numbers.push(norm);
        numbers.push(add_combination_and_norm(&weighted, &[0.1, 0.7], &columns, &mut y, &mut Vec::new()));
        numbers.extend([Euclidean.dot(&x, &y), weighted.norm(&y)]);
        (bits(&y), bits(&numbers))
    };
    let one = with_threads(1, run);
    assert_eq!(one, with_threads(2, run));
    assert_eq!(one, with_threads(3, run));
}

#[test]
fn updates_are_those_of_their_names() {
    let x: Vec<f64> = (0..LENGTH).map(|i| i as f64).collect();
    let y = vec![2.0; LENGTH];
    let after = |rule: &dyn Fn(&mut [f64])| {
        let mut y = y.clone();
        rule(&mut y);
        (y[1], y[LENGTH - 1])
    };
    let last = (LENGTH - 1) as f64;
    assert_eq!(after(&|y| axpy(3.0, &x, y)), (5.0, 2.0 + 3.0 * last));
    assert_eq!(after(&|y| xpay(&x, 3.0, y)), (7.0, last + 6.0));
    assert_eq!(after(&|y| copy(&x, y)), (1.0, last));
    assert_eq!(after(&|y| scale(3.0, y)), (6.0, 6.0));
    assert_eq!(after(&|y| add_combination(&[1.0, 2.0], &[x.clone(), x.clone()], y)), (5.0, 2.0 + 3.0 * last));
}

#[test]
fn the_largest_and_the_smallest_value_are_found_wherever_they_are() {
    for position in [0, 1, LENGTH / 2, LENGTH - 1] {
        let mut x = scattered(LENGTH);
        x[position] = -3.0;
        assert_eq!((smallest(x.iter().copied()), largest_size(&x, &Sums::alone())), (-3.0, 3.0), "{position}");
        x[position] = 4.0;
        assert_eq!((largest(x.iter().copied()), largest_size(&x, &Sums::alone())), (4.0, 4.0), "{position}");
    }
    assert_eq!((largest([]), smallest([]), largest_size(&[], &Sums::alone())), (f64::NEG_INFINITY, f64::INFINITY, 0.0));
    assert_eq!((largest([1.0, f64::NAN]), smallest([f64::NAN, 1.0])), (1.0, 1.0));
}

#[test]
fn the_largest_size_is_that_of_all_ranks() {
    let of_rank = |ranks: Arc<dyn ranks::Communicator>| {
        let x = [0.5, -1.0 - ranks.rank() as f64];
        largest_size(&x, &Sums::new(ranks, 3))
    };
    assert_eq!(ranks::Threads::run(3, of_rank), [3.0; 3]);
}

#[test]
fn values_are_combined_in_their_order() {
    assert_eq!(reduce(["a", "b", "c"].map(str::to_owned), |all, next| all + &next).as_deref(), Some("abc"));
    assert_eq!(reduce(Vec::<u8>::new(), u8::max), None);
}

#[test]
fn a_sum_is_a_tree_of_chunks_and_of_blocks() {
    let x = scattered(3 * CHUNK);
    let of_chunk = |chunk: usize| x[chunk * CHUNK..(chunk + 1) * CHUNK].iter().sum::<f64>();
    assert_eq!(sum(&x), of_chunk(0) + (of_chunk(1) + of_chunk(2)));
    // Two entries for each cell of two blocks.
    let (x, sums) = ([0.1, 1e16, -1e16, 0.2, 0.3, 0.4], Sums::new(Arc::new(ranks::Alone), 2));
    assert_eq!(sum_over_blocks(&x, &[0, 1, 3], &sums), sum(&x[..2]) + sum(&x[2..]));
}
