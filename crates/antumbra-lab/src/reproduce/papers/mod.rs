//! One file per paper. A new table, figure or row is one entry in its paper's file.

mod lauritzen_2008;
mod marrs_2014;
mod selgrad_2014;
mod shen_2013;
mod sintorn_2008;

use super::exhibit::Paper;

/// `pcss` as the papers know it: one layer of blockers, with one mean depth.
const SKETCHED_PCSS: &[(&str, &str)] = &[("attach_contacts", "false")];

/// All papers, by year.
pub const PAPERS: [Paper; 5] =
    [lauritzen_2008::PAPER, sintorn_2008::PAPER, shen_2013::PAPER, marrs_2014::PAPER, selgrad_2014::PAPER];
