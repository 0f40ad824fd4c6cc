// Geometric normals from depth and from Bevy's normal prepass, whose normals are bent by smooth shading and by normal maps.
//
// A normal follows from a pixel's place and those of two neighbours, one beside it and one above or below: four choices. Bevy's
// normal says which of them are on the pixel's own surface. Where none is, on what is a pixel or two wide, Bevy's is taken.
//
// Which neighbours may be: under a perspective with reversed depth, depth is affine over a plane's pixels, so that of three in
// a row the middle one is the others' mean.

struct View {
    view_from_clip: mat4x4<f32>,
    world_from_view: mat4x4<f32>,
    origin_px: vec2<i32>,
    size_px: vec2<i32>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var depths: texture_depth_2d;
// World space, times a half and plus a half.
@group(0) @binding(2) var shading_normals: texture_2d<f32>;
@group(0) @binding(3) var normals: texture_storage_2d<rgba32float, write>;

// Depths of three pixels on one plane differ from the middle one's mean by rounding alone, some units in the last place, and on
// what bends by a part of what they rise by. Across an edge they differ by all of it.
const FLAT: f32 = 3e-6;
const BEND: f32 = 0.2;
// The cosine of 18 degrees: what a normal may differ by from an interpolated one on a mesh of some hundred triangles.
const LIKE: f32 = 0.9;

// Beyond the view there is nothing.
fn depth_at(pixel: vec2<i32>) -> f32 {
    if any(pixel < vec2<i32>(0)) || any(pixel >= view.size_px) {
        return 0.0;
    }
    return textureLoad(depths, view.origin_px + pixel, 0);
}

fn pos_in_view(pixel: vec2<i32>, depth: f32) -> vec3<f32> {
    let across = (vec2<f32>(pixel) + 0.5) / vec2<f32>(view.size_px);
    let pos = view.view_from_clip * vec4<f32>(2.0 * across.x - 1.0, 1.0 - 2.0 * across.y, depth, 1.0);
    return pos.xyz / pos.w;
}

// How far three depths in a row are from one plane: 0 as far as rounding tells, 1 where they bend, 2 where they are two surfaces'.
fn bend(before: f32, middle: f32, after: f32) -> u32 {
    if before <= 0.0 || after <= 0.0 {
        return 2u;
    }
    let miss = abs(before + after - 2.0 * middle);
    if miss <= FLAT * middle {
        return 0u;
    }
    return select(2u, 1u, miss <= BEND * max(abs(after - middle), abs(before - middle)));
}

@compute @workgroup_size(8, 8)
fn derive(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<i32>(id.xy);
    if any(pixel >= view.size_px) {
        return;
    }
    let depth = depth_at(pixel);
    let place = view.origin_px + pixel;
    if depth <= 0.0 {
        textureStore(normals, place, vec4<f32>(0.0));
        return;
    }
    let here = pos_in_view(pixel, depth);
    let shading = 2.0 * textureLoad(shading_normals, place, 0).xyz - 1.0;
    let to_view = transpose(mat3x3<f32>(
        view.world_from_view[0].xyz, view.world_from_view[1].xyz, view.world_from_view[2].xyz,
    ));
    // Turned to the camera; nearly, for a shading normal may look away at silhouettes.
    var smooth_normal = normalize(to_view * shading);
    if dot(smooth_normal, here) > 0.0 {
        smooth_normal = -smooth_normal;
    }

    var best = smooth_normal;
    var best_likeness = LIKE;
    for (var k = 0; k < 4; k += 1) {
        let step = vec2<i32>(2 * (k & 1) - 1, (k & 2) - 1);
        let right = vec2<i32>(step.x, 0);
        let up = vec2<i32>(0, step.y);
        let beside = depth_at(pixel + right);
        let above = depth_at(pixel + up);
        let row = min(bend(depth_at(pixel - right), depth, beside), bend(depth, beside, depth_at(pixel + 2 * right)));
        let column = min(bend(depth_at(pixel - up), depth, above), bend(depth, above, depth_at(pixel + 2 * up)));
        let most = max(row, column);
        if most == 2u {
            continue;
        }
        let along = pos_in_view(pixel + right, beside) - here;
        let across = pos_in_view(pixel + up, above) - here;
        let normal = normalize(cross(along, across) * f32(step.x * step.y));
        // What is flat comes before what bends, and what bends has to be like Bevy's normal.
        let likeness = abs(dot(normal, smooth_normal)) + select(0.0, 1.0, most == 0u);
        if likeness > best_likeness {
            best_likeness = likeness;
            best = normal;
        }
    }
    textureStore(normals, place, vec4<f32>(
        (view.world_from_view * vec4<f32>(best, 0.0)).xyz, 1.0,
    ));
}
