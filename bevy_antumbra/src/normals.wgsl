// Geometric normals from depth and from Bevy's normal prepass, whose normals are changed by smooth shading and normal maps.
//
// A normal follows from the positions of a pixel and two neighbours, one beside it and one above or below: four candidates.
// Bevy's normal selects those on the pixel's own surface; if there is none, on features 1 or 2 pixels wide, it is used itself.
//
// A neighbour on the same plane is found by depth: under a perspective with reversed depth, depth is affine over a plane's
// pixels, so that of three in a row the middle one is the mean of the others.

struct View {
    view_from_clip: mat4x4<f32>,
    world_from_view: mat4x4<f32>,
    origin_px: vec2<i32>,
    size_px: vec2<i32>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var depths: texture_depth_2d;
// Normals of Bevy's prepass: world space, scaled by a half and offset by a half.
@group(0) @binding(2) var shading_normals: texture_2d<f32>;
@group(0) @binding(3) var normals: texture_storage_2d<rgba32float, write>;

// Thresholds of coplanarity. On a plane the middle of three depths differs from the others' mean by rounding alone, some units
// in the last place; on a curved surface by a part of the depth step; across an edge by all of it.
const FLAT: f32 = 3e-6;
const BEND: f32 = 0.2;
// Minimum cosine between a candidate and Bevy's normal: 18 degrees, as on a smoothly shaded mesh of some hundred triangles.
const LIKE: f32 = 0.9;

// Returns the depth of a pixel; 0, the background, outside the view.
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

// Classifies three depths in a row: 0 coplanar within rounding, 1 curved, 2 on different surfaces.
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
    // Faces the camera, approximately: a shading normal can face away at silhouettes.
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
        // Planar candidates precede curved ones, and curved ones have to be similar to Bevy's normal.
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
