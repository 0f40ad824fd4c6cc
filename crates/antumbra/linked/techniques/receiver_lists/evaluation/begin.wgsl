// Linked from src/techniques/receiver_lists/evaluation/begin.wesl by `cargo xtask shaders`: edit that, not this.

const EITHER = 0u;

const DRAWN = 1u;

const WALKED = 2u;

override WAY: u32 = EITHER;

@compute @workgroup_size(1)
fn begin() {
    bindings_work[0] = 0u;
    bindings_work[1] = 0u;
    bindings_totals[settings_TOTAL_PASS] = 0u;
    let is_taken = WAY == EITHER || select(WAY == DRAWN, WAY == WALKED, bindings_totals[settings_TOTAL_CELLS] == 1u);
    bindings_dispatch_groups(select(0u, (bindings_totals[settings_TOTAL_LISTED] + 63u) / 64u, is_taken));
}

@group(0) @binding(0)
var<storage, read_write> bindings_totals: array<u32>;

@group(0) @binding(1)
var<storage, read_write> bindings_dispatches: array<u32>;

@group(0) @binding(2)
var<storage, read_write> bindings_work: array<u32>;

const bindings_MAX_GROUPS = 65535u;

fn bindings_dispatch_groups(groups: u32) {
    bindings_totals[settings_TOTAL_GROUPS] = groups;
    bindings_dispatches[0] = min(groups, bindings_MAX_GROUPS);
    bindings_dispatches[1] = (groups + bindings_MAX_GROUPS - 1u) / bindings_MAX_GROUPS;
    bindings_dispatches[2] = 1u;
}

const settings_TOTAL_LISTED = 0u;

const settings_TOTAL_GROUPS = 2u;

const settings_TOTAL_PASS = 3u;

const settings_TOTAL_CELLS = 4u;
