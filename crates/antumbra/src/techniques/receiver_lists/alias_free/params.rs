use crate::contract::{param_choice, params};
use crate::techniques::receiver_lists::Traversal;

param_choice! {
    /// Region of the light's map over which a triangle is drawn.
    pub enum RegionHull {
        /// The convex hull of three boxes, twelve corners.
        Boxes = "boxes",
        /// Two corners for each of the triangle's, as published.
        SixVertices = "six_vertices",
    }
}

param_choice! {
    /// Planes that a receiver is tested against.
    pub enum TestedPlanes {
        /// Planes of the triangle and the receiver, computed per receiver.
        Receiver = "receiver",
        /// Planes of the triangle and the light, computed once per triangle, as published.
        Triangle = "triangle",
    }
}

params! {
    /// Parameters of [`AliasFree`](super::AliasFree).
    pub struct AliasFreeParams {
        shared map_size of lists;
        /// Method by which triangles find the receivers that they may shadow.
        traversal: Traversal = Traversal::Chosen,
            more "raster, the paper's, is up to four times as fast if receivers are spread evenly over one window, but \
                 arbitrarily slow if many share a texel. chosen uses raster where few share one. All give identical shadows.";
        /// Region of the light's map over which a triangle is drawn, where triangles are drawn.
        region: RegionHull = RegionHull::SixVertices,
            more "six_vertices, the paper's, has fewer corners, but is a texel wider at sharp ones; the shadows are identical.";
        /// Planes that receivers are tested against, where triangles are drawn.
        planes: TestedPlanes = TestedPlanes::Receiver,
            more "triangle, the paper's, takes less work per receiver, but edges move by the rounding error of positions.";
        /// Stores receivers' positions in the lists, where triangles are drawn; otherwise they come from the depth buffer.
        stored_positions: bool = false,
            more "true saves a depth buffer read per test and takes 32 bytes per pixel; the shadow is the same.";
        /// Early depth test that discards fragments over empty lists, on devices that have one.
        stencil: bool = true,
            more "true skips fragments over empty lists and takes a pass over each window; the shadow is the same.";
        shared bias_scale of rays;
    }
    => Paper {
        traversal: Traversal::Raster, ours "Where many receivers share a texel, groups of 64 test the triangles in front of them.";
        planes: TestedPlanes::Triangle, ours "Planes through the triangle and the receiver, computed per receiver.";
        stored_positions: true, ours "Lists contain pixels, whose positions are read from the depth buffer.";
    } kept {
        "Bits are cleared by atomics, because WebGPU has no bitwise blending.",
        "A depth test replaces the paper's stencil, and the vertex stage its geometry shader, for each vertex of a region.",
        "On open meshes, segments start at the ray offset from the surface; the paper's casters are closed.",
    }
}
