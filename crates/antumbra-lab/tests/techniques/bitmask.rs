//! `bitmask` against the ray tracer: test scenes, and every kind of light.

use antumbra::TechniqueKind;

use crate::texels::{keeps_its_figures, knows_every_light};

const KIND: TechniqueKind = TechniqueKind::Bitmask;

#[test]
fn bitmask_keeps_its_figures() {
    let bounds = [
        ("builtin:overlap", 0.0162, 0.0024),
        ("builtin:leaning-plank", 0.0085, 0.0009),
        ("builtin:lantern-wall", 0.0123, 0.001),
        ("builtin:columns", 0.0147, 0.0015),
        ("builtin:window", 0.0203, 0.0018),
        ("builtin:tree", 0.07, 0.059),
    ];
    keeps_its_figures(KIND, &bounds);
}

#[test]
fn every_kind_of_light_is_known() {
    knows_every_light(KIND, [0.0146, 0.0152, 0.022, 0.0142, 0.047, 0.0201, 0.0159]);
}
