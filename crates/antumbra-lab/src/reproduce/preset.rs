//! Techniques that each paper compares: its own, and those that it compares them with.

use antumbra::TechniqueKind;

/// Comparison of one paper.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Id of the paper in [`PAPERS`](super::PAPERS).
    pub paper: &'static str,
    /// Techniques: the paper's own first.
    pub techniques: &'static [TechniqueKind],
}

/// Comparisons of all papers.
pub const PRESETS: &[Preset] = &[
    // Figures 8 to 10.
    Preset {
        paper: "lauritzen-2008",
        techniques: &[TechniqueKind::Lvsm, TechniqueKind::Evsm, TechniqueKind::Vsm, TechniqueKind::Convolution],
    },
    // Sections 3 and 4; figure 13 for many maps.
    Preset {
        paper: "sintorn-2008",
        techniques: &[
            TechniqueKind::AliasFree,
            TechniqueKind::SampleBased,
            TechniqueKind::Hard,
            TechniqueKind::MultiView,
        ],
    },
    // Figures 6 to 8.
    Preset {
        paper: "shen-2013",
        techniques: &[
            TechniqueKind::Essm,
            TechniqueKind::Cssm,
            TechniqueKind::Vssm,
            TechniqueKind::PcssAnisotropic,
            TechniqueKind::Pcss,
        ],
    },
    // Figures 3 and 6.
    Preset {
        paper: "marrs-2014",
        techniques: &[TechniqueKind::Reprojection, TechniqueKind::MultiView, TechniqueKind::Pcss],
    },
    // Figures 1, 12, 14 and 15.
    Preset { paper: "selgrad-2014", techniques: &[TechniqueKind::MultiLayer, TechniqueKind::Essm] },
];
