// Linked from src/light_map/texel_lists/sort.wesl by `cargo xtask shaders`: edit that, not this.

struct ListSort {
    map_size: vec2u,
    capacity: u32,
    layers: u32,
    join_slope: f32,
    join_m: f32,
    adjoin_slope: f32,
    adjoin_m: f32
}

override COLORED: u32 = 0u;

override ACCUMULATION: u32 = 0u;

override JOINS: bool = false;

@group(0) @binding(0)
var<uniform> list_sort: ListSort;

@group(0) @binding(1)
var<storage, read> cursors: array<u32>;

@group(0) @binding(2)
var<storage, read_write> fragments: array<vec2u>;

@group(0) @binding(3)
var<storage, read_write> lists: array<vec2u>;

@group(0) @binding(4)
var<storage, read_write> counters: fragments_ListCounters;

@group(0) @binding(5)
var<storage, read> nodes: array<vec2u>;

@group(0) @binding(6)
var<storage, read> links: array<u32>;

fn is_before(a: vec2u, b: vec2u) -> bool {
    let za = bitcast<f32>(a.x);
    let zb = bitcast<f32>(b.x);
    return za < zb || (za == zb && a.y < b.y);
}

const GAP_FACTOR = 3u;

const MAX_GAPS = 20u;

fn sort(first: u32, count: u32) {
    var gap = 1u;
    for (var i = 0u; i < MAX_GAPS && GAP_FACTOR * gap + 1u < count; i++) {
        gap = GAP_FACTOR * gap + 1u;
    }
    for (var k = 0u; k < MAX_GAPS + 1u && gap > 0u; k++) {
        for (var i = gap; i < count; i++) {
            let moved = fragments[first + i];
            var place = i;
            for (var steps = 0u; steps < count && place >= gap; steps++) {
                let before = fragments[first + place - gap];
                if !is_before(moved, before) {
                    break;
                }
                fragments[first + place] = before;
                place -= gap;
            }
            fragments[first + place] = moved;
        }
        gap /= GAP_FACTOR;
    }
}

fn merge_adjoining(first: u32, index: u32, count: u32) -> fragments_GatheredFragment {
    var whole = fragments_unpack_gathered(fragments[first + index], COLORED);
    if whole.samples == fragments_ALL_SAMPLES || whole.samples == 0u {
        return whole;
    }
    let limit = whole.z_m + list_sort.adjoin_slope * whole.z_m + list_sort.adjoin_m;
    var covered = f32(countOneBits(whole.samples));
    var opacity = covered * whole.opacity;
    var z_sum = covered * whole.z_m;
    for (var i = index + 1u; i < count && whole.samples != fragments_ALL_SAMPLES; i++) {
        let next = fragments_unpack_gathered(fragments[first + i], COLORED);
        if next.z_m > limit {
            break;
        }
        let share = f32(countOneBits(next.samples & ~whole.samples));
        covered += share;
        opacity += share * next.opacity;
        z_sum += share * next.z_m;
        whole.samples |= next.samples;
        fragments[first + i] = fragments_pack_gathered(fragments_GatheredFragment(next.z_m, vec3f(), 0u), COLORED);
    }
    return fragments_GatheredFragment(z_sum / covered, opacity / covered, whole.samples);
}

fn sample_overlap(samples: u32, covered: u32) -> f32 {
    if covered == 0u {
        return 1.0;
    }
    let hidden = f32(countOneBits(samples & covered));
    return fragments_SAMPLE_COUNT * hidden / f32(countOneBits(samples) * countOneBits(covered));
}

fn cover(first: u32, count: u32) -> u32 {
    var kept = 0u;
    var sample_count = 0u;
    var samples_covered = 0u;
    for (var i = 0u; i < count; i++) {
        let gathered = merge_adjoining(first, i, count);
        if gathered.samples == 0u {
            continue;
        }
        if list_sort.layers > 0u && sample_count >= list_sort.layers * u32(fragments_SAMPLE_COUNT) {
            break;
        }
        let samples = countOneBits(gathered.samples);
        sample_count += samples;
        let opacity = gathered.opacity * (f32(samples) / fragments_SAMPLE_COUNT);
        var place = kept;
        for (; place > 0u && bitcast<f32>(fragments[first + place - 1u].x) > gathered.z_m; place--) {
            fragments[first + place] = fragments[first + place - 1u];
        }
        let overlap = sample_overlap(gathered.samples, samples_covered);
        samples_covered |= gathered.samples;
        fragments[first + place] = fragments_pack_fragment(fragments_Fragment(gathered.z_m, opacity, overlap), COLORED);
        kept++;
    }
    return kept;
}

fn join(first: u32, count: u32) -> u32 {
    var kept = 0u;
    var joined: fragments_Fragment;
    var limit = 0.0;
    var z_sum = 0.0;
    var n = 0u;
    for (var i = 0u; i < count; i++) {
        let next = fragments_unpack_fragment(fragments[first + i], COLORED);
        if n > 0u && next.z_m <= limit {
            z_sum += next.z_m;
            n++;
            joined.opacity = fragments_accumulate(ACCUMULATION, joined.opacity, next.opacity, next.overlap);
            continue;
        }
        if n > 0u {
            joined.z_m = z_sum / f32(n);
            fragments[first + kept] = fragments_pack_fragment(joined, COLORED);
            kept++;
        }
        joined = next;
        limit = next.z_m + list_sort.join_slope * next.z_m + list_sort.join_m;
        z_sum = next.z_m;
        n = 1u;
    }
    if n > 0u {
        joined.z_m = z_sum / f32(n);
        fragments[first + kept] = fragments_pack_fragment(joined, COLORED);
        kept++;
    }
    return kept;
}

fn finish_list(first: u32, gathered_count: u32) -> u32 {
    sort(first, gathered_count);
    let count = cover(first, gathered_count);
    if JOINS {
        return join(first, count);
    }
    return count;
}

@compute @workgroup_size(8, 8)
fn sort_lists(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= list_sort.map_size) {
        return;
    }
    let texel = id.y * list_sort.map_size.x + id.x;
    let is_last = all(id.xy == list_sort.map_size - 1u);
    let first = min(links[texel], list_sort.capacity);
    let room_end = select(links[texel + select(1u, 0u, is_last)], list_sort.capacity, is_last);
    let end = max(min(cursors[texel], min(room_end, list_sort.capacity)), first);
    lists[texel] = vec2u(first, finish_list(first, end - first));
    if is_last {
        atomicStore(&counters.fragments, cursors[texel]);
        atomicStore(&counters.end, end);
    }
}

const WORKGROUP = 64u;

var<workgroup> sums: array<u32, WORKGROUP>;

var<workgroup> workgroup_first: u32;

@compute @workgroup_size(8, 8)
fn pack_lists(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let is_inside = all(id.xy < list_sort.map_size);
    let texel = id.y * list_sort.map_size.x + id.x;
    var head = 0u;
    if is_inside {
        head = cursors[texel];
    }
    var count = 0u;
    var walked = head;
    for (; count < list_sort.capacity && walked != 0u; count++) {
        walked = links[walked - 1u];
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
    if !is_inside {
        return;
    }
    let first = min(workgroup_first + sums[local], list_sort.capacity);
    let room = min(count, list_sort.capacity - first);
    var node = head;
    for (var place = 0u; place < room; place++) {
        fragments[first + place] = nodes[node - 1u];
        node = links[node - 1u];
    }
    lists[texel] = vec2u(first, finish_list(first, room));
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

struct fragments_GatheredFragment {
    z_m: f32,
    opacity: vec3f,
    samples: u32
}

const fragments_ALL_SAMPLES = 15u;

const fragments_SAMPLE_COUNT = 4.0;

fn fragments_pack_gathered(fragment: fragments_GatheredFragment, colored: u32) -> vec2u {
    var bits = (bitcast<u32>(fragment.opacity.x) & ~fragments_ALL_SAMPLES) | fragment.samples;
    if colored == 1u {
        let m = vec3u(round(511.0 * saturate(fragment.opacity)));
        bits = m.r | (m.g << 9u) | (m.b << 18u) | (fragment.samples << 27u);
    }
    return vec2u(bitcast<u32>(fragment.z_m), bits);
}

fn fragments_unpack_gathered(bits: vec2u, colored: u32) -> fragments_GatheredFragment {
    var fragment = fragments_GatheredFragment(bitcast<f32>(bits.x), vec3f(), 0u);
    if colored == 1u {
        fragment.opacity = vec3f(vec3u(bits.y & 511u, (bits.y >> 9u) & 511u, (bits.y >> 18u) & 511u)) / 511.0;
        fragment.samples = bits.y >> 27u;
    }
    else {
        fragment.opacity = vec3f(bitcast<f32>(bits.y & ~fragments_ALL_SAMPLES));
        fragment.samples = bits.y & fragments_ALL_SAMPLES;
    }
    return fragment;
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

fn fragments_unpack_fragment(bits: vec2u, colored: u32) -> fragments_Fragment {
    return fragments_Fragment(bitcast<f32>(bits.x), fragments_unpack_opacity(bits.y, colored), fragments_unpack_overlap(bits.y, colored));
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
