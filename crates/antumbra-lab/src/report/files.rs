//! The writing of a report's files.

use std::fs;
use std::path::Path;

use serde_json::json;

use super::html::png_data_uri;
use super::json::metrics_json;
use super::model::{Outcome, Report};
use super::page::page_html;
use super::paths::{
    JUDGED_PATH, REFERENCE_STEM, error_path, motion_path, shaded_path, visibility_exr_path, visibility_path,
};
use crate::color_maps::signed_error_map;
use crate::image_io::{encode_png, write_png, write_visibility_exr};
use crate::output_files::{FileError, write_atomically};
use crate::picture::rgb_image;

/// Writes a report into the folder `dir`, which must exist: `index.html`, `metrics.json`, `values.js` (visibility for
/// the page's pixel readout) and `images/`, with every visibility image as PNG and as 32-bit float OpenEXR, the error
/// maps, and the mask of judged pixels.
pub fn write_report(dir: &Path, report: &Report) -> Result<(), FileError> {
    let images = dir.join("images");
    fs::create_dir_all(&images).map_err(|error| FileError::from_write(&images, &error))?;

    let reference = &report.reference;
    let mut values = Vec::new();
    let mut write_visibility = |stem: &str, visibility| -> Result<(), FileError> {
        let path = dir.join(visibility_path(stem));
        let gray = crate::picture::Visibility::to_gray_levels(visibility);
        let png =
            encode_png(&gray).map_err(|why| FileError::bad_path("write", &path, why, "render at another size"))?;
        write_atomically(&path, &png)?;
        write_visibility_exr(&dir.join(visibility_exr_path(stem)), visibility)?;
        values.push(png_data_uri(&png));
        Ok(())
    };

    write_png(&dir.join(shaded_path(REFERENCE_STEM)), &reference.shaded)?;
    write_visibility(REFERENCE_STEM, &reference.visibility)?;
    let judged = rgb_image(reference.visibility.size_px, |i| [if reference.judged[i] { 255 } else { 0 }; 3]);
    write_png(&dir.join(JUDGED_PATH), &judged)?;

    for truth in report.motion.iter().flat_map(|info| &info.truths) {
        write_png(&dir.join(motion_path(REFERENCE_STEM, truth.motion)), &truth.strip)?;
    }
    for (row, stem) in report.rows.iter().zip(report.stems()) {
        let Outcome::Measured(measured) = &row.outcome else { continue };
        write_png(&dir.join(shaded_path(&stem)), &measured.shaded)?;
        write_visibility(&stem, &measured.visibility)?;
        let truth = measured.own_truth.as_ref().unwrap_or(&reference.visibility);
        let error = signed_error_map(truth, &measured.visibility, &reference.judged);
        write_png(&dir.join(error_path(&stem)), &error)?;
        for figures in &measured.motions {
            write_png(&dir.join(motion_path(&stem, figures.motion)), &figures.strip)?;
        }
    }

    let judged = encode_png(&judged).map_or_else(|_| String::new(), |png| png_data_uri(&png));
    let values = format!("window.antumbraValues = {};\n", json!({ "judged": judged, "visibility": values }));
    write_atomically(&dir.join("values.js"), values.as_bytes())?;
    write_atomically(&dir.join("metrics.json"), &metrics_json(report))?;
    write_atomically(&dir.join("index.html"), page_html(report).as_bytes())
}
