//! Enclosing or touching geometry: cameras inside closed meshes, lamps behind covers and in housings, rooms without gaps,
//! light at grazing angles.

use antumbra::TechniqueKind;
use glam::UVec2;

use crate::common::{Judged, case, lab};

const SIZE: UVec2 = UVec2::new(160, 90);

/// RMSE of a technique with small maps and few samples.
fn rmse(judged: &Judged, name: &str) -> f64 {
    let lab = lab().expect("asked for before");
    let kind = TechniqueKind::from_name(name).expect("a technique");
    let wanted = [("map_size", "512"), ("view_size", "512"), ("samples", "64"), ("search_samples", "64")];
    let has = |key: &str| kind.param_specs().iter().any(|spec| spec.key == key);
    let settings: Vec<_> = wanted.into_iter().filter(|(key, _)| has(key)).collect();
    let rmse = judged.metrics(&judged.run(lab, kind, &settings)).rmse.expect("judged pixels");
    println!("{}, {name}: rmse {rmse:.4}", judged.spec);
    rmse
}

/// Checks techniques against bounds on RMSE.
fn hold(name: &str, bounds: &[(&str, f64)]) {
    if lab().is_none() {
        return;
    }
    let Some(judged) = case(name, SIZE) else { return };
    for (technique, most) in bounds {
        let rmse = rmse(&judged, technique);
        assert!(rmse <= *most, "{name}, {technique}: rmse {rmse} against {most}");
    }
}

#[test]
fn a_closed_mesh_about_the_camera_keeps_light_out() {
    hold("inside_out", &[("sample_based", 0.002), ("alias_free", 0.002), ("multi_view", 0.002)]);
    hold("inside_out_sun", &[("sample_based", 0.002), ("alias_free", 0.002), ("multi_view", 0.002)]);
}

#[test]
fn a_near_plane_may_cut_into_a_closed_mesh() {
    hold("nearcut", &[("sample_based", 0.005)]);
}

/// A sheet in front of a panel of 60 cm hides it at any distance.
#[test]
fn a_cover_before_a_panel_hides_all_of_it() {
    for name in ["cover_0.01", "cover_0.05", "cover_0.2"] {
        hold(
            name,
            &[
                ("hard", 0.0),
                ("pcss", 0.001),
                ("smrt", 0.001),
                ("multi_layer", 0.01),
                ("essm", 0.01),
                ("pcss_anisotropic", 0.01),
                ("savsm", 0.01),
                ("vssm", 0.01),
                ("cssm", 0.01),
                ("evssm", 0.01),
                ("mssm", 0.01),
                ("reprojection_layered", 0.05),
                ("sample_based", 0.0),
                ("multi_view", 0.00001),
            ],
        );
    }
}

/// As published, geometry does not extend beyond the map.
#[test]
fn casters_end_at_the_map_s_edge_as_published() {
    let Some(lab) = lab() else { return };
    let Some(judged) = case("cover_0.01", SIZE) else { return };
    let settings = [("map_size", "512"), ("edge_goes_on", "false")];
    let rmse = judged.metrics(&judged.run(lab, TechniqueKind::Essm, &settings)).rmse.expect("judged pixels");
    assert!(rmse > 0.9, "{rmse}");
}

#[test]
fn a_shell_about_a_lamp_hides_it() {
    hold(
        "shell_0.08",
        &[
            ("hard", 0.0),
            ("pcss", 0.02),
            ("smrt", 0.02),
            ("multi_layer", 0.02),
            ("essm", 0.05),
            ("pcss_anisotropic", 0.01),
            ("savsm", 0.01),
            ("vssm", 0.01),
            ("cssm", 0.01),
            ("evssm", 0.01),
            ("mssm", 0.01),
            ("reprojection_layered", 0.05),
            ("sample_based", 0.001),
        ],
    );
}

/// Walls of single sheets, and of five millimetres.
#[test]
fn a_closed_room_keeps_a_sun_out() {
    for name in ["room_sheet", "room_5mm"] {
        hold(name, &[("hard", 0.06), ("pcss", 0.06), ("smrt", 0.06), ("multi_layer", 0.06), ("essm", 0.06)]);
    }
}

/// A bulb two centimetres in front of a wall lights it at less than one degree beyond a metre.
#[test]
fn grazing_light_is_not_taken_for_shadow() {
    hold(
        "sconce_near",
        &[
            ("hard", 0.06),
            ("pcf", 0.06),
            ("pcss", 0.03),
            ("multi_layer", 0.03),
            ("essm", 0.06),
            ("reprojection_layered", 0.03),
            ("sample_based", 0.005),
        ],
    );
}

/// A bulb that touches a wall is hidden neither from the ground in front of the wall nor from the wall.
#[test]
fn a_wall_beside_a_lamp_is_no_blocker() {
    hold("sconce_touch", &[("pcf", 0.11), ("pcss", 0.06), ("multi_layer", 0.11), ("essm", 0.09), ("multi_view", 0.02)]);
}
