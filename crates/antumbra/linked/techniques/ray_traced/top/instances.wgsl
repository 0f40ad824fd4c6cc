// Linked from src/techniques/ray_traced/top/instances.wesl by `cargo xtask shaders`: edit that, not this.

struct InstanceRun {
    first_item: u32,
    first_instance: u32,
    caster: u32,
    first_node: u32
}

@group(0) @binding(0)
var<storage, read> instance_runs: array<InstanceRun>;

@group(0) @binding(1)
var<storage, read> nodes: array<vec4u>;

@group(0) @binding(2)
var<storage, read_write> items: array<vec4f>;

@group(0) @binding(3)
var<storage, read_write> instances: array<vec4u>;

struct InstanceRange {
    anchor_in_world: vec3f,
    first_item: u32,
    end_item: u32,
    run_count: u32,
    padding_0: u32,
    padding_1: u32
}

@group(1) @binding(0)
var<uniform> instance_range: InstanceRange;

@group(1) @binding(1)
var<storage, read> mesh_instances: array<mat4x4f>;

fn run_of(item: u32) -> InstanceRun {
    var low = 0u;
    var high = instance_range.run_count;
    for (var turn = 0u; turn < 32u; turn++) {
        let middle = (low + high) / 2u;
        if high - low <= 1u {
            break;
        }
        if instance_runs[middle].first_item <= item {
            low = middle;
        }
        else {
            high = middle;
        }
    }
    return instance_runs[low];
}

fn mesh_box(first_node: u32) -> nodes_Box {
    let frame = nodes_Box(bitcast<vec3f>(nodes[first_node].xyz), bitcast<vec3f>(nodes[first_node + 1u].xyz));
    return nodes_Box(frame.low, max(frame.high, frame.low + nodes_STEPS * nodes_step_of(frame)));
}

fn world_box(box: nodes_Box, world_from_object: mat4x4f) -> nodes_Box {
    let middle = (world_from_object * vec4f(0.5 * box.low + 0.5 * box.high, 1.0)).xyz;
    let half = 0.5 * (box.high - box.low);
    let across = abs(world_from_object[0].xyz) * half.x + abs(world_from_object[1].xyz) * half.y + abs(world_from_object[2].xyz) * half.z;
    let sums = abs(middle) + across;
    let sum = sums.x + sums.y + sums.z;
    if sum >= nodes_NOTHING || !finite_is_finite(sum) {
        return nodes_empty_box();
    }
    return nodes_Box(middle - across, middle + across);
}

const MIN_VOLUME = 0.01;

@compute @workgroup_size(64)
fn list_instances(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let item = instance_range.first_item + shape_thread_index(id, workgroups);
    if item >= instance_range.end_item {
        return;
    }
    let run = run_of(item);
    let world_from_object = anchored_anchored(mesh_instances[run.first_instance + item - run.first_item], instance_range.anchor_in_world);
    let box = world_box(mesh_box(run.first_node), world_from_object);
    items[2u * item] = vec4f(box.low, 0.0);
    items[2u * item + 1u] = vec4f(box.high, 0.0);
    let x = world_from_object[0].xyz;
    let y = world_from_object[1].xyz;
    let z = world_from_object[2].xyz;
    let lengths = vec3f(length(x), length(y), length(z));
    let safe = max(lengths, vec3f(1e-30));
    let unit_x = x / safe.x;
    let unit_y = y / safe.y;
    let unit_z = z / safe.z;
    let volume = dot(unit_x, cross(unit_y, unit_z));
    let is_flat = !(abs(volume) >= MIN_VOLUME) || any(lengths < vec3f(1e-20));
    let divisor = select(volume, 1.0, is_flat);
    var rows = array<vec3f, 3>(cross(unit_y, unit_z) / (divisor * safe.x), cross(unit_z, unit_x) / (divisor * safe.y), cross(unit_x, unit_y) / (divisor * safe.z));
    let place = world_from_object[3].xyz;
    let at = instance_INSTANCE_VECTORS * item;
    for (var k = 0u; k < 3u; k++) {
        instances[at + k] = bitcast<vec4u>(vec4f(rows[k], -dot(rows[k], place)));
        instances[at + 3u + k] = bitcast<vec4u>(vec4f(x[k], y[k], z[k], place[k]));
    }
    instances[at + 6u] = vec4u(run.caster, select(0u, instance_IS_FLAT, is_flat), 0u, 0u);
}

fn anchored_anchored(world_from_object: mat4x4f, anchor_in_world: vec3f) -> mat4x4f {
    let place = world_from_object[3];
    return mat4x4f(world_from_object[0], world_from_object[1], world_from_object[2], vec4f(place.xyz - anchor_in_world, place.w));
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

const instance_INSTANCE_VECTORS: u32 = 7;

const instance_IS_FLAT = 1u;

struct nodes_Box {
    low: vec3f,
    high: vec3f
}

const nodes_NOTHING = 3e38;

fn nodes_empty_box() -> nodes_Box {
    return nodes_Box(vec3f(nodes_NOTHING), vec3f(-nodes_NOTHING));
}

const nodes_STEPS = 65535.0;

fn nodes_step_of(frame: nodes_Box) -> vec3f {
    let size = max(abs(frame.low), abs(frame.high));
    let largest = max(size.x, max(size.y, size.z));
    return max(frame.high - frame.low, vec3f(max(1e-6 * largest, 1e-30))) / nodes_STEPS;
}

fn shape_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
}
