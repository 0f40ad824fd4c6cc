// Linked from src/techniques/receiver_lists/begin.wesl by `cargo xtask shaders`: edit that, not this.

const EITHER = 0u;

const DRAWN = 1u;

const WALKED = 2u;

override WAY: u32 = EITHER;

@compute @workgroup_size(1)
fn begin() {
    passes_work[0] = 0u;
    passes_work[1] = 0u;
    passes_totals[settings_TOTAL_PASS] = 0u;
    let is_taken = WAY == EITHER || select(WAY == DRAWN, WAY == WALKED, passes_totals[settings_TOTAL_CELLS] == 1u);
    passes_dispatch_groups(select(0u, (passes_totals[settings_TOTAL_LISTED] + 63u) / 64u, is_taken));
}

@group(0) @binding(0)
var<storage, read_write> passes_totals: array<u32>;

@group(0) @binding(1)
var<storage, read_write> passes_dispatches: array<u32>;

@group(0) @binding(2)
var<storage, read_write> passes_work: array<u32>;

const passes_MAX_GROUPS = 65535u;

fn passes_dispatch_groups(groups: u32) {
    passes_totals[settings_TOTAL_GROUPS] = groups;
    passes_dispatches[0] = min(groups, passes_MAX_GROUPS);
    passes_dispatches[1] = (groups + passes_MAX_GROUPS - 1u) / passes_MAX_GROUPS;
    passes_dispatches[2] = 1u;
}

const settings_TOTAL_LISTED = 0u;

const settings_TOTAL_GROUPS = 2u;

const settings_TOTAL_PASS = 3u;

const settings_TOTAL_CELLS = 4u;
