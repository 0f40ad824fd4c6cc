use crate::contract::params;
use crate::techniques::receiver_lists::Traversal;

params! {
    /// Parameters of [`AliasFree`](super::AliasFree).
    pub struct AliasFreeParams {
        /// Texels along a side of a light map with as many texels as there are lists of receivers; rounded up to a power of
        /// two. The lists take space by distance from the light too.
        map_size: u32 = 512, in 16..=2048, unit "texels", scale Log,
            more "Shorter lists, which changes the time and never the shadow.";
        /// How triangles find the receivers that they may hide the light from.
        traversal: Traversal = Traversal::Groups,
            more "raster is the paper's way: up to 2.5 times as fast where receivers are spread evenly over one window, and without \
                  bound where many share a texel. chosen takes raster where one window holds them. The shadow is the same, bit for bit.";
        /// Scale of the distance off their surface at which segments start where casters are not closed.
        bias_scale: f32 = 1.0, in 0.0..=8.0,
            more "Above 1 detaches contact shadows by micrometres, below 1 risks acne on open meshes.";
    }
    => Paper {
        traversal: Traversal::Raster, ours "Groups of 64 receivers walk the triangles before them.";
    } kept {
        "A triangle is drawn as the hull of three boxes, twelve corners, where the paper has six vertices.",
        "Bits are cleared by atomics: fragments of WebGPU have no bitwise blending.",
        "Lists hold pixels, whose positions come from the depth buffer, where the paper's hold positions.",
        "Planes are made for each receiver that a triangle meets, where the paper makes them once a triangle.",
        "Open meshes start segments a hair off their surface; the paper's casters are closed.",
    }
}
