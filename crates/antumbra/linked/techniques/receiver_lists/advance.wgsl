// Linked from src/techniques/receiver_lists/advance.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(1)
fn advance() {
    let pass_number = package_techniques__1receiver_lists_passes_totals[package_techniques__1receiver_lists_settings__1TOTAL_PASS] + 1u;
    package_techniques__1receiver_lists_passes_totals[package_techniques__1receiver_lists_settings__1TOTAL_PASS] = pass_number;
    package_techniques__1receiver_lists_passes_work[1u - (pass_number & 1u)] = 0u;
    package_techniques__1receiver_lists_passes__1dispatch_groups(package_techniques__1receiver_lists_passes_work[pass_number & 1u]);
}

@group(0) @binding(0)
var<storage, read_write> package_techniques__1receiver_lists_passes_totals: array<u32>;

@group(0) @binding(1)
var<storage, read_write> package_techniques__1receiver_lists_passes_dispatches: array<u32>;

@group(0) @binding(2)
var<storage, read_write> package_techniques__1receiver_lists_passes_work: array<u32>;

const package_techniques__1receiver_lists_passes__1MAX_GROUPS = 65535u;

fn package_techniques__1receiver_lists_passes__1dispatch_groups(groups: u32) {
    package_techniques__1receiver_lists_passes_totals[package_techniques__1receiver_lists_settings__1TOTAL_GROUPS] = groups;
    package_techniques__1receiver_lists_passes_dispatches[0] = min(groups, package_techniques__1receiver_lists_passes__1MAX_GROUPS);
    package_techniques__1receiver_lists_passes_dispatches[1] = (groups + package_techniques__1receiver_lists_passes__1MAX_GROUPS - 1u) / package_techniques__1receiver_lists_passes__1MAX_GROUPS;
    package_techniques__1receiver_lists_passes_dispatches[2] = 1u;
}

const package_techniques__1receiver_lists_settings__1TOTAL_GROUPS = 2u;

const package_techniques__1receiver_lists_settings__1TOTAL_PASS = 3u;
