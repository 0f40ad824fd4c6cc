//! Report of a comparison as a folder: a page that opens from disk, the numbers as JSON, the images.
//!
//! [`Report`] is the content; [`write_report`] writes it. The page is one file including style and script (`page.html`,
//! `style.css`, `page.js` and `copy.js` here). Its images are beside it, and nothing is fetched from a network. [`write_index`]
//! writes the index page of several reports.

mod advice;
mod baseline;
mod files;
mod glossary;
mod html;
mod index;
mod json;
mod lines;
mod model;
mod motion;
mod page;
mod paths;
mod reproduced;
mod reproduced_plots;
mod resume;
mod scatter;
#[cfg(test)]
mod tests;

pub use advice::write_advice;
pub use files::{ReportWriter, write_report};
pub use index::write_index;
pub use model::{
    IndexEntry, IndexTechnique, Measurement, MotionInfo, Outcome, PassTime, Reference, ReferenceInfo, Report, Row,
    SceneInfo,
};
pub use paths::{METRICS_PATH, report_paths};
pub use reproduced::{ReproductionInfo, write_reproduction};

pub use resume::report_to_resume;

pub use crate::adapter_info::AdapterInfo;
pub use crate::date::utc_now;
