// Linked from src/techniques/receiver_lists/light_bits/triangle_probe.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<storage, read> cases: array<vec4f>;

@group(0) @binding(1)
var<storage, read_write> answers: array<vec4f>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&answers) {
        return;
    }
    let first = 6u * id.x;
    let a = cases[first];
    let b = cases[first + 1u];
    let c = cases[first + 2u].xyz;
    let rays = points_Rays(cases[first + 3u].xyz, vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0), b.w);
    let middle = cases[first + 4u].xyz;
    let half_box = cases[first + 5u].xyz;
    let planes = triangle_test_planes_of(rays, vec3f(), a.xyz, b.xyz, c, a.w == 1.0, vec3f(), middle, half_box);
    let cover = select(triangle_test_box_cover(planes, middle, half_box), 0u, planes.is_missed);
    answers[id.x] = vec4f(f32(planes.is_missed), f32(cover), points_at_point(planes.support, middle), planes.slack.w);
}

struct points_Rays {
    to_center: vec3f,
    right: vec3f,
    up: vec3f,
    axis: vec3f,
    inverse_end: f32
}

fn points_plane_for(rays: points_Rays, normal: vec3f) -> vec4f {
    return vec4f(dot(normal, rays.to_center), dot(normal, rays.right), dot(normal, rays.up), dot(normal, rays.axis));
}

fn points_at_point(plane: vec4f, point: vec3f) -> f32 {
    return plane.x + plane.y * point.x + plane.z * point.y + plane.w * point.z;
}

fn points_reach_over(plane: vec4f, half_box: vec3f) -> f32 {
    return abs(plane.y) * half_box.x + abs(plane.z) * half_box.y + abs(plane.w) * half_box.z;
}

const triangle_test_PLANE_SLACK = 9.5367431640625e-7;

struct triangle_test_Planes {
    edge_a: vec4f,
    edge_b: vec4f,
    edge_c: vec4f,
    support: vec4f,
    slack: vec4f,
    is_missed: bool
}

fn triangle_test_slack_of(plane: vec4f, largest: vec3f) -> f32 {
    return triangle_test_PLANE_SLACK * (abs(plane.x) + dot(abs(plane.yzw), largest));
}

fn triangle_test_planes_of(rays: points_Rays, x: vec3f, corner_a: vec3f, corner_b: vec3f, corner_c: vec3f, is_closed: bool, depth_error_m: vec3f, middle: vec3f, half_box: vec3f) -> triangle_test_Planes {
    var planes: triangle_test_Planes;
    planes.is_missed = true;
    let a = corner_a - x;
    let b = corner_b - x;
    let c = corner_c - x;
    let n = cross(corner_b - corner_a, corner_c - corner_a);
    let height = dot(a, n);
    let away = dot(depth_error_m, n);
    let side = sign(select(height, away, abs(height) <= abs(away)));
    if side == 0.0 || (is_closed && height > 0.0) {
        return planes;
    }
    let largest = abs(middle) + half_box;
    let through = points_plane_for(rays, side * n);
    planes.support = vec4f(abs(height) * rays.inverse_end - through.x, -through.yzw);
    planes.slack.w = triangle_test_slack_of(planes.support, largest) + triangle_test_PLANE_SLACK * abs(height);
    if points_at_point(planes.support, middle) - points_reach_over(planes.support, half_box) > planes.slack.w {
        return planes;
    }
    planes.edge_a = points_plane_for(rays, side * cross(corner_b - corner_c, b + c));
    planes.slack.x = triangle_test_slack_of(planes.edge_a, largest);
    if points_at_point(planes.edge_a, middle) + points_reach_over(planes.edge_a, half_box) < -planes.slack.x {
        return planes;
    }
    planes.edge_b = points_plane_for(rays, side * cross(corner_c - corner_a, c + a));
    planes.slack.y = triangle_test_slack_of(planes.edge_b, largest);
    if points_at_point(planes.edge_b, middle) + points_reach_over(planes.edge_b, half_box) < -planes.slack.y {
        return planes;
    }
    planes.edge_c = points_plane_for(rays, side * cross(corner_a - corner_b, a + b));
    planes.slack.z = triangle_test_slack_of(planes.edge_c, largest);
    planes.is_missed = points_at_point(planes.edge_c, middle) + points_reach_over(planes.edge_c, half_box) < -planes.slack.z;
    return planes;
}

fn triangle_test_values_at(planes: triangle_test_Planes, point: vec3f) -> vec4f {
    return vec4f(points_at_point(planes.edge_a, point), points_at_point(planes.edge_b, point), points_at_point(planes.edge_c, point), points_at_point(planes.support, point));
}

fn triangle_test_box_cover(planes: triangle_test_Planes, middle: vec3f, half_box: vec3f) -> u32 {
    let at_middle = triangle_test_values_at(planes, middle);
    let reach = vec4f(points_reach_over(planes.edge_a, half_box), points_reach_over(planes.edge_b, half_box), points_reach_over(planes.edge_c, half_box), points_reach_over(planes.support, half_box));
    let inside = at_middle * vec4f(1.0, 1.0, 1.0, -1.0);
    let most = inside + reach + planes.slack;
    let least = inside - reach - planes.slack;
    if min(min(most.x, most.y), min(most.z, most.w)) < 0.0 {
        return 0u;
    }
    return select(1u, 2u, min(min(least.x, least.y), min(least.z, least.w)) > 0.0);
}
