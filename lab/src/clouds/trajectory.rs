//! The blocks of `gt.log` and `gt.info` (Redwood's format): a line `i j n`, then an N×N matrix row by row.

use std::fmt::Write;

use nalgebra::SMatrix;

use crate::files::{corrupt, read};
use crate::prelude::*;
use sim3align_formats::text::{number, quoted, words};

/// A matrix about two fragments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block<const N: usize> {
    /// i, the target.
    pub target: u32,
    /// j, the source.
    pub source: u32,
    /// Number of fragments of the scene.
    pub fragments: u32,
    /// The pose that maps j into i (4×4), or its information (6×6).
    pub matrix: SMatrix<f64, N, N>,
}

/// Reads all blocks of a file.
///
/// # Errors
/// [`InvalidArgument`](sim3align_runtime::error::ErrorCode::InvalidArgument) if a file cannot be read,
/// [`CorruptFile`](sim3align_runtime::error::ErrorCode::CorruptFile) for one that holds anything but whole blocks.
pub fn read_blocks<const N: usize>(path: &Path) -> Result<Vec<Block<N>>> {
    let bytes = read(path)?;
    let mut numbers = words(&bytes).map(|word| {
        let finite = number(word).filter(|x| x.is_finite());
        finite.ok_or_else(|| corrupt(path, quoted(word), "finite numbers"))
    });
    let mut blocks = Vec::new();
    while let Some(first) = numbers.next() {
        let cut = || corrupt(path, format!("block {} cut short", blocks.len()), format!("i j n and {N}×{N} numbers"));
        let index = |x: f64| {
            let whole = (0.0..=f64::from(u32::MAX)).contains(&x) && x == x.trunc();
            if whole { Ok(x as u32) } else { Err(corrupt(path, format!("{x} as a fragment"), "whole numbers from 0")) }
        };
        let target = index(first?)?;
        let source = index(numbers.next().ok_or_else(cut)??)?;
        let fragments = index(numbers.next().ok_or_else(cut)??)?;
        let mut matrix = SMatrix::zeros();
        for (row, column) in (0..N).flat_map(|row| (0..N).map(move |column| (row, column))) {
            matrix[(row, column)] = numbers.next().ok_or_else(cut)??;
        }
        blocks.push(Block { target, source, fragments, matrix });
    }
    Ok(blocks)
}

/// The blocks as text.
pub fn text<const N: usize>(blocks: &[Block<N>]) -> String {
    let mut out = String::new();
    for block in blocks {
        let _ = writeln!(out, "{}\t{}\t{}", block.target, block.source, block.fragments);
        for row in block.matrix.row_iter() {
            let numbers: Vec<String> = row.iter().map(|x| format!("{x:.12e}")).collect();
            let _ = writeln!(out, "{}", numbers.join("\t"));
        }
    }
    out
}
