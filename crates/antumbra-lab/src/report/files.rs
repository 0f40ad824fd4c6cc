//! Writing of a report's files, all at once or incrementally.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::html::png_data_uri;
use super::json::metrics_json;
use super::model::{Measurement, Outcome, Report};
use super::page::page_html;
use super::paths::{
    JUDGED_PATH, METRICS_PATH, PAGE_PATH, REFERENCE_STEM, VALUES_PATH, error_path, motion_path, shaded_path,
    visibility_exr_path, visibility_path,
};
use crate::color_maps::signed_error_map;
use crate::image_io::{encode_png, write_png, write_visibility_exr};
use crate::output_files::{FileError, write_atomically};
use crate::picture::{Visibility, rgb_image};

/// Writes a report into the existing folder `dir`: `index.html`, `metrics.json`, `values.js` (visibility for the page's pixel readout) and
/// `images/`, with every visibility mask as PNG and as 32-bit float OpenEXR, the error maps, and the mask of judged pixels.
pub fn write_report(dir: &Path, report: &Report) -> Result<(), FileError> {
    ReportWriter::new(dir).finish(report)
}

/// Writer of a growing report. After each call, `metrics.json` is complete and the images that it names exist.
#[derive(Debug)]
pub struct ReportWriter {
    dir: PathBuf,
    /// Paths of images written so far.
    written: BTreeSet<String>,
}

impl ReportWriter {
    /// Creates a writer for an existing folder.
    pub fn new(dir: &Path) -> Self {
        Self { dir: dir.to_path_buf(), written: BTreeSet::new() }
    }

    /// Creates a writer for the folder of an earlier report, whose images are kept.
    pub fn resuming(dir: &Path, earlier: &Report) -> Self {
        let mut writer = Self::new(dir);
        writer.written.extend(image_paths(earlier));
        writer
    }

    /// Continues at the path to which the folder was moved.
    pub fn moved_to(&mut self, dir: &Path) {
        self.dir = dir.to_path_buf();
    }

    /// Writes new images, then the numbers.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&mut self, report: &Report) -> Result<(), FileError> {
        let images = self.dir.join("images");
        fs::create_dir_all(&images).map_err(|error| FileError::from_write(&images, &error))?;
        self.write_reference(report)?;
        for (row, stem) in report.rows.iter().zip(report.stems()) {
            if let Outcome::Measured(measured) = &row.outcome {
                self.write_row(report, measured, &stem)?;
            }
        }
        write_atomically(&self.dir.join(METRICS_PATH), &metrics_json(report))
    }

    /// Writes new images, the numbers and the page.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(&mut self, report: &Report) -> Result<(), FileError> {
        self.write(report)?;
        let uri = |path: &str| -> Result<String, FileError> {
            let path = self.dir.join(path);
            Ok(png_data_uri(&fs::read(&path).map_err(|error| FileError::from_read(&path, &error))?))
        };
        let measured = report.rows.iter().zip(report.stems());
        let stems = measured.filter(|(row, _)| matches!(row.outcome, Outcome::Measured(_))).map(|(_, stem)| stem);
        let stems = std::iter::once(REFERENCE_STEM.to_owned()).chain(stems);
        let values = stems.map(|stem| uri(&visibility_path(&stem))).collect::<Result<Vec<_>, _>>()?;
        let values = json!({ "judged": uri(JUDGED_PATH)?, "visibility": values });
        write_atomically(&self.dir.join(VALUES_PATH), format!("window.antumbraValues = {values};\n").as_bytes())?;
        write_atomically(&self.dir.join(PAGE_PATH), page_html(report).as_bytes())
    }

    fn write_reference(&mut self, report: &Report) -> Result<(), FileError> {
        let reference = &report.reference;
        self.write_picture(shaded_path(REFERENCE_STEM), || reference.shaded.clone())?;
        self.write_visibility(REFERENCE_STEM, &reference.visibility)?;
        let judged = || rgb_image(reference.visibility.size_px, |i| [if reference.judged[i] { 255 } else { 0 }; 3]);
        self.write_picture(JUDGED_PATH.to_owned(), judged)?;
        for truth in report.motion.iter().flat_map(|info| &info.truths) {
            self.write_picture(motion_path(REFERENCE_STEM, truth.motion), || truth.strip.clone())?;
        }
        Ok(())
    }

    fn write_row(&mut self, report: &Report, measured: &Measurement, stem: &str) -> Result<(), FileError> {
        let reference = &report.reference;
        self.write_picture(shaded_path(stem), || measured.shaded.clone())?;
        self.write_visibility(stem, &measured.visibility)?;
        let truth = measured.own_truth.as_ref().unwrap_or(&reference.visibility);
        self.write_picture(error_path(stem), || signed_error_map(truth, &measured.visibility, &reference.judged))?;
        for figures in &measured.motions {
            self.write_picture(motion_path(stem, figures.motion), || figures.strip.clone())?;
        }
        Ok(())
    }

    fn write_picture(&mut self, path: String, picture: impl FnOnce() -> image::RgbImage) -> Result<(), FileError> {
        if !self.written.contains(&path) {
            write_png(&self.dir.join(&path), &picture())?;
            self.written.insert(path);
        }
        Ok(())
    }

    fn write_visibility(&mut self, stem: &str, visibility: &Visibility) -> Result<(), FileError> {
        let exr = visibility_exr_path(stem);
        if self.written.contains(&exr) {
            return Ok(());
        }
        let path = self.dir.join(visibility_path(stem));
        let png = encode_png(&visibility.to_gray_levels())
            .map_err(|why| FileError::bad_path("write", &path, why, "choose another size"))?;
        write_atomically(&path, &png)?;
        write_visibility_exr(&self.dir.join(&exr), visibility)?;
        self.written.insert(exr);
        Ok(())
    }
}

/// Returns the paths of all images of a report.
fn image_paths(report: &Report) -> BTreeSet<String> {
    let mut paths = BTreeSet::from([JUDGED_PATH.to_owned()]);
    let mut add = |stem: &str| paths.extend([shaded_path(stem), visibility_path(stem), visibility_exr_path(stem)]);
    add(REFERENCE_STEM);
    let measured: Vec<_> = (report.rows.iter().zip(report.stems()))
        .filter_map(|(row, stem)| match &row.outcome {
            Outcome::Measured(measured) => Some((measured, stem)),
            Outcome::Skipped(_) => None,
        })
        .collect();
    measured.iter().for_each(|(_, stem)| add(stem));
    for (measured, stem) in measured {
        paths.insert(error_path(&stem));
        paths.extend(measured.motions.iter().map(|figures| motion_path(&stem, figures.motion)));
    }
    let truths = report.motion.iter().flat_map(|info| &info.truths);
    paths.extend(truths.map(|truth| motion_path(REFERENCE_STEM, truth.motion)));
    paths
}
