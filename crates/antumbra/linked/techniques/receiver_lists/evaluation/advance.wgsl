// Linked from src/techniques/receiver_lists/evaluation/advance.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(1)
fn advance() {
    let pass_number = bindings_totals[settings_TOTAL_PASS] + 1u;
    bindings_totals[settings_TOTAL_PASS] = pass_number;
    bindings_work[1u - (pass_number & 1u)] = 0u;
    bindings_dispatch_groups(bindings_work[pass_number & 1u]);
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

const settings_TOTAL_GROUPS = 2u;

const settings_TOTAL_PASS = 3u;
