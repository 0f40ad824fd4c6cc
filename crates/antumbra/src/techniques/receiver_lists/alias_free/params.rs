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
            more "raster is the paper's way: up to four times as fast where receivers are spread over one window, and without \
                  bound where many share a texel. chosen takes it where few do. The shadow is the same, bit for bit.";
        /// Region of the light's map over which a triangle is drawn, where triangles are drawn.
        region: RegionHull = RegionHull::SixVertices,
            more "six_vertices is the paper's, smaller, and a texel wider at sharp corners; the shadow is the same, bit for bit.";
        /// Planes that receivers are tested against, where triangles are drawn.
        planes: TestedPlanes = TestedPlanes::Receiver,
            more "triangle is the paper's: less to do for each receiver; edges move by the rounding of positions.";
        /// Stores receivers' positions in the lists, where triangles are drawn; otherwise they come from the depth buffer.
        stored_positions: bool = false,
            more "Saves each test a read of the depth buffer, for 32 bytes per pixel; changes nothing else.";
        /// Early depth test that discards fragments over empty lists, on devices that have one.
        stencil: bool = true,
            more "Saves fragments that would end at once, for a pass over each window; changes nothing else.";
        shared bias_scale of rays;
    }
    => Paper {
        traversal: Traversal::Raster, ours "Where many receivers share a texel, groups of 64 walk the triangles before them.";
        planes: TestedPlanes::Triangle, ours "Planes through each receiver that a triangle meets.";
        stored_positions: true, ours "Lists hold pixels, whose positions come from the depth buffer.";
    } kept {
        "Bits are cleared by atomics: fragments of WebGPU have no bitwise blending.",
        "The paper's stencil is a depth test, and its geometry shader the vertex stage, at each of a region's vertices.",
        "Open meshes start segments at the ray offset from their surface; the paper's casters are closed.",
    }
}
