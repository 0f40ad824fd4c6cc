//! Feeds the viewer random input and prints its memory use: `cargo run -p antumbra-viewer --example random_input -- SECONDS
//! [SEED] [FOLDER] [TECHNIQUES]`. Files of FOLDER, valid or broken, are opened and dropped like built-in scenes. TECHNIQUES
//! are names separated by commas; without them every technique may be chosen.
//!
//! Every half minute the application returns to its initial state and prints a line: the resident memory of the process, which includes
//! the driver's; the heap of Rust code, which includes wgpu's; the number of objects on the device. Any failure ends the run with a panic.

#[cfg(not(target_arch = "wasm32"))]
mod counting {
    //! The system's allocator with a count of the allocated bytes.

    use std::alloc::{GlobalAlloc, Layout, System};
    use std::sync::atomic::{AtomicI64, Ordering};

    struct Counting;

    static HELD_BYTES: AtomicI64 = AtomicI64::new(0);

    #[allow(unsafe_code, reason = "implementing GlobalAlloc requires unsafe code")]
    unsafe impl GlobalAlloc for Counting {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            HELD_BYTES.fetch_add(layout.size() as i64, Ordering::Relaxed);
            unsafe { System.alloc(layout) }
        }
        unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
            HELD_BYTES.fetch_sub(layout.size() as i64, Ordering::Relaxed);
            unsafe { System.dealloc(pointer, layout) }
        }
    }

    #[global_allocator]
    static ALLOCATOR: Counting = Counting;

    /// Bytes that Rust code has allocated on the heap.
    pub fn held_bytes() -> i64 {
        HELD_BYTES.load(Ordering::Relaxed)
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn main() -> Result<(), String> {
    use std::time::{Duration, Instant};

    use antumbra::TechniqueKind;
    use antumbra_viewer::random_input::{RandomInput, things_to_open};

    const BETWEEN_LINES: Duration = Duration::from_secs(30);
    const USAGE: &str = "usage: random_input SECONDS [SEED] [FOLDER] [TECHNIQUES]: SECONDS and SEED are whole numbers, SEED is \
         not 0, TECHNIQUES are names separated by commas";

    let mut arguments = std::env::args().skip(1);
    let seconds: u64 = arguments.next().and_then(|text| text.parse().ok()).ok_or(USAGE)?;
    let seed = arguments.next().map_or(Some(1), |text| text.parse().ok()).filter(|seed| *seed > 0).ok_or(USAGE)?;
    let folder = arguments.next();
    let kinds = arguments
        .next()
        .map_or(Some(TechniqueKind::ALL.to_vec()), |names| names.split(',').map(TechniqueKind::from_name).collect());
    let kinds = kinds.filter(|kinds| !kinds.is_empty()).ok_or(USAGE)?;
    let things = things_to_open(folder.as_ref().map(std::path::Path::new))
        .map_err(|error| format!("{}: {error}", folder.unwrap_or_default()))?;
    let count = things.len();
    let mut input = RandomInput::new(seed, things, kinds).map_err(|error| error.to_string())?;
    println!("{}; seed {seed}; {count} things to open", input.adapter());
    println!("seconds  steps  opened  process MiB  heap MiB  buffers  textures  bind groups  pipelines");
    let (began, mut steps) = (Instant::now(), 0u64);
    loop {
        let objects = input.come_home();
        println!(
            "{:7}  {steps:5}  {:6}  {:>11}  {:8.1}  {:7}  {:8}  {:11}  {:9}",
            began.elapsed().as_secs(),
            input.opened(),
            resident_bytes().map_or("unknown".into(), |bytes| format!("{:.1}", mebibytes(bytes))),
            mebibytes(counting::held_bytes()),
            objects.buffers,
            objects.textures,
            objects.bind_groups,
            objects.pipelines
        );
        let line_began = Instant::now();
        while line_began.elapsed() < BETWEEN_LINES && began.elapsed().as_secs() < seconds {
            input.step();
            steps += 1;
        }
        if line_began.elapsed() < BETWEEN_LINES {
            return Ok(());
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn mebibytes(bytes: i64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// Resident memory of the process, bytes; `None` on systems without Linux's `/proc/self/status`.
#[cfg(not(target_arch = "wasm32"))]
fn resident_bytes() -> Option<i64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: i64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes << 10)
}

/// Stub for browsers, where examples are built only if all of them are requested.
#[cfg(target_arch = "wasm32")]
fn main() {}
