//! Draws cases of `antumbra_viewer::masks` and writes the masks into a folder: `cargo run -p antumbra-viewer --example masks -- FOLDER
//! [techniques | NAME...]`. By default all cases are drawn; `techniques` draws only the first case of each technique, and names draw only
//! the first cases of those techniques. `cargo xtask web --check` compares a browser's masks with these.
//!
//! The first line of `cases.txt` names the adapter; each further line names a case. The mask of the case on line *n*,
//! counted from 0 after the first line, is `n.f32`: 32-bit floats, little-endian, row by row from the top.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> Result<(), String> {
    use antumbra::TechniqueKind;
    use antumbra_viewer::masks::{Case, Masks, cases};

    let folder = std::env::args_os()
        .nth(1)
        .map(std::path::PathBuf::from)
        .ok_or("usage: masks FOLDER: give the folder to write to")?;
    let write = |name: String, bytes: &[u8]| {
        std::fs::write(folder.join(&name), bytes).map_err(|error| format!("{}: {error}", folder.join(&name).display()))
    };
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut masks = pollster::block_on(Masks::new())?;
    let gpu = masks.gpu().clone();
    let mut lines = format!("{}\n", masks.adapter());
    let names: Vec<String> = std::env::args().skip(2).collect();
    let count = if names.is_empty() { usize::MAX } else { TechniqueKind::ALL.len() };
    let is_asked =
        |case: &Case| names.iter().all(|name| name == "techniques") || names.contains(&case.side.kind().to_string());
    for (index, case) in cases().iter().enumerate().take(count) {
        lines += &format!("{}\n", case.name());
        if !is_asked(case) {
            continue;
        }
        let rest = async || {
            // A lost device is reported by the next frame's error.
            let _ = gpu.device().poll(wgpu::PollType::wait_indefinitely());
        };
        let mask = pollster::block_on(masks.draw(case, rest)).map_err(|why| format!("{}: {why}", case.name()))?;
        let bytes: Vec<u8> = mask.iter().flat_map(|value| value.to_le_bytes()).collect();
        write(format!("{index}.f32"), &bytes)?;
    }
    write("cases.txt".into(), lines.as_bytes())
}

/// Stub for browsers, where examples are built only if all of them are requested.
#[cfg(target_arch = "wasm32")]
fn main() {}
