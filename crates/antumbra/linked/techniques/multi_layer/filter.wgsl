// Linked from src/techniques/multi_layer/filter.wesl by `cargo xtask shaders`: edit that, not this.

struct FilterStep {
    source_size: vec2u,
    target_size: vec2u,
    source_first: u32,
    target_first: u32,
    stride: u32,
    near_child: i32,
    far_child: i32,
    subsample: u32,
    epsilon_slope: f32,
    epsilon_m: f32,
    capacity: u32,
    z_limit_m: f32,
    complete_from_m: f32,
    padding_0: u32
}

@group(0) @binding(0)
var<storage, read> filter_step: FilterStep;

@group(0) @binding(1)
var<storage, read_write> lists: array<vec2u>;

@group(0) @binding(2)
var<storage, read_write> fragments: array<vec2u>;

@group(0) @binding(3)
var<storage, read_write> counters: fragments_ListCounters;

override AVERAGES_BY_COUNT: bool = false;

override COLORED: u32 = 0u;

override LIST_ACCUMULATION: u32 = 0u;

const NONE = 3e38;

const WORKGROUP = 64u;

const KEPT = 24u;

var<workgroup> merged: array<vec2u, 1536>;

var<workgroup> sums: array<u32, WORKGROUP>;

var<workgroup> workgroup_first: u32;

fn child_at(texel: vec2u, k: u32) -> vec2i {
    return vec2i(filter_step.stride * texel) + vec2i(select(filter_step.near_child, filter_step.far_child, (k & 1u) == 1u), select(filter_step.near_child, filter_step.far_child, (k & 2u) == 2u));
}

fn is_in_source(child: vec2i) -> bool {
    return all(child >= vec2i(0)) && all(child < vec2i(filter_step.source_size));
}

fn list_at(child: vec2i) -> vec2u {
    return lists[filter_step.source_first + u32(child.y) * filter_step.source_size.x + u32(child.x)];
}

fn child_list(texel: vec2u, k: u32) -> vec2u {
    let child = child_at(texel, k);
    if !is_in_source(child) {
        return vec2u();
    }
    return list_at(child);
}

struct Reader {
    z_m: f32,
    opacity_bits: u32,
    place: u32,
    end: u32,
    z_end: f32,
    transmittance: f32
}

fn reader_at(place: u32, end: u32, z_end: f32, transmittance: f32) -> Reader {
    if place < end {
        let fragment = fragments[place];
        let z_m = bitcast<f32>(fragment.x);
        return Reader(select(NONE, z_m, z_m < z_end), fragment.y, place, end, z_end, transmittance);
    }
    return Reader(NONE, 0u, place, end, z_end, transmittance);
}

fn reader_of(texel: vec2u, k: u32) -> Reader {
    let child = child_at(texel, k);
    let held = clamp(child, vec2i(0), vec2i(filter_step.source_size) - 1);
    let list = list_at(held);
    let z_end = select(filter_step.complete_from_m, NONE, all(held == child));
    return reader_at(list.x, min(list.x + list.y, arrayLength(&fragments)), z_end, 1.0);
}

struct DepthSum {
    z: f32,
    weight: f32
}

fn overlap_of(opacity: f32, before: f32, after: f32) -> f32 {
    if LIST_ACCUMULATION != fragments_ACCUMULATE_OVERLAP || before >= 1.0 {
        return 1.0;
    }
    let behind = 1.0 - saturate((before - after) / max(opacity, 1e-20));
    return behind / (1.0 - before);
}

fn take(reader: ptr<function, Reader>, limit: f32, depths: ptr<function, DepthSum>) -> vec3f {
    var opacity = vec3f();
    let end = min((*reader).end, arrayLength(&fragments));
    for (var place = (*reader).place; place < end; place++) {
        if !((*reader).z_m <= limit) {
            break;
        }
        let a = fragments_unpack_opacity((*reader).opacity_bits, COLORED);
        let overlap = fragments_unpack_overlap((*reader).opacity_bits, COLORED);
        opacity = fragments_accumulate(LIST_ACCUMULATION, opacity, a, overlap);
        let strength = fragments_largest(a);
        let weight = select(max(strength, 1e-20), 1.0, AVERAGES_BY_COUNT);
        (*depths).z += weight * (*reader).z_m;
        (*depths).weight += weight;
        let before = (*reader).transmittance;
        let after = max(before - strength * saturate(1.0 - overlap * (1.0 - before)), 0.0);
        *reader = reader_at(place + 1u, end, (*reader).z_end, after);
    }
    return opacity;
}

fn merge(texel: vec2u, local: u32, in_place: bool, first: u32) -> u32 {
    var a = reader_of(texel, 0u);
    var b = reader_of(texel, 1u);
    var c = reader_of(texel, 2u);
    var d = reader_of(texel, 3u);
    let most = min((a.end - a.place) + (b.end - b.place) + (c.end - c.place) + (d.end - d.place), arrayLength(&fragments));
    var count = 0u;
    for (; count < most; count++) {
        let nearest = min(min(a.z_m, b.z_m), min(c.z_m, d.z_m));
        if nearest >= min(filter_step.z_limit_m, NONE) {
            break;
        }
        let limit = nearest + abs(filter_step.epsilon_slope * nearest) + filter_step.epsilon_m;
        let before = 0.25 * (a.transmittance + b.transmittance + c.transmittance + d.transmittance);
        var depths = DepthSum(0.0, 0.0);
        var opacity = take(&a, limit, &depths);
        opacity += take(&b, limit, &depths);
        opacity += take(&c, limit, &depths);
        opacity += take(&d, limit, &depths);
        opacity *= 0.25;
        let after = 0.25 * (a.transmittance + b.transmittance + c.transmittance + d.transmittance);
        let overlap = overlap_of(fragments_largest(opacity), before, after);
        let fragment = fragments_pack_fragment(fragments_Fragment(depths.z / depths.weight, opacity, overlap), COLORED);
        if in_place {
            fragments[first + count] = fragment;
        }
        else if count < KEPT {
            merged[count * WORKGROUP + local] = fragment;
        }
    }
    return count;
}

@compute @workgroup_size(8, 8)
fn filter_level(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let is_inside = all(id.xy < filter_step.target_size);
    let target_list = filter_step.target_first + id.y * filter_step.target_size.x + id.x;
    let merges = is_inside && filter_step.subsample == 0u;
    var count = 0u;
    if merges {
        count = merge(id.xy, local, false, 0u);
    }
    sums[local] = count;
    workgroupBarrier();
    if local == 0u {
        var sum = 0u;
        for (var i = 0u; i < WORKGROUP; i++) {
            let own = sums[i];
            sums[i] = sum;
            sum += own;
        }
        workgroup_first = atomicAdd(&counters.end, sum);
    }
    workgroupBarrier();
    let first = workgroup_first + sums[local];
    if merges && first + count <= filter_step.capacity {
        lists[target_list] = vec2u(first, count);
        if count > KEPT {
            merge(id.xy, local, true, first);
        }
        else {
            for (var i = 0u; i < min(count, KEPT); i++) {
                fragments[first + i] = merged[i * WORKGROUP + local];
            }
        }
    }
    else if is_inside {
        let k = ((id.x ^ id.y) & 1u) + 2u * (id.y & 1u);
        lists[target_list] = child_list(id.xy, k);
    }
}

const fragments_EXPONENT_BIAS = 14;

const fragments_MANTISSA_BITS = 8;

const fragments_OVERLAP_STEPS = 4094.0;

const fragments_OVERLAP_STEPS_COLORED = 14.0;

const fragments_OVERLAP_BITS = 4095u;

struct fragments_Fragment {
    z_m: f32,
    opacity: vec3f,
    overlap: f32
}

fn fragments_power_of_two(exponent: i32) -> f32 {
    return bitcast<f32>(u32(exponent + 127) << 23u);
}

fn fragments_pack_rgb8e4(color: vec3f) -> u32 {
    let c = clamp(color, vec3f(0.0), vec3f(1.0));
    let largest = max(c.r, max(c.g, c.b));
    let floor_log2 = i32(bitcast<u32>(largest) >> 23u) - 127;
    var exponent = max(-fragments_EXPONENT_BIAS - 1, floor_log2) + 1 + fragments_EXPONENT_BIAS;
    if round(largest * fragments_power_of_two(fragments_MANTISSA_BITS + fragments_EXPONENT_BIAS - exponent)) >= 256.0 {
        exponent += 1;
    }
    let m = vec3u(round(c * fragments_power_of_two(fragments_MANTISSA_BITS + fragments_EXPONENT_BIAS - exponent)));
    return m.r | (m.g << 8u) | (m.b << 16u) | (u32(exponent) << 24u);
}

fn fragments_unpack_rgb8e4(bits: u32) -> vec3f {
    let m = vec3u(bits & 255u, (bits >> 8u) & 255u, (bits >> 16u) & 255u);
    return vec3f(m) * fragments_power_of_two(i32((bits >> 24u) & 15u) - fragments_EXPONENT_BIAS - fragments_MANTISSA_BITS);
}

fn fragments_pack_overlap(overlap: f32, steps: f32) -> u32 {
    return u32(round(steps * overlap / (1.0 + overlap)));
}

fn fragments_pack_fragment(fragment: fragments_Fragment, colored: u32) -> vec2u {
    var bits = 0u;
    if colored == 1u {
        bits = fragments_pack_rgb8e4(fragment.opacity) | (fragments_pack_overlap(fragment.overlap, fragments_OVERLAP_STEPS_COLORED) << 28u);
    }
    else {
        let rounded = bitcast<u32>(fragment.opacity.x) + (fragments_OVERLAP_BITS + 1u) / 2u;
        bits = (rounded & ~fragments_OVERLAP_BITS) | fragments_pack_overlap(fragment.overlap, fragments_OVERLAP_STEPS);
    }
    return vec2u(bitcast<u32>(fragment.z_m), bits);
}

fn fragments_unpack_opacity(bits: u32, colored: u32) -> vec3f {
    if colored == 1u {
        return fragments_unpack_rgb8e4(bits);
    }
    return vec3f(bitcast<f32>(bits & ~fragments_OVERLAP_BITS));
}

fn fragments_unpack_overlap(bits: u32, colored: u32) -> f32 {
    let share = select(f32(bits & fragments_OVERLAP_BITS) / fragments_OVERLAP_STEPS, f32(bits >> 28u) / fragments_OVERLAP_STEPS_COLORED, colored == 1u);
    return share / max(1.0 - share, 1.0 / fragments_OVERLAP_STEPS);
}

fn fragments_largest(color: vec3f) -> f32 {
    return max(color.r, max(color.g, color.b));
}

struct fragments_ListCounters {
    fragments: atomic<u32>,
    end: atomic<u32>
}

const fragments_ACCUMULATE_ADD = 0u;

const fragments_ACCUMULATE_MULTIPLY = 1u;

const fragments_ACCUMULATE_OVERLAP = 3u;

fn fragments_common_opacity(a: vec3f, b: vec3f, overlap: f32) -> vec3f {
    return clamp(overlap * a * b, max(a + b - 1.0, vec3f(0.0)), min(a, b));
}

fn fragments_accumulate(mode: u32, a: vec3f, b: vec3f, overlap: f32) -> vec3f {
    switch mode {
        case fragments_ACCUMULATE_ADD {
            return min(a + b, vec3f(1.0));
        }
        case fragments_ACCUMULATE_MULTIPLY {
            return a + b - a * b;
        }
        case fragments_ACCUMULATE_OVERLAP {
            return a + b - fragments_common_opacity(a, b, overlap);
        }
        case default {
            return max(a, b);
        }
    }
}
